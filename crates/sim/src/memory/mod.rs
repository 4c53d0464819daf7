//! How much memory a run takes: counted from the sizes of what it holds, before any of it is there.

pub(crate) mod amounts;

use crate::SimulationError;
use crate::foresight::Course;
use crate::free_memory::available;
use crate::material::elastic::Elastic;
use crate::total;
use crate::updated::Updated;
use amounts::{Amounts, Need};
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::{Formulation, HeldParticles, OnDistortion, Scene};

/// What the program takes without a scene [bytes]: `fissure run` on bodies of a few particles.
const PROGRAM: f64 = 13.5 * MEBIBYTE;

/// What the division keeps for each cell near a crack: its entry in the map, and a list of a few segments [bytes].
const NEAR_CELL: f64 = 128.0;

/// What each cell of growth adds: particles cut anew, eight points of either face with their stencils, in states and
/// frames too, and their part in making a mesh [bytes]. 30 to 65 kB were taken where cracks grow by 60 to 500 cells.
const GROWN_CELL: f64 = 45e3;

/// What the allocator keeps of what it was given back, as a part of what is needed, and at most [bytes]: large pieces
/// go back to the system. Gaps come up by and by, within some twenty frames.
const KEPT_PART: f64 = 0.25;
const KEPT_AT_MOST: f64 = 7.0 * MEBIBYTE;
const FRAMES_TO_GAPS: f64 = 24.0;

/// What making a mesh takes for each vertex of the outlines [bytes].
const MESH_PER_POINT: f64 = 1000.0;

/// Frames held at once: the one at hand, the one before, of which the mesh is made, and the file of one.
const FRAMES: f64 = 3.0;

/// States held at once: that of the solver, and the whole one with a copy of it.
const STATES: f64 = 2.0;

/// Particles within a cell of an outline or a crack, for each of those that lie in cut cells there.
const ROWS_AT_SURFACES: f64 = 2.0;

const MEBIBYTE: f64 = (1 << 20) as f64;

/// Bytes of the particles at rest: places, positions, numbers of body and material, volume and mass, and the number of
/// the fragment.
const PARTICLE: usize = size_of::<[i32; 2]>() + size_of::<Point>() + 3 * size_of::<u32>() + 2 * size_of::<f64>();

/// Bytes of a particle at rest in a frame, of which those are chosen that the take holds.
const CHOSEN_FROM: usize = 3 * size_of::<u32>() + size_of::<f64>() + size_of::<Point>();

/// Bytes of a particle in a frame.
const FRAME_PARTICLE: usize =
    3 * size_of::<u32>() + size_of::<f64>() + 2 * size_of::<Point>() + size_of::<Vector>() + 2 * size_of::<Matrix>();

/// Bytes of a vertex of an outline in a frame.
const FRAME_OUTLINE_POINT: usize = 2 * size_of::<Point>() + size_of::<Vector>();

/// Memory that a run of `scene` takes, meshes included, when it begins in `formulation` and its cracks grow by `growth`
/// [m] [bytes].
pub(crate) fn needed(scene: &Scene, formulation: Formulation, growth: f64) -> f64 {
    let amounts = Amounts::of(scene, growth);
    let need = match formulation {
        Formulation::Updated => Updated::memory(scene, &amounts),
        _ if scene.solver.on_distortion == OnDistortion::Switch => {
            let (total, updated) = (total::memory::need(scene, &amounts), Updated::memory(scene, &amounts));
            Need { solver: total.solver.max(updated.solver), state: total.state.max(updated.state) }
        }
        _ => total::memory::need(scene, &amounts),
    };
    let (held, chosen_from) = match scene.take.particles {
        HeldParticles::Full => (amounts.particles, 0.0),
        HeldParticles::Surface => {
            ((ROWS_AT_SURFACES * amounts.cut_particles).min(amounts.particles), amounts.particles)
        }
        HeldParticles::None => (0.0, amounts.particles),
    };
    let frame = held * FRAME_PARTICLE as f64 + amounts.outline_points * FRAME_OUTLINE_POINT as f64;
    let needed = PROGRAM
        + amounts.particles * PARTICLE as f64
        + amounts.outline_points * MESH_PER_POINT
        + amounts.crack_cells * NEAR_CELL
        + amounts.grown_cells * GROWN_CELL
        + need.solver
        + FRAMES * frame
        + chosen_from * CHOSEN_FROM as f64
        + STATES * need.state;
    let gaps = (scene.frames.count().saturating_sub(1) as f64 / FRAMES_TO_GAPS).min(1.0);
    needed + gaps * (KEPT_PART * needed).min(KEPT_AT_MOST)
}

/// Checks that a run fits into the memory there is, where that is known.
///
/// # Errors
/// [`SimulationError::TooManyParticles`] with the spacing that fits.
pub(crate) fn check(scene: &Scene, formulation: Formulation) -> Result<(), SimulationError> {
    available().map_or(Ok(()), |available| check_against(scene, formulation, available as f64))
}

fn check_against(scene: &Scene, formulation: Formulation, available: f64) -> Result<(), SimulationError> {
    // Once, not for every spacing that is tried: it asks each crack about all others.
    let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
    let growth = Course::of(scene, &elastic).growth;
    let needed = needed(scene, formulation, growth);
    if needed <= available {
        return Ok(());
    }
    Err(SimulationError::TooManyParticles {
        particles: Amounts::of(scene, growth).particles.round() as u64,
        needed: (needed / MEBIBYTE).ceil() as u64,
        available: (available / MEBIBYTE) as u64,
        fitting: fitting_spacing(scene, formulation, growth, available),
    })
}

/// A spacing of particles with which a run fits, two digits; none where it hardly depends on that.
fn fitting_spacing(scene: &Scene, formulation: Formulation, growth: f64, available: f64) -> Option<f64> {
    let mut coarser = scene.clone();
    let cells = scene.cell_size / scene.particle_spacing;
    (0..200).map(|k| scene.particle_spacing * 1.1_f64.powi(k + 1)).find_map(|spacing| {
        let digit = 10.0_f64.powf(spacing.log10().floor() - 1.0);
        let spacing = (spacing / digit).ceil() * digit;
        (coarser.particle_spacing, coarser.cell_size) = (spacing, cells * spacing);
        (needed(&coarser, formulation, growth) <= available).then_some(spacing)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use crate::Simulation;
    use crate::test_scenes::{add_body, free_body, rectangle};

    /// Truth: the laid scene, wherever the second body is.
    #[test]
    fn amounts_are_those_of_the_laid_scene() {
        let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 9.0]), 0.05);
        add_body(&mut scene, [1e5, 3e4]);
        let amounts = Amounts::of(&scene, 0.0);
        let laid = Simulation::new(&scene).unwrap();
        assert!((amounts.particles / laid.particles() as f64 - 1.0).abs() < 0.01, "{amounts:?}");
        assert_eq!(amounts.outline_points, 2.0 * 26.0 / 0.05);
    }

    /// Truth: what is told is what is checked, and the spacing that is named fits.
    #[test]
    fn what_does_not_fit_is_refused_at_once_with_a_spacing_that_fits() {
        // 1e12 particles.
        let mut scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 1e-6);
        for formulation in [Formulation::Total, Formulation::Updated] {
            let available = 2.0 * 1024.0 * MEBIBYTE;
            let found = check_against(&scene, formulation, available);
            let Err(SimulationError::TooManyParticles { particles, needed, available: 2048, fitting: Some(fitting) }) =
                found
            else {
                panic!("{found:?}");
            };
            assert!((particles as f64 / 1e12 - 1.0).abs() < 1e-9 && needed > 100_000_000);
            (scene.particle_spacing, scene.cell_size) = (fitting, 2.0 * fitting);
            assert_eq!(check_against(&scene, formulation, available), Ok(()));
            // No more than a tenth too coarse, and its rounding.
            (scene.particle_spacing, scene.cell_size) = (fitting / 1.25, 2.0 * fitting / 1.25);
            assert!(check_against(&scene, formulation, available).is_err());
            (scene.particle_spacing, scene.cell_size) = (1e-6, 2e-6);
        }
        if cfg!(feature = "system") {
            assert!(matches!(Simulation::new(&scene), Err(SimulationError::TooManyParticles { .. })));
        }
    }
}
