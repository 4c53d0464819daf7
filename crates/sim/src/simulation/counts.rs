//! How much work a simulation has done: a right result that took too much of it is a fault too.

/// Work done since a simulation was made or restored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Steps, those of a relaxation included.
    pub steps: u64,
    /// Measurements of a tip: J, K and what follows from them.
    pub looks: u64,
    /// Times that the cracks' new points were taken up, by which fields, ties and faces were made anew.
    pub recuts: u64,
}
