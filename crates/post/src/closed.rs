//! Cracks within a fragment, shown closed where they are hardly open: programs that merge vertices by distance would
//! join their faces corner by corner.

use crate::widening::{Shift, normal};
use fissure_scene::CrackFrame;

/// Faces that have slid along each other by more than so many times the narrowest width keep what they have slid.
const SLID: f64 = 4.0;

/// For each point of `crack` how far its faces have to move to meet, where they overlap or are nearer to each other
/// than `narrowest` [m]. `parted`: the points that part two fragments, where nothing moves.
pub(crate) fn shifts(crack: &CrackFrame, parted: &[bool], narrowest: f64) -> Vec<Shift> {
    let shift = |i: usize| {
        if parted[i] {
            return Shift::default();
        }
        let apart = crack.above[i] - crack.below[i];
        let across = normal(&crack.above, i) + normal(&crack.below, i);
        let across = across.try_normalize(0.0).unwrap_or_default();
        let width = apart.dot(&across);
        if width >= narrowest {
            return Shift::default();
        }
        let way = if apart.norm() <= SLID * narrowest { apart } else { width * across };
        Shift { above: -0.5 * way, below: 0.5 * way }
    };
    (0..crack.rest.len()).map(shift).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::widening::widened;
    use fissure_scene::{Point, Vector};

    /// Truth: by hand. A wedge that opens to 1 over 10 segments of length 1, the last of which parts two fragments.
    #[test]
    fn faces_meet_where_they_are_near() {
        let rest: Vec<Point> = (0..=10).map(|i| Point::new(f64::from(i), 0.0)).collect();
        let face = |side: f64| rest.iter().map(|p| p + Vector::new(0.0, 0.05 * side * p.x)).collect();
        let crack = CrackFrame { above: face(1.0), below: face(-1.0), rest: rest.clone(), ..CrackFrame::default() };
        let parted: Vec<bool> = (0..=10).map(|point| point == 10).collect();
        let width = |narrowest: f64| {
            let shown = widened(&crack, &shifts(&crack, &parted, narrowest));
            shown.above.iter().zip(&shown.below).map(|(a, b)| (a - b).norm()).collect::<Vec<f64>>()
        };
        let closed = |narrowest: f64| width(narrowest).iter().filter(|width| **width < 1e-12).count();
        assert_eq!([closed(0.0), closed(0.35), closed(9.0)], [1, 4, 10]);
        assert!((width(0.35)[4] - 0.4).abs() < 1e-12);
    }
}
