//! What fields make of particles: values, gradients and strains, particle by particle.

use super::field_vectors::{FieldVectors, at};
use super::lattice::Lattice;
use super::motion::Motion;
use crate::grid::walker::Walker;
use fissure_plane::{Matrix, Vector};

/// Reads fields at particles. Particles that follow each other share most of their nodes, which one reader does not
/// look up again.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    lattice: &'a Lattice,
    walker: Walker<'a>,
}

/// How a particle has moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct ParticleMotion {
    /// Displacement [m].
    pub(super) displacement: Vector,
    /// Velocity [m/s].
    pub(super) velocity: Vector,
    /// Displacement gradient H = F − I, misfit included.
    pub(super) strain: Matrix,
}

/// How fast a particle moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct ParticleRates {
    /// Displacement [m].
    pub(super) displacement: Vector,
    /// Velocity [m/s].
    pub(super) velocity: Vector,
    /// Its gradient [1/s].
    pub(super) velocity_gradient: Matrix,
    /// Acceleration [m/s²].
    pub(super) acceleration: Vector,
}

impl Lattice {
    /// A reader of fields at particles.
    pub(super) fn reader(&self) -> Reader<'_> {
        Reader::new(self)
    }
}

impl<'a> Reader<'a> {
    /// A reader of fields at the particles of `lattice`.
    pub(super) fn new(lattice: &'a Lattice) -> Self {
        Self { lattice, walker: Walker::new(&lattice.grid) }
    }

    /// Calls `visit` with (field, weight, gradient) for every entry of the stencil of a particle.
    #[inline]
    pub(super) fn for_each_entry(&mut self, particle: usize, mut visit: impl FnMut(usize, f64, Vector)) {
        let lattice = self.lattice;
        if let Some(entries) = lattice.layout.cut.entries_of(particle) {
            for e in entries {
                visit(e.field as usize, e.weight, e.gradient);
            }
        } else {
            let stencil = lattice.stencil(lattice.particles.rest[particle]);
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

    /// Displacement gradient H = F − I of a particle for the displacement `u`.
    pub(super) fn strain(&mut self, particle: usize, u: &FieldVectors) -> Matrix {
        self.gradient(particle, u) + self.lattice.layout.cut.misfit_of(particle)
    }

    /// Displacement, velocity and strain of a particle.
    pub(super) fn motion(&mut self, particle: usize, fields: &Motion) -> ParticleMotion {
        let (mut displacement, mut velocity, mut gradient) = (Vector::zeros(), Vector::zeros(), Matrix::zeros());
        self.for_each_entry(particle, |field, w, g| {
            let u = fields.displacement(field);
            displacement += u * w;
            velocity += fields.velocity(field) * w;
            add_outer(&mut gradient, u, g);
        });
        ParticleMotion { displacement, velocity, strain: gradient + self.lattice.layout.cut.misfit_of(particle) }
    }

    /// Displacement, velocity, its gradient, and acceleration of a particle.
    pub(super) fn rates(&mut self, particle: usize, fields: &Motion) -> ParticleRates {
        let mut rates = ParticleRates {
            displacement: Vector::zeros(),
            velocity: Vector::zeros(),
            velocity_gradient: Matrix::zeros(),
            acceleration: Vector::zeros(),
        };
        self.for_each_entry(particle, |field, w, g| {
            let v = fields.velocity(field);
            rates.displacement += fields.displacement(field) * w;
            rates.velocity += v * w;
            add_outer(&mut rates.velocity_gradient, v, g);
            rates.acceleration += fields.acceleration(field) * w;
        });
        rates
    }
}

/// Adds v ⊗ g.
#[inline]
fn add_outer(sum: &mut Matrix, v: Vector, g: Vector) {
    sum.m11 += v.x * g.x;
    sum.m12 += v.x * g.y;
    sum.m21 += v.y * g.x;
    sum.m22 += v.y * g.y;
}
