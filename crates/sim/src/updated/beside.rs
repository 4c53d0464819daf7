//! Places of the material beside a particle, where edges are held or pulled at.

use super::lattice::Lattice;
use super::points::Points;
use super::setup::Setup;
use crate::boundary::loads::nearest;
use fissure_scene::{Kernel, Matrix, Point, Vector};

/// A place of the material that goes with a particle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    particle: u32,
    /// From the particle at rest [m].
    offset: Vector,
}

impl Beside {
    /// The place of a particle.
    pub(super) fn at(particle: u32) -> Self {
        Self { particle, offset: Vector::zeros() }
    }

    /// Its particle.
    pub(super) fn particle(&self) -> usize {
        self.particle as usize
    }

    /// The way from the particle to where the place is now, F (X − X_p) [m], no longer than `cell_size` [m], be the
    /// material beyond it never so much torn.
    pub(super) fn way(&self, points: &Points, cell_size: f64) -> Vector {
        let way = (Matrix::identity() + points.total_gradient(self.particle())) * self.offset;
        way.cap_magnitude(cell_size)
    }

    /// A place at rest beside the nearest particle of `layer`, with the bilinear kernel that of the particle itself, as
    /// its gradients do not vanish with its weights; none of no particles.
    pub(super) fn nearest(setup: &Setup, layer: &[u32], place: Point) -> Option<Self> {
        let particle = nearest(&setup.particles, layer.iter().copied(), place)?;
        if setup.scene.solver.kernel == Kernel::Bilinear {
            return Some(Self::at(particle));
        }
        Some(Self { particle, offset: place - setup.particles.rest[particle as usize] })
    }

    /// Calls `visit` with (field, w + ∇w · r), r the way from the particle: so weighted, velocities of fields add up
    /// to the one that the place has as the particle moves and deforms, and a force there turns the material as at the
    /// place.
    pub(super) fn for_each_entry(&self, points: &Points, lattice: &Lattice, mut visit: impl FnMut(usize, f64)) {
        let way = self.way(points, lattice.grid.cell_size);
        let place = points.point[self.particle()].position;
        lattice.for_each_slope(self.particle(), place, |field, w, slope| visit(field, w + slope.dot(&way)));
    }
}
