//! How much of their speed pieces keep when they land.
//!
//! Contact itself takes nothing: what has fallen springs back as far as its own elasticity and that of what it has
//! fallen upon throw it, .6 times as fast as it came for a block on the foot of its column, again and again. Real
//! pieces crush their corners, and lie. As in the spring that is stiffer while it is pressed than while it lets go
//! (Walton & Braun 1986), a push counts as a whole while two pieces come together, and by the
//! part κ = e² while they part: then the energy that was stored gives back κ of itself and the speed is e times what it
//! would be. Here the stiffness is that of whole bodies, so that what is taken from the push is taken from their motion
//! as rigid ones, at its place and with the same impulse on both: momenta are kept, and nothing is strained by it.
//!
//! Pieces that lie where they lay in the drawing, on both sides of the crack between them, have not landed.

use super::lattice::Lattice;
use super::motion::Motion;
use super::pieces::{Pieces, RigidMotion};
use super::supports::HeldFields;
use fissure_plane::{Point, Vector};
use fissure_scene::Scene;

/// The least κ: what lets go with no force at all would not part.
const LEAST_PART: f64 = 0.0025;

/// Steps between two looks at which pieces there are, at least, where cracks grow: a look takes as long as some steps.
const STEPS_BETWEEN_LOOKS: u32 = 64;

/// A push of something that has landed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    /// Where [m].
    pub(super) point: Point,
    /// A field of what is pushed.
    pub(super) field: u32,
    /// What it lands on.
    pub(super) on: Ground,
    /// Impulse along the normal, per unit thickness [N s/m].
    pub(super) impulse: Vector,
}

/// What a piece lands on.
#[derive(Debug, Clone, Copy)]
pub(super) enum Ground {
    /// The piece of a field.
    Field(u32),
    /// A collider, which has there this velocity [m/s].
    Collider(Vector),
}

/// What pieces keep when they land.
#[derive(Debug)]
pub(super) struct Rebound {
    /// κ of bodies that are whole, and of fragments [–].
    kept: [f64; 2],
    pieces: Pieces,
    is_stale: bool,
    steps_since_look: u32,
    /// The pushes of this step.
    pushes: Vec<Push>,
}

impl Rebound {
    /// What the scene says of it.
    pub(super) fn new(scene: &Scene) -> Self {
        let contact = &scene.contact;
        Self {
            kept: [contact.restitution, contact.fragment_restitution].map(|e| (e * e).max(LEAST_PART)),
            pieces: Pieces::default(),
            is_stale: true,
            steps_since_look: STEPS_BETWEEN_LOOKS,
            pushes: Vec::new(),
        }
    }

    /// Whether anything is ever taken.
    pub(super) fn is_on(&self) -> bool {
        self.kept.iter().any(|&kept| kept < 1.0)
    }

    /// Cracks have grown.
    pub(super) fn change(&mut self) {
        self.is_stale = true;
    }

    /// What was found so far counts no more, so that a run goes on from here as one that is restored does.
    pub(super) fn look_again(&mut self) {
        self.is_stale = true;
        self.steps_since_look = STEPS_BETWEEN_LOOKS;
    }

    /// Something has pushed in this step.
    pub(super) fn add(&mut self, push: Push) {
        self.pushes.push(push);
    }

    /// Takes from the motion of pieces what the pushes of this step have given beyond what they keep.
    pub(super) fn end_step(&mut self, lattice: &Lattice, held: &HeldFields, motion: &mut Motion) {
        self.steps_since_look = self.steps_since_look.saturating_add(1);
        if self.pushes.is_empty() {
            return;
        }
        if self.is_stale && self.steps_since_look > STEPS_BETWEEN_LOOKS {
            self.pieces = Pieces::new(lattice, held);
            (self.is_stale, self.steps_since_look) = (false, 0);
        }
        let mut motions: Vec<Option<[RigidMotion; 2]>> = vec![None; self.pieces.len()];
        for push in &self.pushes {
            let other = if let Ground::Field(field) = push.on { Some(field) } else { None };
            let pair = [Some(push.field), other].map(|field| self.pieces.of(field?));
            let kept = pair.into_iter().flatten().map(|piece| self.kept_by(piece)).fold(1.0, f64::min);
            if kept == 1.0 {
                continue;
            }
            for piece in pair.into_iter().flatten() {
                motions[piece].get_or_insert_with(|| [self.pieces.get(piece).rigid_motion(lattice, motion); 2]);
            }
            self.take(push, pair, 1.0 - kept, &mut motions);
        }
        self.pushes.clear();
        for (piece, motions) in motions.into_iter().enumerate() {
            if let Some([before, after]) = motions.filter(|[before, after]| before != after) {
                self.pieces.get(piece).change(&before, &after, motion);
            }
        }
    }

    /// Takes from the motion of two pieces, of which the first has got the push, a `part` of it as far as they part.
    /// `motions`: those of all pieces before, and now.
    fn take(&self, push: &Push, pair: [Option<usize>; 2], part: f64, motions: &mut [Option<[RigidMotion; 2]>]) {
        let (point, size) = (push.point.coords, push.impulse.norm());
        let normal = push.impulse / size;
        let now = pair.map(|piece| motions[piece?].map(|[_, now]| now));
        let velocity = |side: usize| now[side].map_or(Vector::zeros(), |motion| motion.velocity_at(point));
        let of_ground = if let Ground::Collider(velocity) = push.on { velocity } else { velocity(1) };
        let parting = (velocity(0) - of_ground).dot(&normal);
        // A support bears what it holds.
        let is_free = pair.map(|piece| piece.is_some_and(|piece| !self.pieces.get(piece).is_held));
        let compliance = |side: usize| {
            let free = now[side].filter(|_| is_free[side]);
            free.map_or(0.0, |motion| {
                motion.pushed(normal, point).velocity_at(point).dot(&normal) - velocity(side).dot(&normal)
            })
        };
        let compliance = compliance(0) + compliance(1);
        if !(parting > 0.0 && compliance > 0.0) {
            return;
        }
        // No more than brings them to rest: beyond that it would drive them together.
        let taken = (part * size).min(parting / compliance);
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let (Some(piece), true) = (pair[side], is_free[side])
                && let Some([_, now]) = &mut motions[piece]
            {
                *now = now.pushed(normal * (sign * taken), point);
            }
        }
    }

    fn kept_by(&self, piece: usize) -> f64 {
        self.kept[usize::from(self.pieces.get(piece).is_fragment)]
    }
}
