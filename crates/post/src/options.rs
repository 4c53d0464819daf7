//! How a frame becomes meshes.

use crate::error::PostError;
use fissure_scene::{OutputSettings, Part, UpAxis, Walls};

/// How a frame becomes meshes. Made from [`OutputSettings`], then changed at will.
#[derive(Debug, Clone, PartialEq)]
pub struct PostOptions {
    /// Thickness of solids, half on each side of the drawing plane [m]; above 0.
    pub thickness: f64,
    /// Walls that turn by less than this look smooth [rad].
    pub crease_angle: f64,
    /// Polygons of less area are left out [m²].
    pub smallest_fragment: f64,
    /// Which cracks inside a fragment have walls.
    pub walls: Walls,
    /// What to make.
    pub parts: Vec<Part>,
    /// Up axis of formats that do not fix it.
    pub up: UpAxis,
}

impl From<&OutputSettings> for PostOptions {
    /// The settings of a scene, with a crease angle of 30 degrees.
    fn from(output: &OutputSettings) -> Self {
        Self {
            thickness: output.thickness,
            crease_angle: 30.0_f64.to_radians(),
            smallest_fragment: output.smallest_fragment,
            walls: output.walls,
            parts: output.parts.clone(),
            up: output.up,
        }
    }
}

impl PostOptions {
    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// [`PostError::Option`]
    pub(crate) fn check(&self) -> Result<(), PostError> {
        let positive = |name, value: f64| {
            let fine = value.is_finite() && value as f32 > 0.0 && (value as f32).is_finite();
            if fine {
                Ok(())
            } else {
                Err(PostError::Option { name, value, range: "above 0 that single precision can hold" })
            }
        };
        let not_negative = |name, value: f64| {
            let fine = value.is_finite() && value >= 0.0;
            if fine { Ok(()) } else { Err(PostError::Option { name, value, range: "of at least 0" }) }
        };
        positive("thickness", self.thickness)?;
        not_negative("smallest_fragment", self.smallest_fragment)?;
        not_negative("crease_angle", self.crease_angle)
    }
}
