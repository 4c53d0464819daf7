//! What fields make of particles: values, gradients and strains, particle by particle.

use super::{FieldVectors, Total, stencil_of};
use crate::grid::Walker;
use fissure_scene::{Matrix, Vector};

/// Reads fields at particles. Particles that follow each other share most of their nodes, which one reader does not look up again.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    solver: &'a Total,
    walker: Walker<'a>,
}

/// How a particle has moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    /// Displacement [m].
    pub(super) displacement: Vector,
    /// Velocity [m/s].
    pub(super) velocity: Vector,
    /// Displacement gradient H = F − I, misfit included.
    pub(super) strain: Matrix,
}

/// How fast a particle moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    /// Velocity [m/s].
    pub(super) velocity: Vector,
    /// Its gradient [1/s].
    pub(super) velocity_gradient: Matrix,
    /// Acceleration [m/s²].
    pub(super) acceleration: Vector,
}

impl Total {
    /// A reader of fields at particles.
    pub(super) fn reader(&self) -> Reader<'_> {
        Reader { solver: self, walker: Walker::new(&self.grid) }
    }
}

impl Reader<'_> {
    /// Calls `visit` with (field, weight, gradient) for every entry of the stencil of a particle.
    #[inline]
    pub(super) fn for_each_entry(&mut self, particle: usize, mut visit: impl FnMut(usize, f64, Vector)) {
        let solver = self.solver;
        if let Some(entries) = solver.state.cut.entries_of(particle) {
            for e in entries {
                visit(e.field as usize, e.weight, e.gradient);
            }
        } else {
            let stencil = stencil_of(&solver.scene, &solver.grid, solver.particles.rest[particle]);
            // All nodes of a particle exist.
            let Some(rows) = self.walker.rows(stencil.first, stencil.width) else { return };
            for b in 0..stencil.width {
                for a in 0..stencil.width {
                    visit(rows[b] + a, stencil.weight(a, b), stencil.weight_gradient(a, b));
                }
            }
        }
    }

    /// Gradient of a field vector at a particle.
    pub(super) fn gradient(&mut self, particle: usize, u: &FieldVectors) -> Matrix {
        let mut gradient = Matrix::zeros();
        self.for_each_entry(particle, |field, _, g| add_outer(&mut gradient, at(u, field), g));
        gradient
    }

    /// Displacement gradient H = F − I of a particle.
    pub(super) fn strain(&mut self, particle: usize) -> Matrix {
        let state = &self.solver.state;
        self.gradient(particle, &state.displacement) + state.cut.misfit_of(particle)
    }

    /// Displacement, velocity and strain of a particle.
    pub(super) fn motion(&mut self, particle: usize) -> Motion {
        let state = &self.solver.state;
        let (mut displacement, mut velocity, mut gradient) = (Vector::zeros(), Vector::zeros(), Matrix::zeros());
        self.for_each_entry(particle, |field, w, g| {
            let u = at(&state.displacement, field);
            displacement += u * w;
            velocity += at(&state.velocity, field) * w;
            add_outer(&mut gradient, u, g);
        });
        Motion { displacement, velocity, strain: gradient + state.cut.misfit_of(particle) }
    }

    /// Velocity, its gradient, and acceleration of a particle.
    pub(super) fn rates(&mut self, particle: usize) -> Rates {
        let solver = self.solver;
        let mut rates =
            Rates { velocity: Vector::zeros(), velocity_gradient: Matrix::zeros(), acceleration: Vector::zeros() };
        self.for_each_entry(particle, |field, w, g| {
            let v = at(&solver.state.velocity, field);
            rates.velocity += v * w;
            add_outer(&mut rates.velocity_gradient, v, g);
            rates.acceleration += at(&solver.acceleration, field) * w;
        });
        rates
    }
}

#[inline]
fn at(u: &FieldVectors, field: usize) -> Vector {
    Vector::new(u[0][field], u[1][field])
}

/// Adds v ⊗ g.
#[inline]
fn add_outer(sum: &mut Matrix, v: Vector, g: Vector) {
    sum.m11 += v.x * g.x;
    sum.m12 += v.x * g.y;
    sum.m21 += v.y * g.x;
    sum.m22 += v.y * g.y;
}
