//! What a tip does when it grows.

use fissure_scene::{CrackEnd, Point, TipState};

/// A ligament of less than this many cells breaks at once: no integral can be taken in it.
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
}
