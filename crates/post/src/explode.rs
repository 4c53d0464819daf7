//! Fragments shown apart.

use fissure_scene::{Frame, Point, Vector};
use std::collections::BTreeMap;

/// How far each fragment, by body and number, is moved to be shown apart: `factor` times the way from the middle of the
/// particles of its body to that of its own [m].
pub(crate) fn offsets(frame: &Frame, factor: f64) -> BTreeMap<(u32, u32), Vector> {
    let particles = &frame.particles;
    let (mut bodies, mut pieces) = (BTreeMap::new(), BTreeMap::new());
    let mut add = |p: usize| {
        let body: &mut Sum = bodies.entry(particles.body[p]).or_default();
        body.add(particles.position[p]);
        let piece: &mut Sum = pieces.entry((particles.body[p], particles.piece[p])).or_default();
        piece.add(particles.position[p]);
    };
    (0..particles.len()).for_each(&mut add);
    pieces.into_iter().map(|(key, piece)| (key, factor * (piece.mean() - bodies[&key.0].mean()))).collect()
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
    use fissure_scene::ParticleFrame;

    /// Truth: by hand. Two halves of one body part, each from where it is now; another body stays.
    #[test]
    fn fragments_move_away_from_the_middle_of_their_body() {
        let position = [(0.0, 0.0), (0.0, 2.0), (4.0, 1.0), (9.0, 9.0)].map(|(x, y)| Point::new(x, y)).to_vec();
        let (body, piece) = (vec![0, 0, 0, 1], vec![0, 0, 1, 0]);
        let particles = ParticleFrame { id: vec![0, 1, 2, 3], body, piece, position, ..ParticleFrame::default() };
        let offsets = offsets(&Frame { particles, ..Frame::default() }, 1.5);
        let middle = Point::new(4.0 / 3.0, 1.0);
        assert!((offsets[&(0, 0)] - 1.5 * (Point::new(0.0, 1.0) - middle)).norm() < 1e-12);
        assert!((offsets[&(0, 1)] - 1.5 * (Point::new(4.0, 1.0) - middle)).norm() < 1e-12);
        assert_eq!(offsets[&(1, 0)], Vector::zeros());
    }
}
