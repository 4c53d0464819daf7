//! Both sides of a sharp corner, followed away from it side by side: as far along one as along the other, from corner
//! to corner of both.

/// How far both sides have been followed.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TwoSides {
    /// How many edges of each side are passed.
    pub(crate) edges: [usize; 2],
    /// How far from the corner the edge of each that is followed begins.
    begun: [f64; 2],
    /// How far along both.
    pub(crate) reached: f64,
}

impl TwoSides {
    /// How far along the next corner of either side is. `lengths`: of the edges that are followed.
    pub(crate) fn next(&self, lengths: [f64; 2]) -> f64 {
        (self.begun[0] + lengths[0]).min(self.begun[1] + lengths[1])
    }

    /// Where a place so far along a side is on its edge, as a part of the edge from its end nearer to the corner.
    pub(crate) fn part(&self, side: usize, arc: f64, lengths: [f64; 2]) -> f64 {
        (arc - self.begun[side]) / lengths[side]
    }

    /// Goes on to what [`TwoSides::next`] tells.
    pub(crate) fn go_on(&mut self, to: f64, lengths: [f64; 2]) {
        for side in 0..2 {
            if self.begun[side] + lengths[side] <= to {
                self.begun[side] += lengths[side];
                self.edges[side] += 1;
            }
        }
        self.reached = to;
    }
}
