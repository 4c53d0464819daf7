//! What all pictures of a sequence have in common.

use crate::coloring::Coloring;
use fissure_plane::{Point, Vector};
use fissure_scene::Frame;

/// Share of the particles, at each side of a frame, that may leave the picture.
const STRAYS: f64 = 0.005;
/// What is shown beyond the others, in diagonals of the box around these.
const BEYOND: f64 = 0.1;
/// Share of the particles whose value may lie beyond the scale of colours: those at tips are far above all others.
const PEAKS: f64 = 0.005;

/// What is in view in a sequence, and the scale of its colours; gathered from all frames before the first is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    coloring: Coloring,
    /// Two corners of the box that is in view [m]; none before there is a frame.
    corners: Option<[Point; 2]>,
    /// Largest value of the scale.
    most: f64,
}

impl Survey {
    /// Of no frame yet.
    pub fn new(coloring: Coloring) -> Self {
        Self { coloring, corners: None, most: 0.0 }
    }

    /// Takes up a frame. Single fragments that fly far off do not count.
    pub fn add(&mut self, frame: &Frame) {
        let outline = frame.outlines.iter().flat_map(|ring| &ring.position);
        let places: Vec<Point> = outline.chain(&frame.particles.position).copied().filter(is_finite).collect();
        if places.is_empty() {
            return;
        }
        let (low, high) = fissure_plane::bounds(&places);
        let of = |axis: usize, share: f64| quantile(places.iter().map(|place| place[axis]).collect(), share);
        let most = Point::new(of(0, 1.0 - STRAYS), of(1, 1.0 - STRAYS));
        let least = Point::new(of(0, STRAYS), of(1, STRAYS));
        let reach = Vector::repeat(BEYOND * (most - least).norm());
        let (low, high) = (low.sup(&(least - reach)), high.inf(&(most + reach)));
        let [known_low, known_high] = self.corners.unwrap_or([low, high]);
        self.corners = Some([known_low.inf(&low), known_high.sup(&high)]);
        if let Some(values) = self.coloring.values(&frame.particles).filter(|values| !values.is_empty()) {
            self.most = self.most.max(quantile(values.into_iter().map(f64::abs).collect(), 1.0 - PEAKS));
        }
    }

    /// Makes room for fragments that are moved away from the middle of their body by up to `factor` times their way
    /// from it.
    pub fn spread(&mut self, factor: f64) {
        if let Some([low, high]) = &mut self.corners {
            let way = (*high - *low) * (0.5 * factor);
            (*low, *high) = (*low - way, *high + way);
        }
    }

    /// Two corners of the box that is in view [m]; a square of 1 m where there is nothing.
    pub(crate) fn corners(&self) -> [Point; 2] {
        let [low, high] = self.corners.unwrap_or([Point::new(-0.5, -0.5), Point::new(0.5, 0.5)]);
        // A single particle has no size.
        let least = Vector::repeat(1e-6 * (1.0 + low.coords.amax().max(high.coords.amax())));
        if high == low { [low - least, high + least] } else { [low, high] }
    }

    /// The ends of the scale of colours.
    pub(crate) fn scale(&self) -> [f64; 2] {
        self.coloring.scale(if self.most > 0.0 { self.most } else { 1.0 })
    }
}

fn is_finite(place: &Point) -> bool {
    place.x.is_finite() && place.y.is_finite()
}

/// The value below which a share of `values` lies; `values` is not empty.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    let last = values.len() - 1;
    let at = ((last as f64 * share).round() as usize).min(last);
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_scene::ParticleFrame;

    fn frame(places: impl Iterator<Item = (f64, f64)>) -> Frame {
        let position: Vec<Point> = places.map(|(x, y)| Point::new(x, y)).collect();
        let velocity = position.iter().map(|p| p.coords).collect();
        Frame { particles: ParticleFrame { position, velocity, ..ParticleFrame::default() }, ..Frame::default() }
    }

    fn square() -> impl Iterator<Item = (f64, f64)> {
        (0..1000).map(|i| (f64::from(i % 40) / 39.0, f64::from(i / 40) / 24.0))
    }

    #[test]
    fn a_stray_fragment_does_not_shrink_the_others() {
        let mut survey = Survey::new(Coloring::Speed);
        survey.add(&frame(square()));
        assert_eq!(survey.corners(), [Point::new(0.0, 0.0), Point::new(1.0, 1.0)]);
        survey.add(&frame(square().chain([(500.0, -300.0), (500.0, -300.5)])));
        let [low, high] = survey.corners();
        assert!(high.x < 1.2 && low.y > -0.2, "{low} {high}");
        // Nor does it take the colours of all others.
        assert!(survey.scale()[1] < 1.5);
    }

    #[test]
    fn nothing_and_a_single_point_can_be_seen_too() {
        let mut survey = Survey::new(Coloring::Fragment);
        assert!((survey.corners()[1] - survey.corners()[0]).amin() > 0.0);
        survey.add(&frame([(3.0, 4.0)].into_iter()));
        assert!((survey.corners()[1] - survey.corners()[0]).amin() > 0.0);
    }
}
