//! What a tip does when it grows.

use crate::crack::cracks::TipId;
use fissure_scene::{CrackEnd, Point, TipState};

/// In a ligament of less than this many cells no integral can be taken. A tip that runs goes straight on through it, on
/// its account alone; from rest, or where tips only jump, it breaks at once.
pub(super) const LAST_LIGAMENT: f64 = 1.5;

/// What one tip does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Advance {
    /// New points, in the order they are reached [m].
    pub(crate) points: Vec<Point>,
    /// What the new end is.
    pub(crate) end: CrackEnd,
    /// State of the tip afterwards.
    pub(crate) state: TipState,
    /// Whether the tip is in its last ligament afterwards.
    pub(crate) is_in_last_ligament: bool,
    /// The tip of another crack that it ends on, and which ends with it.
    pub(crate) meets: Option<TipId>,
}
