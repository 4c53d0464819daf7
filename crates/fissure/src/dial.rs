//! The particle spacing that a wish for an accuracy or a time comes to, as overrides of the scene.

use crate::check::expected_seconds;
use crate::exit::Exit;
use crate::failure::Failure;
use fissure_scene::{KeyPath, Scene, Wish};
use fissure_sim::{DialError, Simulation};

/// The overrides that make `scene` as wished.
///
/// # Errors
/// When no particle spacing does.
pub(crate) fn overrides(scene: &Scene, wish: Wish) -> Result<Vec<String>, Failure> {
    let spacing = Simulation::spacing_for(scene, wish, &expected_seconds)?;
    let mut keys = vec![format!("grid.particle_spacing={spacing:?}")];
    let ratio = scene.cell_size / scene.particle_spacing;
    // Twice is the default; another ratio is kept.
    if (ratio - 2.0).abs() > 1e-9 {
        keys.push(format!("grid.cell_size={:?}", ratio * spacing));
    }
    Ok(keys)
}

/// Where a scene says what it wishes for.
pub(crate) fn key(wish: Wish) -> KeyPath {
    KeyPath::setting(
        "grid",
        match wish {
            Wish::Accuracy(_) => "accuracy",
            Wish::Budget(_) => "budget",
        },
    )
}

impl From<DialError> for Failure {
    fn from(error: DialError) -> Self {
        match error {
            DialError::Simulation(error) => error.into(),
            // The others name their remedy.
            error => Self::of(Exit::Usage, error),
        }
    }
}
