//! Fragments shown apart.
//!
//! Each goes away from the middle of its body. What would go into another one on that way, a core in a ring, a splinter
//! in the mouth of a C, goes along with it instead. What that is, is told by fragments where they lie at rest: it is
//! the same in all frames until one breaks, so that none jumps while others move.

use crate::boolean::{Edge, Shape, common, twice_area};
use crate::snap::{Grid, GridPoint};
use fissure_scene::{ParticleFrame, Point, Vector};
use std::collections::BTreeMap;

/// Body and number of a fragment.
type Key = (u32, u32);

/// Places on the way at which fragments are looked at.
const STEPS: u32 = 8;
/// What two of them may have in common there beyond what they have where they are, as a part of the smaller one: teeth
/// of faces that part along each other.
const MOST: f64 = 0.02;

/// The way of each fragment, by body and number, from the middle of the particles of its body to that of its own [m]:
/// that times a factor is how far it is moved to be shown apart. `places`: of the particles, now or at rest [m].
pub(crate) fn ways(particles: &ParticleFrame, places: &[Point]) -> BTreeMap<Key, Vector> {
    let (mut bodies, mut pieces) = (BTreeMap::new(), BTreeMap::new());
    let mut add = |p: usize| {
        let body: &mut Sum = bodies.entry(particles.body[p]).or_default();
        body.add(places[p]);
        let piece: &mut Sum = pieces.entry((particles.body[p], particles.piece[p])).or_default();
        piece.add(places[p]);
    };
    (0..particles.len()).for_each(&mut add);
    pieces.into_iter().map(|(key, piece)| (key, piece.mean() - bodies[&key.0].mean())).collect()
}

/// A fragment on its way.
struct Moving {
    key: Key,
    shapes: Vec<Shape>,
    area: f64,
    low: GridPoint,
    high: GridPoint,
    /// The first of those that go along with each other.
    group: usize,
}

/// Which fragments go along with each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Member {
    /// The same for those that do.
    group: usize,
    /// What its way counts.
    area: f64,
}

/// Which fragments go along with each other: those that would go into each other on the way to so many times their
/// `ways` at most. `shapes`: what they enclose, on the grids of their bodies.
pub(crate) fn groups(
    ways: &BTreeMap<Key, Vector>,
    shapes: BTreeMap<Key, Vec<Shape>>,
    grids: &[Grid],
    largest: f64,
) -> BTreeMap<Key, Member> {
    let moving = shapes.into_iter().filter(|(key, _)| ways.contains_key(key)).enumerate();
    // Of several bodies the coarsest grid: steps are powers of two.
    let step = grids.iter().map(|grid| grid.step).fold(0.0, f64::max);
    let made = |(group, (key, shapes)): (usize, (Key, Vec<Shape>))| {
        let shapes = on_grid(shapes, grids[key.0 as usize].step / step);
        Moving::new(key, shapes, group)
    };
    let mut all: Vec<Moving> = moving.filter_map(made).collect();
    let members = |all: &[Moving]| -> BTreeMap<Key, Member> {
        all.iter().map(|of| (of.key, Member { group: of.group, area: of.area })).collect()
    };
    // In each round two groups at least become one.
    for _ in 0..all.len() {
        let ways = together(ways.clone(), &members(&all));
        let mut pairs = Vec::new();
        for (i, p) in all.iter().enumerate() {
            for (j, q) in all.iter().enumerate().skip(i + 1) {
                let apart = largest * (ways[&q.key] - ways[&p.key]) / step;
                if p.group != q.group && p.meets(q, apart) {
                    pairs.push((i, j));
                }
            }
        }
        if pairs.is_empty() {
            break;
        }
        for (i, j) in pairs {
            let (first, other) = (all[i].group.min(all[j].group), all[i].group.max(all[j].group));
            all.iter_mut().filter(|of| of.group == other).for_each(|of| of.group = first);
        }
    }
    members(&all)
}

/// The `ways` with those of fragments that go along with each other made alike: the mean of theirs by their area.
pub(crate) fn together(mut ways: BTreeMap<Key, Vector>, members: &BTreeMap<Key, Member>) -> BTreeMap<Key, Vector> {
    let mut sums = BTreeMap::<usize, (Vector, f64, usize)>::new();
    for (key, member) in members {
        let (sum, area, count) = sums.entry(member.group).or_insert((Vector::zeros(), 0.0, 0));
        *sum += member.area * ways.get(key).copied().unwrap_or_default();
        *area += member.area;
        *count += 1;
    }
    for (key, member) in members {
        let (sum, area, count) = sums[&member.group];
        if count > 1 {
            ways.insert(*key, sum / area);
        }
    }
    ways
}

/// Polygons with grid steps so many times as large.
fn on_grid(mut shapes: Vec<Shape>, scale: f64) -> Vec<Shape> {
    if scale != 1.0 {
        let scaled =
            |p: GridPoint| GridPoint::new((scale * p.x as f64).round() as i64, (scale * p.y as f64).round() as i64);
        let edges = shapes.iter_mut().flatten().flatten();
        edges.for_each(|edge| *edge = Edge { a: scaled(edge.a), b: scaled(edge.b), ..*edge });
    }
    shapes
}

impl Moving {
    fn new(key: Key, shapes: Vec<Shape>, group: usize) -> Option<Self> {
        let corners = || shapes.iter().flatten().flatten().map(|edge| edge.a);
        let first = corners().next()?;
        let low = corners().fold(first, |low, p| GridPoint::new(low.x.min(p.x), low.y.min(p.y)));
        let high = corners().fold(first, |high, p| GridPoint::new(high.x.max(p.x), high.y.max(p.y)));
        let area = area(&shapes);
        (area > 0.0).then_some(Self { key, shapes, area, low, high, group })
    }

    /// Whether this one and another one that moves `apart` from it, in grid steps, lie in each other on the way, by
    /// more than now.
    fn meets(&self, other: &Self, apart: Vector) -> bool {
        let shared = |part: f64| {
            let (x, y) = ((part * apart.x).round() as i64, (part * apart.y).round() as i64);
            let is_beside = other.low.x + x > self.high.x
                || other.high.x + x < self.low.x
                || other.low.y + y > self.high.y
                || other.high.y + y < self.low.y;
            if is_beside {
                return 0.0;
            }
            let moved = |p: GridPoint| GridPoint::new(p.x + x, p.y + y);
            let edges = other.shapes.iter().flatten().flatten();
            let moved = edges.map(|edge| Edge { a: moved(edge.a), b: moved(edge.b), ..*edge });
            area(&common(self.shapes.iter().flatten().flatten().copied(), moved))
        };
        let most = MOST * self.area.min(other.area);
        let mut before = None;
        (1..=STEPS).any(|step| {
            let found = shared(f64::from(step) / f64::from(STEPS));
            found > most && found - *before.get_or_insert_with(|| shared(0.0)) > most
        })
    }
}

/// In squared grid steps.
fn area(shapes: &[Shape]) -> f64 {
    0.5 * shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
}

/// The middle of some particles in the making.
#[derive(Default)]
struct Sum {
    total: Vector,
    count: usize,
}

impl Sum {
    fn add(&mut self, point: Point) {
        self.total += point.coords;
        self.count += 1;
    }

    /// [m]
    fn mean(&self) -> Vector {
        self.total / self.count.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::SourceIndex;

    /// Truth: by hand. Two halves of one body part, each from where it is now; another body stays.
    #[test]
    fn fragments_move_away_from_the_middle_of_their_body() {
        let position = [(0.0, 0.0), (0.0, 2.0), (4.0, 1.0), (9.0, 9.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let (body, piece) = (vec![0, 0, 0, 1], vec![0, 0, 1, 0]);
        let particles = ParticleFrame { id: vec![0, 1, 2, 3], body, piece, position, ..ParticleFrame::default() };
        let ways = ways(&particles, &particles.position);
        let middle = Point::new(4.0 / 3.0, 1.0);
        assert!((ways[&(0, 0)] - (Point::new(0.0, 1.0) - middle)).norm() < 1e-12);
        assert!((ways[&(0, 1)] - (Point::new(4.0, 1.0) - middle)).norm() < 1e-12);
        assert_eq!(ways[&(1, 0)], Vector::zeros());
    }

    fn shape(contours: &[&[(i64, i64)]]) -> Vec<Shape> {
        let contour = |corners: &&[(i64, i64)]| {
            let place = |&(x, y): &(i64, i64)| GridPoint::new(1000 * x, 1000 * y);
            let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
            pairs.map(|(a, b)| Edge { a: place(a), b: place(b), source: SourceIndex(0) }).collect()
        };
        vec![contours.iter().map(contour).collect()]
    }

    /// Truth: by hand. A C with a piece in its mouth and another one above it, at any turn of a quarter and mirrored: a
    /// piece that would go through the C goes along with it, one that leaves by the mouth and the one above go alone. A
    /// core never leaves its ring. None has anything in common with another one afterwards.
    #[test]
    fn what_would_go_into_another_one_goes_along() {
        let c = [(0, 0), (9, 0), (9, 3), (3, 3), (3, 6), (9, 6), (9, 9), (0, 9)];
        let (in_mouth, above) = ([(4, 4), (7, 4), (7, 5), (4, 5)], [(0, 10), (9, 10), (9, 12), (0, 12)]);
        let ring: [&[(i64, i64)]; 2] = [&[(0, 0), (9, 0), (9, 9), (0, 9)], &[(3, 3), (3, 6), (6, 6), (6, 3)]];
        let core = [(4, 4), (5, 4), (5, 5), (4, 5)];
        let parts = |turn: usize, mirrored: bool| {
            move |(x, y): (i64, i64)| {
                let (mut x, mut y) = if mirrored { (-x, y) } else { (x, y) };
                (0..turn).for_each(|_| (x, y) = (-y, x));
                (x, y)
            }
        };
        let grid = Grid { step: 1e-3 };
        for (turn, mirrored) in (0..4).flat_map(|turn| [(turn, false), (turn, true)]) {
            let to = parts(turn, mirrored);
            let made = |contours: &[&[(i64, i64)]]| {
                let contours: Vec<Vec<(i64, i64)>> = contours
                    .iter()
                    .map(|contour| {
                        let mut corners: Vec<(i64, i64)> = contour.iter().copied().map(to).collect();
                        if mirrored {
                            corners.reverse();
                        }
                        corners
                    })
                    .collect();
                shape(&contours.iter().map(Vec::as_slice).collect::<Vec<_>>())
            };
            let way = |x: i64, y: i64| {
                let (x, y) = to((x, y));
                Vector::new(x as f64, y as f64)
            };
            let cases = [(way(4, 0), true), (way(-4, 0), false), (way(0, 3), false)];
            // Of one body, or of two with a finer grid for the other one.
            for ((out, is_alone), fine) in cases.into_iter().flat_map(|case| [(case, 1.0), (case, 4.0)]) {
                let other = if fine == 1.0 { (0, 1) } else { (1, 1) };
                let ways = BTreeMap::from([((0, 0), way(-1, 0)), (other, out), ((0, 2), way(-1, 5))]);
                let shapes =
                    BTreeMap::from([((0, 0), made(&[&c])), (other, made(&[&in_mouth])), ((0, 2), made(&[&above]))]);
                let mut on_grids = shapes.clone();
                if other.0 == 1 {
                    on_grids.entry(other).and_modify(|shapes| *shapes = on_grid(shapes.clone(), fine));
                }
                let members = groups(&ways, on_grids, &[grid, Grid { step: grid.step / fine }], 2.0);
                let found = together(ways.clone(), &members);
                assert_eq!(found[&(0, 2)], ways[&(0, 2)]);
                assert_eq!(found == ways, is_alone, "{out} {turn} {mirrored}");
                assert_eq!(found[&(0, 0)] == found[&other], !is_alone);
                for factor in 0..=8 {
                    let moved = |key: Key| {
                        let way = (250.0 * f64::from(factor) * found[&key]).map(f64::round);
                        let point = |p: GridPoint| GridPoint::new(p.x + way.x as i64, p.y + way.y as i64);
                        let edge = move |edge: &Edge| Edge { a: point(edge.a), b: point(edge.b), ..*edge };
                        shapes[&key].iter().flatten().flatten().map(edge).collect::<Vec<_>>().into_iter()
                    };
                    for [p, q] in [[(0, 0), other], [(0, 0), (0, 2)], [other, (0, 2)]] {
                        assert_eq!(area(&common(moved(p), moved(q))), 0.0, "{p:?} {q:?} {factor}");
                    }
                }
            }
            let shapes = BTreeMap::from([((0, 0), made(&ring)), ((0, 1), made(&[&core]))]);
            let ways = BTreeMap::from([((0, 0), Vector::zeros()), ((0, 1), way(5, 1))]);
            let members = groups(&ways, shapes, &[grid], 3.0);
            let found = together(ways, &members);
            assert_eq!(found[&(0, 0)], found[&(0, 1)]);
        }
    }
}
