//! Contact of outlines and crack faces with each other: which surfaces are near, and the impulses of a step.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::probes::Probes;
use super::rebound::{Ground, Push};
use super::supports::HeldFields;
use super::surfaces::{Surfaces, VertexKey, can_meet};
use crate::contact::impulses::{Impulse, Meetings, Share, allowed};
use crate::contact::meeting::{Meeting, meeting, were_within};
use crate::contact::neighbours::{Neighbours, Scenery, TOGETHER};
use crate::crack::cracks::Cracks;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use fissure_scene::Scene;
use serde::{Deserialize, Serialize};

/// Steps between two looks at how far surfaces have moved: a wave takes more than twice as many for the reach of a look
/// at material that moves at a tenth of its speed.
const STEPS_BETWEEN_LOOKS: u32 = 8;

/// A gap that is wider than this, in cells, and does not close within a step needs no impulse.
const SLIM: f64 = 0.1;

/// What touches, or may.
#[derive(Debug)]
pub(super) struct Touching {
    /// None where nothing can ever meet.
    surfaces: Option<Surfaces>,
    cracks_touch: bool,
    cell_size: f64,
    /// Whether the surfaces have changed since they were laid: at their ends ...
    is_stale: bool,
    /// ... or elsewhere, so that what was found on them counts no more.
    is_void: bool,
    neighbours: Neighbours,
    /// Where vertices that were asked for are [m].
    place: Vec<Point>,
    /// Whether neighbours that were found count.
    are_found: bool,
    steps_since_look: u32,
    meetings: Meetings,
    /// Of each meeting, its vertex and one of what it meets; none where that is the other side of a crack, as it was
    /// drawn.
    landings: Vec<Option<[u32; 2]>>,
    /// What goes on from step to step.
    last: LastImpulses,
}

/// An impulse and what tells its vertex from others, whatever their numbers are.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Kept {
    key: VertexKey,
    impulse: Impulse,
}

/// The impulses of the last step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct LastImpulses {
    /// Vertices rising.
    impulses: Vec<Kept>,
    /// Time in which they acted [s].
    kick: f64,
}

impl LastImpulses {
    /// Checks impulses that were read.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self) -> Fits {
        saved::finite("an impulse", self.impulses.iter().flat_map(|k| [&k.impulse.normal, &k.impulse.tangential]))?;
        saved::finite("an impulse", [&self.kick])
    }

    fn of(&self, vertex: u32, kick: f64) -> Impulse {
        let scale = if self.kick > 0.0 { kick / self.kick } else { 0.0 };
        match self.impulses.binary_search_by_key(&vertex, |kept| kept.impulse.vertex) {
            Ok(found) => {
                let Impulse { normal, tangential, .. } = self.impulses[found].impulse;
                Impulse { vertex, normal: normal * scale, tangential: tangential * scale }
            }
            Err(_) => Impulse { vertex, normal: 0.0, tangential: 0.0 },
        }
    }
}

/// What a step of contact works on.
pub(super) struct Moment<'a> {
    pub(super) scene: &'a Scene,
    pub(super) lattice: &'a Lattice,
    pub(super) probes: &'a Probes,
    pub(super) cracks: &'a Cracks,
    /// Time of the kick of this step, and of the step [s].
    pub(super) kick: f64,
    pub(super) time_step: f64,
}

impl Touching {
    /// What of `scene` can touch; `last`: impulses to go on from.
    pub(super) fn new(scene: &Scene, last: LastImpulses) -> Self {
        Self {
            surfaces: can_meet(scene).then(Surfaces::default),
            cracks_touch: scene.solver.crack_contact,
            cell_size: scene.cell_size,
            is_stale: true,
            is_void: true,
            neighbours: Neighbours::default(),
            place: Vec::new(),
            are_found: false,
            steps_since_look: 0,
            meetings: Meetings::default(),
            landings: Vec::new(),
            last,
        }
    }

    /// The impulses of the last step.
    pub(super) fn last(&self) -> &LastImpulses {
        &self.last
    }

    /// Whether anything has touched in the last step.
    pub(super) fn is_touching(&self) -> bool {
        !self.last.impulses.is_empty()
    }

    /// Cracks have grown. What they add to the surfaces lies at their tips, where nothing can touch it before the next
    /// look; a new mouth (`has_mouthed`) changes an outline.
    pub(super) fn change(&mut self, near: &Near, has_mouthed: bool) {
        self.is_stale = true;
        self.is_void |= has_mouthed;
        if let Some(surfaces) = &mut self.surfaces {
            surfaces.renumber(near);
        }
    }

    /// What was found so far counts no more, so that a run goes on from here as one that is restored does.
    pub(super) fn look_again(&mut self) {
        self.is_stale = true;
        self.are_found = false;
    }

    /// Looks for what may touch, where surfaces may have moved enough.
    pub(super) fn look(&mut self, moment: &Moment<'_>, motion: &Motion) {
        if self.is_void {
            self.lay_surfaces(moment);
        }
        let Some(surfaces) = &self.surfaces else { return };
        self.steps_since_look += 1;
        if self.steps_since_look < STEPS_BETWEEN_LOOKS && self.are_found {
            return;
        }
        self.steps_since_look = 0;
        let time = moment.time_step * f64::from(STEPS_BETWEEN_LOOKS);
        if self.are_found {
            let velocity = velocities(surfaces, moment, motion);
            let scenery = scenery_of(surfaces, &self.place, (self.cell_size, self.cracks_touch));
            if !self.neighbours.go_on(&scenery, &velocity, time) {
                self.neighbours.choose(&scenery);
                return;
            }
        }
        if self.is_stale {
            self.lay_surfaces(moment);
        }
        let Some(surfaces) = &self.surfaces else { return };
        let place = |v: u32| surfaces.probe(v, moment.probes).moved(&motion.displacement);
        self.place = (0..surfaces.surface.len() as u32).map(place).collect();
        let scenery = scenery_of(surfaces, &self.place, (self.cell_size, self.cracks_touch));
        if self.are_found {
            self.neighbours.find_again(&scenery);
        } else {
            self.neighbours = Neighbours::find(&scenery);
        }
        self.neighbours.foresee(&scenery, &velocities(surfaces, moment, motion), time);
        self.neighbours.choose(&scenery);
        self.are_found = true;
    }

    /// Lays the surfaces as they are now.
    fn lay_surfaces(&mut self, moment: &Moment<'_>) {
        let Some(surfaces) = &mut self.surfaces else { return };
        *surfaces = Surfaces::new(moment.scene, moment.probes, moment.cracks);
        self.last.impulses = renumbered(&self.last.impulses, surfaces);
        self.are_found = false;
        (self.is_stale, self.is_void) = (false, false);
    }

    /// Whether the two sides of a segment of a crack belonged to different pieces when surfaces were laid.
    pub(super) fn are_apart(&self, crack: u32, segment: u32) -> bool {
        self.surfaces.as_ref().is_some_and(|surfaces| surfaces.are_apart(crack as usize, segment as usize))
    }

    /// Whether anything is near enough to touch.
    pub(super) fn is_near(&self) -> bool {
        self.neighbours.are_due()
    }

    /// Gives velocities the impulses of all that touches. `held`: fields that supports hold.
    pub(super) fn resolve(&mut self, moment: &Moment<'_>, held: &HeldFields, motion: &mut Motion) {
        self.meetings.clear();
        self.landings.clear();
        let Some(surfaces) = &self.surfaces else { return };
        let Moment { probes, kick, time_step, .. } = *moment;
        for &v in self.neighbours.asked() {
            self.place[v as usize] = surfaces.probe(v, probes).moved(&motion.displacement);
        }
        let mut shares = Vec::new();
        for (vertex, near) in self.neighbours.iter() {
            let Some(found) = meeting(&surfaces.surface, &self.place, vertex, near, self.cell_size) else { continue };
            let value = |v: u32| surfaces.probe(v, probes).value(&motion.velocity);
            let relative =
                value(vertex) - value(found.ends[0]) * (1.0 - found.along) - value(found.ends[1]) * found.along;
            let least = allowed(found.gap, self.cell_size, time_step);
            let before = self.last.of(vertex, kick);
            if found.gap > SLIM * self.cell_size && relative.dot(&found.normal) > least && before.normal == 0.0 {
                continue;
            }
            shares_of(&mut shares, surfaces, vertex, &found, moment, held);
            let Meeting { ends, along, .. } = found;
            let are_beside = were_within(&surfaces.surface, vertex, ends, along, TOGETHER * self.cell_size);
            let friction = if are_beside {
                moment.scene.solver.crack_friction
            } else {
                friction_between(moment.scene, surfaces, [vertex, ends[0]])
            };
            self.landings.push((!are_beside).then_some([vertex, ends[0]]));
            self.meetings.push(found.normal, least, friction, &mut shares, before);
        }
        self.meetings.begin(&mut motion.velocity);
        self.meetings.solve(&mut motion.velocity);
    }

    /// Tells `each` of the pushes of this step, but those between the two sides of a crack that have not slid along
    /// each other by more than faces do that are no pieces.
    pub(super) fn each_push(&self, probes: &Probes, each: &mut dyn FnMut(Push)) {
        let Some(surfaces) = &self.surfaces else { return };
        for (meeting, vertices) in self.landings.iter().enumerate() {
            let impulse = self.meetings.along_normal(meeting);
            let (Some([vertex, other]), true) = (*vertices, impulse != Vector::zeros()) else { continue };
            let [field, on] = [vertex, other].map(|v| surfaces.probe(v, probes).entries.first().map(|entry| entry.0));
            if let (Some(field), Some(on)) = (field, on) {
                each(Push { point: self.place[vertex as usize], field, on: Ground::Field(on), impulse });
            }
        }
    }

    /// Goes on with the impulses of [`Touching::resolve`] after velocities have changed.
    pub(super) fn resolve_again(&mut self, motion: &mut Motion) {
        self.meetings.solve(&mut motion.velocity);
    }

    /// The step is over: keeps its impulses, which acted for `kick` [s]. Returns the work that supports did against
    /// them [J/m].
    pub(super) fn keep(&mut self, kick: f64, motion: &Motion) -> f64 {
        self.last.impulses.clear();
        if self.meetings.is_empty() {
            return 0.0;
        }
        let Some(surfaces) = &self.surfaces else { return 0.0 };
        let kept = |impulse: Impulse| Kept { key: surfaces.key(impulse.vertex), impulse };
        self.last.impulses.extend(self.meetings.impulses().map(kept));
        self.last.kick = kick;
        -self.meetings.work_on_held(&motion.velocity)
    }
}

/// Coulomb friction between the materials of two vertices.
fn friction_between(scene: &Scene, surfaces: &Surfaces, vertices: [u32; 2]) -> f64 {
    let [own, other] = vertices.map(|v| surfaces.surface.vertex(v).material as usize);
    scene.contact.friction_between(own, other)
}

/// How the fields take part in a meeting.
fn shares_of(
    shares: &mut Vec<Share>,
    surfaces: &Surfaces,
    vertex: u32,
    found: &Meeting,
    moment: &Moment<'_>,
    held: &HeldFields,
) {
    let parts = [(vertex, 1.0), (found.ends[0], found.along - 1.0), (found.ends[1], -found.along)];
    for (v, part) in parts.into_iter().filter(|(_, part)| *part != 0.0) {
        for &(field, weight) in &surfaces.probe(v, moment.probes).entries {
            let free = moment.lattice.inverse_mass[field as usize];
            let mobility = [0, 1].map(|axis| if held.holds(field, axis) { 0.0 } else { free });
            shares.push(Share { field, weight: part * weight, mobility });
        }
    }
}

/// The impulses with the numbers that their vertices have now; those of vertices that are no more are left out.
fn renumbered(impulses: &[Kept], now: &Surfaces) -> Vec<Kept> {
    if impulses.is_empty() {
        return Vec::new();
    }
    let mut vertices: Vec<(VertexKey, u32)> = (0..now.surface.len() as u32).map(|v| (now.key(v), v)).collect();
    vertices.sort_unstable();
    let number = |kept: &Kept| {
        let found = vertices.binary_search_by(|(key, _)| key.cmp(&kept.key)).ok()?;
        Some(Kept { impulse: Impulse { vertex: vertices[found].1, ..kept.impulse }, ..*kept })
    };
    let mut all: Vec<Kept> = impulses.iter().filter_map(number).collect();
    all.sort_unstable_by_key(|kept| kept.impulse.vertex);
    all
}

/// Surfaces with their vertices at `place` [m], for a look at them; `cell_size` [m].
fn scenery_of<'a>(surfaces: &'a Surfaces, place: &'a [Point], (cell_size, cracks_touch): (f64, bool)) -> Scenery<'a> {
    Scenery { surface: &surfaces.surface, place, cell_size, most_moved: surfaces.most_moved(), cracks_touch }
}

/// The velocities of all vertices [m/s].
fn velocities(surfaces: &Surfaces, moment: &Moment<'_>, motion: &Motion) -> Vec<Vector> {
    let all = 0..surfaces.surface.len() as u32;
    all.map(|v| surfaces.probe(v, moment.probes).value(&motion.velocity)).collect()
}
