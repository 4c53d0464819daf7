//! Contact between the two faces of a crack, at points of the crack itself.
//!
//! Nairn 2003, Guo & Nairn 2006 (thesis eq. 7–10): fields that overlap, (u_a − u_b)·n < 0 with n from below to above,
//! and approach, (v_a − v_b)·n < 0, get the normal velocity of their centre of mass. Friction after Coulomb: the
//! tangential impulse is at most μ times the normal one; an infinite μ sticks.
//!
//! As published, fields are held apart at their nodes, which lie up to a cell beside the crack. There they differ by
//! more than the faces do: a crack in pure shear, whose faces slide along each other without pressure, is stretched
//! along one face and shortened along the other, so that the fields of its nodes overlap on one side. Here what the
//! fields say is taken to the foot of each node on the crack, u_a − u_b there being Σ N_i (u_a − u_b)_i, and an impulse
//! there goes to the fields by the same weights.
//!
//! Points near each other share fields. In each round all of them see the same velocities, and each has its part of the
//! mass of a field that it shares, so that none comes before another and mirrored scenes stay so (Tonge, Benevolenski &
//! Voroshilov 2012). They begin with the impulses of the step before; without that what is pressed together would sink
//! a little in every step.
//!
//! As published, too, faces that meet overlap by the way they go in one step, and stay so; faces that slide along
//! each other overlap a little more with every step, and less and less pressure is passed on near a tip. Here two
//! faces may approach in a step by as much as the gap between them, so that faces meet and never overlap.
//!
//! Within two cells of a tip the fields do not know the gap so well: in pure shear they overlap or gape there by up to
//! a tenth of what the faces have slid, by how the crack lies in its cells, and faces held apart would open the tip by
//! as much (K_I up to .13 of K_II). There faces that slide count as apart until they overlap by that, unless they press
//! on each other behind as well, where the fields know: what is pressed together there is so up to the tip.

mod answers;

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::probes::Probes;
use super::segment_normals::SegmentNormals;
use super::ties::{Coupled, Ties};
use super::touching::Touching;
use crate::contact::friction::{borne_by_friction, left_of};
use crate::contact::neighbours::{MATCHED, TOGETHER};
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, Stretch};
use crate::saved::{self, Fits};
use answers::Answers;
use fissure_plane::{Point, Vector};
use fissure_scene::{CrackEnd, End};
use smallvec::{SmallVec, smallvec};

/// Rounds through all points in a step, at most.
const ROUNDS: usize = 32;
/// No more rounds are needed when no impulse changes by more than this part of the largest.
const CONVERGED: f64 = 1e-5;

/// How far behind a tip the gap between faces is known no better than by a part of what they have slid [cells].
const BLURRED: f64 = 2.0;
/// That part at a tip [–]. Without contact, pure shear gave at most .13 at the tip, .09 a quarter of a cell behind it,
/// .07 at .75 cells, .04 at 1.25 (50 places and turns).
const LEEWAY: f64 = 0.1;
/// By how much it grows with the way ahead of a tip, where fields are divided already [1/cells]: .24 at half a cell.
const LEEWAY_AHEAD: f64 = 0.3;
/// By how much of a cell's compression behind the blurred stretch the leeway is less.
const PRESSED: f64 = 2.0;

/// Two fields of one node on the two sides of one crack.
#[derive(Debug, Clone, Copy)]
struct FacingFields {
    above: u32,
    below: u32,
    /// What they weigh at the point [–].
    weight: f64,
}

/// A point of a crack at which its faces may meet.
#[derive(Debug)]
struct MeetingPoint {
    /// The node whose foot it is.
    node: u32,
    crack: u32,
    segment: u32,
    /// At rest [m].
    place: Point,
    fields: SmallVec<[FacingFields; 4]>,
    /// What the fields weigh together [–]: less than one where some nodes around have no fields on both sides.
    weight: f64,
    /// The largest E' around it [Pa].
    modulus: f64,
    /// Force on the face above in the last step, per unit thickness [N/m].
    force: Vector,
    /// The part of it that the faces feel: see [`Masses::part_on_faces`].
    on_faces: f64,
}

/// A pair of fields of a node that face each other across a crack, and are held apart at the feet of other nodes.
#[derive(Debug, Clone, Copy)]
struct Idle {
    node: u32,
    crack: u32,
    segment: u32,
    /// Foot of the node on the segment [m].
    place: Point,
}

/// What [`Contacts`] are made of: for each pair of fields that face each other across a crack one or the other.
#[derive(Debug, Default)]
struct Laid {
    points: Vec<MeetingPoint>,
    idle: Vec<Idle>,
}

/// All points at which the faces of cracks may meet, in the order of their nodes.
#[derive(Debug)]
pub(super) struct Contacts {
    points: Vec<MeetingPoint>,
    /// In the order of their nodes, too.
    idle: Vec<Idle>,
    /// Numbers of the points of each crack when points were laid last.
    lengths: Vec<usize>,
    /// Numbers of those that pressed on each other in the last step.
    pressed: Vec<u32>,
    /// Coefficient of friction; none where faces pass through each other.
    friction: Option<f64>,
    /// [m]
    cell_size: f64,
    /// Of each field, the points that act on it in a round; zero between rounds.
    sharing: Vec<u32>,
    /// Of each field, whether a point has pushed it in this step; none has between steps.
    pushed: Vec<bool>,
    /// Of each field, the number from 1 on of the fields that it is tied with; zero between steps and elsewhere.
    tied: Vec<u32>,
    normals: SegmentNormals,
}

/// How faces lie at a point.
#[derive(Debug, Clone, Copy)]
struct Facing {
    point: usize,
    /// Displacement of the face above less that of the face below [m].
    gap: Vector,
    /// Velocity of the face above less that of the face below [m/s].
    speed: Vector,
    /// Unit vector from below to above.
    normal: Vector,
    /// Of the step before, along the normal and to the left of it [N s/m].
    impulse: [f64; 2],
}

/// What faces at a point do in a step.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    point: usize,
    /// Unit vector from below to above.
    normal: Vector,
    /// Speed along the normal that is allowed; negative when the faces may still approach [m/s].
    allowed: f64,
    /// Along the normal and to the left of it, on the face above, per unit thickness [N s/m].
    impulse: [f64; 2],
    /// Whether the faces approach each other by more than is allowed, or have pressed on each other in the step before.
    is_pressed: bool,
}

/// How fields answer impulses: with their own masses, and with the inertia of ties around tips.
struct Masses<'a> {
    /// Of each field [kg/m].
    mass: &'a [f64],
    /// The fields that are tied together.
    groups: Vec<&'a Coupled>,
    /// See [`Contacts`].
    tied: Vec<u32>,
}

/// Forces between faces: the number of a point, the force on the face above [N/m], and the part that the faces feel.
pub(super) type FaceForces = Vec<(u32, [f64; 2], f64)>;

impl Contacts {
    /// The points of `lattice`. `friction`: coefficient of friction; none where faces pass through each other.
    pub(super) fn new(friction: Option<f64>, lattice: &Lattice, cracks: &Cracks) -> Self {
        let Laid { points, idle } = all_points(lattice, cracks);
        Self {
            points,
            idle,
            lengths: lengths(cracks),
            pressed: Vec::new(),
            friction,
            cell_size: lattice.grid.cell_size,
            sharing: Vec::new(),
            pushed: Vec::new(),
            tied: Vec::new(),
            normals: SegmentNormals::default(),
        }
    }

    /// Checks forces that were read, and goes on from them.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn set_forces(&mut self, forces: &FaceForces) -> Fits {
        saved::below("a force between faces", forces.iter().map(|f| f.0), self.points.len())?;
        saved::finite("a force between faces", forces.iter().flat_map(|f| f.1.iter().chain([&f.2])))?;
        for &(point, force, on_faces) in forces {
            let point = &mut self.points[point as usize];
            (point.force, point.on_faces) = (force.into(), on_faces);
        }
        self.note_pressed();
        Ok(())
    }

    /// Notes which points have a force.
    fn note_pressed(&mut self) {
        self.pressed.clear();
        let all = self.points.iter().enumerate().filter(|(_, point)| point.force != Vector::zeros());
        self.pressed.extend(all.map(|(index, _)| index as u32));
    }

    /// The forces of the last step.
    pub(super) fn all_forces(&self) -> FaceForces {
        let pressed = self.points.iter().enumerate().filter(|(_, point)| point.force != Vector::zeros());
        pressed.map(|(index, point)| (index as u32, point.force.into(), point.on_faces)).collect()
    }

    /// Lays all points anew that may lie otherwise by now, with the forces that they have: a tip slides on between two
    /// changes, and with it the end of the segment the points around it were laid on.
    pub(super) fn lay_anew(&mut self, lattice: &Lattice, cracks: &Cracks) {
        if self.friction.is_none() {
            return;
        }
        let stays = Stays::of_slides(cracks);
        let forks = cracks.forks();
        self.lengths = lengths(cracks);
        let before = std::mem::take(&mut self.points);
        let mut now = Laid { points: Vec::with_capacity(before.len() + 32), idle: Vec::with_capacity(self.idle.len()) };
        let mut before = before.into_iter().peekable();
        let mut idle = std::mem::take(&mut self.idle).into_iter().peekable();
        for node in lattice.fields().divided_nodes() {
            // Those of nodes that are divided no more are left out.
            while before.next_if(|point| (point.node as usize) < node).is_some() {}
            while idle.next_if(|of| (of.node as usize) < node).is_some() {}
            let own: SmallVec<[MeetingPoint; 2]> =
                std::iter::from_fn(|| before.next_if(|point| point.node as usize == node)).collect();
            let own_idle: SmallVec<[Idle; 2]> =
                std::iter::from_fn(|| idle.next_if(|of| of.node as usize == node)).collect();
            let is_laid = !own.is_empty() || !own_idle.is_empty();
            if is_laid && stays.of_node(node, &own, &own_idle, lattice, cracks) {
                now.points.extend(own.into_iter().map(MeetingPoint::renewed));
                now.idle.extend(own_idle);
                continue;
            }
            let first = now.points.len();
            add_points_of_node(lattice, node, cracks, &forks, &mut now);
            for point in own.into_iter().filter(|point| point.force != Vector::zeros()) {
                let same = |now: &&mut MeetingPoint| now.crack == point.crack && now.force == Vector::zeros();
                if let Some(now) = now.points[first..].iter_mut().find(same) {
                    (now.force, now.on_faces) = (point.force, point.on_faces);
                }
            }
        }
        (self.points, self.idle) = (now.points, now.idle);
        self.note_pressed();
    }

    /// Whether faces can press on each other.
    pub(super) fn are_possible(&self) -> bool {
        self.friction.is_some() && !self.points.is_empty()
    }

    /// The same after a change: nodes elsewhere have the points they had. `turned`: nodes of which a field has got
    /// mass, or has lost all.
    pub(super) fn refresh(&mut self, near: &Near, turned: &[usize], lattice: &Lattice, cracks: &Cracks) {
        let stays = Stays::new(near, turned, &self.lengths, lattice, cracks);
        self.lengths = lengths(cracks);
        let forks = cracks.forks();
        // A point sees nodes of the same stencil, so that what has changed there changes it.
        let reach = (lattice.reach() + 1.0) * lattice.grid.cell_size;
        let nodes = near.divided_nodes(lattice, reach);
        self.renumber(near);
        let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else { return };
        // Of nodes before and after these nothing is touched.
        let outside = |of: u32, node: usize| (of as usize).cmp(&node);
        let points_after = self.points.split_off(self.points.partition_point(|of| outside(of.node, last).is_le()));
        let before = self.points.split_off(self.points.partition_point(|of| outside(of.node, first).is_lt()));
        let idle_after = self.idle.split_off(self.idle.partition_point(|of| outside(of.node, last).is_le()));
        let idle = self.idle.split_off(self.idle.partition_point(|of| outside(of.node, first).is_lt()));
        let mut now = Laid { points: Vec::with_capacity(before.len() + 32), idle: Vec::with_capacity(idle.len()) };
        let (mut before, mut idle) = (before.into_iter().peekable(), idle.into_iter().peekable());
        for node in nodes {
            let is_before = |other: u32| (other as usize) < node;
            now.points.extend(std::iter::from_fn(|| before.next_if(|point| is_before(point.node))));
            now.idle.extend(std::iter::from_fn(|| idle.next_if(|of| is_before(of.node))));
            let own: SmallVec<[MeetingPoint; 2]> =
                std::iter::from_fn(|| before.next_if(|point| point.node as usize == node)).collect();
            let own_idle: SmallVec<[Idle; 2]> =
                std::iter::from_fn(|| idle.next_if(|of| of.node as usize == node)).collect();
            if stays.of_node(node, &own, &own_idle, lattice, cracks) {
                // As a new one that takes over from the one before: a force of −0 is one of 0.
                let taken_over = |point: MeetingPoint| MeetingPoint { force: Vector::zeros() + point.force, ..point };
                now.points.extend(own.into_iter().map(taken_over));
                now.idle.extend(own_idle);
                continue;
            }
            let first = now.points.len();
            add_points_of_node(lattice, node, cracks, &forks, &mut now);
            // What the faces did to each other in this step they did, however the node is divided now: tips may be
            // measured again before the next.
            for before in own {
                if let Some(now) = now.points[first..].iter_mut().find(|point| point.crack == before.crack) {
                    now.force += before.force;
                    now.on_faces = before.on_faces;
                }
            }
        }
        self.points.extend(now.points);
        self.points.extend(points_after);
        self.idle.extend(now.idle);
        self.idle.extend(idle_after);
        self.note_pressed();
    }

    /// Gives all segments the numbers that they have now.
    fn renumber(&mut self, near: &Near) {
        if near.has_shifts() {
            self.points.iter_mut().for_each(|of| of.segment = near.segment_now(of.crack, of.segment));
            self.idle.iter_mut().for_each(|of| of.segment = near.segment_now(of.crack, of.segment));
        }
    }

    /// Of each point the gap along its normal [m], by how much the faces have slid [m], and the part of that by which
    /// they may overlap.
    #[cfg(test)]
    pub(super) fn gaps(&self, probes: &Probes, cracks: &Cracks, motion: &Motion) -> Vec<[f64; 3]> {
        let of = |(point, [of_slide, _]): (&MeetingPoint, [f64; 2])| {
            let (normal, gap) =
                (probes.segment_normal(point.crack, point.segment, motion)?, point.gap_and_speed(motion).0);
            Some([gap.dot(&normal), gap.dot(&left_of(normal)).abs(), of_slide])
        };
        self.points.iter().zip(self.leeways(cracks)).filter_map(of).collect()
    }

    /// Applies contact at all points: impulses within the time `kick` [s], beginning with those of the step before.
    pub(super) fn resolve(
        &mut self,
        (mass, ties): (&[f64], &Ties),
        (probes, cracks, touching): (&Probes, &Cracks, &Touching),
        motion: &mut Motion,
        kick: f64,
        time_step: f64,
    ) {
        let Some(friction) = self.friction else { return };
        self.normals.begin(probes);
        let mut meetings = self.meetings((probes, cracks, touching), motion, kick, time_step);
        let masses = self.masses(mass, ties, &meetings);
        let mut answers = Answers::new(meetings.len());
        self.pushed.resize(mass.len(), false);
        for (k, meeting) in meetings.iter_mut().enumerate() {
            meeting.impulse[1] = borne_by_friction(meeting.impulse[1], friction, meeting.impulse[0]);
            if meeting.impulse[0] > 0.0 {
                answers.note_moves(k, &self.points[meeting.point], &masses);
                answers.push(k, meeting.whole(), &mut self.pushed, motion);
            }
        }
        self.relax((meetings, answers), friction, masses, motion, kick);
    }

    /// Goes on with the impulses of [`Contacts::resolve`] after velocities have changed, and nothing else: normals are
    /// as they were.
    pub(super) fn resolve_again(
        &mut self,
        (mass, ties): (&[f64], &Ties),
        (probes, cracks, touching): (&Probes, &Cracks, &Touching),
        motion: &mut Motion,
        kick: f64,
        time_step: f64,
    ) {
        let Some(friction) = self.friction else { return };
        let meetings = self.meetings((probes, cracks, touching), motion, kick, time_step);
        let masses = self.masses(mass, ties, &meetings);
        let answers = Answers::new(meetings.len());
        self.relax((meetings, answers), friction, masses, motion, kick);
    }

    /// Goes through all meetings until none approaches more than it may, or often enough; keeps their forces.
    fn relax(
        &mut self,
        (mut meetings, mut answers): (Vec<Meeting>, Answers),
        friction: f64,
        masses: Masses<'_>,
        motion: &mut Motion,
        kick: f64,
    ) {
        if meetings.is_empty() {
            self.points.iter_mut().for_each(|point| point.force = Vector::zeros());
            self.pressed.clear();
            return;
        }
        // All others stay as they are until one that shares a field with them is pushed.
        let fields = masses.mass.len();
        let mut candidates = self.candidates(&meetings, fields);
        let mut acting: Vec<usize> = Vec::new();
        let mut before: Vec<usize> = Vec::new();
        for _ in 0..ROUNDS {
            let acts = |&k: &usize| {
                let meeting = &meetings[k];
                meeting.impulse[0] > 0.0
                    || self.points[meeting.point].speed(motion).dot(&meeting.normal) < meeting.allowed
            };
            std::mem::swap(&mut acting, &mut before);
            acting.clear();
            acting.extend(candidates.iter().copied().filter(acts));
            if acting.is_empty() {
                break;
            }
            // As a rule those that act are the same from round to round, and share fields as they did.
            if acting != before {
                let points = || acting.iter().map(|&k| meetings[k].point);
                self.share_fields(points(), fields);
                answers.note((&acting, &meetings, &self.points), &masses, &self.sharing);
                self.forget_shares(points());
            }
            let change = |(&k, &reduced): (&usize, &f64)| self.change(&meetings[k], friction, reduced, motion);
            let changes: Vec<[f64; 2]> = acting.iter().zip(&answers.reduced).map(change).collect();
            let (mut change, mut largest, mut spreads) = (0.0_f64, 0.0_f64, false);
            for (&k, changed) in acting.iter().zip(changes) {
                let meeting = &mut meetings[k];
                let before = std::mem::replace(&mut meeting.impulse, changed);
                let by = [changed[0] - before[0], changed[1] - before[1]];
                let impulse = Meeting { impulse: by, ..*meeting }.whole();
                spreads |= answers.push(k, impulse, &mut self.pushed, motion);
                change = change.max(by[0].abs()).max(by[1].abs());
                largest = largest.max(changed[0]);
            }
            if change <= CONVERGED * largest {
                break;
            }
            if spreads {
                candidates = self.candidates(&meetings, fields);
            }
        }
        self.pushed.fill(false);
        self.points.iter_mut().for_each(|point| point.force = Vector::zeros());
        for meeting in &meetings {
            let point = &mut self.points[meeting.point];
            point.force = meeting.whole() * (point.weight / kick);
            point.on_faces = masses.part_on_faces(&point.fields);
        }
        self.note_pressed();
        self.untie(masses);
    }

    /// How fields answer impulses, until [`Contacts::untie`].
    fn masses<'a>(&mut self, mass: &'a [f64], ties: &'a Ties, meetings: &[Meeting]) -> Masses<'a> {
        let mut tied = std::mem::take(&mut self.tied);
        let groups: Vec<&Coupled> = if meetings.is_empty() { Vec::new() } else { ties.coupled().collect() };
        tied.resize(mass.len(), 0);
        for (number, group) in (1..).zip(&groups) {
            group.fields().iter().for_each(|&field| tied[field as usize] = number);
        }
        Masses { mass, groups, tied }
    }

    /// Forgets what [`Contacts::masses`] has noted.
    fn untie(&mut self, masses: Masses<'_>) {
        let Masses { groups, mut tied, .. } = masses;
        groups.iter().flat_map(|group| group.fields()).for_each(|&field| tied[field as usize] = 0);
        self.tied = tied;
    }

    /// The meetings in which something may happen, of so many `fields`.
    fn candidates(&mut self, meetings: &[Meeting], fields: usize) -> Vec<usize> {
        self.pushed.resize(fields, false);
        let is_pushed = |pair: &FacingFields| self.pushed[pair.above as usize] || self.pushed[pair.below as usize];
        let may_act = |meeting: &Meeting| meeting.is_pressed || self.points[meeting.point].fields.iter().any(is_pushed);
        (0..meetings.len()).filter(|&k| may_act(&meetings[k])).collect()
    }

    /// The impulse that a meeting would like, with the velocities as they are; `reduced`: its part of the masses
    /// [kg/m].
    fn change(&self, meeting: &Meeting, friction: f64, reduced: f64, motion: &Motion) -> [f64; 2] {
        let speed = self.points[meeting.point].speed(motion);
        let [normal, tangential] = meeting.impulse;
        let normal = (normal + (meeting.allowed - speed.dot(&meeting.normal)) * reduced).max(0.0);
        let sticking = tangential - speed.dot(&left_of(meeting.normal)) * reduced;
        [normal, borne_by_friction(sticking, friction, normal)]
    }

    /// The points whose faces could meet in a step, with what they did in the step before; none where nothing can come
    /// of them.
    fn meetings(
        &mut self,
        (probes, cracks, touching): (&Probes, &Cracks, &Touching),
        motion: &Motion,
        kick: f64,
        time_step: f64,
    ) -> Vec<Meeting> {
        let facing: Vec<Facing> =
            (0..self.points.len()).filter_map(|point| self.facing(point, (probes, touching), motion, kick)).collect();
        // What is left of the gap may be used up in this step; faces that overlap stay as they are.
        let allowed = |f: &Facing, leeway: f64| -(f.gap.dot(&f.normal) + leeway).max(0.0) / time_step;
        let is_pressed = |f: &Facing, allowed: f64| f.impulse[0] > 0.0 || f.speed.dot(&f.normal) < allowed;
        if !facing.iter().any(|f| is_pressed(f, allowed(f, 0.0))) {
            return Vec::new();
        }
        let leeways = self.leeways(cracks);
        let meeting = |f: Facing| {
            let [of_slide, pressed] = leeways[f.point];
            let leeway = (of_slide * f.gap.dot(&left_of(f.normal)).abs() - pressed).max(0.0);
            let allowed = allowed(&f, leeway);
            let is_pressed = is_pressed(&f, allowed);
            Meeting { point: f.point, normal: f.normal, allowed, impulse: f.impulse, is_pressed }
        };
        facing.into_iter().map(meeting).collect()
    }

    /// How faces lie at a point; none where they cannot meet.
    fn facing(
        &mut self,
        index: usize,
        (probes, touching): (&Probes, &Touching),
        motion: &Motion,
        kick: f64,
    ) -> Option<Facing> {
        let point = &self.points[index];
        let (gap, speed) = point.gap_and_speed(motion);
        // Faces that have come so far apart, sideways or not, touch others than they faced at rest: surfaces do. Of
        // pieces that have turned the normal may point anywhere, and say of faces far apart that they overlap.
        let in_cells = gap.norm() / (self.cell_size * point.weight);
        if in_cells > MATCHED && (in_cells > TOGETHER || touching.are_apart(point.crack, point.segment)) {
            return None;
        }
        if gap == Vector::zeros() && speed == Vector::zeros() {
            return None;
        }
        let normal = self.normals.find((point.crack, point.segment), probes, motion)?;
        let before = point.force * (kick / point.weight);
        let impulse = [before.dot(&normal).max(0.0), before.dot(&left_of(normal))];
        Some(Facing { point: index, gap, speed, normal, impulse })
    }

    /// Of each point, by how much of what they have slid the faces may overlap there, and by how much less for what
    /// pressed on them behind the blurred stretch of the tip in the step before [m].
    fn leeways(&self, cracks: &Cracks) -> Vec<[f64; 2]> {
        let forks = cracks.forks();
        let tips: Vec<_> = self.points.iter().map(|point| point.near_tip(cracks, &forks, self.cell_size)).collect();
        let slots = tips.iter().flatten().map(|(tip, _)| tip + 1).max().unwrap_or_default();
        let mut compression = vec![0.0; slots];
        for (point, near) in self.points.iter().zip(&tips) {
            if let Some((tip, _)) = near.filter(|(_, way)| *way >= BLURRED) {
                compression[tip] += point.force.norm() / (BLURRED * point.modulus);
            }
        }
        let leeway = |near: &Option<(usize, f64)>| match *near {
            Some((tip, way)) if way < 0.0 => [LEEWAY - LEEWAY_AHEAD * way, PRESSED * compression[tip]],
            Some((tip, way)) if way < BLURRED => [LEEWAY * (1.0 - way / BLURRED), PRESSED * compression[tip]],
            _ => [0.0; 2],
        };
        tips.iter().map(leeway).collect()
    }

    /// Counts, of each of so many `fields`, the points that act on it.
    fn share_fields(&mut self, points: impl Iterator<Item = usize>, fields: usize) {
        self.sharing.resize(fields, 0);
        for pair in points.flat_map(|point| &self.points[point].fields) {
            self.sharing[pair.above as usize] += 1;
            self.sharing[pair.below as usize] += 1;
        }
    }

    /// Sets back what [`Contacts::share_fields`] has counted.
    fn forget_shares(&mut self, points: impl Iterator<Item = usize>) {
        for pair in points.flat_map(|point| &self.points[point].fields) {
            self.sharing[pair.above as usize] = 0;
            self.sharing[pair.below as usize] = 0;
        }
    }

    /// The forces of the last step between the faces of a crack along a stretch of it: place at rest [m] and force on
    /// the face above [N/m].
    pub(super) fn forces(&self, stretch: Stretch) -> impl Iterator<Item = (Point, Vector)> {
        let is_on =
            move |p: &&MeetingPoint| p.crack as usize == stretch.crack && stretch.has_segment(p.segment as usize);
        let pressed = self.pressed.iter().map(|&index| &self.points[index as usize]);
        pressed.filter(is_on).map(|p| (p.place, p.force * p.on_faces))
    }
}

impl Meeting {
    /// Its impulse on the face above [N s/m].
    fn whole(&self) -> Vector {
        self.normal * self.impulse[0] + left_of(self.normal) * self.impulse[1]
    }
}

impl MeetingPoint {
    /// As one that is laid now, and takes over the force that it has, if it has one.
    fn renewed(self) -> Self {
        if self.force == Vector::zeros() { Self { force: Vector::zeros(), on_faces: 1.0, ..self } } else { self }
    }

    /// Displacement of the face above less that of the face below [m], and the same of their velocities [m/s].
    fn gap_and_speed(&self, motion: &Motion) -> (Vector, Vector) {
        let (mut gap, mut speed) = (Vector::zeros(), Vector::zeros());
        for &FacingFields { above, below, weight } in &self.fields {
            let [above, below] = [above, below].map(|field| field as usize);
            gap += (motion.displacement(above) - motion.displacement(below)) * weight;
            speed += (motion.velocity(above) - motion.velocity(below)) * weight;
        }
        (gap, speed)
    }

    /// The tip that is so near that what the faces do here tells of it: its number among all ends of cracks, and the
    /// way behind it, negative ahead of it, in cells of a size [m]. None on a trunk, which is behind both its branches.
    fn near_tip(&self, cracks: &Cracks, forks: &[(Point, Stretch)], cell_size: f64) -> Option<(usize, f64)> {
        let (crack, segment) = (self.crack as usize, self.segment as usize);
        if forks.iter().any(|(_, trunk)| trunk.crack == crack && trunk.has_segment(segment)) {
            return None;
        }
        let line = cracks.get(crack)?;
        let way = |end: End| {
            let beyond = self.place - line.tip_position(end);
            let is_ahead = beyond.dot(&line.last_direction(end)) > 0.0;
            let number = 2 * crack + usize::from(end == End::End);
            (number, beyond.norm() / if is_ahead { -cell_size } else { cell_size })
        };
        let tips = [End::Start, End::End].into_iter().filter(|&end| line.end(end) == CrackEnd::Tip);
        tips.map(way).filter(|(_, way)| *way < 2.0 * BLURRED).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Velocity of the face above less that of the face below [m/s].
    fn speed(&self, motion: &Motion) -> Vector {
        let apart = |pair: &FacingFields| motion.velocity(pair.above as usize) - motion.velocity(pair.below as usize);
        self.fields.iter().map(|pair| apart(pair) * pair.weight).sum()
    }
}

impl Masses<'_> {
    /// Tells of each field that an impulse of 1 on `field` moves by how much it does [m/kg].
    fn each_moved(&self, field: u32, each: &mut dyn FnMut(usize, f64)) {
        let field = field as usize;
        match self.place(field) {
            None => each(field, 1.0 / self.mass[field]),
            Some((group, pushed)) => {
                for (moved, &other) in group.fields().iter().enumerate() {
                    each(other as usize, group.response(self.mass, pushed, moved));
                }
            }
        }
    }

    /// The fields that a field is tied with, and its number among them.
    fn place(&self, field: usize) -> Option<(&Coupled, usize)> {
        let group = self.groups[(self.tied[field] as usize).checked_sub(1)?];
        Some((group, group.fields().iter().position(|&other| other as usize == field)?))
    }

    /// By how much an impulse of 1 at a point parts the two fields there, with their weight [m/kg]; of what `sharing`
    /// points act on, each has a part.
    fn mobility(&self, pair: &FacingFields, sharing: Option<&[u32]>) -> f64 {
        let [above, below] = [pair.above, pair.below].map(|field| self.place(field as usize));
        let of_side = |field: u32, place: Option<(&Coupled, usize)>| match place {
            None => {
                1.0 / (self.mass[field as usize] / sharing.map_or(1.0, |sharing| f64::from(sharing[field as usize])))
            }
            Some((group, at)) => self.shared(group, sharing) * group.response(self.mass, at, at),
        };
        let together = match (above, below) {
            (Some((group, a)), Some((of_below, b))) if std::ptr::eq(group, of_below) => {
                2.0 * self.shared(group, sharing) * group.response(self.mass, b, a)
            }
            _ => 0.0,
        };
        pair.weight * pair.weight * (of_side(pair.above, above) + of_side(pair.below, below) - together)
    }

    /// The part of an impulse at a point with these `fields` that its faces feel: around a tip, where material holds
    /// together still, the ties take the rest.
    fn part_on_faces(&self, fields: &[FacingFields]) -> f64 {
        let untied = |field: u32| self.tied[field as usize] == 0;
        if fields.iter().all(|pair| untied(pair.above) && untied(pair.below)) {
            return 1.0;
        }
        let alone = |field: u32| 1.0 / self.mass[field as usize];
        let free = |pair: &FacingFields| pair.weight * pair.weight * (alone(pair.above) + alone(pair.below));
        let all: f64 = fields.iter().map(free).sum();
        fields.iter().map(|pair| self.mobility(pair, None)).sum::<f64>() / all
    }

    /// How many points act on fields that are tied together: each does on two.
    fn shared(&self, group: &Coupled, sharing: Option<&[u32]>) -> f64 {
        let Some(sharing) = sharing else { return 1.0 };
        let twice: u32 = group.fields().iter().map(|&field| sharing[field as usize]).sum();
        (0.5 * f64::from(twice)).max(1.0)
    }
}

/// Numbers of the points of all cracks.
fn lengths(cracks: &Cracks) -> Vec<usize> {
    cracks.iter().map(|crack| crack.points.len()).collect()
}

/// A node nearer to its foot than this, in cells, is not nearer to what has come since it was laid beyond where
/// something has changed.
const BESIDE: f64 = 2.0;

/// Two distances that differ by more than this, in cells, differ by more than round-off.
const CLEARLY: f64 = 1e-6;

/// What tells after a change whether what a node has been laid with is what it would be laid with now.
struct Stays {
    /// Nodes of which a field has got mass, or has lost all, rising, and where they are [m].
    turned: Vec<(usize, Point)>,
    /// Of each crack, the segments that have come since or of which the end of the crack has moved on: so many at its
    /// start, and so many at its end; none where that is not known.
    changed: Vec<Option<[usize; 2]>>,
}

impl Stays {
    /// `lengths`: how many points cracks had when nodes were laid last.
    fn new(near: &Near, turned: &[usize], lengths: &[usize], lattice: &Lattice, cracks: &Cracks) -> Self {
        let mut turned: Vec<(usize, Point)> = turned.iter().map(|&node| (node, lattice.grid.position(node))).collect();
        turned.sort_unstable_by_key(|of| of.0);
        turned.dedup_by_key(|of| of.0);
        // Around forks what is nearest is not all that counts.
        let has_forks = !cracks.forks().is_empty();
        let changed = |(index, crack): (usize, &Crack)| {
            let before = *lengths.get(index)?;
            let at_start = near.shift(index) as usize;
            let at_end = crack.points.len().checked_sub(before + at_start)?;
            // Of so few points it may not be known where they were added.
            let is_known = before >= 4 && !has_forks;
            is_known.then_some([at_start + 1, at_end + 1])
        };
        Self { turned, changed: cracks.iter().enumerate().map(changed).collect() }
    }

    /// What tells the same after tips have slid, which moves nothing but the ends of cracks.
    fn of_slides(cracks: &Cracks) -> Self {
        let is_known = cracks.forks().is_empty();
        Self { turned: Vec::new(), changed: cracks.iter().map(|_| is_known.then_some([1, 1])).collect() }
    }

    /// Whether a node keeps its `points` and what is `idle` of it, the numbers of whose segments are those of now.
    fn of_node(&self, node: usize, points: &[MeetingPoint], idle: &[Idle], lattice: &Lattice, cracks: &Cracks) -> bool {
        if self.turned.binary_search_by_key(&node, |of| of.0).is_ok() {
            return false;
        }
        let place = lattice.grid.position(node);
        // Of what faces across the same crack the first would take over all forces.
        let is_alone = |(k, point): (usize, &MeetingPoint)| points[..k].iter().all(|other| other.crack != point.crack);
        let feet = points.iter().map(|of| (of.crack, of.segment, of.place));
        let mut feet = feet.chain(idle.iter().map(|of| (of.crack, of.segment, of.place)));
        points.iter().enumerate().all(is_alone)
            && feet.all(|(crack, segment, foot)| {
                self.of_foot((place, foot), &cracks[crack as usize], (crack, segment), lattice)
            })
    }

    /// Whether the foot of a node at `place` on a segment of a crack is where it was, with what faces each other around
    /// it.
    fn of_foot(
        &self,
        (place, foot): (Point, Point),
        line: &Crack,
        (crack, segment): (u32, u32),
        lattice: &Lattice,
    ) -> bool {
        let Some([at_start, at_end]) = self.changed[crack as usize] else { return false };
        let (count, segment, h) = (line.points.len() - 1, segment as usize, lattice.grid.cell_size);
        let Some(last) = count.checked_sub(at_end) else { return false };
        let distance = (place - foot).norm();
        if segment < at_start || segment >= last || distance >= BESIDE * h {
            return false;
        }
        let is_farther = |k: usize| {
            fissure_plane::distance_to_segment(place, line.points[k], line.points[k + 1]) > distance + CLEARLY * h
        };
        let stencil = (lattice.reach() + CLEARLY) * h;
        (0..at_start).chain(last..count).all(is_farther)
            && self.turned.iter().all(|(_, turned)| (turned - foot).amax() > stencil)
    }
}

/// The points of all nodes.
fn all_points(lattice: &Lattice, cracks: &Cracks) -> Laid {
    let forks = cracks.forks();
    let mut laid = Laid::default();
    for node in lattice.fields().divided_nodes() {
        add_points_of_node(lattice, node, cracks, &forks, &mut laid);
    }
    laid
}

fn add_points_of_node(lattice: &Lattice, node: usize, cracks: &Cracks, forks: &[(Point, Stretch)], laid: &mut Laid) {
    let place = lattice.grid.position(node);
    let facing: Vec<_> = lattice.fields().facing_pairs(&lattice.fields_with_mass(node)).collect();
    for pair in &facing {
        let crack = pair.crack;
        let Some(line) = cracks.get(crack as usize) else { continue };
        // Around a fork the two sides of the trunk differ by both its branches: what differs by one faces across that.
        let is_of_trunk = |segment: &usize| {
            let is_near = |at: Point| (place - at).amax() <= lattice.division.around_fork();
            forks.iter().any(|(at, trunk)| trunk.crack == crack as usize && trunk.has_segment(*segment) && is_near(*at))
        };
        let segment = nearest_segment(lattice, crack, line, place, |segment| !is_of_trunk(segment));
        let foot = foot_on(line, segment, place);
        // Where a node has several pairs across one crack, none of those around it is known to be the same faces.
        let is_alone = facing.iter().filter(|other| other.crack == crack).count() == 1;
        let around = if is_alone { facing_fields_at(lattice, crack, foot) } else { SmallVec::new() };
        let [above, below] = pair.above_and_below();
        let sees_own = around.iter().any(|other| (other.above, other.below) == (above, below));
        // A node so far from the crack that it has no weight at its foot is held apart where it has some: at the feet
        // of nodes nearer to it.
        let (node, segment) = (node as u32, segment as u32);
        if !sees_own && !around.is_empty() {
            laid.idle.push(Idle { node, crack, segment, place: foot });
            continue;
        }
        let fields = if sees_own { around } else { smallvec![FacingFields { above, below, weight: 1.0 }] };
        laid.points.push(MeetingPoint {
            node,
            crack,
            segment,
            place: foot,
            weight: fields.iter().map(|pair| pair.weight).sum(),
            fields,
            modulus: modulus_around(lattice, foot),
            force: Vector::zeros(),
            on_faces: 1.0,
        });
    }
}

/// The largest E' of the particles around a place [Pa].
fn modulus_around(lattice: &Lattice, place: Point) -> f64 {
    let reach = Vector::repeat(lattice.reach() * lattice.grid.cell_size);
    let around = lattice.particles.in_box(place - reach, place + reach);
    around.map(|p| lattice.material(p).effective_modulus).fold(0.0, f64::max)
}

/// Where the way from `place` meets a segment of a crack at a right angle; beyond the ends of the crack as if it went
/// straight on.
fn foot_on(line: &Crack, segment: usize, place: Point) -> Point {
    let (a, b) = (line.points[segment], line.points[segment + 1]);
    let along = (place - a).dot(&(b - a)) / (b - a).norm_squared();
    let least = if segment == 0 { f64::NEG_INFINITY } else { 0.0 };
    let most = if segment + 2 == line.points.len() { f64::INFINITY } else { 1.0 };
    a + (b - a) * along.clamp(least, most)
}

/// The fields that face each other across a crack around a `place` on it, with their weights there; nodes where several
/// pairs do have no part.
fn facing_fields_at(lattice: &Lattice, crack: u32, place: Point) -> SmallVec<[FacingFields; 4]> {
    let stencil = lattice.stencil(place);
    let nodes = lattice.grid.stencil(&stencil);
    let mut fields = SmallVec::new();
    for (b, a) in (0..stencil.width).flat_map(|b| (0..stencil.width).map(move |a| (b, a))) {
        let weight = stencil.weight(a, b);
        let Some(node) = nodes.at(a, b).filter(|_| weight > 0.0) else { continue };
        let with_mass = lattice.fields_with_mass(node);
        let mut pairs = lattice.fields().facing_pairs(&with_mass).filter(|pair| pair.crack == crack);
        if let (Some(pair), None) = (pairs.next(), pairs.next()) {
            let [above, below] = pair.above_and_below();
            fields.push(FacingFields { above, below, weight });
        }
    }
    fields
}

/// The segment of a crack nearest to `place` of those that count.
fn nearest_segment(
    lattice: &Lattice,
    crack: u32,
    line: &Crack,
    place: Point,
    counts: impl Fn(&usize) -> bool + Copy,
) -> usize {
    // Around a vertex both its segments are equally near, up to round-off: the first one counts.
    let clearly = 1e-9 * lattice.grid.cell_size;
    for beside in [0, 1] {
        let around = lattice.division.segments_around(crack, place, beside);
        let (distance, segment) = nearest_of(around.into_iter().filter(counts), line, place, clearly);
        if distance < lattice.division.surroundings(beside) - 2.0 * clearly {
            return segment;
        }
    }
    // Ahead of a tip or beyond a mouth, where few nodes are, what is nearest may lie anywhere.
    nearest_of((0..line.points.len() - 1).filter(counts), line, place, clearly).1
}

/// Distance to the nearest of `segments` [m], which rise, and which it is; one counts as nearer than those before it
/// when it is so `clearly` [m].
fn nearest_of(segments: impl Iterator<Item = usize>, line: &Crack, place: Point, clearly: f64) -> (f64, usize) {
    segments.fold((f64::INFINITY, 0), |(nearest, segment), s| {
        let distance = fissure_plane::distance_to_segment(place, line.points[s], line.points[s + 1]);
        if distance < nearest - clearly { (distance, s) } else { (nearest, segment) }
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Total;
    use super::*;
    use crate::crack::cracks::TipId;
    use crate::particles::Particles;
    use crate::solver::{SlidingTips, Solver};
    use crate::test_scenes;
    use fissure_scene::{Formulation, Kernel, TipDivision};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn plate(kernel: Kernel, points: &[[f64; 2]]) -> (Total, Cracks) {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        scene.solver.formulation = Formulation::Total;
        scene.solver.kernel = kernel;
        scene.solver.tip_division = TipDivision::PartlyCut;
        test_scenes::add_crack(&mut scene, points);
        let cracks = Cracks::of_scene(&scene);
        (Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap(), cracks)
    }

    /// The segment of every pair, and what a look at all segments of the crack finds.
    fn assert_nearest(total: &Total, cracks: &Cracks) {
        let clearly = 1e-9 * total.lattice.grid.cell_size;
        assert!(!total.contacts.points.is_empty());
        for point in &total.contacts.points {
            let line = &cracks[point.crack as usize];
            let place = total.lattice.grid.position(point.node as usize);
            let nearest = nearest_of(0..line.points.len() - 1, line, place, clearly).1;
            assert_eq!(point.segment as usize, nearest, "at {place}");
        }
    }

    /// Truth: the construction. Of a plate that is split in two, one half has come far away and flies on; whichever way
    /// it has gone, and be it that there the faces seem to overlap, the other half does not feel it.
    #[test]
    fn faces_far_apart_do_nothing_to_each_other() {
        for way in [[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [0.6, -0.8]] {
            let (mut total, cracks) = plate(Kernel::Bilinear, &[[0.0, 2.03], [4.0, 2.03]]);
            let way = Vector::from(way);
            let above =
                total.contacts.points.iter().flat_map(|point| point.fields.iter().map(|pair| pair.above as usize));
            for field in above.collect::<Vec<_>>() {
                for axis in 0..2 {
                    total.motion.displacement[axis][field] = 1.5 * way[axis];
                    total.motion.velocity[axis][field] = 10.0 * way[axis];
                }
            }
            let before = total.motion.velocity.clone();
            let Total { lattice, ties, motion, probes, contacts, touching, .. } = &mut total;
            contacts.resolve((lattice.mass(), ties), (probes, &cracks, touching), motion, 1e-4, 1e-4);
            assert!(total.motion.velocity == before, "{way}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Truth: brute force, over cracks that wind, come back beside themselves and grow.
        #[test]
        fn points_have_the_nearest_segment_of_all(
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp, Kernel::Cubic]),
            start in 0.5..3.5_f64,
            turns in prop::collection::vec((-1.2..1.2_f64, 0.02..0.6_f64), 1..40),
            grown in 0.0..0.6_f64,
        ) {
            let mut points = vec![Point::new(0.0, start), Point::new(0.3, start)];
            let mut heading = 0.0_f64;
            for (turn, length) in turns {
                heading += turn;
                let next = points[points.len() - 1] + Vector::new(heading.cos(), heading.sin()) * length;
                if next.coords.amin() < 0.3 || next.coords.amax() > 3.7 {
                    break;
                }
                points.push(next);
            }
            let points: Vec<[f64; 2]> = points.into_iter().map(Into::into).collect();
            let (mut total, mut cracks) = plate(kernel, &points);
            assert_nearest(&total, &cracks);
            let ahead = Vector::new(heading.cos(), heading.sin()) * (grown * total.lattice.grid.cell_size);
            if ahead != Vector::zeros() {
                let id = TipId::new(0, End::End);
                cracks.grow(id, &[cracks.position(id) + ahead]);
                total.recut(&cracks, &[id]);
                assert_nearest(&total, &cracks);
            }
        }
    }

    /// All that is laid, but for what the faces do to each other.
    fn laid(points: &[MeetingPoint], idle: &[Idle]) -> String {
        let points: Vec<_> = points.iter().map(|of| (of.node, of.crack, of.segment, of.place, &of.fields)).collect();
        format!("{points:?} {idle:?}")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Truth: all laid from nothing. Two tips turn and slide on, one into what the other has cut, with recuts and
        /// without; what faces did stays with them.
        #[test]
        fn what_stays_is_as_laid_anew(
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp, Kernel::Cubic]),
            ends in [0.9..1.8_f64, 2.2..3.1_f64], heights in prop::array::uniform2(1.6..2.4_f64),
            turns in prop::collection::vec((-1.0..1.0_f64, 0.0..1.0_f64, any::<bool>()), 1..25),
        ) {
            let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
            (scene.solver.formulation, scene.solver.kernel) = (Formulation::Total, kernel);
            scene.solver.tip_division = TipDivision::PartlyCut;
            scene.solver.crack_contact = true;
            test_scenes::add_crack(&mut scene, &[[0.0, heights[0]], [0.4, heights[0]], [ends[0], heights[0]]]);
            test_scenes::add_crack(&mut scene, &[[ends[1], heights[1]], [3.6, heights[1]], [4.0, heights[1]]]);
            (scene.cracks[0].end_live, scene.cracks[1].start_live) = (true, true);
            let mut cracks = Cracks::of_scene(&scene);
            let mut total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            for (round, (turn, part, is_first)) in turns.into_iter().enumerate() {
                let (id, way) = if is_first { (TipId::new(0, End::End), 0.05) } else { (TipId::new(1, End::Start), -0.05) };
                if cracks.left_of_increment(id).is_none() {
                    let target = cracks.position(id) + Vector::new(way, way * turn);
                    cracks.begin_increment(id, target, 1e-3);
                    total.recut(&cracks, &[id]);
                }
                let left = cracks.left_of_increment(id).unwrap_or_default();
                cracks.slide(id, if part > 0.4 { left } else { part * left });
                SlidingTips::slide(&mut total, &cracks, id);
                let Total { lattice, contacts, .. } = &mut total;
                let forces: FaceForces = (0..contacts.points.len() as u32).map(|k| (k, [f64::from(k % 3), 0.0], 0.5)).collect();
                contacts.set_forces(&forces).unwrap();
                let force = |point: &MeetingPoint| ((point.node, point.crack), point.force.x);
                let before: Vec<_> = contacts.points.iter().map(force).collect();
                contacts.lay_anew(lattice, &cracks);
                let anew = all_points(lattice, &cracks);
                prop_assert_eq!(laid(&contacts.points, &contacts.idle), laid(&anew.points, &anew.idle), "{}", round);
                for (of, force) in contacts.points.iter().map(force) {
                    let own: Vec<_> = before.iter().filter(|(other, _)| *other == of).collect();
                    prop_assert!(own.len() != 1 || own[0].1 == force, "{} {:?}", round, of);
                }
                let feels = |point: &MeetingPoint| if point.force.x == 0.0 { 1.0 } else { 0.5 };
                let is_kept = contacts.points.iter().all(|point| point.on_faces == feels(point));
                prop_assert!(is_kept);
            }
        }
    }

    /// Truth: the construction. However long a crack is, only what is around a node is looked at.
    #[test]
    fn a_node_looks_at_what_is_around_it() {
        let most = [40, 400].map(|segments| {
            let points: Vec<[f64; 2]> =
                (0..=segments).map(|k| [0.1 + 0.2 * f64::from(k), 2.03 + 0.02 * f64::from(k % 2)]).collect();
            let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [90.0, 4.0]), 0.1);
            scene.solver.formulation = Formulation::Total;
            test_scenes::add_crack(&mut scene, &points);
            let cracks = Cracks::of_scene(&scene);
            let total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            let looks = |point: &MeetingPoint| {
                let place = total.lattice.grid.position(point.node as usize);
                total.lattice.division.segments_around(point.crack, place, 1).len()
            };
            total.contacts.points.iter().map(looks).max().unwrap()
        });
        assert!(most[0] < 40 && most[1] <= most[0] + 2, "{most:?}");
    }
}
