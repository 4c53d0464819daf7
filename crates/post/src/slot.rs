//! Material slots.

/// Material slot of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// Caps and the original boundary of the body.
    Outside,
    /// Crack walls.
    Inside,
}

impl Slot {
    /// Both slots, in the order in which they are written.
    pub const ALL: [Self; 2] = [Self::Outside, Self::Inside];

    /// Name of the material.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Inside => "inside",
        }
    }
}
