//! Supports: prescribed velocities of edges and of fields.

use super::constraints::{Constraint, ConstraintSystem};
use super::edge_means::{Chain, EdgeMean};
use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use crate::SimulationError;
use crate::boundary::selector::Selector;
use crate::boundary::supports::{Reaction, contradiction, prescribed};
use fissure_plane::{Point, Vector};
use fissure_scene::{OutlineStretch, Scene, Selection, Support};
use std::collections::BTreeMap;

/// What the supports of the scene hold.
#[derive(Debug)]
pub(super) struct Supports {
    of_support: Vec<Held>,
    /// What is held along x and along y.
    systems: [ConstraintSystem; 2],
    held: HeldFields,
}

/// What one support holds.
#[derive(Debug)]
struct Held {
    /// Its edges.
    chains: Vec<Chain>,
    /// Means of the velocity along these.
    means: Vec<EdgeMean>,
    /// Fields that it holds as a whole.
    fields: Vec<u32>,
}

impl Supports {
    /// What each support of `scene` holds.
    ///
    /// # Errors
    /// When a support holds nothing.
    pub(super) fn new(scene: &Scene, lattice: &Lattice) -> Result<Self, SimulationError> {
        let bodies = body_of_fields(scene, lattice);
        let places = lattice.places_of_fields().map(|place| lattice.grid.place(place));
        let fields: Vec<(usize, Point)> = places.enumerate().collect();
        let held = |(index, support): (usize, &Support)| {
            let selector = Selector::new(scene, &support.selection);
            let chains = Chain::of(scene, &edges_of(&selector, scene));
            let means: Vec<EdgeMean> = chains.iter().flat_map(|chain| chain.means(lattice)).collect();
            let is_edge = matches!(support.selection, Selection::Edge { .. } | Selection::Outline(_));
            let held = |&&(field, node): &&(usize, Point)| holds(&selector, lattice, field, node, &bodies);
            // Of a side that no edge lies along: the nodes nearer to it than half a cell.
            let of_support = fields.iter().filter(|_| !is_edge || chains.is_empty()).filter(held);
            let fields: Vec<u32> = of_support.map(|&(field, _)| field as u32).collect();
            if means.is_empty() && fields.is_empty() {
                return Err(lattice.particles.no_particle("support", index, &support.selection).into());
            }
            Ok(Held { chains, means, fields })
        };
        let of_support = scene.supports.iter().enumerate().map(held).collect::<Result<Vec<_>, SimulationError>>()?;
        let systems = systems(scene, lattice, &of_support);
        let held = HeldFields::of(&systems);
        Ok(Self { of_support, systems, held })
    }

    /// The same after a change: what is elsewhere is held as before.
    pub(super) fn refresh(&mut self, near: &Near, scene: &Scene, lattice: &Lattice) {
        if scene.supports.is_empty() {
            return;
        }
        let bodies = body_of_fields(scene, lattice);
        let fields = near.fields(lattice);
        let mut has_changed = false;
        for (held, support) in self.of_support.iter_mut().zip(&scene.supports) {
            if held.chains.iter().any(|chain| near.widened(0.0).any(|(low, high)| chain.meets(low, high))) {
                has_changed = true;
                held.means = held.chains.iter().flat_map(|chain| chain.means(lattice)).collect();
            }
            let is_edge = matches!(support.selection, Selection::Edge { .. } | Selection::Outline(_));
            if is_edge && !held.chains.is_empty() {
                continue;
            }
            let selector = Selector::new(scene, &support.selection);
            let before = held.fields.len();
            held.fields.retain(|&field| !near.contains(lattice.position(field as usize)));
            let kept = held.fields.len();
            let news = fields.iter().filter(|&&(field, node)| holds(&selector, lattice, field, node, &bodies));
            held.fields.extend(news.map(|&(field, _)| field as u32));
            held.fields.sort_unstable();
            has_changed |= kept < before || kept < held.fields.len();
        }
        if has_changed {
            self.systems = systems(scene, lattice, &self.of_support);
            self.held = HeldFields::of(&self.systems);
        }
    }

    /// The fields that supports hold, as a whole or in part.
    pub(super) fn held(&self) -> &HeldFields {
        &self.held
    }

    /// Makes velocities those that `supports` prescribe over a step. Gives the work of that [J/m] and adds what each
    /// does to `reactions`, one for each.
    pub(super) fn apply(
        &self,
        supports: &[Support],
        step: HeldStep,
        mass: &[f64],
        motion: &mut Motion,
        reactions: &mut [Reaction],
    ) -> f64 {
        let mut work = 0.0;
        for (axis, system) in self.systems.iter().enumerate().filter(|(_, system)| !system.is_empty()) {
            let speed = |support: &Support| {
                let of_axis = prescribed(support, step.middle, step.time_step).find(|held| held.axis == axis);
                of_axis.map_or(0.0, |held| held.velocity())
            };
            let speeds: Vec<f64> = supports.iter().map(speed).collect();
            let (velocity, before) = motion.velocity_and_before(axis);
            system.apply(
                |support| speeds[support as usize],
                mass,
                velocity,
                |held, impulse| {
                    let reaction = &mut reactions[held.support as usize];
                    let impulse = step.gain * impulse;
                    // A force over a step does work on the mean of the velocities before and after it.
                    let was: f64 = held.entries.iter().map(|&(field, w)| w * before[field as usize]).sum();
                    let done = impulse * 0.5 * (was + speeds[held.support as usize]);
                    reaction.impulse[axis] += impulse;
                    reaction.work += done;
                    work += done;
                },
            );
        }
        work
    }
}

/// A step in which supports hold velocities.
#[derive(Debug, Clone, Copy)]
pub(super) struct HeldStep {
    /// Time in its middle [s].
    pub(super) middle: f64,
    /// Its length [s].
    pub(super) time_step: f64,
    /// What force times time an impulse of 1 stands for ([`super::motion::force_of_impulse`]).
    pub(super) gain: f64,
}

/// Fields that supports hold, along which axes.
#[derive(Debug, Clone, Default)]
pub(super) struct HeldFields(Vec<(u32, usize)>);

impl HeldFields {
    fn of(systems: &[ConstraintSystem; 2]) -> Self {
        let of_axis = |axis: usize| systems[axis].fields().map(move |field| (field, axis));
        let mut held: Vec<(u32, usize)> = of_axis(0).chain(of_axis(1)).collect();
        held.sort_unstable();
        Self(held)
    }

    /// Whether a field is held along an axis.
    pub(super) fn holds(&self, field: u32, axis: usize) -> bool {
        self.0.binary_search(&(field, axis)).is_ok()
    }
}

/// The edges that a selection holds: those that it names, or that lie in its region.
fn edges_of(selector: &Selector<'_>, scene: &Scene) -> Vec<OutlineStretch> {
    match selector {
        Selector::Side(_) | Selector::Outline(_) | Selector::Region { .. } => selector.parts(scene),
        Selector::All | Selector::Bodies(_) | Selector::Near { .. } => Vec::new(),
    }
}

/// Whether a support holds a field whose node is at `place` at rest.
///
/// A node beside a crack has a field for the material on each side of it. The one across the crack is held only if the
/// support means that material too: a support that ends at a notch does not hold the other face of it.
fn holds(selector: &Selector<'_>, lattice: &Lattice, field: usize, place: Point, bodies: &[u32]) -> bool {
    let (body, h) = (bodies[field] as usize, lattice.grid.cell_size);
    lattice.mass()[field] > 0.0
        && selector.selects(place, body, 0.499 * h, h)
        && (lattice.fields().crossed(field).is_empty() || has_selected_particle(selector, lattice, field, place))
}

/// What is held along each axis. Where two supports want different velocities of a field, the later one has it.
fn systems(scene: &Scene, lattice: &Lattice, of_support: &[Held]) -> [ConstraintSystem; 2] {
    let supports = &scene.supports;
    [0, 1].map(|axis| {
        let mut constraints = Vec::new();
        // The last supports that have each field.
        let mut holders: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (index, held) in of_support.iter().enumerate().rev().filter(|(i, _)| supports[*i].velocity[axis].is_some())
        {
            let (support, start) = (index as u32, constraints.len());
            let later: Vec<u32> = (support + 1..supports.len() as u32)
                .filter(|&other| contradiction(&supports[index], &supports[other as usize], axis).is_some())
                .collect();
            let is_taken = |&(field, _): &(u32, f64)| {
                holders.get(&field).is_some_and(|of| of.iter().any(|other| later.contains(other)))
            };
            let fields = held.fields.iter().map(|&field| vec![(field, 1.0)]);
            for entries in held.means.iter().cloned().chain(fields) {
                if !entries.iter().any(is_taken) {
                    constraints.push(Constraint { support, entries });
                }
            }
            for (field, _) in constraints[start..].iter().flat_map(|c| &c.entries) {
                let of = holders.entry(*field).or_default();
                if of.last() != Some(&support) {
                    of.push(support);
                }
            }
        }
        ConstraintSystem::new(constraints, &lattice.inverse_mass)
    })
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
