//! The colour of front faces by what the particles under them carry.

use crate::coloring::Coloring;
use fissure_scene::Frame;
use std::collections::HashMap;

/// Cells that are looked at around a place without a particle, to each side.
const REACH: i64 = 4;

/// Particles by cell, with their colours.
#[derive(Debug)]
pub(crate) struct CapField {
    cell: f64,
    particles: HashMap<(i64, i64), Vec<Colored>>,
}

/// A place [m] and its colour.
type Colored = ([f64; 2], [u8; 3]);

impl CapField {
    /// Of the particles of a frame; none where colours say which fragment it is.
    pub(crate) fn new(frame: &Frame, spacing: f64, coloring: Coloring, [low, high]: [f64; 2]) -> Option<Self> {
        let values = coloring.values(&frame.particles)?;
        let mut particles: HashMap<_, Vec<_>> = HashMap::new();
        for (place, value) in frame.particles.position.iter().zip(values) {
            let place = [place.x, place.y];
            let color = coloring.color((value - low) / (high - low));
            particles.entry(cell(place, spacing)).or_default().push((place, color));
        }
        Some(Self { cell: spacing, particles })
    }

    /// The colour of the particle nearest to a place; none where none is near.
    pub(crate) fn color(&self, place: [f64; 2]) -> Option<[u8; 3]> {
        let (i, j) = cell(place, self.cell);
        let mut nearest: Option<(f64, [u8; 3])> = None;
        for reach in 0..=REACH {
            for (di, dj) in ring(reach) {
                for (particle, color) in self.particles.get(&(i + di, j + dj)).into_iter().flatten() {
                    let distance = (particle[0] - place[0]).hypot(particle[1] - place[1]);
                    if nearest.is_none_or(|(least, _)| distance < least) {
                        nearest = Some((distance, *color));
                    }
                }
            }
            // What lies in further rings is at least this far off.
            if nearest.is_some_and(|(least, _)| least <= reach as f64 * self.cell) {
                break;
            }
        }
        nearest.map(|(_, color)| color)
    }
}

fn cell(place: [f64; 2], size: f64) -> (i64, i64) {
    ((place[0] / size).floor() as i64, (place[1] / size).floor() as i64)
}

/// The cells at a distance of `reach` in the larger of both directions.
fn ring(reach: i64) -> impl Iterator<Item = (i64, i64)> {
    let all = (-reach..=reach).flat_map(move |i| (-reach..=reach).map(move |j| (i, j)));
    all.filter(move |(i, j)| i.abs().max(j.abs()) == reach)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use fissure_plane::{Point, Vector};
    use fissure_scene::ParticleFrame;

    /// Truth: all distances.
    #[test]
    fn the_nearest_particle_gives_the_colour() {
        let place = |i: usize| {
            let part = |factor: f64| (i as f64 * factor).fract();
            Point::new(part(0.754_877), part(0.569_84))
        };
        let position: Vec<Point> = (0..200).map(place).collect();
        let velocity = (0..200).map(|i| Vector::new(f64::from(i), 0.0)).collect();
        let particles = ParticleFrame { position: position.clone(), velocity, ..ParticleFrame::default() };
        let frame = Frame { particles, ..Frame::default() };
        let field = CapField::new(&frame, 0.06, Coloring::Speed, [0.0, 199.0]).unwrap();
        for i in 0..300 {
            let asked = Point::new((f64::from(i) * 0.324).fract(), (f64::from(i) * 0.618).fract());
            let distance = |j: &usize| (position[*j] - asked).norm();
            let nearest = (0..200).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
            assert_eq!(field.color([asked.x, asked.y]), Some(Coloring::Speed.color(nearest as f64 / 199.0)));
        }
        assert_eq!(field.color([9.0, 9.0]), None);
    }
}
