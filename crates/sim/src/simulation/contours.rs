//! What the last step has measured over several radii, for whoever wants it; nothing is measured for nobody.

use super::Simulation;
use crate::tip::contours::ContourReading;

/// The readings of the last step; none: nobody wants any.
#[derive(Debug, Default)]
pub(super) struct ContourWatch(Option<Vec<ContourReading>>);

impl ContourWatch {
    /// A step begins.
    pub(super) fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }

    /// Whether anybody wants any.
    pub(super) fn is_wanted(&self) -> bool {
        self.0.is_some()
    }

    /// Keeps what was measured at a tip.
    pub(super) fn keep(&mut self, found: Vec<ContourReading>) {
        if let Some(readings) = &mut self.0 {
            readings.extend(found);
        }
    }
}

impl Simulation {
    /// From now on every look at a tip measures J and K over 2, 3, 4, 5 and 6 cells. Changes nothing of the run; a look
    /// takes some three times as long.
    pub fn watch_contours(&mut self) {
        self.contours = ContourWatch(Some(Vec::new()));
    }

    /// What was measured over several radii in the last step, tip by tip, radii rising; nothing before
    /// [`Simulation::watch_contours`]. It belongs to the beginning of the step.
    pub fn contours(&self) -> &[ContourReading] {
        self.contours.0.as_deref().unwrap_or_default()
    }
}
