//! How far the corners of fragments that keep their triangles go where these lie in each other a little.
//!
//! ```text
//!        a     ·──·──────·──·     corners of b within a
//!      ──p──────── ─ ─ ───────q── the middle
//!              ·────·───·    b    corners of a within b
//! ```
//! No corner may be added where two boundaries cross, as [`crate::overlaps`] does. Corners of both go to the middle,
//! and where one side has none the other one goes all the way; what is left since edges are chords of the middle is an
//! overlap of a small part of the size, and goes in the next round.

use crate::boolean::{Contour, Edge, Shape, twice_area};
use crate::lattice::{Chain, Claim, Enclosed, Lattice, Lens, Material, Overlaps, Tangle, rounded};
use crate::snap::GridPoint;
use rustc_hash::{FxHashMap, FxHashSet};

/// Part of a fragment within another one from which on it goes as a whole.
const MOST_OF_CRUMB: f64 = 0.5;

/// Where corners go, each known by the edge that starts there.
pub(crate) type Ways = FxHashMap<u32, GridPoint>;

/// What fragments that lie in each other do.
pub(crate) struct Apart {
    /// Of each.
    pub(crate) ways: Vec<Ways>,
    /// Whether it lies in another one.
    pub(crate) meets: Vec<bool>,
}

/// What of a fragment stays.
#[derive(Debug, Clone)]
pub(crate) enum Held {
    /// The corners at which these edges start.
    Corners(FxHashSet<u32>),
    /// All of it.
    All,
}

impl Default for Held {
    fn default() -> Self {
        Self::Corners(FxHashSet::default())
    }
}

impl Held {
    /// Lets a corner stay from now on.
    pub(crate) fn hold(&mut self, corner: u32) {
        if let Self::Corners(corners) = self {
            corners.insert(corner);
        }
    }

    fn contains(&self, corner: u32) -> bool {
        match self {
            Self::Corners(corners) => corners.contains(&corner),
            Self::All => true,
        }
    }
}

/// Where corners of `fragments` go, in steps of their own grids, so that these lie beside each other. Overlaps wider
/// than `widest` [m] in the mean are no inaccuracy of contact: corners leave what the other one alone has particles in,
/// all others stay, and so does what is `held`.
pub(crate) fn ways_apart(fragments: &[Enclosed], held: &[Held], widest: f64, material: &impl Material) -> Apart {
    let lattice = Lattice::new(fragments);
    let mut found = Found {
        lattice: &lattice,
        fragments,
        held,
        apart: Apart { ways: vec![Ways::default(); fragments.len()], meets: vec![false; fragments.len()] },
    };
    let Overlaps { lenses, tangles, claims } = lattice.overlaps(fragments, widest, material);
    claims.iter().for_each(|claim| found.claimed(claim));
    tangles.iter().for_each(|tangle| found.tangled(tangle));
    lenses.iter().for_each(|lens| found.lens(lens));
    found.apart
}

/// What has been found so far.
struct Found<'a> {
    lattice: &'a Lattice,
    fragments: &'a [Enclosed],
    held: &'a [Held],
    apart: Apart,
}

impl Found<'_> {
    /// The corner at the start of an edge on the lattice, if there is one.
    fn corner(&self, fragment: usize, edge: &Edge) -> Option<u32> {
        let scale = self.lattice.scales[fragment];
        let local = edge.source.0 - self.lattice.firsts[fragment];
        let start = self.fragments[fragment].sources[local as usize].a;
        let is_there = GridPoint::new(start.x * scale, start.y * scale) == edge.a;
        (is_there && !self.held[fragment].contains(local)).then_some(local)
    }

    /// Sends a corner `at` a place on the lattice to another one, or half the way.
    fn send(&mut self, (fragment, corner): (usize, u32), at: GridPoint, to: GridPoint, half: bool) {
        let scale = self.lattice.scales[fragment];
        let part = |from: i64, to: i64| if half { rounded(from + to, 2 * scale) } else { rounded(to, scale) };
        self.apart.ways[fragment].insert(corner, GridPoint::new(part(at.x, to.x), part(at.y, to.y)));
    }

    /// Sends the corners around an overlap with two sides to its middle, by parts of the length of both.
    fn lens(&mut self, lens: &Lens) {
        lens.fragments().iter().for_each(|&fragment| self.apart.meets[fragment] = true);
        let chains =
            lens.sides.each_ref().map(|(_, edges)| Chain::new(edges.iter().map(|edge| (edge.a, edge.b)).collect()));
        let corners = lens.sides.each_ref().map(|(fragment, edges)| {
            let inner = edges.iter().enumerate().skip(1);
            inner.filter_map(|(k, edge)| Some((k, self.corner(*fragment, edge)?))).collect::<Vec<_>>()
        });
        for (side, other) in [(0, 1), (1, 0)] {
            let (fragment, edges) = &lens.sides[side];
            for &(k, corner) in &corners[side] {
                let (_, there) = chains[other].at(1.0 - chains[side].parts[k - 1]);
                self.send((*fragment, corner), edges[k].a, there, !corners[other].is_empty());
            }
        }
    }

    /// Sends all of a crumb, most of which lies within another fragment, out of that by the shortest way. Whether there
    /// is one in a `region` of a `pair`.
    fn crumb(&mut self, pair: [usize; 2], region: &Shape) -> bool {
        let areas = pair.map(|k| {
            let twice: i128 = self.fragments[k].shapes.iter().flatten().map(|contour| twice_area(contour)).sum();
            twice as f64 * (self.lattice.scales[k] as f64).powi(2)
        });
        let [crumb, other] = if areas[0] < areas[1] { pair } else { [pair[1], pair[0]] };
        let common = region.iter().map(|contour| twice_area(contour)).sum::<i128>() as f64;
        if common < MOST_OF_CRUMB * areas[0].min(areas[1]) || !matches!(&self.held[crumb], Held::Corners(_)) {
            return false;
        }
        let corners: Vec<Edge> = self.lattice.edges(crumb, self.fragments).collect();
        let walls: Vec<Edge> = self.lattice.edges(other, self.fragments).collect();
        let count = corners.len() as i64;
        let sum = corners.iter().fold((0, 0), |(x, y), edge| (x + edge.a.x, y + edge.a.y));
        let middle = GridPoint::new(sum.0 / count, sum.1 / count);
        let near = walls.iter().map(|wall| (nearest(middle, wall), wall)).min_by(|p, q| p.0.0.total_cmp(&q.0.0));
        let Some(((_, place), _)) = near else { return false };
        let scale = self.lattice.scales[crumb];
        let way = [place.x - middle.x, place.y - middle.y].map(|way| rounded(way, scale));
        let sources = self.fragments[crumb].sources.iter().zip(0..);
        self.apart.ways[crumb] =
            sources.map(|(source, k)| (k, GridPoint::new(source.a.x + way[0], source.a.y + way[1]))).collect();
        true
    }

    /// Sends the corners around an overlap of another form towards the nearest place on the other boundary around it.
    fn tangled(&mut self, &Tangle { pair, ref region }: &Tangle) {
        pair.iter().for_each(|&fragment| self.apart.meets[fragment] = true);
        if self.crumb(pair, region) {
            return;
        }
        self.leave(pair, region);
    }

    /// Sends the corners of one of two fragments out of what the other one alone has particles in.
    fn claimed(&mut self, &Claim { owner, other, ref region }: &Claim) {
        [owner, other].iter().for_each(|&fragment| self.apart.meets[fragment] = true);
        self.leave([other, other], region);
    }

    /// Sends the corners of some fragments around a region to the nearest place on the other boundary around it.
    fn leave(&mut self, leaving: [usize; 2], region: &Shape) {
        let edges: Vec<(usize, Edge)> = region.iter().flatten().map(|edge| (self.lattice.owner(edge), *edge)).collect();
        let previous =
            |contour: &Contour, k: usize| self.lattice.owner(&contour[(k + contour.len() - 1) % contour.len()]);
        let mut corners = Vec::new();
        for contour in region {
            for (k, edge) in contour.iter().enumerate() {
                let owner = self.lattice.owner(edge);
                if previous(contour, k) == owner
                    && leaving.contains(&owner)
                    && let Some(corner) = self.corner(owner, edge)
                {
                    corners.push((owner, corner, edge.a));
                }
            }
        }
        let both = leaving[0] != leaving[1]
            && leaving.iter().all(|fragment| corners.iter().any(|(owner, ..)| owner == fragment));
        for (owner, corner, at) in corners {
            let others = edges.iter().filter(|(other, _)| *other != owner);
            let nearest = others.map(|(_, edge)| nearest(at, edge)).min_by(|p, q| p.0.total_cmp(&q.0));
            if let Some((_, there)) = nearest {
                self.send((owner, corner), at, there, both);
            }
        }
    }
}

/// The place on an edge nearest to another one, and how far it is.
fn nearest(from: GridPoint, edge: &Edge) -> (f64, GridPoint) {
    let way = [(edge.b.x - edge.a.x) as f64, (edge.b.y - edge.a.y) as f64];
    let here = [(from.x - edge.a.x) as f64, (from.y - edge.a.y) as f64];
    let squared = way[0] * way[0] + way[1] * way[1];
    let part = if squared > 0.0 { ((way[0] * here[0] + way[1] * here[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let place = GridPoint::new(edge.a.x + (part * way[0]).round() as i64, edge.a.y + (part * way[1]).round() as i64);
    (((from.x - place.x) as f64).hypot((from.y - place.y) as f64), place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boolean::material;
    use crate::slot::Slot;
    use crate::snap::Grid;
    use crate::source::{Carried, SourceEdge};
    use fissure_scene::{Point, Vector};

    fn enclosed(piece: u32, ring: &[GridPoint]) -> Enclosed {
        let carried = [Carried::within(Point::origin(), Vector::zeros()); 2];
        let edges = ring.iter().zip(ring.iter().cycle().skip(1));
        let sources: Vec<SourceEdge> = edges.map(|(&a, &b)| SourceEdge { a, b, carried, slot: Slot::Inside }).collect();
        let grid = Grid::covering(&[Point::new(1.0, 1.0)], 0.0);
        Enclosed { body: 0, piece, grid, shapes: material(&sources), sources, least: 0.0, has_lost: false }
    }

    /// A square from `low` to `high` with so many edges on each side.
    fn square(piece: u32, low: (i64, i64), high: (i64, i64), edges: i64) -> Enclosed {
        let corners = [(low.0, low.1), (high.0, low.1), (high.0, high.1), (low.0, high.1)];
        let sides = corners.iter().zip(corners.iter().cycle().skip(1));
        let places = sides.flat_map(|(&a, &b)| {
            let between = move |a: i64, b: i64, k: i64| a + (b - a) * k / edges;
            (0..edges).map(move |k| GridPoint::new(between(a.0, b.0, k), between(a.1, b.1, k)))
        });
        enclosed(piece, &places.collect::<Vec<_>>())
    }

    /// Particles of the second fragment alone, wherever one asks.
    struct OfSecond;

    impl Material for OfSecond {
        fn at(&self, _: &Enclosed, _: Point) -> Option<(Point, Vector)> {
            None
        }

        fn is_in(&self, fragment: &Enclosed, _: &[Vec<Point>]) -> bool {
            fragment.piece == 1
        }
    }

    /// What two fragments have in common once their corners have gone so many times, of the second one, and both.
    fn left(rounds: usize, mut fragments: [Enclosed; 2], held: &[Held; 2], widest: f64) -> (f64, [Enclosed; 2]) {
        for _ in 0..rounds {
            let apart = ways_apart(&fragments, held, widest, &OfSecond);
            for (fragment, ways) in fragments.iter_mut().zip(&apart.ways) {
                let corner = |(k, source): (u32, &SourceEdge)| ways.get(&k).copied().unwrap_or(source.a);
                let ring: Vec<GridPoint> = (0..).zip(&fragment.sources).map(corner).collect();
                *fragment = enclosed(fragment.piece, &ring);
            }
        }
        let common = Lattice::new(&fragments).common([0, 1], &fragments);
        (area(&common) / area(&fragments[1].shapes), fragments)
    }

    fn area(shapes: &[Shape]) -> f64 {
        shapes.iter().flatten().map(|contour| twice_area(contour)).sum::<i128>() as f64
    }

    /// Truth: by hand. Two squares that lie in each other by a corner or a side end beside each other; where one of
    /// them is held it keeps its form; nothing is widened.
    #[test]
    fn corners_go_to_the_middle() {
        let held = [Held::default(), Held::default()];
        let first = || square(0, (0, 0), (9000, 9000), 30);
        for (low, high) in [((8600, 8700), (12_000, 12_500)), ((8700, 500), (12_000, 8000))] {
            let second = || square(1, low, high, 11);
            let before = [first(), second()].map(|of| area(&of.shapes));
            for held in [held.clone(), [Held::All, Held::default()], [Held::default(), Held::All]] {
                let (part, fragments) = left(4, [first(), second()], &held, f64::INFINITY);
                assert!(part < 1e-3, "{part} of what is held as {held:?}");
                for k in 0..2 {
                    let now = area(&fragments[k].shapes);
                    assert!(now <= before[k], "{now} of {}", before[k]);
                    assert!(!matches!(held[k], Held::All) || now == before[k]);
                }
            }
        }
    }

    /// Truth: by hand. A crumb within a square, near to one of its sides, comes out there and keeps its area but for
    /// what it shares out with the square.
    #[test]
    fn a_crumb_comes_out_of_what_it_lies_in() {
        let crumb = square(1, (4000, 8400), (4400, 8800), 3);
        let before = area(&crumb.shapes);
        let held = [Held::default(), Held::default()];
        let (part, fragments) = left(8, [square(0, (0, 0), (9000, 9000), 90), crumb], &held, f64::INFINITY);
        assert!(part < 0.02, "{part}");
        assert!(area(&fragments[1].shapes) > 0.6 * before);
        assert!(fragments[1].sources.iter().all(|source| source.a.y > 8800 - 400));
    }

    /// Truth: by hand. A fang of one square lies in another one by more than contact is inexact, and only that has
    /// particles there: the fang leaves it, and it keeps its form.
    #[test]
    fn corners_leave_what_another_one_alone_has_particles_in() {
        let fang = [(5000, 4000), (6500, 4150), (8000, 4300), (9000, 4400), (8000, 4500), (6500, 4650), (5000, 4800)];
        let ring = [&[(0, 0), (5000, 0)][..], &fang, &[(5000, 9000), (0, 9000)]].concat();
        let ring: Vec<GridPoint> = ring.iter().map(|&(x, y)| GridPoint::new(x, y)).collect();
        let squares = [enclosed(0, &ring), square(1, (6000, 500), (12_000, 8000), 11)];
        let before = [0, 1].map(|k| area(&squares[k].shapes));
        let widest = 10.0 * squares[0].grid.step;
        let (part, fragments) = left(4, squares, &[Held::default(), Held::default()], widest);
        assert!(part < 1e-4, "{part}");
        assert_eq!(area(&fragments[1].shapes), before[1]);
        assert!(area(&fragments[0].shapes) > 0.95 * before[0]);
    }
}
