//! A crack as a frame holds it.

use crate::crack::Crack;
use crate::crack::cracks::ENDS;
use fissure_scene::{CrackEnd, CrackFrame, End, Point, Vector};

/// The frame of a crack from the places and velocities of its faces, above and below; they meet at a tip.
pub(crate) fn crack_frame(
    index: usize,
    crack: &Crack,
    faces: [Vec<Point>; 2],
    velocities: [Vec<Vector>; 2],
) -> CrackFrame {
    let [mut above, mut below] = faces;
    let [mut above_velocity, mut below_velocity] = velocities;
    for end in ENDS {
        if crack.end(end) == CrackEnd::Tip {
            let k = if end == End::Start { 0 } else { above.len() - 1 };
            let middle = nalgebra::center(&above[k], &below[k]);
            let velocity = (above_velocity[k] + below_velocity[k]) * 0.5;
            (above[k], below[k]) = (middle, middle);
            (above_velocity[k], below_velocity[k]) = (velocity, velocity);
        }
    }
    CrackFrame {
        crack: index as u32,
        body: crack.body,
        rest: crack.points.clone(),
        above,
        below,
        above_velocity,
        below_velocity,
        formed: Some(crack.formed()),
        start: crack.end(End::Start),
        end: crack.end(End::End),
    }
}
