//! Values at the fields of nodes, and their change by the forces of a step.

use super::setup::Setup;
use crate::threads;
use fissure_scene::Vector;

/// Values at fields: the own field of node i has number i, the further fields of all nodes follow.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    /// m_i [kg/m].
    pub(super) mass: Vec<f64>,
    /// Momentum while it is gathered, then velocity at the beginning of the step [m/s]; x and y apart.
    pub(super) before: [Vec<f64>; 2],
    /// Force while it is gathered, then velocity at the end of the step [m/s].
    pub(super) after: [Vec<f64>; 2],
    /// The beginning's velocity, sent to the particles and back, for XPIC [m/s]; empty otherwise.
    pub(super) smoothed: [Vec<f64>; 2],
    /// v⁺ − k v of the velocities v and v⁺ at the beginning and at the end of the step, for affine FLIP [m/s]; empty
    /// otherwise.
    pub(super) gain: [Vec<f64>; 2],
    /// k: what a particle keeps of its velocity and of its gradient in this step, with affine FLIP [–].
    pub(super) kept: f64,
    /// The particles' new velocities, sent to the grid once more, for the strains of the bilinear kernel [m/s]; empty
    /// otherwise.
    pub(super) remapped: [Vec<f64>; 2],
}

impl Nodes {
    /// Sets all values of so many `fields` to zero.
    pub(super) fn clear(&mut self, fields: usize) {
        let [bx, by] = &mut self.before;
        let [ax, ay] = &mut self.after;
        for values in [&mut self.mass, bx, by, ax, ay] {
            values.clear();
            values.resize(fields, 0.0);
        }
        for values in self.remapped.iter_mut().chain(&mut self.smoothed).chain(&mut self.gain) {
            values.clear();
        }
    }

    /// Velocity of a field at the end of the step [m/s].
    pub(super) fn velocity(&self, field: usize) -> Vector {
        Vector::new(self.after[0][field], self.after[1][field])
    }

    /// Velocity of a field at the beginning of the step [m/s].
    pub(super) fn velocity_before(&self, field: usize) -> Vector {
        Vector::new(self.before[0][field], self.before[1][field])
    }

    /// Gain of a field [m/s].
    pub(super) fn gain(&self, field: usize) -> Vector {
        Vector::new(self.gain[0][field], self.gain[1][field])
    }

    /// Finds what particles gain in this step besides what they keep of their own.
    pub(super) fn find_gain(&mut self, kept: f64) {
        self.kept = kept;
        for axis in 0..2 {
            let change = self.before[axis].iter().zip(&self.after[axis]).map(|(before, after)| after - kept * before);
            self.gain[axis].clear();
            self.gain[axis].extend(change);
        }
    }

    /// v = p/m at the beginning, v + Δt f/m at the end (thesis eq. 6), with gravity and a `damping` rate [1/s].
    pub(super) fn update_velocities(&mut self, gravity: Vector, damping: f64, time_step: f64) {
        let decay = (-damping * time_step).exp();
        let gravity = gravity * time_step;
        let (mass, part) = (&self.mass, threads::part(self.mass.len()));
        for axis in 0..2 {
            let lists = [&mut self.before[axis], &mut self.after[axis]].map(Vec::as_mut_slice);
            threads::share_out(lists, part, &|start, [before, after]| {
                for ((m, v), f) in mass[start..].iter().zip(before).zip(after) {
                    if *m > 0.0 {
                        *v /= m;
                        *f = *v * decay + time_step * *f / m + gravity[axis];
                    }
                }
            });
        }
    }

    /// Power of gravity [W/m].
    pub(super) fn power_of_gravity(&self, setup: &Setup) -> f64 {
        let g = setup.scene.gravity;
        if g == Vector::zeros() {
            return 0.0;
        }
        let [vx, vy] = &self.after;
        self.mass.iter().zip(vx.iter().zip(vy)).map(|(m, (vx, vy))| m * (g.x * vx + g.y * vy)).sum()
    }
}
