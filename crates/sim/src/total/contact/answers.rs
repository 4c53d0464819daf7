//! How points of contact answer to impulses, worked out once for all rounds of a step.

use super::{Masses, Meeting, MeetingPoint};
use crate::total::motion::Motion;
use fissure_plane::Vector;
use std::ops::Range;

/// A field that moves when a point is pushed.
#[derive(Debug, Clone, Copy)]
struct Moved {
    field: usize,
    /// Whether it moves with the face above, 1, or against it, −1.
    sign: f64,
    /// What the pair of the field that is pushed weighs at the point [–].
    weight: f64,
    /// How much it moves by an impulse of 1 on that field [m/kg].
    response: f64,
}

/// How meetings answer to impulses within a step: worked out once for each that acts, for many rounds.
#[derive(Debug)]
pub(super) struct Answers {
    moved: Vec<Moved>,
    /// Of each meeting, those that it moves; none where that has not been asked for.
    moves: Vec<Range<usize>>,
    /// Of each meeting that acts, its part of the masses [kg/m].
    pub(super) reduced: Vec<f64>,
}

impl Answers {
    /// None yet, of so many meetings.
    pub(super) fn new(meetings: usize) -> Self {
        Self { moved: Vec::new(), moves: vec![0..0; meetings], reduced: Vec::new() }
    }

    /// Notes how the meetings that act answer, by what they share with each other.
    pub(super) fn note(
        &mut self,
        (acting, meetings, points): (&[usize], &[Meeting], &[MeetingPoint]),
        masses: &Masses<'_>,
        sharing: &[u32],
    ) {
        self.reduced.clear();
        for &k in acting {
            let point = &points[meetings[k].point];
            self.note_moves(k, point, masses);
            let mobility = point.fields.iter().map(|pair| masses.mobility(pair, Some(sharing))).sum::<f64>();
            self.reduced.push(1.0 / mobility);
        }
    }

    /// Notes what moves when a meeting at `point` is pushed.
    pub(super) fn note_moves(&mut self, meeting: usize, point: &MeetingPoint, masses: &Masses<'_>) {
        if !self.moves[meeting].is_empty() {
            return;
        }
        let first = self.moved.len();
        for pair in &point.fields {
            for (field, sign) in [(pair.above, 1.0), (pair.below, -1.0)] {
                let weight = pair.weight;
                masses.each_moved(field, &mut |field, response| {
                    self.moved.push(Moved { field, sign, weight, response });
                });
            }
        }
        self.moves[meeting] = first..self.moved.len();
    }

    /// Gives an impulse to the face above a meeting, of which is noted what it moves, and takes it from the face below.
    /// Whether that moves a field that nothing has `pushed` before in this step.
    pub(super) fn push(&self, meeting: usize, impulse: Vector, pushed: &mut [bool], motion: &mut Motion) -> bool {
        let mut is_new = false;
        for &Moved { field, sign, weight, response } in &self.moved[self.moves[meeting].clone()] {
            for axis in 0..2 {
                motion.velocity[axis][field] += sign * (impulse[axis] * weight * response);
            }
            is_new |= !std::mem::replace(&mut pushed[field], true);
        }
        is_new
    }
}
