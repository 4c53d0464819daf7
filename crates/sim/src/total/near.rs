//! Where a crack has grown: what is made from the lattice is made anew there and stays elsewhere.

use super::lattice::Lattice;
use fissure_plane::{Point, Vector};

/// Where something has changed.
#[derive(Debug)]
pub(super) struct Near {
    boxes: Vec<(Point, Point)>,
    /// By how much the segments of each crack have moved up, because points were added at its start.
    shifts: Vec<u32>,
}

impl Near {
    /// Around the boxes within which stencils of `lattice` have changed. `shifts`: how many points each crack has got
    /// at its start.
    pub(super) fn new(lattice: &Lattice, boxes: &[(Point, Point)], shifts: Vec<u32>) -> Self {
        // Particles at the rim of a box, up to two rows beyond it, have given mass to nodes outside it, or taken it
        // from them.
        let reach = Vector::repeat((lattice.reach() + 1.0) * lattice.grid.cell_size);
        let boxes = boxes.iter().map(|(low, high)| (low - reach, high + reach)).collect();
        Self { boxes, shifts }
    }

    /// Whether a place at rest lies where something has changed.
    pub(super) fn contains(&self, place: Point) -> bool {
        self.boxes.iter().any(|(low, high)| place >= *low && place <= *high)
    }

    /// Whether something has changed within `reach` [m] of a place at rest, as boxes go.
    pub(super) fn is_within(&self, place: Point, reach: f64) -> bool {
        self.widened(reach).any(|(low, high)| place >= low && place <= high)
    }

    /// The number that a segment of a crack has now.
    pub(super) fn segment_now(&self, crack: u32, before: u32) -> u32 {
        before + self.shift(crack as usize)
    }

    /// Whether segments of any crack have got other numbers.
    pub(super) fn has_shifts(&self) -> bool {
        self.shifts.iter().any(|&shift| shift > 0)
    }

    /// By how much the numbers of the points of a crack have moved up.
    pub(super) fn shift(&self, crack: usize) -> u32 {
        self.shifts[crack]
    }

    /// The boxes, widened by `margin` [m].
    pub(super) fn widened(&self, margin: f64) -> impl Iterator<Item = (Point, Point)> {
        let by = Vector::repeat(margin);
        self.boxes.iter().map(move |(low, high)| (low - by, high + by))
    }

    /// The nodes with further fields within `reach` [m] of where something has changed, rising.
    pub(super) fn divided_nodes(&self, lattice: &Lattice, reach: f64) -> Vec<usize> {
        let mut nodes: Vec<usize> = Vec::new();
        for (low, high) in self.widened(reach) {
            let around =
                lattice.grid.nodes_around(low, high).filter(|&(node, _)| !lattice.fields().of(node).is_empty());
            let is_inside = |place: Point| place >= low && place <= high;
            nodes.extend(around.filter(|&(_, place)| is_inside(lattice.grid.place(place))).map(|(node, _)| node));
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// The fields where something has changed, rising, with the places of their nodes at rest [m].
    pub(super) fn fields(&self, lattice: &Lattice) -> Vec<(usize, Point)> {
        let mut nodes: Vec<(usize, Point)> = Vec::new();
        for (low, high) in self.widened(0.0) {
            let around = lattice.grid.nodes_around(low, high).map(|(node, place)| (node, lattice.grid.place(place)));
            nodes.extend(around.filter(|&(_, place)| self.contains(place)));
        }
        let further = |&(node, place): &(usize, Point)| {
            lattice.fields().of(node).iter().map(move |&field| (field as usize, place))
        };
        let mut fields: Vec<(usize, Point)> = nodes.iter().flat_map(further).collect();
        fields.append(&mut nodes);
        fields.sort_unstable_by_key(|f| f.0);
        fields.dedup_by_key(|f| f.0);
        fields
    }
}
