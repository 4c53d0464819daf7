//! Supports: prescribed velocities of edges and of fields.

use super::edge_means::means;
use super::held_points::HeldPoint;
use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::ties::Ties;
use crate::SimulationError;
use crate::boundary::constraints::{ConstraintSystem, Held, systems};
use crate::boundary::edges::{Chain, EdgeMean, edges_of};
use crate::boundary::selector::Selector;
use crate::boundary::supports::{Reaction, prescribed};
use crate::particles::nothing_selected;
use fissure_plane::{Point, Vector};
use fissure_scene::{Scene, Selection, Support};

/// What the supports of the scene hold.
#[derive(Debug)]
pub(super) struct Supports {
    of_support: Vec<Held>,
    /// The edges of each.
    chains: Vec<Vec<Chain>>,
    /// The points of each that is smaller than a cell.
    points: Vec<Vec<HeldPoint>>,
    /// What is held along x and along y.
    systems: [ConstraintSystem; 2],
    held: HeldFields,
}

impl Supports {
    /// What each support of `scene` holds.
    ///
    /// # Errors
    /// When a support holds nothing.
    pub(super) fn new(scene: &Scene, lattice: &Lattice, ties: &Ties) -> Result<Self, SimulationError> {
        let bodies = body_of_fields(scene, lattice);
        let places = lattice.places_of_fields().map(|place| lattice.grid.place(place));
        let fields: Vec<(usize, Point)> = places.enumerate().collect();
        let chains: Vec<Vec<Chain>> =
            scene.supports.iter().map(|support| edges_of(scene, &support.selection)).collect();
        let held = |(index, support): (usize, &Support)| {
            let selector = Selector::new(scene, &support.selection);
            let chains = &chains[index];
            let mut means: Vec<EdgeMean> = chains.iter().flat_map(|chain| means(chain, lattice)).collect();
            let is_edge = matches!(support.selection, Selection::Edge { .. } | Selection::Outline(_));
            let held = |&&(field, node): &&(usize, Point)| holds(&selector, lattice, field, node, &bodies);
            // Of a side that no edge lies along: the nodes nearer to it than half a cell.
            let of_support = fields.iter().filter(|_| !is_edge || chains.is_empty()).filter(held);
            let held: Vec<u32> = of_support.map(|&(field, _)| field as u32).collect();
            let is_small = means.is_empty() && held.is_empty();
            let points = if is_small { HeldPoint::of(scene, &support.selection) } else { Vec::new() };
            means.extend(points.iter().map(|point| point.mean(lattice)));
            if means.is_empty() && held.is_empty() {
                // What is held are nodes: between two of them there may be particles.
                let with_mass = fields.iter().filter(|&&(field, _)| lattice.mass()[field] > 0.0);
                let places: Vec<Point> = with_mass.map(|&(_, place)| place).collect();
                let what = "node of the grid";
                return Err(nothing_selected(what, &places, "support", index, &support.selection).into());
            }
            Ok((Held { means, fields: held }, points))
        };
        let held = scene.supports.iter().enumerate().map(held).collect::<Result<Vec<_>, SimulationError>>()?;
        let (of_support, points): (Vec<Held>, Vec<Vec<HeldPoint>>) = held.into_iter().unzip();
        let systems = systems(&scene.supports, &of_support, &ties.inertia(&lattice.inverse_mass));
        let held = HeldFields::of(&systems);
        Ok(Self { of_support, chains, points, systems, held })
    }

    /// The same after a change: what is elsewhere is held as before. `retied`: fields to which ties give another
    /// inertia than before.
    pub(super) fn refresh(&mut self, near: &Near, scene: &Scene, lattice: &Lattice, (ties, retied): (&Ties, &[u32])) {
        if scene.supports.is_empty() {
            return;
        }
        let bodies = body_of_fields(scene, lattice);
        let fields = near.fields(lattice);
        let mut has_changed = self.held.holds_any(retied);
        let drawn = self.chains.iter().zip(&self.points);
        for ((held, (chains, points)), support) in self.of_support.iter_mut().zip(drawn).zip(&scene.supports) {
            if !points.is_empty() {
                if points.iter().any(|point| near.widened(0.0).any(|(low, high)| point.meets(low, high))) {
                    has_changed = true;
                    held.means = points.iter().map(|point| point.mean(lattice)).collect();
                }
                continue;
            }
            if chains.iter().any(|chain| near.widened(0.0).any(|(low, high)| chain.meets(low, high))) {
                has_changed = true;
                held.means = chains.iter().flat_map(|chain| means(chain, lattice)).collect();
            }
            let is_edge = matches!(support.selection, Selection::Edge { .. } | Selection::Outline(_));
            if is_edge && !chains.is_empty() {
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
            self.systems = systems(&scene.supports, &self.of_support, &ties.inertia(&lattice.inverse_mass));
            self.held = HeldFields::of(&self.systems);
        }
    }

    /// The same when ties give the fields `retied` another inertia than before.
    pub(super) fn retie(&mut self, scene: &Scene, lattice: &Lattice, ties: &Ties, retied: &[u32]) {
        if self.held.holds_any(retied) {
            self.systems = systems(&scene.supports, &self.of_support, &ties.inertia(&lattice.inverse_mass));
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

    /// Whether one of the fields is held.
    fn holds_any(&self, fields: &[u32]) -> bool {
        fields.iter().any(|&field| (0..2).any(|axis| self.holds(field, axis)))
    }

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
    let (body, h) = (bodies[field] as usize, lattice.grid.cell_size);
    lattice.mass()[field] > 0.0
        && selector.selects(place, body, 0.499 * h, h)
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
            reader.for_each_part(p, |field, _, _, _| bodies[field] = lattice.particles.body[p]);
        }
    }
    bodies
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::crack::cracks::Cracks;
    use crate::particles::Particles;
    use crate::solver::Snapshot;
    use crate::test_scenes;
    use crate::total::Total;
    use fissure_scene::{Formulation, Kernel, Region, TipDivision};
    use proptest::prelude::*;
    use std::sync::Arc;

    /// A square of 12 cells, turned and moved by less than a cell, held by what of its outline lies within a `depth` of
    /// one side [cells]: that side and a piece of both beside it.
    /// `crack`: where one lies, before the turn.
    fn held_around_a_side(angle: f64, away: [f64; 2], depth: f64, crack: &[[f64; 2]]) -> Total {
        let turn = nalgebra::Rotation2::new(angle);
        let placed = |low: [f64; 2], high: [f64; 2]| {
            let mut region: Region = test_scenes::rectangle(low, high);
            region.exterior.iter_mut().for_each(|p| *p = turn * *p + Vector::from(away));
            region
        };
        let mut scene = test_scenes::free_body(placed([0.0, -6.0], [12.0, 6.0]), 0.5);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = Kernel::Bilinear;
        scene.solver.tip_division = TipDivision::PartlyCut;
        let crack: Vec<[f64; 2]> = crack.iter().map(|&p| (turn * Point::from(p) + Vector::from(away)).into()).collect();
        if !crack.is_empty() {
            test_scenes::add_crack(&mut scene, &crack);
        }
        scene.supports.push(Support {
            selection: Selection::Region(placed([-1.0, -7.0], [depth, 7.0])),
            velocity: [Some(0.0); 2],
            curve: test_scenes::always(),
        });
        let particles = Arc::new(Particles::fill(&scene).unwrap());
        Total::new(&scene, particles, &Cracks::of_scene(&scene)).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        /// Truth: what does not move takes no work and gives none. Of any velocities up to 1 m/s the supports leave no
        /// more energy than there was, and edges at rest but for what cannot be told from rest.
        #[test]
        fn what_is_held_gains_nothing(
            angle in -3.2..3.2_f64,
            away in prop::array::uniform2(0.0..1.0_f64),
            depth in 0.0..2.0_f64,
            speeds in prop::collection::vec(-1.0..1.0_f64, 64..65),
        ) {
            let mut total = held_around_a_side(angle, away, depth, &[]);
            for axis in 0..2 {
                let velocity = total.motion.velocity[axis].iter_mut().enumerate();
                velocity.for_each(|(field, v)| *v = speeds[(field * 37 + axis * 11) % 64]);
            }
            let kinetic = |total: &Total| -> f64 {
                let of = |axis: usize| total.lattice.mass().iter().zip(&total.motion.velocity[axis]);
                (0..2).flat_map(of).map(|(mass, v)| mass * v * v).sum()
            };
            let before = kinetic(&total);
            total.apply_supports(0.0, 1e-3, 1e-3);
            prop_assert!(kinetic(&total) <= before * (1.0 + 1e-12), "{} {before}", kinetic(&total));
            for (axis, system) in total.supports.systems.iter().enumerate() {
                let velocity = &total.motion.velocity[axis];
                let fastest = system.speeds(velocity).fold(0.0_f64, |fastest, speed| fastest.max(speed.abs()));
                prop_assert!(fastest < 1e-3, "{fastest}");
            }
        }

        /// Truth: Gauss' principle, with the inertia that ties give to the opening of a crack whose tip is near or in
        /// what is held: the change that holds it is orthogonal to what is left, so that their energies add up. They do
        /// to rounding in nine of ten, and to .004 at the worst of 512, where means around a corner say nearly the
        /// same; with impulses by the masses of fields alone to .22.
        #[test]
        fn the_least_change_holds_beside_a_tip(
            angle in -3.2..3.2_f64,
            away in prop::array::uniform2(0.0..1.0_f64),
            depth in 0.0..2.0_f64,
            tip in prop::array::uniform2(-1.5..1.5_f64),
            heading in -3.2..3.2_f64,
            speeds in prop::collection::vec(-1.0..1.0_f64, 64..65),
        ) {
            let end = [(depth + tip[0]).max(0.1), tip[1]];
            let start = [(end[0] + 3.0 * heading.cos()).max(0.1), end[1] + 3.0 * heading.sin()];
            let mut total = held_around_a_side(angle, away, depth, &[start, end]);
            for axis in 0..2 {
                let velocity = total.motion.velocity[axis].iter_mut().enumerate();
                velocity.for_each(|(field, v)| *v = speeds[(field * 37 + axis * 11) % 64]);
            }
            let before = (total.kinetic_energy(), total.motion.velocity.clone());
            total.apply_supports(0.0, 1e-3, 1e-3);
            let after = total.kinetic_energy();
            for (left, before) in total.motion.velocity.iter_mut().zip(&before.1) {
                left.iter_mut().zip(before).for_each(|(left, before)| *left = before - *left);
            }
            let apart = (after + total.kinetic_energy()) / before.0 - 1.0;
            prop_assert!(apart.abs() < 0.01, "{apart}");
        }
    }
}
