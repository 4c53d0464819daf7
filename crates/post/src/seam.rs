//! Where a crack ends on a boundary: that boundary must be parted there, or a skin would span the end of the crack.
//!
//! A ring has two tracers at a mouth, and a crack two points at a junction, equal to the end points of the faces that
//! come in there. Where they are missing (a crack that has just arrived, a take of another program) they are put in
//! here.

use crate::snap::Grid;
use crate::source::{Carried, SourceEdge};
use fissure_plane::{Point, orientation};
use fissure_scene::{CrackEnd, CrackFrame};

/// The end of a crack on another boundary.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Guest {
    /// What it ends on.
    pub(crate) end: CrackEnd,
    /// The face end where the host's boundary arrives, and the one where it goes on: material on its left both times.
    arrive: End,
    leave: End,
    /// The crack point next to the end, at rest: on which side of the host the crack lies.
    inner: Point,
    /// Host vertices closer than this at rest are the end itself [m].
    reach: f64,
}

/// The end point of one face.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    place: crate::snap::GridPoint,
    rest: Point,
    velocity: fissure_scene::Vector,
}

/// The ends of `crack` that lie on other boundaries.
pub(crate) fn guests(crack: &CrackFrame, grid: Grid) -> Vec<Guest> {
    let count = crack.rest.len();
    if count < 2 {
        return Vec::new();
    }
    let above =
        |i: usize| End { place: grid.snap(crack.above[i]), rest: crack.rest[i], velocity: crack.above_velocity[i] };
    let below =
        |i: usize| End { place: grid.snap(crack.below[i]), rest: crack.rest[i], velocity: crack.below_velocity[i] };
    let guest = |end, arrive, leave, inner| Guest { end, arrive, leave, inner, reach: 2.0 * grid.step };
    // Walking a boundary with the material on the left, the left side of a crack that starts here is behind us.
    let start = guest(crack.start, above(0), below(0), crack.rest[1]);
    let end = guest(crack.end, below(count - 1), above(count - 1), crack.rest[count - 2]);
    [start, end].into_iter().filter(|guest| guest.end != CrackEnd::Tip).collect()
}

/// Parts the nearest of the closed boundaries `hosts` at the end of `guest`, unless it is parted already or the end is
/// closed.
pub(crate) fn join(hosts: &mut [Vec<SourceEdge>], guest: &Guest) {
    let (arrive, leave) = (guest.arrive.place, guest.leave.place);
    let is_parted = |edge: &SourceEdge| edge.a == arrive && edge.b == leave;
    if arrive == leave || hosts.iter().flatten().any(is_parted) {
        return;
    }
    // The crack lies in the material to the left of the edge; edges without length at rest are other seams.
    let faces = |edge: &SourceEdge| orientation(edge.carried[0].rest, edge.carried[1].rest, guest.inner) > 0.0;
    let edges = hosts.iter().enumerate().flat_map(|(h, host)| (0..host.len()).map(move |i| (h, i, &host[i])));
    let nearest = edges.filter(|(_, _, edge)| faces(edge)).map(|(h, i, edge)| (h, i, foot(edge, guest.arrive.rest)));
    let Some((h, i, foot)) = nearest.min_by(|x, y| x.2.distance.total_cmp(&y.2.distance)) else { return };
    part(&mut hosts[h], i, foot, guest);
}

/// Where a place at rest lies beside an edge.
#[derive(Debug, Clone, Copy)]
struct Foot {
    /// Distance to the edge at rest [m].
    distance: f64,
    /// Distance at rest from the start of the edge to the foot [m], and from there to its end.
    along: [f64; 2],
}

fn foot(edge: &SourceEdge, place: Point) -> Foot {
    let [a, b] = edge.carried.map(|c| c.rest);
    let length = (b - a).norm();
    let along = ((place - a).dot(&(b - a)) / length).clamp(0.0, length);
    Foot { distance: (a + (b - a) * (along / length) - place).norm(), along: [along, length - along] }
}

/// Leads the boundary `host` through both ends of `guest`, at edge `i` or at one of its vertices.
fn part(host: &mut Vec<SourceEdge>, i: usize, foot: Foot, guest: &Guest) {
    let (count, edge) = (host.len(), host[i]);
    // The edges before and behind the seam: two that meet in a vertex there, or the two halves of one.
    let (before, behind) = if foot.along[1] <= guest.reach {
        (i, (i + 1) % count)
    } else if foot.along[0] <= guest.reach {
        ((i + count - 1) % count, i)
    } else {
        let [start, end] = edge.carried.map(|c| c.arc);
        let arc = start + (end - start) * foot.along[0] / (foot.along[0] + foot.along[1]);
        host.insert(i + 1, edge);
        host[i].carried[1].arc = arc;
        host[i + 1].carried[0].arc = arc;
        (i, i + 1)
    };
    let at = |end: End, old: Carried| Carried { rest: end.rest, velocity: end.velocity, arc: old.arc };
    let carried = [at(guest.arrive, host[before].carried[1]), at(guest.leave, host[behind].carried[0])];
    let seam = SourceEdge { a: guest.arrive.place, b: guest.leave.place, carried, slot: edge.slot };
    (host[before].b, host[before].carried[1]) = (seam.a, carried[0]);
    (host[behind].a, host[behind].carried[0]) = (seam.b, carried[1]);
    host.insert(before + 1, seam);
}
