//! Velocities of particles that are sent to the grid once more.

use super::gather::{FromGrid, Wanted};
use super::particles_to_grid::ToGrid;
use super::supports::{HeldStep, Supports};
use crate::boundary::collider::PlacedObstacle;

/// S⁺ S v: the beginning's velocities, sent to the particles and back, at each field [m/s].
pub(super) fn smoothed_velocities(to: &ToGrid<'_>, from: &FromGrid<'_>) -> [Vec<f64>; 2] {
    let velocities = from.gather_all(&to.points.point, Wanted::BEFORE, |_, g| g.before);
    to.mean(&velocities, &from.nodes.mass)
}

/// Velocities for the strains of the bilinear kernel: the particles' new ones, sent to the grid once more (Sulsky, Zhou
/// & Schreyer 1995), at each field [m/s].
///
/// A particle that has just entered a cell reaches its far nodes with a weight w → 0 but a gradient of 1/h, so that
/// their velocity f Δt/m grows as 1/w and would turn the particle inside out. Wider kernels have gradients that vanish
/// with the weight.
pub(super) fn remapped_velocities(
    to: &ToGrid<'_>,
    from: &FromGrid<'_>,
    obstacles: &[PlacedObstacle<'_>],
    supports: &Supports,
    step: HeldStep,
) -> [Vec<f64>; 2] {
    let settings = &from.setup.scene.solver;
    let wanted = Wanted::by(settings.transfer, settings.kernel);
    let mut velocities = from.gather_all(&to.points.point, wanted, |point, g| {
        let v = g.new_velocity(point.velocity, from.nodes.kept, settings.transfer);
        obstacles.iter().fold(v, |v, o| o.resolve(v, point.position))
    });
    supports.prescribe(from.setup, &mut velocities, step);
    let mut remapped = to.mean(&velocities, &from.nodes.mass);
    supports.hold_remapped(from.setup, step, &from.nodes.mass, &mut remapped);
    remapped
}
