//! Cells that are not filled alike.

use fissure_plane::bounds;
use fissure_scene::{Formulation, KeyPath, Scene, SceneFault};

/// How far particles may move along within their cells from one end of the bodies to the other, in spacings. In cells
/// of a whole number of particles they are half a spacing from the lines of nodes.
const MOST_DRIFT: f64 = 0.25;

/// Checks that cells in which particles stay are a whole number of them wide.
///
/// Otherwise some particles lie beside a line of nodes, and where no others are beyond it, at an outline or across a
/// crack, the nodes there have hardly any mass: of plates with 1.5 or 2.5 particles along a cell, turned anyhow, some
/// ask for steps a hundred to a billion times shorter, and where a crack grows by such a place steps grow too long.
pub(super) fn check_whole_cells(scene: &Scene, formulation: Formulation) -> Result<(), SceneFault> {
    let (cell, spacing) = (scene.cell_size, scene.particle_spacing);
    let corners = scene.bodies.iter().flat_map(|body| <[_; 2]>::from(body.region.bounds()));
    let (low, high) = bounds(&corners.collect::<Vec<_>>());
    let (along, cells) = (cell / spacing, (high - low).amax() / cell);
    let whole = along.round().max(1.0);
    if formulation != Formulation::Total || (along - whole).abs() * cells <= MOST_DRIFT {
        return Ok(());
    }
    let message = format!(
        "cells of {cell} m are {along:.4} particle spacings of {spacing} m wide: where particles lie beside lines of nodes steps \
         would have to be far shorter"
    );
    let remedy = format!(
        "leave `grid.cell_size` out, which makes it {} m, or set `grid.particle_spacing` to {} m, a {} of it",
        2.0 * spacing,
        cell / whole,
        match whole as u64 {
            1 => "whole".into(),
            2 => "half".into(),
            3 => "third".into(),
            n => format!("{n}th"),
        }
    );
    Err(SceneFault::new(KeyPath::setting("grid", "cell_size"), message, remedy))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::Simulation;
    use crate::test_scenes::{free_body, rectangle};
    use fissure_plane::Vector;
    use fissure_scene::{Formulation, Kernel};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Truth: the wave that fits into a cell. Turned anyhow, what is not refused takes steps of the length that
        /// waves ask for, and what is refused is told with a spacing that is taken.
        #[test]
        fn steps_are_as_long_as_waves_ask_for(
            angle in -3.2..3.2_f64,
            size in (8.0..20.0_f64, 4.0..12.0_f64),
            per_cell in prop::sample::select(vec![1.0, 1.5, 1.75, 2.0, 2.0 + 1e-9, 2.003, 2.1, 2.5, 3.0]),
        ) {
            let mut region = rectangle([0.0, 0.0], [size.0, size.1]);
            let turn = nalgebra::Rotation2::new(angle);
            region.exterior.iter_mut().for_each(|p| *p = turn * *p + Vector::new(0.3, 0.7));
            let mut scene = free_body(region, 1.0 / per_cell);
            scene.cell_size = 1.0;
            scene.solver.formulation = Formulation::Total;
            scene.solver.kernel = Kernel::Bilinear;
            let fastest = 36.7; // m/s: E = 1000 Pa, ν = .3, ρ = 1 kg/m³, plane strain
            match Simulation::estimate(&scene) {
                Ok(estimate) => {
                    prop_assert!([1.0, 2.0, 3.0].iter().any(|n: &f64| (n - per_cell).abs() < 0.01), "{per_cell}");
                    let cells = estimate.stable_time_step * fastest;
                    prop_assert!(cells > 0.2, "{cells}");
                }
                Err(error) => {
                    let told = error.to_string();
                    let spacing: f64 =
                        told.split("`grid.particle_spacing` to ").nth(1).unwrap().split(" m").next().unwrap().parse().unwrap();
                    prop_assert!([1.5, 1.75, 2.003, 2.1, 2.5].contains(&per_cell), "{per_cell}: {told}");
                    scene.particle_spacing = spacing;
                    prop_assert!(Simulation::new(&scene).is_ok(), "{told}");
                }
            }
        }
    }
}
