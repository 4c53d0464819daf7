//! Loads, supports, colliders, gravity, and the first velocities, as they act on nodes and particles.

use super::{MaterialPoint, Updated};
use crate::SimulationError;
use crate::boundary::collider::PlacedObstacle;
use crate::boundary::loads::{ForcePlace, forces_of_load, nearest};
use crate::boundary::supports::prescribed;
use fissure_scene::{Load, Matrix, Point, Vector};

impl Updated {
    /// The forces of each load as forces on particles; those along outlines act on the nearest of the selected particles.
    pub(super) fn forces_of_loads(&self) -> Result<Vec<Vec<(u32, Vector)>>, SimulationError> {
        let of_load = |(index, load): (usize, &Load)| {
            let layer = self.particles.select(&self.scene, &load.selection);
            let particle = |place| match place {
                ForcePlace::Particle(p) => Some(p),
                ForcePlace::Outline(place) => nearest(&self.particles, layer.iter().copied(), place),
            };
            let forces = forces_of_load(&self.scene, &self.particles, index)?.into_iter();
            let forces: Vec<(u32, Vector)> = forces.filter_map(|at| Some((particle(at.place)?, at.force))).collect();
            if forces.is_empty() {
                return Err(self.particles.no_particle("load", index, &load.selection).into());
            }
            Ok(forces)
        };
        self.scene.loads.iter().enumerate().map(of_load).collect()
    }

    /// The particles that each support holds, chosen at rest.
    pub(super) fn particles_of_supports(&self) -> Result<Vec<Vec<u32>>, SimulationError> {
        let mut held = Vec::new();
        for (index, support) in self.scene.supports.iter().enumerate() {
            let selected = self.particles.select(&self.scene, &support.selection);
            if selected.is_empty() {
                return Err(self.particles.no_particle("support", index, &support.selection).into());
            }
            held.push(selected);
        }
        Ok(held)
    }

    /// Velocities at time zero.
    pub(super) fn set_initial_velocities(&mut self) {
        for (p, motion) in self.particles.first_motions(&self.scene).into_iter().enumerate() {
            self.state.points[p].velocity += motion.velocity;
            if let Some(c) = self.state.affine.get_mut(p) {
                *c += Matrix::new(0.0, -motion.angular_velocity, motion.angular_velocity, 0.0);
            }
        }
    }

    /// Adds the loads in the middle of the step to the forces on nodes.
    pub(super) fn add_loads(&mut self, time: f64, time_step: f64) {
        if self.loads.is_empty() {
            return;
        }
        let mut force = std::mem::take(&mut self.nodes.after);
        for (load, forces) in self.scene.loads.iter().zip(&self.loads) {
            let factor = load.curve.value(time + 0.5 * time_step);
            if factor == 0.0 {
                continue;
            }
            for &(p, f) in forces {
                let f = f * factor;
                self.for_each_entry(p as usize, |field, w| {
                    force[0][field] += w * f.x;
                    force[1][field] += w * f.y;
                });
            }
        }
        self.nodes.after = force;
    }

    /// Work of loads and gravity: material moves by Σ v_i w_ip Δt, so that Σ f·v Δt is exact.
    pub(super) fn count_work(&mut self, time: f64, time_step: f64) {
        let mut power = 0.0;
        for (load, forces) in self.scene.loads.iter().zip(&self.loads) {
            let factor = load.curve.value(time + 0.5 * time_step);
            for &(p, f) in forces {
                power += factor * f.dot(&self.gather_at_particle(p as usize).velocity);
            }
        }
        let g = self.scene.gravity;
        if g != Vector::zeros() {
            let [vx, vy] = &self.nodes.after;
            power += self
                .nodes
                .mass
                .iter()
                .zip(vx.iter().zip(vy))
                .map(|(m, (vx, vy))| m * (g.x * vx + g.y * vy))
                .sum::<f64>();
        }
        self.state.external_work += power * time_step;
    }

    /// Prescribed velocities on nodes that hold more mass of held particles than of others. Whether any node was.
    ///
    /// Dragging the other nodes along in part would do so again in every step, and damp the waves at the support: a plate pulled at one end, 81 steps,
    /// gained 81 % of the work that way, 98 % this way.
    pub(super) fn hold_nodes(&mut self, time: f64, time_step: f64) -> bool {
        if self.held.is_empty() {
            return false;
        }
        let mut held_mass = vec![0.0; self.nodes.mass.len()];
        let mut touched: Vec<usize> = Vec::new();
        let mut work = 0.0;
        for (support, particles) in self.scene.supports.iter().zip(&self.held) {
            touched.clear();
            for &p in particles {
                let m = self.particles.mass[p as usize];
                self.for_each_entry(p as usize, |field, w| {
                    if w > 0.0 {
                        if held_mass[field] == 0.0 {
                            touched.push(field);
                        }
                        held_mass[field] += m * w;
                    }
                });
            }
            let prescribed = prescribed(support, time + 0.5 * time_step);
            for &field in &touched {
                let mass = self.nodes.mass[field];
                if 2.0 * held_mass[field] > mass {
                    for held in prescribed.clone() {
                        let v = &mut self.nodes.after[held.axis][field];
                        let change = held.velocity() - *v;
                        *v += change;
                        // The force that does it moves along with the prescribed velocity.
                        work += mass * change * held.speed * held.factor;
                    }
                }
                held_mass[field] = 0.0;
            }
        }
        self.state.external_work += work;
        true
    }

    /// Places of the held particles before they move, support by support.
    pub(super) fn held_places(&self, points: &[MaterialPoint]) -> Vec<Vec<Point>> {
        self.held.iter().map(|ps| ps.iter().map(|&p| points[p as usize].position).collect()).collect()
    }

    /// Prescribed velocities on the particles themselves: they move exactly as prescribed.
    pub(super) fn hold_particles(&mut self, places: &[Vec<Point>], time: f64, time_step: f64) {
        let mut work = 0.0;
        for ((support, particles), places) in self.scene.supports.iter().zip(&self.held).zip(places) {
            let prescribed = prescribed(support, time + 0.5 * time_step);
            for (&p, place) in particles.iter().zip(places) {
                let point = &mut self.state.points[p as usize];
                for held in prescribed.clone() {
                    let (axis, after) = (held.axis, held.velocity());
                    work += self.particles.mass[p as usize] * (after - point.velocity[axis]) * after;
                    point.velocity[axis] = after;
                    point.position[axis] = place[axis] + time_step * after;
                    if let Some(c) = self.state.affine.get_mut(p as usize) {
                        c.row_mut(axis).fill(0.0);
                    }
                }
            }
        }
        self.state.external_work += work;
    }

    /// Obstacles on nodes (thesis 3.1.4). Whether there are any.
    pub(super) fn collide_nodes(&mut self, time: f64, time_step: f64) -> bool {
        if self.colliders.is_empty() {
            return false;
        }
        let mut work = 0.0;
        for collider in &self.colliders {
            let placed: PlacedObstacle<'_> = collider.at(time + 0.5 * time_step);
            let own = self.grid.nodes().map(|(_, place)| place);
            let further = self.cut.fields.nodes_of_further().map(|node| self.grid.place_of(node));
            for (field, place) in own.chain(further).enumerate() {
                let mass = self.nodes.mass[field];
                if mass <= 0.0 {
                    continue;
                }
                let place = self.grid.place(place);
                let before = self.nodes.velocity(field);
                let after = placed.resolve(before, place);
                if after != before {
                    work += mass * (after - before).dot(&placed.velocity(place));
                    self.nodes.after[0][field] = after.x;
                    self.nodes.after[1][field] = after.y;
                }
            }
        }
        self.state.external_work += work;
        true
    }
}
