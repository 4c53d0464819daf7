//! The line-crossing test: does the straight line from a particle to a node cross a crack segment, and from which side?
//!
//! Nairn 2003 (CRAMP), as in the thesis, section 3.1.1. Signs come from an exact predicate. For a segment a → b, a
//! particle p and a node n the four signs are those of the triangles (p, n, a), (p, n, b), (a, b, p), (a, b, n).
//!
//! | signs | meaning |
//! |---|---|
//! | − + + −, − + + 0, 0 + + 0, − 0 + 0 | crosses, particle above |
//! | + − − +, + − − 0, 0 − − 0, + 0 − 0 | crosses, particle below |
//! | − 0 + −, 0 − − + | crosses too: the line passes through an end of the segment |
//! | 0 in the third place | the particle lies on the crack and counts as above |
//!
//! The third line is not in the thesis' list, where a line through a vertex that two segments share crosses neither of
//! them. 0 + + − and + 0 − + stay out, so that it crosses just one, and a touched corner both or none.
//!
//! A node exactly on the crack is crossed to from either side: its own field stays empty there.

use fissure_plane::{Point, orientation};
use serde::{Deserialize, Serialize};

/// A side of a crack, for one who walks from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(crate) enum Side {
    /// On the left.
    Above,
    /// On the right.
    Below,
}

impl Side {
    /// The other side.
    pub(crate) fn opposite(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }

    /// +1 above, −1 below.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

/// How a line crosses a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Crossing {
    /// The side the particle is on.
    pub(crate) side: Side,
    /// Whether the node lies on the crack itself: two segments that share the node then report one and the same
    /// crossing.
    pub(crate) at_node: bool,
}

fn sign(value: f64) -> i8 {
    (value > 0.0) as i8 - (value < 0.0) as i8
}

/// The crossing of the line from `particle` to `node` with the segment `a` → `b`, if any.
pub(crate) fn crossing(particle: Point, node: Point, a: Point, b: Point) -> Option<Crossing> {
    let particle_side = sign(orientation(a, b, particle));
    let node_side = sign(orientation(a, b, node));
    // The particle on the crack counts as above; both on the crack's line: no crossing.
    let side = match (particle_side, node_side) {
        (1, ..=0) | (0, -1) => Side::Above,
        (-1, 0..) => Side::Below,
        _ => return None,
    };
    let at_a = sign(orientation(particle, node, a));
    let at_b = sign(orientation(particle, node, b));
    let at_node = node_side == 0;
    // A vertex on the line counts as left of it; with the node on the crack both ends count.
    let crosses = match (side, at_a, at_b) {
        (Side::Above, -1, 0..) | (Side::Below, 0.., -1) => true,
        (Side::Above, 0, 1) | (Side::Below, 1, 0) => at_node,
        _ => false,
    };
    crosses.then_some(Crossing { side, at_node })
}

/// The net crossing of a line with the segments of one crack: an even number of crossings cancels.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NetCrossing {
    balance: i32,
    at_node: Option<Side>,
}

impl NetCrossing {
    /// Counts one more crossing.
    pub(crate) fn add(&mut self, crossing: Crossing) {
        if crossing.at_node {
            self.at_node.get_or_insert(crossing.side);
        } else {
            self.balance += crossing.side.sign() as i32;
        }
    }

    /// The side of the crack the particle is on as seen from the node; none: the same side.
    pub(crate) fn side(&self) -> Option<Side> {
        let total = self.balance + self.at_node.map_or(0, |s| s.sign() as i32);
        match total {
            0 => None,
            1.. => Some(Side::Above),
            _ => Some(Side::Below),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    /// Signs of the four areas for a segment a → b on the x axis.
    fn signs(p: Point, n: Point, a: Point, b: Point) -> [i8; 4] {
        [sign(orientation(p, n, a)), sign(orientation(p, n, b)), sign(orientation(a, b, p)), sign(orientation(a, b, n))]
    }

    #[test]
    fn every_row_of_the_sign_table() {
        let (a, b) = (point(0.0, 0.0), point(1.0, 0.0));
        let above = |at_node| Some(Crossing { side: Side::Above, at_node });
        let below = |at_node| Some(Crossing { side: Side::Below, at_node });
        let cases = [
            (point(0.5, 1.0), point(0.5, -1.0), [-1, 1, 1, -1], above(false)),
            (point(0.5, 1.0), point(0.5, 0.0), [-1, 1, 1, 0], above(true)),
            (point(0.5, 1.0), point(0.0, 0.0), [0, 1, 1, 0], above(true)),
            (point(0.5, 1.0), point(1.0, 0.0), [-1, 0, 1, 0], above(true)),
            (point(0.5, -1.0), point(0.5, 1.0), [1, -1, -1, 1], below(false)),
            (point(0.5, -1.0), point(0.5, 0.0), [1, -1, -1, 0], below(true)),
            (point(0.5, -1.0), point(0.0, 0.0), [0, -1, -1, 0], below(true)),
            (point(0.5, -1.0), point(1.0, 0.0), [1, 0, -1, 0], below(true)),
            // Through one end: from above through b, from below through a.
            (point(1.0, 1.0), point(1.0, -1.0), [-1, 0, 1, -1], above(false)),
            (point(0.0, -1.0), point(0.0, 1.0), [0, -1, -1, 1], below(false)),
            (point(0.0, 1.0), point(0.0, -1.0), [0, 1, 1, -1], None),
            (point(1.0, -1.0), point(1.0, 1.0), [1, 0, -1, 1], None),
            // The particle on the crack counts as above.
            (point(0.5, 0.0), point(0.5, -1.0), [-1, 1, 0, -1], above(false)),
            (point(0.5, 0.0), point(0.5, 1.0), [1, -1, 0, 1], None),
            // Misses: beside the segment, before it, along it.
            (point(1.5, 1.0), point(1.5, -1.0), [-1, -1, 1, -1], None),
            (point(0.5, 2.0), point(0.5, 1.0), [-1, 1, 1, 1], None),
            (point(-1.0, 0.0), point(2.0, 0.0), [0, 0, 0, 0], None),
        ];
        for (particle, node, expected_signs, expected) in cases {
            assert_eq!(signs(particle, node, a, b), expected_signs, "signs at {particle} {node}");
            assert_eq!(crossing(particle, node, a, b), expected, "crossing at {particle} {node}");
        }
    }

    fn net(particle: Point, node: Point, line: &[Point]) -> Option<Side> {
        let mut net = NetCrossing::default();
        for w in line.windows(2) {
            if let Some(c) = crossing(particle, node, w[0], w[1]) {
                net.add(c);
            }
        }
        net.side()
    }

    #[test]
    fn a_line_through_a_shared_vertex_crosses_once_and_a_touched_corner_never() {
        let bend = [point(-1.0, 0.0), point(0.0, 0.0), point(1.0, 0.5)];
        assert_eq!(net(point(0.0, 1.0), point(0.0, -1.0), &bend), Some(Side::Above));
        assert_eq!(net(point(0.0, -1.0), point(0.0, 1.0), &bend), Some(Side::Below));
        // The node is the shared vertex itself.
        assert_eq!(net(point(0.0, 1.0), point(0.0, 0.0), &bend), Some(Side::Above));
        assert_eq!(net(point(0.0, -1.0), point(0.0, 0.0), &bend), Some(Side::Below));
        let corner = [point(-1.0, -1.0), point(0.0, 0.0), point(1.0, -1.0)];
        assert_eq!(net(point(-1.0, 0.0), point(1.0, 0.0), &corner), None);
        // In at one leg, out at the other.
        assert_eq!(net(point(-1.0, -0.5), point(1.0, -0.5), &corner), None);
    }

    #[test]
    fn a_hair_beside_the_crack_is_still_decided() {
        let (a, b) = (point(0.1, 0.1), point(0.7, 0.7));
        let hair = 0.4_f64;
        let next = f64::from_bits(hair.to_bits() + 1);
        assert_eq!(crossing(point(hair, next), point(0.6, 0.1), a, b).map(|c| c.side), Some(Side::Above));
        assert_eq!(crossing(point(next, hair), point(0.6, 0.1), a, b), None);
    }

    use fissure_plane::Region;
    use proptest::prelude::*;

    /// A ring around the origin, counter-clockwise, whose corners lie at distances of 0.3 to 1.
    fn any_ring() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec(0.3_f64..1.0, 3..12).prop_map(|radii| {
            let turn = std::f64::consts::TAU / radii.len() as f64;
            let corner = |(k, r): (usize, &f64)| point(r * (turn * k as f64).cos(), r * (turn * k as f64).sin());
            radii.iter().enumerate().map(corner).collect()
        })
    }

    fn any_point() -> impl Strategy<Value = Point> {
        (-1.2_f64..1.2, -1.2_f64..1.2).prop_map(|(x, y)| point(x, y))
    }

    proptest! {
        /// Truth: the even-odd rule, which counts along another line. A crack that closes parts inside and outside, and
        /// inside is on its left; coarse places, so that many lines run through vertices.
        #[test]
        fn a_closed_crack_parts_inside_and_outside(
            ring in any_ring(), particle in any_point(), node in any_point(), coarse in any::<bool>(),
        ) {
            let place = |p: Point| if coarse { point((4.0 * p.x).round() / 4.0, (4.0 * p.y).round() / 4.0) } else { p };
            let ring: Vec<Point> = ring.into_iter().map(place).collect();
            let (particle, node) = (place(particle), place(node));
            let closed: Vec<Point> = ring.iter().copied().chain([ring[0]]).collect();
            // A place on the crack itself belongs to neither; rings that coarse places fold are no rings.
            let on = |p: Point| closed.windows(2).any(|w| {
                let along = w[1] - w[0];
                orientation(w[0], w[1], p) == 0.0 && (p - w[0]).dot(&along) * (p - w[1]).dot(&along) <= 0.0
            });
            prop_assume!(!on(particle) && !on(node) && fissure_plane::find_crossing(&[&ring], true).is_none());
            let region = Region { exterior: ring, holes: Vec::new() };
            let inside = [particle, node].map(|p| region.contains(p));
            let expected = match inside {
                [true, false] => Some(Side::Above),
                [false, true] => Some(Side::Below),
                _ => None,
            };
            prop_assert_eq!(net(particle, node, &closed), expected);
        }
    }
}
