//! Static edge crack: K_I against a converged finite element solution, for both presets.
#![allow(clippy::unwrap_used)]

use fissure_scene::{Formulation, PlaneState, SolverPreset};
use fissure_sim::Simulation;
use fissure_verify::EdgeCrack;

/// Measured over 16 places of the tip within a cell at 8 cells per crack, at worst: K_I 0.54 %, J against K_I 0.086 %,
/// K_II 0.18 % of K_I (where the crack parts the squares of particles in the middle); 684 steps to rest.
#[test]
fn the_standard_preset_is_within_half_a_per_cent_at_eight_cells() {
    for place in 0..16 {
        let (along, across) = (f64::from(place % 4), f64::from(place / 4));
        let tip_offset = [-0.375 + 0.25 * along, 0.01 + 0.25 * across];
        let problem = EdgeCrack { tip_offset, ..EdgeCrack::default() };
        let found = problem.run(SolverPreset::Standard).unwrap();
        let error = found.mode_1 / problem.mode_1() - 1.0;
        assert!(error.abs() < 0.006, "K_I off by {error} at {tip_offset:?}");
        assert!((found.mode_1_of_j / found.mode_1 - 1.0).abs() < 0.0012, "J and K_I disagree: {found:?}");
        assert!((found.mode_2 / found.mode_1).abs() < 0.002, "K_II of a symmetric problem: {found:?}");
        assert!(found.steps < 720, "{} steps to rest", found.steps);
    }
}

/// With traction alone K does not depend on the elastic constants or the plane state. Measured: 2e-5.
#[test]
fn plane_stress_gives_the_stress_intensity_of_plane_strain() {
    let strain = EdgeCrack::default().run(SolverPreset::Standard).unwrap();
    let stress = EdgeCrack { plane: PlaneState::Stress, ..EdgeCrack::default() }.run(SolverPreset::Standard).unwrap();
    assert!((stress.mode_1 / strain.mode_1 - 1.0).abs() < 5e-5, "{strain:?} {stress:?}");
}

/// The thesis' scheme is known to give 10.5 % too much at 8 cells: the wide kernel makes the crack act longer than it
/// is.
#[test]
fn the_thesis_preset_has_its_known_error() {
    let problem = EdgeCrack::default();
    let found = problem.run(SolverPreset::Thesis).unwrap();
    let error = found.mode_1 / problem.mode_1() - 1.0;
    assert!((0.1..0.11).contains(&error), "K_I off by {error}");
}

/// The updated formulation, whose kernel is wider. Measured at 6 cells per crack: −2.3 to +1.6 %.
#[test]
fn the_updated_formulation_is_within_three_per_cent_at_six_cells() {
    for tip_offset in [[-0.125, 0.26], [0.0, 0.6], [0.25, 0.1]] {
        let problem = EdgeCrack { slenderness: 1, cells: 6.0, tip_offset, ..EdgeCrack::default() };
        let mut scene = problem.scene(SolverPreset::Standard);
        scene.solver.formulation = Formulation::Updated;
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.relax(1e-7, 20_000).unwrap();
        let error = simulation.tips()[0].mode_1 / problem.mode_1() - 1.0;
        assert!(error.abs() < 0.03, "K_I off by {error} at {tip_offset:?}");
    }
}
