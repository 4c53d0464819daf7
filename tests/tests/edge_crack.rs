//! Static edge crack: K_I against a converged finite element solution, for both presets.
#![allow(clippy::unwrap_used)]

use fissure_scene::{PlaneState, SolverPreset};
use fissure_verify::EdgeCrack;

/// Measured over 16 offsets of the tip within a cell at 8 cells: worst 3.0 %, mean 0.4 %.
#[test]
fn the_standard_preset_is_within_three_per_cent_at_eight_cells() {
    for tip_offset in [[-0.375, 0.01], [-0.125, 0.26], [0.125, 0.51], [0.375, 0.76]] {
        let problem = EdgeCrack { tip_offset, ..EdgeCrack::default() };
        let found = problem.run(SolverPreset::Standard).unwrap();
        let error = found.mode_1 / problem.mode_1() - 1.0;
        assert!(error.abs() < 0.035, "K_I off by {error} at {tip_offset:?}");
        assert!((found.mode_1_of_j / found.mode_1 - 1.0).abs() < 0.01, "J and K_I disagree: {found:?}");
        assert!((found.mode_2 / found.mode_1).abs() < 0.015, "K_II of a symmetric problem: {found:?}");
    }
}

/// With traction alone K does not depend on the elastic constants or the plane state.
#[test]
fn plane_stress_gives_the_stress_intensity_of_plane_strain() {
    let strain = EdgeCrack::default().run(SolverPreset::Standard).unwrap();
    let stress = EdgeCrack { plane: PlaneState::Stress, ..EdgeCrack::default() }.run(SolverPreset::Standard).unwrap();
    assert!((stress.mode_1 / strain.mode_1 - 1.0).abs() < 5e-3, "{strain:?} {stress:?}");
}

/// The thesis' scheme is known to give some 10 % too much at 8 cells: the wide kernel makes the crack act longer than
/// it is.
#[test]
fn the_thesis_preset_has_its_known_error() {
    let problem = EdgeCrack::default();
    let found = problem.run(SolverPreset::Thesis).unwrap();
    let error = found.mode_1 / problem.mode_1() - 1.0;
    assert!((0.05..0.16).contains(&error), "K_I off by {error}");
}
