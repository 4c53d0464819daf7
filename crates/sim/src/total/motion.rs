//! How the fields move: displacements at whole steps, velocities half a step ahead.

use super::field_vectors::{FieldVectors, at};
use super::lattice::Lattice;
use crate::saved::{self, Fits};
use crate::threads;
use crate::wide::{Loop, run_widest};
use fissure_plane::Vector;
use fissure_scene::Scene;
use serde::{Deserialize, Serialize};

/// The motion of all fields.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Motion {
    /// Displacement u [m].
    pub(super) displacement: FieldVectors,
    /// Velocity v at half steps [m/s].
    pub(super) velocity: FieldVectors,
    /// Velocities and displacements belong to the same moment: the next kick takes half a step, after which velocities
    /// are half a step ahead. A whole kick here would more than double the amplitude of the shortest waves.
    in_step: bool,
    /// Length of the last step [s].
    pub(super) last_step: f64,
    /// Velocities before the last kick [m/s].
    #[serde(skip)]
    before_kick: FieldVectors,
    /// Time that the last kick took [s]; 0 before the first one.
    #[serde(skip)]
    last_kick: f64,
    /// Force of the last step [N/m].
    #[serde(skip)]
    pub(super) force: FieldVectors,
}

/// What force over a kick [s], times its length, changes velocities as much as an impulse of 1, where velocities decay
/// at the rate `damping` [1/s].
///
/// Damped leapfrog v' = α v + β a is stable up to ω² Δt β = 2 (1 + α): β = ½ (1 + α) Δt keeps the limit where it is
/// without damping. A force f then changes velocities by β f/m.
pub(super) fn force_of_impulse(damping: f64, kick: f64) -> f64 {
    2.0 / (1.0 + (-damping * kick).exp())
}

impl Motion {
    /// So many fields at rest.
    pub(super) fn at_rest(fields: usize) -> Self {
        let zeros = || [vec![0.0; fields], vec![0.0; fields]];
        Self {
            displacement: zeros(),
            velocity: zeros(),
            in_step: true,
            last_step: 0.0,
            before_kick: zeros(),
            last_kick: 0.0,
            force: zeros(),
        }
    }

    /// The motion at time zero: that of the particles.
    pub(super) fn initial(scene: &Scene, lattice: &Lattice) -> Self {
        let (particles, mass) = (&lattice.particles, lattice.mass());
        let mut momentum = [vec![0.0; mass.len()], vec![0.0; mass.len()]];
        let mut any = false;
        let mut reader = lattice.reader();
        for (p, motion) in particles.first_motions(scene).into_iter().enumerate() {
            let v = motion.velocity;
            if v != Vector::zeros() {
                any = true;
                let m = particles.mass[p];
                reader.for_each_part(p, |field, share, w, _| {
                    momentum[0][field] += m * share * w * v.x;
                    momentum[1][field] += m * share * w * v.y;
                });
            }
        }
        let mut initial = Self::at_rest(lattice.field_count());
        if any {
            for axis in 0..2 {
                for (d, &m) in mass.iter().enumerate() {
                    initial.velocity[axis][d] = if m > 0.0 { momentum[axis][d] / m } else { 0.0 };
                }
            }
        }
        initial
    }

    /// Checks a motion that was read against so many `fields`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize) -> Fits {
        for values in self.displacement.iter().chain(&self.velocity) {
            saved::ensure(values.len() == fields, "its number of fields")?;
            saved::finite("a field", values)?;
        }
        saved::finite("its last step", [&self.last_step])
    }

    /// Makes room for new fields.
    pub(super) fn resize(&mut self, fields: usize) {
        let vectors = [&mut self.displacement, &mut self.velocity, &mut self.before_kick, &mut self.force];
        for values in vectors.into_iter().flatten() {
            values.resize(fields, 0.0);
        }
    }

    /// Displacement of a field [m].
    #[inline]
    pub(super) fn displacement(&self, field: usize) -> Vector {
        at(&self.displacement, field)
    }

    /// Velocity of a field [m/s].
    #[inline]
    pub(super) fn velocity(&self, field: usize) -> Vector {
        at(&self.velocity, field)
    }

    /// Acceleration of a field in the last step [m/s²]: what kick and impulses have made of the velocity before.
    #[inline]
    pub(super) fn acceleration(&self, field: usize) -> Vector {
        if self.last_kick == 0.0 {
            return Vector::zeros();
        }
        (self.velocity(field) - at(&self.before_kick, field)) / self.last_kick
    }

    /// Sets all velocities to zero.
    pub(super) fn stop(&mut self) {
        self.velocity.iter_mut().for_each(|v| v.fill(0.0));
        self.last_step = 0.0;
        self.last_kick = 0.0;
        self.in_step = true;
    }

    /// v += Δt f/m, with gravity, and with velocities that decay at the rate `damping` [1/s]. Returns the time that the
    /// kick takes: a step, but half a step from rest.
    pub(super) fn kick(&mut self, inverse_mass: &[f64], gravity: Vector, damping: f64, time_step: f64) -> f64 {
        let kick = if self.in_step { 0.5 * time_step } else { time_step };
        (self.in_step, self.last_kick) = (false, kick);
        let (decay, push) = ((-damping * kick).exp(), kick / force_of_impulse(damping, kick));
        let part = threads::part(inverse_mass.len());
        let Self { velocity: [velocity_x, velocity_y], before_kick: [before_x, before_y], force: all, .. } = self;
        // Both axes at once: to share out takes as long as some thousand fields.
        let lists = [velocity_x, before_x, velocity_y, before_y].map(Vec::as_mut_slice);
        threads::share_out(lists, part, &|start, [velocity_x, before_x, velocity_y, before_y]| {
            let fields = start..start + velocity_x.len();
            let inverse_mass = &inverse_mass[fields.clone()];
            for (axis, velocity, before) in [(0, velocity_x, before_x), (1, velocity_y, before_y)] {
                let (force, gravity) = (&all[axis][fields.clone()], gravity[axis]);
                run_widest(Kick { velocity, before, force, inverse_mass, gravity, decay, push });
            }
        });
        kick
    }

    /// Velocities before the kick of this step.
    pub(super) fn before_kick(&self) -> &FieldVectors {
        &self.before_kick
    }

    /// Velocities along an axis, and what they were before the kick of this step.
    pub(super) fn velocity_and_before(&mut self, axis: usize) -> (&mut [f64], &[f64]) {
        (&mut self.velocity[axis], &self.before_kick[axis])
    }

    /// u += Δt v.
    pub(super) fn drift(&mut self, time_step: f64) {
        let part = threads::part(self.velocity[0].len());
        let (displacement, velocity) = (&mut self.displacement, &self.velocity);
        threads::share_out(displacement.each_mut().map(Vec::as_mut_slice), part, &|start, parts| {
            for (displacement, velocity) in parts.into_iter().zip(velocity) {
                let velocity = &velocity[start..start + displacement.len()];
                run_widest(Drift { displacement, velocity, time_step });
            }
        });
        self.last_step = time_step;
    }

    /// By how much the velocities lag behind the displacements between two steps [s].
    pub(super) fn lag(&self) -> f64 {
        if self.in_step { 0.0 } else { 0.5 * self.last_step }
    }

    /// Work that gravity does at the present velocities, per time [W/m].
    pub(super) fn power_of_gravity(&self, mass: &[f64], gravity: Vector) -> f64 {
        let v = &self.velocity;
        mass.iter().enumerate().map(|(d, m)| m * (gravity.x * v[0][d] + gravity.y * v[1][d])).sum()
    }
}

/// The kick of some fields along one axis.
struct Kick<'a> {
    velocity: &'a mut [f64],
    before: &'a mut [f64],
    force: &'a [f64],
    inverse_mass: &'a [f64],
    gravity: f64,
    decay: f64,
    push: f64,
}

impl Loop for Kick<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { velocity, before, force, inverse_mass, gravity, decay, push } = self;
        let count = velocity.len();
        let (before, force, inverse_mass) = (&mut before[..count], &force[..count], &inverse_mass[..count]);
        for d in 0..count {
            before[d] = velocity[d];
            // Fields without mass have an inverse mass of zero and stay where they are.
            let moving = if inverse_mass[d] > 0.0 { gravity } else { 0.0 };
            velocity[d] = before[d] * decay + push * (force[d] * inverse_mass[d] + moving);
        }
    }
}

/// The drift of some fields along one axis.
struct Drift<'a> {
    displacement: &'a mut [f64],
    velocity: &'a [f64],
    time_step: f64,
}

impl Loop for Drift<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (displacement, velocity) in self.displacement.iter_mut().zip(self.velocity) {
            *displacement += self.time_step * velocity;
        }
    }
}
