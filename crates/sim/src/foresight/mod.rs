//! What will go wrong with a scene, told before it runs.
//!
//! Faults need the particles and stop a simulation before it begins. Warnings come from the scene alone and stop
//! nothing; they rest on estimates of the order of magnitude, made so that they stay silent where they are not sure.

mod accuracy;
mod buried;
mod course;
mod dispensable;
mod drawn_tip;
mod driving;
mod groups;
mod idle;
mod matter;
mod pace;
mod samples;
mod section;
mod strain;
mod supports;
mod toughness;
mod whole_cells;
mod wholeness;
mod width;

pub(crate) use accuracy::accuracy;
pub use accuracy::{Accuracy, Limit};
pub(crate) use course::Course;
pub use dispensable::dispensable;
pub(crate) use strain::overload;

use crate::material::elastic::Elastic;
use crate::particles::Particles;
use fissure_scene::{Formulation, Scene, SceneFault, Warning};

/// Checks what can be seen only when the particles are laid.
///
/// # Errors
/// A body that is too narrow for its particles to hold together; supports that contradict each other; a body inside a
/// collider; cells that are no whole number of particles wide, where the `formulation` needs it.
pub(crate) fn check_layout(scene: &Scene, particles: &Particles, formulation: Formulation) -> Result<(), SceneFault> {
    whole_cells::check_whole_cells(scene, formulation)?;
    wholeness::check_wholeness(scene, particles)?;
    supports::check_supports(scene, particles)?;
    buried::check_colliders(scene, particles)
}

/// What will hardly go well with a validated scene. Paths count items as in the scene.
pub fn warnings(scene: &Scene) -> Vec<Warning> {
    let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
    let mut found = width::narrow_bodies(scene);
    found.extend(matter::unlikely_materials(scene, &elastic));
    found.extend(strain::soft_materials(scene, &elastic));
    match idle::nothing_loads(scene) {
        Some(warning) => found.push(warning),
        None => {
            found.extend(pace::crosses_at_once(scene, &elastic));
            found.extend(toughness::out_of_reach(scene, &elastic));
        }
    }
    found
}
