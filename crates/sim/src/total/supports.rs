//! Supports: prescribed velocities of fields.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use crate::SimulationError;
use crate::boundary::selector::Selector;
use crate::boundary::supports::prescribed;
use fissure_plane::{Point, Vector};
use fissure_scene::{Scene, Support};

/// A prescribed velocity of one field.
#[derive(Debug, Clone, Copy)]
struct Constraint {
    field: u32,
    support: u32,
}

/// The fields that the supports of the scene hold.
#[derive(Debug)]
pub(super) struct Supports(Vec<Constraint>);

impl Supports {
    /// The fields each support of `scene` holds.
    ///
    /// # Errors
    /// When a support holds nothing.
    pub(super) fn new(scene: &Scene, lattice: &Lattice) -> Result<Self, SimulationError> {
        let mut constraints = Vec::new();
        let bodies = body_of_fields(scene, lattice);
        for (support, of) in scene.supports.iter().enumerate() {
            let before = constraints.len();
            let selector = Selector::new(scene, &of.selection);
            for (field, place) in lattice.places_of_fields().enumerate() {
                if holds(&selector, lattice, field, lattice.grid.place(place), &bodies) {
                    constraints.push(Constraint { field: field as u32, support: support as u32 });
                }
            }
            if constraints.len() == before {
                return Err(lattice.particles.no_particle("support", support, &of.selection).into());
            }
        }
        Ok(Self(constraints))
    }

    /// The same after a change: fields elsewhere are held as before.
    pub(super) fn refresh(&mut self, near: &Near, scene: &Scene, lattice: &Lattice) {
        if scene.supports.is_empty() {
            return;
        }
        let bodies = body_of_fields(scene, lattice);
        let changed = near.fields(lattice);
        self.0.retain(|c| !near.contains(lattice.position(c.field as usize)));
        for (support, of) in scene.supports.iter().enumerate() {
            let selector = Selector::new(scene, &of.selection);
            let held = changed.iter().filter(|&&(field, place)| holds(&selector, lattice, field, place, &bodies));
            self.0.extend(held.map(|&(field, _)| Constraint { field: field as u32, support: support as u32 }));
        }
        self.0.sort_unstable_by_key(|c| (c.support, c.field));
    }

    /// The fields that `supports` hold at the time `time` [s].
    pub(super) fn held(&self, supports: &[Support], time: f64) -> HeldFields {
        let mut held = Vec::new();
        for c in &self.0 {
            held.extend(prescribed(&supports[c.support as usize], time).map(|held| (c.field, held.axis)));
        }
        held.sort_unstable();
        HeldFields(held)
    }

    /// Makes velocities those that `supports` prescribe at the time `time` [s]. Adds the work of a step to `work`
    /// [J/m].
    pub(super) fn apply(&self, supports: &[Support], time: f64, mass: &[f64], motion: &mut Motion, work: &mut f64) {
        for c in &self.0 {
            let d = c.field as usize;
            for held in prescribed(&supports[c.support as usize], time) {
                let (before, after) = (motion.velocity[held.axis][d], held.velocity());
                // The force m (v' − v)/Δt acts along the prescribed motion.
                *work += mass[d] * (after - before) * after;
                motion.velocity[held.axis][d] = after;
            }
        }
    }
}

/// Fields that supports hold now, along which axes.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldFields(Vec<(u32, usize)>);

impl HeldFields {
    /// Whether a field is held along an axis.
    pub(super) fn holds(&self, field: u32, axis: usize) -> bool {
        self.0.binary_search(&(field, axis)).is_ok()
    }
}

/// Whether a support holds a field whose node is at `place` at rest.
///
/// A node beside a crack has a field for the material on each side of it. The one across the crack is held only if the
/// support means that material too: a support that ends at a notch does not hold the other face of it.
fn holds(selector: &Selector<'_>, lattice: &Lattice, field: usize, place: Point, bodies: &[u32]) -> bool {
    if lattice.mass()[field] == 0.0 {
        return false;
    }
    let (body, h) = (bodies[field] as usize, lattice.grid.cell_size);
    // Nodes on an edge and, where the edge is not on a grid line, those beyond it or nearer than half a cell.
    selector.selects(place, body, 0.499 * h, h)
        && (lattice.fields().crossed(field).is_empty() || has_selected_particle(selector, lattice, field, place))
}

/// Whether a support selects one of the particles of a field whose node is at `place` at rest.
fn has_selected_particle(selector: &Selector<'_>, lattice: &Lattice, field: usize, place: Point) -> bool {
    let particles = &lattice.particles;
    let reach = Vector::repeat(lattice.reach() * lattice.grid.cell_size);
    let mut reader = lattice.reader();
    particles.in_box(place - reach, place + reach).any(|p| {
        let mut is_own = false;
        reader.for_each_entry(p, |of, weight, _| is_own |= of == field && weight > 0.0);
        is_own && selector.selects(particles.rest[p], particles.body[p] as usize, particles.spacing, 0.0)
    })
}

/// The body each field belongs to.
fn body_of_fields(scene: &Scene, lattice: &Lattice) -> Vec<u32> {
    let mut bodies = vec![0; lattice.field_count()];
    if scene.bodies.len() > 1 {
        let mut reader = lattice.reader();
        for p in 0..lattice.particles.len() {
            reader.for_each_entry(p, |field, _, _| bodies[field] = lattice.particles.body[p]);
        }
    }
    bodies
}
