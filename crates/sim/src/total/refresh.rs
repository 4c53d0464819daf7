//! What is made from the state: loads, supports, surfaces and contacts as they act on fields. Made once, and anew only near what has grown.

use super::Total;
use crate::SimulationError;
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use fissure_scene::{End, Point};

/// Where something has changed.
#[derive(Debug)]
pub(super) struct Near {
    boxes: Vec<(Point, Point)>,
    /// By how much the segments of each crack have moved up, because points were added at its start.
    shifts: Vec<u32>,
}

impl Near {
    /// `points_before`: number of points of each crack before it changed.
    pub(super) fn new(boxes: Vec<(Point, Point)>, cracks: &Cracks, changed: &[TipId], points_before: &[usize]) -> Self {
        let shift = |(index, crack): (usize, &Crack)| match points_before.get(index) {
            Some(&before) if changed.contains(&TipId::new(index, End::Start)) => (crack.points.len() - before) as u32,
            _ => 0,
        };
        Self { boxes, shifts: cracks.iter().enumerate().map(shift).collect() }
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
        before + self.shifts[crack as usize]
    }

    /// The boxes, widened by `margin` [m].
    pub(super) fn widened(&self, margin: f64) -> impl Iterator<Item = (Point, Point)> {
        let by = fissure_scene::Vector::repeat(margin);
        self.boxes.iter().map(move |(low, high)| (low - by, high + by))
    }
}

impl Total {
    /// Everything that is made from the state, made anew.
    ///
    /// # Errors
    /// When a load or support selects nothing.
    pub(super) fn refresh(&mut self, cracks: &Cracks) -> Result<(), SimulationError> {
        self.refresh_masses();
        self.loads = self.point_forces()?;
        self.constraints = self.constraints_of_supports()?;
        self.surface = self.surface_nodes();
        self.contacts = self.contact_pairs(cracks);
        Ok(())
    }

    /// The same where something has changed; the result is that of [`Total::refresh`], order included.
    pub(super) fn refresh_near(&mut self, near: &Near, cracks: &Cracks) {
        self.refresh_masses();
        self.refresh_loads(near);
        self.constraints = self.constraints_near(near);
        self.surface = self.surface_near(near);
        self.contacts = self.contacts_near(near, cracks);
        self.lay_ties_near(near, cracks);
    }

    fn refresh_masses(&mut self) {
        self.resize_fields();
        self.inverse_mass.clear();
        self.inverse_mass.extend(self.state.mass.iter().map(|&m| if m > 0.0 { 1.0 / m } else { 0.0 }));
    }
}
