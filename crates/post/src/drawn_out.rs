//! Points of a boundary that have been drawn out of their fragment: faces of crumbs, corners and needles without a
//! particle of their own may ride along with what lay beside them, and be drawn out to fangs as the two part. So no
//! point is shown farther than half a cell from where every particle of its own fragment around it carries it.

use crate::snap::{Grid, GridPoint};
use crate::source::SourceEdge;
use fissure_scene::{Frame, Point, Vector};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// So far a point may be from where particles carry it, in distances of particles: half a cell. With a whole one areas
/// of soft letters and rings (1 to 5 MPa) are off by a quarter more.
const FARTHEST: f64 = 1.0;
/// Boundaries are looked at that have an edge so many times as long as at rest: without one nothing is drawn out.
const STRETCH: f64 = 1.25;
/// Such edges are at least so long, in distances of particles.
const LONG: f64 = 0.25;
/// Fragments that are smaller at rest are looked at always, for they may be carried off as a whole, in areas of a
/// particle.
const CRUMB: f64 = 16.0;
/// Particles as near as that at rest carry a point, in distances of particles; where there are none the nearest does.
const AROUND: f64 = 2.0;

/// Holds the boundaries of fragment `piece` of `body` with its particles where they have been drawn out. `spacing` is
/// the distance of particles [m].
pub(crate) fn hold_drawn_out(
    boundaries: &mut [Vec<SourceEdge>],
    frame: &Frame,
    (body, piece): (u32, u32),
    spacing: f64,
    grid: Grid,
) {
    let edges = || boundaries.iter().flatten();
    let is_stretched = |edge: &SourceEdge| {
        let now = (grid.place(edge.b) - grid.place(edge.a)).norm();
        now > LONG * spacing && now > STRETCH * (edge.carried[1].rest - edge.carried[0].rest).norm()
    };
    let twice: f64 = edges().map(|e| e.carried[0].rest.coords.perp(&e.carried[1].rest.coords)).sum();
    if 0.5 * twice.abs() >= CRUMB * spacing * spacing && !edges().any(is_stretched) {
        return;
    }
    let own = Own::new(frame, (body, piece), spacing);
    let farthest = FARTHEST * spacing;
    let mut held = BTreeMap::<GridPoint, (GridPoint, Option<Vector>)>::new();
    let mut hold = |place: GridPoint, rest: Point| {
        *held.entry(place).or_insert_with(|| {
            let Some((carried, velocity)) = own.carried(grid.place(place), rest) else { return (place, None) };
            let off = grid.place(place) - carried;
            // What flies beyond the grid, alone, stays where its faces are.
            if off.norm() <= farthest || carried.coords.amax() + farthest > grid.reach() {
                return (place, None);
            }
            (grid.snap(carried + off * (farthest / off.norm())), Some(velocity))
        })
    };
    for edge in boundaries.iter_mut().flatten() {
        let ends = [(edge.a, 0), (edge.b, 1)].map(|(place, k)| hold(place, edge.carried[k].rest));
        [edge.a, edge.b] = ends.map(|(place, _)| place);
        for (carried, (_, velocity)) in edge.carried.iter_mut().zip(ends) {
            carried.velocity = velocity.unwrap_or(carried.velocity);
        }
    }
}

/// The particles of a fragment, to be found by where they are at rest.
struct Own<'a> {
    frame: &'a Frame,
    /// Width of a bin [m].
    width: f64,
    bins: FxHashMap<[i64; 2], Vec<usize>>,
    all: Vec<usize>,
}

impl<'a> Own<'a> {
    fn new(frame: &'a Frame, (body, piece): (u32, u32), spacing: f64) -> Self {
        let particles = &frame.particles;
        let is_own = |&p: &usize| particles.piece[p] == piece && particles.body[p] == body;
        let all = (0..particles.len()).filter(is_own).collect();
        let mut own = Self { frame, width: AROUND * spacing, bins: FxHashMap::default(), all };
        let mut bins = FxHashMap::<[i64; 2], Vec<usize>>::default();
        own.all.iter().for_each(|&p| bins.entry(own.bin(particles.rest[p])).or_default().push(p));
        own.bins = bins;
        own
    }

    fn bin(&self, rest: Point) -> [i64; 2] {
        [rest.x, rest.y].map(|x| (x / self.width).floor() as i64)
    }

    /// Where the particles around a point at `rest` [m] carry it, that nearest to `place` [m], with the velocity [m/s].
    fn carried(&self, place: Point, rest: Point) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let [column, row] = self.bin(rest);
        let squared = |&p: &usize| (particles.rest[p] - rest).norm_squared();
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [column + i, row + j]));
        let near = around.filter_map(|bin| self.bins.get(&bin)).flatten().copied();
        let carried = |p: usize| {
            let way = particles.deformation_gradient[p] * (rest - particles.rest[p]);
            (particles.position[p] + way, particles.velocity[p])
        };
        let off = |(carried, _): &(Point, Vector)| (carried - place).norm_squared();
        near.filter(|p| squared(p) <= self.width * self.width)
            .map(carried)
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .or_else(|| self.all.iter().min_by(|p, q| squared(p).total_cmp(&squared(q))).map(|&p| carried(p)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slot::Slot;
    use crate::source::Carried;
    use fissure_scene::ParticleFrame;

    const SPACING: f64 = 0.1;

    /// A square at the origin of `side`, on a grid of 2⁻²⁰ m, whose upper right corner has been drawn out by `drawn`.
    fn boundary(side: f64, drawn: f64, grid: Grid) -> Vec<SourceEdge> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)].map(|(x, y)| Point::new(x, y));
        let out = |p: Point| if p == corners[2] { p + Vector::repeat(drawn) } else { p };
        let carried = |rest| Carried::within(rest, Vector::new(9.0, 9.0));
        let edge = |(p, q): (&Point, &Point)| SourceEdge {
            a: grid.snap(out(*p)),
            b: grid.snap(out(*q)),
            carried: [carried(*p), carried(*q)],
            slot: Slot::Inside,
        };
        corners.iter().zip(corners.iter().cycle().skip(1)).map(edge).collect()
    }

    /// Truth: by hand. The corner of a fragment that was drawn out comes back to a distance of particles from where its
    /// particle, which has not moved, carries it, and has the velocity of that; all else stays, and so do corners that
    /// are nearer, and those of fragments that have no particle.
    #[test]
    fn corners_stay_with_their_particles() {
        let grid = Grid::covering(&[Point::new(15.0, 15.0)], 0.0);
        let particles = ParticleFrame {
            rest: vec![Point::new(0.05, 0.05)],
            position: vec![Point::new(0.05, 0.05)],
            velocity: vec![Vector::new(1.0, 2.0)],
            deformation_gradient: vec![fissure_scene::Matrix::identity()],
            id: vec![0],
            piece: vec![7],
            body: vec![0],
            ..ParticleFrame::default()
        };
        let frame = Frame { particles, ..Frame::default() };
        for (side, drawn, piece, moves) in [
            (0.2, 5.0, 7, true),
            (0.2, 0.05, 7, false),
            (0.2, 5.0, 8, false),
            (1.0, 5.0, 7, true),
            (1.0, 5.0, 8, false),
        ] {
            let before = boundary(side, drawn, grid);
            let mut held = vec![before.clone()];
            hold_drawn_out(&mut held, &frame, (0, piece), SPACING, grid);
            let held = held.remove(0);
            assert!(held.iter().zip(held.iter().cycle().skip(1)).all(|(one, two)| one.b == two.a));
            if !moves {
                assert_eq!(held, before);
                continue;
            }
            assert_eq!((held[0].a, held[0].b, held[2].b), (before[0].a, before[0].b, before[2].b));
            let off = grid.place(held[1].b) - Point::new(side, side);
            let expected = Vector::repeat(SPACING / 2.0_f64.sqrt());
            assert!((off - expected).norm() < 2.0 * grid.step, "{off}");
            assert_eq!(held[1].carried[1].velocity, Vector::new(1.0, 2.0));
            assert_eq!(held[1].carried[0].velocity, Vector::new(9.0, 9.0));
        }
    }
}
