//! How the walls of cracks came about: when, by what load, and how far from where their crack began.

use crate::opening::arc_lengths;
use crate::options::PostOptions;
use fissure_plane::nearest_on_segment;
use fissure_scene::{Attribute, CrackEnd, CrackFrame, Formed, Frame, Point};

/// How a place on the wall of a crack came about. All 0 on what is no wall of a crack, and where nobody asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct History {
    /// Time since the tip was here [s of simulated time].
    pub age: f64,
    /// Way along cracks, at rest, to the mouth that the crack began at [m]. A branch goes on from where it leaves its
    /// trunk; a crack that began at no mouth has none on what was drawn of it.
    pub mouth_distance: f64,
    /// K_I at the tip when it was here [Pa·√m]; 0 where it was drawn, and where nothing was measured.
    pub mode_1: f64,
}

impl History {
    /// The number that an attribute is, rounded as files hold it.
    pub(crate) fn number(&self, attribute: Attribute) -> f32 {
        match attribute {
            Attribute::CrackAge => self.age as f32,
            Attribute::MouthDistance => self.mouth_distance as f32,
            Attribute::Mode1 => self.mode_1 as f32,
        }
    }

    /// A part of the way, 0 to 1, from this one to another.
    pub(crate) fn between(self, other: Self, part: f64) -> Self {
        let at = |from: f64, to: f64| from + part * (to - from);
        Self {
            age: at(self.age, other.age),
            mouth_distance: at(self.mouth_distance, other.mouth_distance),
            mode_1: at(self.mode_1, other.mode_1),
        }
    }
}

/// The attributes that are asked for, each once; none where the cracks of the frame do not say how they formed.
pub(crate) fn attributes(frame: &Frame, options: &PostOptions) -> Vec<Attribute> {
    let is_known = frame.cracks.iter().all(|crack| crack.formed.is_some());
    Attribute::ALL.into_iter().filter(|attribute| is_known && options.attributes.contains(attribute)).collect()
}

/// That of each point of each crack of a frame; none where a crack does not say how it formed.
pub(crate) fn histories(frame: &Frame) -> Option<Vec<Vec<History>>> {
    let formed: Vec<&[Formed]> = frame.cracks.iter().map(|crack| crack.formed.as_deref()).collect::<Option<_>>()?;
    let distances = mouth_distances(&frame.cracks, &formed);
    let of_crack = |(formed, distances): (&[Formed], Vec<f64>)| {
        let history = |(formed, mouth_distance): (&Formed, f64)| History {
            age: (frame.time - formed.time).max(0.0),
            mouth_distance,
            mode_1: formed.mode_1,
        };
        formed.iter().zip(distances).map(history).collect()
    };
    Some(formed.into_iter().zip(distances).map(of_crack).collect())
}

/// Way from each point of each crack to the mouth that it began at [m].
///
/// A crack begins at its oldest points. Ends that came later, where it met an outline or another crack, are no places
/// to count from: so the distance of a place stays what it is as cracks grow.
fn mouth_distances(cracks: &[CrackFrame], formed: &[&[Formed]]) -> Vec<Vec<f64>> {
    let mut known: Vec<Option<Vec<f64>>> = vec![None; cracks.len()];
    // A branch waits for its trunk. What waits for itself begins at its own joints.
    let mut waits = true;
    while known.contains(&None) {
        let before = known.clone();
        for (i, crack) in cracks.iter().enumerate().filter(|(i, _)| before[*i].is_none()) {
            let of_trunk = |trunk: u32, place: Point| {
                let trunk = cracks.iter().position(|other| other.crack == trunk && other.crack != crack.crack);
                match trunk.map(|trunk| (trunk, &before[trunk])) {
                    Some((trunk, Some(distances))) => Some(at(&cracks[trunk].rest, distances, place)),
                    Some((_, None)) if waits => None,
                    _ => Some(0.0),
                }
            };
            known[i] = from_beginnings(crack, formed[i], of_trunk);
        }
        waits = known != before;
    }
    known.into_iter().flatten().collect()
}

/// Way from each point of a crack to the nearest place that it began at, and what that is from a mouth; `of_trunk` says
/// the latter for a place on another crack. None where `of_trunk` has none.
fn from_beginnings(
    crack: &CrackFrame,
    formed: &[Formed],
    of_trunk: impl Fn(u32, Point) -> Option<f64>,
) -> Option<Vec<f64>> {
    let arcs = arc_lengths(&crack.rest, None);
    let oldest = formed.iter().map(|formed| formed.time).fold(f64::INFINITY, f64::min);
    let last = formed.len().saturating_sub(1);
    let mut beginnings = Vec::with_capacity(2);
    for (k, end) in [(0, crack.start), (last, crack.end)] {
        match end {
            _ if formed.get(k).is_none_or(|formed| formed.time > oldest) => {}
            CrackEnd::Tip => {}
            CrackEnd::Mouth => beginnings.push((arcs[k], 0.0)),
            CrackEnd::Junction { crack: trunk } => beginnings.push((arcs[k], of_trunk(trunk, crack.rest[k])?)),
        }
    }
    if beginnings.is_empty() {
        let is_oldest = |k: &usize| formed[*k].time == oldest;
        beginnings.extend((0..formed.len()).filter(is_oldest).map(|k| (arcs[k], 0.0)));
    }
    let nearest = |arc: f64| {
        beginnings.iter().map(|(begin, distance)| (arc - begin).abs() + distance).fold(f64::INFINITY, f64::min)
    };
    Some(arcs.iter().map(|&arc| nearest(arc)).collect())
}

/// What the points of a line have, at the place on it that is nearest to `place`.
fn at(line: &[Point], values: &[f64], place: Point) -> f64 {
    let on_segment = |k: usize| {
        let (a, b) = (line[k], line[k + 1]);
        let nearest = nearest_on_segment(a, b, place);
        let (way, length) = ((nearest - a).norm(), (b - a).norm());
        let part = if length > 0.0 { way / length } else { 0.0 };
        ((nearest - place).norm(), values[k] + part * (values[k + 1] - values[k]))
    };
    let segments = (0..line.len().saturating_sub(1)).map(on_segment);
    segments.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, value)| value)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A crack along `points`, each with the time that it formed at; K_I is a million times that.
    fn crack(number: u32, points: &[(f64, f64, f64)], ends: [CrackEnd; 2]) -> CrackFrame {
        let formed = points.iter().map(|p| Formed { time: p.2, mode_1: 1e6 * p.2 }).collect();
        let rest: Vec<Point> = points.iter().map(|p| Point::new(p.0, p.1)).collect();
        let [start, end] = ends;
        CrackFrame { crack: number, rest, formed: Some(formed), start, end, ..CrackFrame::default() }
    }

    fn distances(cracks: Vec<CrackFrame>) -> Vec<Vec<f64>> {
        let frame = Frame { time: 9.0, cracks, ..Frame::default() };
        histories(&frame).unwrap().into_iter().map(|c| c.iter().map(|h| h.mouth_distance).collect()).collect()
    }

    const TIP: CrackEnd = CrackEnd::Tip;
    const MOUTH: CrackEnd = CrackEnd::Mouth;

    /// Truth: the drawing. A trunk from a mouth, with a branch in the middle of its second segment and one on that,
    /// listed the wrong way round; the trunk has come out of the body at its other end.
    #[test]
    fn branches_go_on_from_their_trunk_and_later_mouths_do_not_count() {
        let on = |crack| CrackEnd::Junction { crack };
        let twig = crack(2, &[(2.0, 2.0, 3.0), (3.0, 2.0, 4.0)], [on(1), TIP]);
        let branch = crack(1, &[(2.0, 0.0, 2.0), (2.0, 2.0, 3.0), (2.0, 3.0, 4.0)], [on(0), TIP]);
        let trunk = crack(0, &[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, 0.0, 5.0)], [MOUTH, MOUTH]);
        let found = distances(vec![twig, branch, trunk]);
        assert_eq!(found, [vec![4.0, 5.0], vec![2.0, 4.0, 5.0], vec![0.0, 1.0, 3.0]]);
    }

    /// Truth: by hand. What was drawn within the body has no distance; from there on it is counted to both sides. Drawn
    /// from mouth to mouth, the nearer one counts. Two drawn cracks that begin on each other begin there.
    #[test]
    fn cracks_without_one_mouth() {
        let inner = crack(0, &[(-2.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (4.0, 0.0, 2.0)], [MOUTH, TIP]);
        let through = crack(1, &[(0.0, 5.0, 0.0), (1.0, 5.0, 0.0), (4.0, 5.0, 0.0)], [MOUTH, MOUTH]);
        let on = |crack| CrackEnd::Junction { crack };
        let one = crack(2, &[(0.0, 7.0, 0.0), (1.0, 7.0, 0.0)], [on(3), TIP]);
        let other = crack(3, &[(0.0, 7.0, 0.0), (0.0, 9.0, 0.0)], [on(2), TIP]);
        let found = distances(vec![inner, through, one, other]);
        let expected = [vec![1.0, 0.0, 0.0, 3.0], vec![0.0, 1.0, 0.0], vec![0.0, 1.0], vec![0.0, 2.0]];
        assert_eq!(found, expected);
    }

    /// Truth: the definition.
    #[test]
    fn age_is_the_time_since_the_tip_was_there() {
        let cracks = vec![crack(0, &[(0.0, 0.0, 0.0), (1.0, 0.0, 2.0), (2.0, 0.0, 9.5)], [MOUTH, TIP])];
        let mut frame = Frame { time: 9.0, cracks, ..Frame::default() };
        let found = histories(&frame).unwrap();
        let ages: Vec<[f64; 2]> = found[0].iter().map(|h| [h.age, h.mode_1]).collect();
        assert_eq!(ages, [[9.0, 0.0], [7.0, 2e6], [0.0, 9.5e6]]);
        frame.cracks[0].formed = None;
        assert_eq!(histories(&frame), None);
    }
}
