//! Loads, supports, colliders, gravity, and the first velocities, as they act on fields.

use super::Total;
use super::cut::Probe;
use super::refresh::Near;
use crate::SimulationError;
use crate::boundary::loads::{self, ForcePlace};
use crate::boundary::selector::Selector;
use crate::boundary::supports::prescribed;
use fissure_scene::{Point, Vector};

/// A force at a place of the material.
#[derive(Debug, Clone)]
pub(super) struct PointForce {
    probe: Probe,
    /// At a curve factor of 1 [N/m].
    force: Vector,
}

/// A prescribed velocity of one field.
#[derive(Debug, Clone, Copy)]
pub(super) struct Constraint {
    field: u32,
    support: u32,
}

/// A field at the surface of a body, which a collider can touch.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceNode {
    field: u32,
    /// Where its node is at rest [m].
    place: Point,
    /// How far the material goes beyond the node towards an obstacle [m]; negative when it ends before it.
    reach: f64,
}

/// The surface node of a field whose hat is filled with material to the given part; none within the material and far from it.
fn surface_node(field: usize, place: Point, part: f64, h: f64) -> Option<SurfaceNode> {
    if part <= 0.0 || part > 0.999 {
        return None;
    }
    // A half-plane of material whose edge lies d beyond the node fills the part ½ + d/h ∓ ½ (d/h)² of the node's hat; solved for d.
    let beyond = |x: f64| h * (1.0 - (1.0 - x).max(0.0).sqrt());
    let reach = if part >= 0.5 { beyond(2.0 * part - 1.0) } else { -beyond(1.0 - 2.0 * part) };
    Some(SurfaceNode { field: field as u32, place, reach })
}

impl Total {
    /// The forces of each load.
    pub(super) fn point_forces(&self) -> Result<Vec<Vec<PointForce>>, SimulationError> {
        let on_probe = |at: loads::PointForce| {
            let place = match at.place {
                ForcePlace::Particle(p) => self.particles.rest[p as usize],
                ForcePlace::Outline(place) => place,
            };
            PointForce { probe: self.probe(place, place), force: at.force }
        };
        let of_load = |index| {
            let forces = loads::forces_of_load(&self.scene, &self.particles, index)?;
            Ok(forces.into_iter().map(on_probe).collect())
        };
        (0..self.scene.loads.len()).map(of_load).collect()
    }

    /// Lays the places of loads anew where something has changed.
    pub(super) fn refresh_loads(&mut self, near: &Near) {
        let mut loads = std::mem::take(&mut self.loads);
        for force in loads.iter_mut().flatten().filter(|force| near.contains(force.probe.rest)) {
            force.probe = self.probe(force.probe.rest, force.probe.nudged);
        }
        self.loads = loads;
    }

    /// Adds the loads for the time `time` to the forces.
    pub(super) fn apply_loads(&mut self, time: f64) {
        for (load, forces) in self.scene.loads.iter().zip(&self.loads) {
            let factor = load.curve.value(time);
            if factor == 0.0 {
                continue;
            }
            for point in forces {
                let f = point.force * factor;
                for &(field, w) in &point.probe.entries {
                    self.force[0][field as usize] += f.x * w;
                    self.force[1][field as usize] += f.y * w;
                }
            }
        }
    }

    /// Counts the work of loads and gravity over a step, by the displacements it will make: v Δt with the velocities of the middle of the step.
    pub(super) fn count_work(&mut self, time: f64, time_step: f64) {
        let mut power = 0.0;
        for (load, forces) in self.scene.loads.iter().zip(&self.loads) {
            let factor = load.curve.value(time);
            if factor != 0.0 {
                let v = &self.state.velocity;
                power += factor * forces.iter().map(|p| p.force.dot(&p.probe.value(v))).sum::<f64>();
            }
        }
        let g = self.scene.gravity;
        if g != Vector::zeros() {
            let v = &self.state.velocity;
            power += self.state.mass.iter().enumerate().map(|(d, m)| m * (g.x * v[0][d] + g.y * v[1][d])).sum::<f64>();
        }
        self.state.external_work += power * time_step;
    }

    /// The fields each support holds.
    pub(super) fn constraints_of_supports(&self) -> Result<Vec<Constraint>, SimulationError> {
        let mut constraints = Vec::new();
        let bodies = self.body_of_fields();
        for (support, of) in self.scene.supports.iter().enumerate() {
            let before = constraints.len();
            let selector = Selector::new(&self.scene, &of.selection);
            for (field, place) in self.places_of_fields().enumerate() {
                if self.holds(&selector, field, self.grid.place(place), &bodies) {
                    constraints.push(Constraint { field: field as u32, support: support as u32 });
                }
            }
            if constraints.len() == before {
                let selection = &self.scene.supports[support].selection;
                return Err(self.particles.no_particle("support", support, selection).into());
            }
        }
        Ok(constraints)
    }

    /// Whether a support holds a field whose node is at `place` at rest.
    fn holds(&self, selector: &Selector<'_>, field: usize, place: Point, bodies: &[u32]) -> bool {
        if self.state.mass[field] == 0.0 {
            return false;
        }
        let (body, h) = (bodies[field] as usize, self.grid.cell_size);
        // Nodes on an edge and, where the edge is not on a grid line, those beyond it or nearer than half a cell.
        selector.selects(place, body, 0.499 * h, h)
    }

    /// [`Total::constraints_of_supports`] after a change: fields elsewhere are held as before.
    pub(super) fn constraints_near(&self, near: &Near) -> Vec<Constraint> {
        if self.scene.supports.is_empty() {
            return Vec::new();
        }
        let bodies = self.body_of_fields();
        let changed = self.fields_near(near);
        let place = |field: usize| self.grid.position(self.state.fields.node(field));
        let mut constraints: Vec<Constraint> =
            self.constraints.iter().filter(|c| !near.contains(place(c.field as usize))).copied().collect();
        for (support, of) in self.scene.supports.iter().enumerate() {
            let selector = Selector::new(&self.scene, &of.selection);
            let held = changed.iter().filter(|&&(field, place)| self.holds(&selector, field, place, &bodies));
            constraints.extend(held.map(|&(field, _)| Constraint { field: field as u32, support: support as u32 }));
        }
        constraints.sort_unstable_by_key(|c| (c.support, c.field));
        constraints
    }

    /// The fields where something has changed, rising, with the places of their nodes at rest [m].
    fn fields_near(&self, near: &Near) -> Vec<(usize, Point)> {
        let mut nodes: Vec<(usize, Point)> = Vec::new();
        for (low, high) in near.widened(0.0) {
            let around = self.grid.nodes_around(low, high).map(|(node, place)| (node, self.grid.place(place)));
            nodes.extend(around.filter(|&(_, place)| near.contains(place)));
        }
        let further = |&(node, place): &(usize, Point)| {
            self.state.fields.of(node).iter().map(move |&field| (field as usize, place))
        };
        let mut fields: Vec<(usize, Point)> = nodes.iter().flat_map(further).collect();
        fields.append(&mut nodes);
        fields.sort_unstable_by_key(|f| f.0);
        fields.dedup_by_key(|f| f.0);
        fields
    }

    fn body_of_fields(&self) -> Vec<u32> {
        let mut bodies = vec![0; self.state.mass.len()];
        if self.scene.bodies.len() > 1 {
            let mut reader = self.reader();
            for p in 0..self.particles.len() {
                reader.for_each_entry(p, |field, _, _| bodies[field] = self.particles.body[p]);
            }
        }
        bodies
    }

    /// Fields whose node is not surrounded by material of their own.
    pub(super) fn surface_nodes(&self) -> Vec<SurfaceNode> {
        if self.colliders.is_empty() {
            return Vec::new();
        }
        let h = self.grid.cell_size;
        let mut volume = vec![0.0; self.state.mass.len()];
        let mut reader = self.reader();
        for p in 0..self.particles.len() {
            reader.for_each_entry(p, |field, w, _| volume[field] += self.particles.volume[p] * w);
        }
        let fields = volume.iter().zip(self.places_of_fields()).enumerate();
        fields.filter_map(|(field, (v, place))| surface_node(field, self.grid.place(place), v / (h * h), h)).collect()
    }

    /// [`Total::surface_nodes`] after a change: fields elsewhere are as before.
    pub(super) fn surface_near(&self, near: &Near) -> Vec<SurfaceNode> {
        if self.colliders.is_empty() {
            return Vec::new();
        }
        let h = self.grid.cell_size;
        let place = |field: usize| self.grid.position(self.state.fields.node(field));
        let mut surface: Vec<SurfaceNode> = self.surface.iter().filter(|s| !near.contains(s.place)).copied().collect();
        // Every particle that has a weight at a node in the boxes, in the order of their numbers.
        let mut particles: Vec<usize> = Vec::new();
        for (low, high) in near.widened(2.0 * h) {
            particles.extend(self.particles.in_box(low, high));
        }
        particles.sort_unstable();
        particles.dedup();
        let mut volume = std::collections::BTreeMap::<usize, f64>::new();
        let mut reader = self.reader();
        for p in particles {
            reader.for_each_entry(p, |field, w, _| {
                if near.contains(place(field)) {
                    *volume.entry(field).or_default() += self.particles.volume[p] * w;
                }
            });
        }
        surface.extend(volume.iter().filter_map(|(&field, v)| surface_node(field, place(field), v / (h * h), h)));
        surface.sort_unstable_by_key(|s| s.field);
        surface
    }

    /// Prescribed velocities and obstacles; counts the work of both.
    pub(super) fn apply_constraints_and_colliders(&mut self, time: f64, time_step: f64) {
        let middle = time + 0.5 * time_step;
        let mut work = 0.0;
        for c in &self.constraints {
            let d = c.field as usize;
            for held in prescribed(&self.scene.supports[c.support as usize], middle) {
                let (before, after) = (self.state.velocity[held.axis][d], held.velocity());
                // The force m (v' − v)/Δt acts along the prescribed motion.
                work += self.state.mass[d] * (after - before) * after;
                self.state.velocity[held.axis][d] = after;
            }
        }
        for collider in &self.colliders {
            let placed = collider.at(middle);
            for node in &self.surface {
                let d = node.field as usize;
                let u = &self.state.displacement;
                let place = node.place + Vector::new(u[0][d], u[1][d]);
                let found = placed.surface(place);
                if found.distance > node.reach {
                    continue;
                }
                let before = Vector::new(self.state.velocity[0][d], self.state.velocity[1][d]);
                // Where the material itself ends, which is what touches.
                let skin = place - found.normal * node.reach;
                let after = placed.resolve(before, skin);
                let impulse = (after - before) * self.state.mass[d];
                work += impulse.dot(&placed.velocity(place));
                self.state.velocity[0][d] = after.x;
                self.state.velocity[1][d] = after.y;
            }
        }
        self.state.external_work += work;
    }

    /// Velocities at time zero, from those of the particles.
    pub(super) fn set_initial_velocities(&mut self) {
        let mut momentum = [vec![0.0; self.state.mass.len()], vec![0.0; self.state.mass.len()]];
        let mut any = false;
        let mut reader = self.reader();
        for (p, motion) in self.particles.first_motions(&self.scene).into_iter().enumerate() {
            let v = motion.velocity;
            if v != Vector::zeros() {
                any = true;
                let m = self.particles.mass[p];
                reader.for_each_entry(p, |field, w, _| {
                    momentum[0][field] += m * w * v.x;
                    momentum[1][field] += m * w * v.y;
                });
            }
        }
        if any {
            for axis in 0..2 {
                for (d, &m) in self.state.mass.iter().enumerate() {
                    self.state.velocity[axis][d] = if m > 0.0 { momentum[axis][d] / m } else { 0.0 };
                }
            }
        }
    }
}
