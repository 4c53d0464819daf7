//! Supports as prescribed velocities of nodes and particles.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::setup::Setup;
use crate::SimulationError;
use crate::boundary::supports::{Prescribed, Reaction, prescribed};
use fissure_scene::{Point, Support, Vector};

/// A step in which supports hold velocities.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeldStep {
    /// Time in its middle [s].
    pub(super) middle: f64,
    /// Its length [s].
    pub(super) time_step: f64,
}

/// The particles that supports hold.
#[derive(Debug)]
pub(super) struct Supports {
    /// Of each support, chosen at rest.
    held: Vec<Vec<u32>>,
}

impl Supports {
    /// The particles that the supports of a scene hold.
    ///
    /// # Errors
    /// When a support selects nothing.
    pub(super) fn new(setup: &Setup) -> Result<Self, SimulationError> {
        let Setup { scene, particles, .. } = setup;
        let held = |(index, support): (usize, &Support)| {
            let selected = particles.select(scene, &support.selection);
            if selected.is_empty() {
                return Err(particles.no_particle("support", index, &support.selection).into());
            }
            Ok(selected)
        };
        Ok(Self { held: scene.supports.iter().enumerate().map(held).collect::<Result<_, SimulationError>>()? })
    }

    /// Whether nothing is held.
    pub(super) fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// What each support prescribes in a step, with its particles.
    fn prescribed<'a>(
        &'a self,
        setup: &'a Setup,
        step: HeldStep,
    ) -> impl Iterator<Item = (impl Iterator<Item = Prescribed> + Clone + 'a, &'a [u32])> {
        let held = self.held.iter().map(Vec::as_slice);
        setup
            .scene
            .supports
            .iter()
            .zip(held)
            .map(move |(support, held)| (prescribed(support, step.middle, step.time_step), held))
    }

    /// Prescribed velocities on nodes that hold more mass of held particles than of others; gives the work of that
    /// [J/m] and adds it to `reactions`, one for each support.
    ///
    /// Dragging the other nodes along in part would do so again in every step, and damp the waves at the support: a
    /// plate pulled at one end, 81 steps, gained 81 % of the work that way, 98 % this way.
    pub(super) fn hold_nodes(
        &self,
        setup: &Setup,
        points: &Points,
        lattice: &Lattice,
        step: HeldStep,
        nodes: &mut Nodes,
        reactions: &mut [Reaction],
    ) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let mut held_mass = vec![0.0; nodes.mass.len()];
        let mut touched: Vec<usize> = Vec::new();
        let mut work = 0.0;
        for ((prescribed, particles), reaction) in self.prescribed(setup, step).zip(reactions) {
            touched.clear();
            for &p in particles {
                let m = setup.particles.mass[p as usize];
                lattice.for_each_entry(p as usize, points.point[p as usize].position, |field, w| {
                    if w > 0.0 {
                        if held_mass[field] == 0.0 {
                            touched.push(field);
                        }
                        held_mass[field] += m * w;
                    }
                });
            }
            for &field in &touched {
                let mass = nodes.mass[field];
                if 2.0 * held_mass[field] > mass {
                    for held in prescribed.clone() {
                        let v = &mut nodes.after[held.axis][field];
                        let change = held.velocity() - *v;
                        *v += change;
                        // The force that does it moves along with the prescribed velocity.
                        let done = mass * change * held.velocity();
                        work += done;
                        reaction.work += done;
                        reaction.impulse[held.axis] += mass * change;
                    }
                }
                held_mass[field] = 0.0;
            }
        }
        work
    }

    /// Puts prescribed velocities in the place of the `velocities` of held particles [m/s].
    pub(super) fn prescribe(&self, setup: &Setup, velocities: &mut [Vector], step: HeldStep) {
        for (prescribed, particles) in self.prescribed(setup, step) {
            for &p in particles {
                for held in prescribed.clone() {
                    velocities[p as usize][held.axis] = held.velocity();
                }
            }
        }
    }

    /// Places of the held particles, support by support [m].
    pub(super) fn places(&self, points: &Points) -> Vec<Vec<Point>> {
        self.held.iter().map(|ps| ps.iter().map(|&p| points.point[p as usize].position).collect()).collect()
    }

    /// Prescribed velocities on the particles themselves: from the `places` they had they move exactly as prescribed.
    /// Gives the work of that [J/m] and adds it to `reactions`, one for each support.
    pub(super) fn hold_particles(
        &self,
        setup: &Setup,
        places: &[Vec<Point>],
        step: HeldStep,
        points: &mut Points,
        reactions: &mut [Reaction],
    ) -> f64 {
        let mut work = 0.0;
        for (((prescribed, particles), places), reaction) in self.prescribed(setup, step).zip(places).zip(reactions) {
            for (&p, place) in particles.iter().zip(places) {
                let point = &mut points.point[p as usize];
                for held in prescribed.clone() {
                    let (axis, after) = (held.axis, held.velocity());
                    let impulse = setup.particles.mass[p as usize] * (after - point.velocity[axis]);
                    work += impulse * after;
                    reaction.work += impulse * after;
                    reaction.impulse[axis] += impulse;
                    point.velocity[axis] = after;
                    point.position[axis] = place[axis] + step.time_step * after;
                    if let Some(c) = points.affine.get_mut(p as usize) {
                        c.row_mut(axis).fill(0.0);
                    }
                }
            }
        }
        work
    }
}
