//! What fields make of particles: values, gradients and strains, particle by particle.

use super::field_vectors::{FieldVectors, at};
use super::lattice::Lattice;
use super::motion::Motion;
use crate::grid::entries::Entry;
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
#[derive(Debug, Clone, Copy, Default)]
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

impl ParticleRates {
    fn add(&mut self, fields: &Motion, field: usize, w: f64, g: Vector) {
        let v = fields.velocity(field);
        self.displacement += fields.displacement(field) * w;
        self.velocity += v * w;
        add_outer(&mut self.velocity_gradient, v, g);
        self.acceleration += fields.acceleration(field) * w;
    }
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

    /// As [`Reader::for_each_entry`], for both parts of a particle that a crack cuts: (field, share of the volume,
    /// weight, gradient).
    #[inline]
    pub(super) fn for_each_part(&mut self, particle: usize, mut visit: impl FnMut(usize, f64, f64, Vector)) {
        let share = self.lattice.layout.cut.part_of(particle).map_or(1.0, |part| part.0);
        self.for_each_entry(particle, |field, w, g| visit(field, share, w, g));
        if let Some(far) = self.far(particle) {
            far.for_each(|e| visit(e.field as usize, 1.0 - share, e.weight, e.gradient));
        }
    }

    /// The entries of what of a particle lies across a crack, if there is any.
    fn far(&self, particle: usize) -> Option<impl Iterator<Item = &'a Entry> + use<'a>> {
        let far = &self.lattice.layout.far;
        far.part_of(particle).filter(|part| part.0 > 0.0)?;
        far.entries_of(particle).map(|entries| entries.iter())
    }

    /// Gradient of a field vector at what of a particle lies across a crack, if there is any.
    pub(super) fn far_gradient(&self, particle: usize, u: &FieldVectors) -> Option<Matrix> {
        let mut gradient = Matrix::zeros();
        self.far(particle)?.for_each(|e| add_outer(&mut gradient, at(u, e.field as usize), e.gradient));
        Some(gradient)
    }

    /// Displacement gradient of what of a particle lies across a crack, if there is any.
    pub(super) fn far_strain(&self, particle: usize, u: &FieldVectors) -> Option<Matrix> {
        Some(self.far_gradient(particle, u)? + self.lattice.layout.far.misfit_of(particle))
    }

    /// Displacement gradients of a particle and of what of it lies across a crack; twice the same where nothing does.
    pub(super) fn strains(&mut self, particle: usize, u: &FieldVectors) -> [Matrix; 2] {
        let own = self.strain(particle, u);
        [own, self.far_strain(particle, u).unwrap_or(own)]
    }

    /// As the rates of [`Reader::strain_and_rates`], of what of a particle lies across a crack, if there is any.
    pub(super) fn far_rates(&self, particle: usize, fields: &Motion) -> Option<ParticleRates> {
        let mut rates = ParticleRates::default();
        self.far(particle)?.for_each(|e| rates.add(fields, e.field as usize, e.weight, e.gradient));
        Some(rates)
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

    /// Mean strain energy per volume of a particle [J/m³].
    pub(super) fn energy_density(&mut self, particle: usize, u: &FieldVectors) -> f64 {
        let e = self.lattice.material(particle);
        let density = |h: Matrix| crate::energy_density(&h, e.mu, e.lambda);
        // As most are: with no misfit, and nothing across a crack.
        if self.lattice.layout.cut.entries_of(particle).is_none() {
            return density(self.gradient(particle, u));
        }
        let own = density(self.strain(particle, u));
        match self.far_strain(particle, u) {
            Some(far) => {
                let share = self.lattice.layout.cut.part_of(particle).map_or(1.0, |part| part.0);
                share * own + (1.0 - share) * density(far)
            }
            None => own,
        }
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

    /// Displacement gradient H = F − I of a particle, and its displacement, velocity, the gradient of that, and
    /// acceleration: all in one walk over its nodes.
    pub(super) fn strain_and_rates(&mut self, particle: usize, fields: &Motion) -> (Matrix, ParticleRates) {
        let (mut gradient, mut rates) = (Matrix::zeros(), ParticleRates::default());
        self.for_each_entry(particle, |field, w, g| {
            add_outer(&mut gradient, fields.displacement(field), g);
            rates.add(fields, field, w, g);
        });
        (gradient + self.lattice.layout.cut.misfit_of(particle), rates)
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
