//! How a frame becomes meshes.

use crate::error::PostError;
use fissure_scene::{Attribute, Curve, Cut, OpeningSettings, OutputSettings, Part, Roughness, UpAxis, Walls};

/// Shortest edge of contours, as a part of the body: twice the distance at which readers merge vertices, because
/// triangles without small angles need shorter ones than their outline has.
const SHORTEST_EDGE: f64 = 2e-4;

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
    /// Where the material is cut.
    pub cut: Cut,
    /// How far the paths of cracks may be moved to be smooth, in cells; 0: not at all.
    pub smoothing: f64,
    /// How long edges of crack walls may be where their path is straight, in cells; 0: as cracks grew.
    pub wall_step: f64,
    /// Edges shorter than this part of the body are taken out, unless they were drawn; contours that touch in a point
    /// are parted by a quarter of it.
    pub shortest_edge: f64,
    /// How rough the walls of cracks are; none: smooth.
    pub roughness: Option<Roughness>,
    /// How wide the edges between walls of cracks and caps are bevelled [m]; 0: not at all.
    pub bevel: f64,
    /// Whether meshes have a second set of texture coordinates, in metres.
    pub uv_in_metres: bool,
    /// What of the history of crack walls meshes tell.
    pub attributes: Vec<Attribute>,
    /// Length of the edges within caps, at most; none: as long as may be [m].
    pub cap_size: Option<f64>,
    /// How wide cracks are shown; none: as they are.
    pub opening: Option<OpeningSettings>,
    /// How far fragments are shown apart over time; none: where they are.
    pub explode: Option<Curve>,
    /// What to make.
    pub parts: Vec<Part>,
    /// Up axis of formats that do not fix it.
    pub up: UpAxis,
}

impl From<&OutputSettings> for PostOptions {
    /// The settings of a scene, with a crease angle of 30 degrees and no edges below 2e-4 of the body.
    fn from(output: &OutputSettings) -> Self {
        Self {
            thickness: output.thickness,
            crease_angle: 30.0_f64.to_radians(),
            smallest_fragment: output.smallest_fragment,
            walls: output.walls,
            cut: output.surfaces.cut,
            smoothing: output.surfaces.smoothing,
            wall_step: output.surfaces.wall_step,
            opening: output.opening.clone(),
            explode: output.explode.clone(),
            roughness: output.surfaces.roughness,
            bevel: output.surfaces.bevel,
            uv_in_metres: output.surfaces.uv_in_metres,
            attributes: output.attributes.clone(),
            shortest_edge: SHORTEST_EDGE,
            cap_size: output.surfaces.cap_size,
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
        self.cap_size.map_or(Ok(()), |size| positive("cap_size", size))?;
        if let Some(roughness) = &self.roughness {
            positive("roughness.amplitude", roughness.amplitude)?;
            positive("roughness.length", roughness.length)?;
        }
        not_negative("smallest_fragment", self.smallest_fragment)?;
        not_negative("smoothing", self.smoothing)?;
        not_negative("wall_step", self.wall_step)?;
        not_negative("bevel", self.bevel)?;
        not_negative("shortest_edge", self.shortest_edge)?;
        not_negative("crease_angle", self.crease_angle)
    }
}
