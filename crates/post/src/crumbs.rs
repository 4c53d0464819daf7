//! Fragments of a few particles: their faces may ride along with what lay beside them, and be drawn out from one
//! neighbour to another as these fly apart. So no point of one is shown farther than half a cell from where its own
//! particles carry it.

use crate::snap::{Grid, GridPoint};
use crate::source::SourceEdge;
use fissure_scene::{Frame, Point, Vector};
use std::collections::BTreeMap;

/// Fragments that are smaller at rest are crumbs, in areas of a particle.
const CRUMB: f64 = 16.0;
/// So far a point may be from where the particles of its fragment carry it, in distances of particles: half a cell.
const FARTHEST: f64 = 1.0;
/// Particles as near as that to the bounds of a crumb at rest may carry it, in distances of particles.
const BESIDE: f64 = 4.0;

/// Holds the boundaries of fragment `piece` of `body` with its particles, if it is a crumb. `spacing` is the distance
/// of particles [m].
pub(crate) fn hold_crumb(
    boundaries: &mut [Vec<SourceEdge>],
    frame: &Frame,
    (body, piece): (u32, u32),
    spacing: f64,
    grid: Grid,
) {
    let edges = || boundaries.iter().flatten();
    let twice: f64 = edges().map(|e| e.carried[0].rest.coords.perp(&e.carried[1].rest.coords)).sum();
    if 0.5 * twice.abs() >= CRUMB * spacing * spacing {
        return;
    }
    let carriers = carriers(edges(), frame, (body, piece), spacing);
    let particles = &frame.particles;
    let mut held = BTreeMap::<GridPoint, (GridPoint, Option<Vector>)>::new();
    let mut hold = |place: GridPoint, rest: Point| {
        *held.entry(place).or_insert_with(|| {
            let squared = |p: usize| (particles.rest[p] - rest).norm_squared();
            let nearest = carriers.iter().copied().min_by(|&p, &q| squared(p).total_cmp(&squared(q)));
            let Some(p) = nearest else { return (place, None) };
            let carried = particles.position[p] + particles.deformation_gradient[p] * (rest - particles.rest[p]);
            let off = grid.place(place) - carried;
            let farthest = FARTHEST * spacing;
            // What flies beyond the grid, alone, stays where its faces are.
            if off.norm() <= farthest || carried.coords.amax() + farthest > grid.reach() {
                return (place, None);
            }
            (grid.snap(carried + off * (farthest / off.norm())), Some(particles.velocity[p]))
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

/// The particles of a fragment in or beside its part with these edges; all of them if there are none.
fn carriers<'a>(
    edges: impl Iterator<Item = &'a SourceEdge>,
    frame: &Frame,
    (body, piece): (u32, u32),
    spacing: f64,
) -> Vec<usize> {
    let particles = &frame.particles;
    let bounds = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
    let (low, high) = edges.fold(bounds, |(low, high), edge| {
        let rest = edge.carried[0].rest;
        (low.inf(&rest), high.sup(&rest))
    });
    let room = Vector::repeat(BESIDE * spacing);
    let (low, high) = (low - room, high + room);
    let of_piece: Vec<usize> =
        (0..particles.len()).filter(|&p| particles.piece[p] == piece && particles.body[p] == body).collect();
    let is_beside = |&p: &usize| {
        let rest = particles.rest[p];
        (low.x..=high.x).contains(&rest.x) && (low.y..=high.y).contains(&rest.y)
    };
    let beside: Vec<usize> = of_piece.iter().copied().filter(is_beside).collect();
    if beside.is_empty() { of_piece } else { beside }
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

    /// Truth: by hand. The corner of a crumb that was drawn out comes back to a distance of particles from where its
    /// particle, which has not moved, carries it, and has the velocity of that; all else stays, and so do corners that
    /// are nearer, those of larger fragments, and those of crumbs that have no particle.
    #[test]
    fn crumbs_stay_with_their_particles() {
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
        for (side, drawn, piece, moves) in
            [(0.2, 5.0, 7, true), (0.2, 0.05, 7, false), (0.2, 5.0, 8, false), (1.0, 5.0, 7, false)]
        {
            let before = boundary(side, drawn, grid);
            let mut held = vec![before.clone()];
            hold_crumb(&mut held, &frame, (0, piece), SPACING, grid);
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
