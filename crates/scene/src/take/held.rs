//! What a take holds of the particles of a frame.

use crate::fragments::Fragments;
use crate::frame::{Frame, ParticleFrame};
use crate::take_settings::{HeldParticles, Precision, TakeSettings};
use fissure_plane::{Matrix, Point, Vector, distance_to_segment};
use std::collections::HashMap;

/// The particles that a take holds of a frame of a scene with cells of `cell_size` [m], rising; none: all. How they
/// move does not matter.
pub(super) fn chosen(frame: &Frame, settings: TakeSettings, cell_size: f64) -> Option<Vec<usize>> {
    match settings.particles {
        HeldParticles::Full => None,
        HeldParticles::Surface => Some(at_surfaces(frame, cell_size)),
        HeldParticles::None => Some(witnesses(frame)),
    }
}

/// A frame of [`chosen`] particles as it will be read.
pub(super) fn rounded(mut frame: Frame, settings: TakeSettings) -> Frame {
    if settings.precision == Precision::Single {
        round(&mut frame.particles);
    }
    frame
}

/// Two particles in each fragment that have its number, and one of every other number that there is in it: as many
/// as it takes for each fragment to keep its number. Rising.
fn witnesses(frame: &Frame) -> Vec<usize> {
    let (fragments, particles) = (Fragments::of_frame(frame), &frame.particles);
    let numbers = fragments.numbers(particles);
    let mut counts = HashMap::<_, usize>::new();
    let is_witness = |&p: &usize| {
        let (body, piece) = (particles.body[p], particles.piece[p]);
        let fragment = fragments.at(body, particles.rest[p]);
        let is_number = fragment.is_some_and(|fragment| numbers[fragment] == Some(piece));
        let count = counts.entry((body, piece, fragment)).or_default();
        *count += 1;
        *count <= if is_number { 2 } else { 1 }
    };
    (0..particles.len()).filter(is_witness).collect()
}

/// The particles that lie within `reach` [m] of an outline or a crack at rest, rising.
fn at_surfaces(frame: &Frame, reach: f64) -> Vec<usize> {
    let particles = &frame.particles;
    let bin_of = |place: Point| [place.x, place.y].map(|x| (x / reach).floor() as i64);
    let mut edges: Vec<(u32, Point, Point)> = Vec::new();
    for ring in &frame.outlines {
        let next = ring.rest.iter().cycle().skip(1);
        edges.extend(ring.rest.iter().zip(next).map(|(&a, &b)| (ring.body, a, b)));
    }
    for crack in &frame.cracks {
        edges.extend(crack.rest.windows(2).map(|ends| (crack.body, ends[0], ends[1])));
    }
    // The edges that may be within reach of a place in each bin.
    let mut bins = HashMap::<[i64; 2], Vec<usize>>::new();
    for (edge, &(_, a, b)) in edges.iter().enumerate() {
        // In parts no longer than a bin, so that a long edge is in the bins along it only.
        let parts = ((b - a).norm() / reach).ceil().max(1.0);
        for part in 0..parts as usize {
            let middle = a + (b - a) * ((part as f64 + 0.5) / parts);
            let [column, row] = bin_of(middle);
            for bin in (-2..=2).flat_map(|i| (-2..=2).map(move |j| [column + i, row + j])) {
                let of_bin = bins.entry(bin).or_default();
                if of_bin.last() != Some(&edge) {
                    of_bin.push(edge);
                }
            }
        }
    }
    let is_near = |&p: &usize| {
        let (place, body) = (particles.rest[p], particles.body[p]);
        let mut near = bins.get(&bin_of(place)).into_iter().flatten().map(|&edge| edges[edge]);
        near.any(|(of, a, b)| of == body && distance_to_segment(place, a, b) <= reach)
    };
    (0..particles.len()).filter(is_near).collect()
}

/// Rounds what moves to single precision.
fn round(particles: &mut ParticleFrame) {
    fn rounded<'a>(numbers: impl Iterator<Item = &'a mut f64>) {
        numbers.for_each(|number| *number = f64::from(*number as f32));
    }
    rounded(particles.position.iter_mut().flat_map(Point::iter_mut));
    rounded(particles.velocity.iter_mut().flat_map(Vector::iter_mut));
    rounded(particles.deformation_gradient.iter_mut().flat_map(Matrix::iter_mut));
    rounded(particles.cauchy_stress.iter_mut().flat_map(Matrix::iter_mut));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{CrackEnd, CrackFrame, OutlineFrame};
    use proptest::prelude::*;

    fn points(places: &[[f64; 2]]) -> Vec<Point> {
        places.iter().map(|&place| Point::from(place)).collect()
    }

    /// A square of side 1 with `n` by `n` particles, cut from left to right at `height`; numbers as `piece` says.
    fn square(n: usize, height: f64, piece: impl Fn(Point) -> u32) -> Frame {
        let place = |p: usize| Point::new((p % n) as f64 + 0.5, (p / n) as f64 + 0.5) / n as f64;
        let rest: Vec<Point> = (0..n * n).map(place).collect();
        let particles = ParticleFrame {
            id: (0..rest.len() as u32).collect(),
            body: vec![0; rest.len()],
            piece: rest.iter().map(|&place| piece(place)).collect(),
            mass: Some(vec![1.0; rest.len()]),
            position: rest.clone(),
            velocity: vec![Vector::new(0.1, -1e-3); rest.len()],
            deformation_gradient: vec![Matrix::identity() * 1.1; rest.len()],
            cauchy_stress: vec![Matrix::identity() * 1e7; rest.len()],
            rest,
        };
        let ring = points(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, height],
            [1.0, height],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.0, height],
            [0.0, height],
        ]);
        let crack = points(&[[0.0, height], [1.0, height]]);
        let outline = OutlineFrame {
            position: ring.clone(),
            velocity: vec![Vector::zeros(); 8],
            rest: ring,
            ..OutlineFrame::default()
        };
        let crack = CrackFrame {
            above: crack.clone(),
            below: crack.clone(),
            rest: crack,
            above_velocity: vec![Vector::zeros(); 2],
            below_velocity: vec![Vector::zeros(); 2],
            start: CrackEnd::Mouth,
            end: CrackEnd::Mouth,
            ..CrackFrame::default()
        };
        Frame { particles, outlines: vec![outline], cracks: vec![crack], ..Frame::default() }
    }

    fn held_as(particles: HeldParticles, frame: &Frame, cell_size: f64) -> Frame {
        let settings = TakeSettings { particles, precision: Precision::Double };
        let mut held = frame.clone();
        if let Some(chosen) = chosen(frame, settings, cell_size) {
            held.particles = held.particles.chosen(&chosen);
        }
        held
    }

    proptest! {
        /// Truth: the distances to all edges. What is held of each is what it was.
        #[test]
        fn those_at_surfaces_lie_within_a_cell_of_a_line(n in 4_usize..30, height in 0.2..0.8_f64, cell in 0.02..0.3_f64) {
            let frame = square(n, height, |_| 0);
            let found = held_as(HeldParticles::Surface, &frame, cell).particles;
            let near = |p: Point| [p.x, 1.0 - p.x, p.y, 1.0 - p.y, (p.y - height).abs()].iter().any(|d| *d <= cell);
            let expected: Vec<u32> = (0..).zip(&frame.particles.rest).filter(|&(_, &p)| near(p)).map(|(p, _)| p).collect();
            prop_assert_eq!(&found.id, &expected);
            prop_assert!(found.id.iter().zip(&found.rest).all(|(&p, rest)| frame.particles.rest[p as usize] == *rest));
        }

        /// Truth: the numbers of all particles, strays of other numbers among them.
        #[test]
        fn fragments_keep_their_numbers(n in 4_usize..20, height in 0.2..0.8_f64, strays in prop::collection::vec((0_u32..3, 0_usize..400), 0..9)) {
            let mut frame = square(n, height, |place| u32::from(place.y > height) * 4 + 1);
            strays.iter().for_each(|&(number, p)| frame.particles.piece[p % (n * n)] = number);
            let held = held_as(HeldParticles::None, &frame, 0.1);
            let numbers = |frame: &Frame| Fragments::of_frame(frame).numbers(&frame.particles);
            prop_assert_eq!(numbers(&held), numbers(&frame));
            prop_assert_eq!(held.particles.piece.iter().min(), frame.particles.piece.iter().min());
            prop_assert!(held.particles.len() <= 2 * 2 + 2 * 4, "{}", held.particles.len());
        }
    }

    /// Truth: single precision has 24 binary digits. What is at rest stays as it was, and so does what is not a
    /// particle.
    #[test]
    fn single_precision_rounds_what_moves() {
        let frame = square(7, 0.3, |_| 0);
        let settings = TakeSettings { particles: HeldParticles::Full, precision: Precision::Single };
        let found = rounded(frame.clone(), settings);
        assert_eq!((&found.outlines, &found.particles.rest), (&frame.outlines, &frame.particles.rest));
        for (single, double) in found.particles.position.iter().zip(&frame.particles.position) {
            assert!((single - double).amax() <= 2_f64.powi(-25), "{single} {double}");
        }
        assert_ne!(found.particles.position, frame.particles.position);
        assert_eq!(rounded(found.clone(), settings), found);
    }
}
