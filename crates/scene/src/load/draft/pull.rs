//! A pull that makes a drawn crack run, and the time it takes.

use crate::load::split::{Piece, pieces_inside};
use crate::scene::Material;
use fissure_plane::{Point, Region, Vector, bounds, polyline_length};

/// The pull at its full is this many times what the crack needs to start, by the formula for a strip: enough for bodies
/// that are no strips, and for cracks that run on without a stop.
pub(super) const SURPLUS: f64 = 2.5;
/// A crack counts as no longer than this part of the strip, beyond which it would start by itself.
const LONGEST: f64 = 0.7;
/// How far the bands reach out of the body, in parts of its size: beyond rounding, and not to a neighbour.
const MARGIN: f64 = 1e-3;
/// Part of the body at each end, across the crack, that is pulled.
const BAND: f64 = 0.15;
/// Times that a wave takes through the body in which the pull grows to its full, so that it does not hit the body like
/// a hammer.
const RISE: f64 = 6.0;
/// The mean speed of a crack from its start, as a part of the Rayleigh wave speed.
const CRACK_SPEED: f64 = 0.3;
/// A crack has to go this part of the body's width at least, as far as the time shown is concerned.
const SHORTEST_WAY: f64 = 0.1;
/// The time that is shown after the crack is through, in times it needs to get through: the pieces part.
const AFTER: f64 = 2.0;

/// A pull at both sides of a crack, and how long to look.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pull {
    /// Where it acts: to the one and to the other side of the crack, four corners each [m].
    pub(super) bands: [[Point; 4]; 2],
    /// Total force on the first band; the opposite acts on the second [N/m].
    pub(super) force: Vector,
    /// Time in which it grows to that [s].
    pub(super) rise: f64,
    /// Time worth seeing [s].
    pub(super) duration: f64,
}

impl Pull {
    /// The pull that opens a crack, a piece of a line in `region`, across the way from its first to its last point.
    ///
    /// The stress intensity is taken from a strip as wide as the body is on the average along the crack: of an edge
    /// crack (Tada, Paris & Irwin: K = σ √(π a) F(a/W), exact to 0.5 %), or of a central one, half as long.
    pub(super) fn across(crack: &Piece, region: &Region, material: &Material) -> Self {
        let chord = crack.points[crack.points.len() - 1] - crack.points[0];
        let along = level(chord.try_normalize(0.0).unwrap_or_else(Vector::x));
        let across = Vector::new(-along.y, along.x);
        let turned = |p: &Point| Point::new(p.coords.dot(&along), p.coords.dot(&across));
        let (low, high) = bounds(&region.exterior.iter().map(turned).collect::<Vec<_>>());
        let size = high - low;
        let width = region.area() / size.y;
        let length = chord.norm().min(LONGEST * width);
        let is_central = crack.mouths == [false; 2];
        let (half, factor) = if is_central { (0.5 * length, 1.0) } else { (length, edge_crack(length / width)) };
        let stress = material.fracture_toughness / ((std::f64::consts::PI * half).sqrt() * factor);
        let margin = MARGIN * size.max();
        let place = |x: f64, y: f64| Point::from(along * x + across * y);
        let band = |from: f64, to: f64| {
            let (left, right) = (low.x - margin, high.x + margin);
            [place(left, from), place(right, from), place(right, to), place(left, to)]
        };
        let deep = BAND * size.y;
        let bands = [band(high.y - deep, high.y + margin), band(low.y - margin, low.y + deep)];
        let (pressure_wave, rayleigh_wave) = wave_speeds(material);
        let rise = RISE * size.y / pressure_wave;
        let speed = (CRACK_SPEED * rayleigh_wave).min(material.limiting_speed.unwrap_or(f64::INFINITY));
        let crossing = way_ahead(crack, region).unwrap_or(size.x).max(SHORTEST_WAY * size.x) / speed;
        Self { bands, force: across * (SURPLUS * stress * width), rise, duration: rise + (1.0 + AFTER) * crossing }
    }
}

/// How far a crack has to go in `region`, straight on at both ends [m].
fn way_ahead(crack: &Piece, region: &Region) -> Option<f64> {
    let (first, last) = (*crack.points.first()?, *crack.points.last()?);
    let chord = last - first;
    let (low, high) = region.bounds();
    let far = chord.try_normalize(0.0)? * 2.0 * (high - low).norm();
    let through = pieces_inside(&[first - far, last + far], region, 0.0, 0.0);
    let middle = far.norm() + 0.5 * chord.norm();
    let length = |piece: &Piece| polyline_length(&piece.points);
    let around = through.iter().find(|piece| piece.from <= middle && piece.from + length(piece) >= middle)?;
    Some(length(around) - chord.norm())
}

/// A direction, made exactly level or upright when it is nearly so: people draw that by hand. Pointing right, or up.
fn level(direction: Vector) -> Vector {
    const NEARLY: f64 = 0.17;
    let d = match direction {
        d if d.y.abs() < NEARLY => Vector::x(),
        d if d.x.abs() < NEARLY => Vector::y(),
        d => d,
    };
    if d.x < -1e-9 { -d } else { d }
}

/// F of an edge crack in a strip: `ratio` of its length to the width.
fn edge_crack(ratio: f64) -> f64 {
    let angle = 0.5 * std::f64::consts::PI * ratio;
    (angle.tan() / angle).sqrt() * (0.752 + 2.02 * ratio + 0.37 * (1.0 - angle.sin()).powi(3)) / angle.cos()
}

/// Speeds of pressure waves in plane strain and of Rayleigh waves [m/s].
fn wave_speeds(material: &Material) -> (f64, f64) {
    let (e, nu, density) = (material.young_modulus, material.poisson_ratio, material.density);
    let shear = e / (2.0 * (1.0 + nu));
    let pressure = 2.0 * shear * (1.0 - nu) / (1.0 - 2.0 * nu);
    // Viktorov's approximation.
    ((pressure / density).sqrt(), (shear / density).sqrt() * (0.862 + 1.14 * nu) / (1.0 + nu))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::materials::material_preset;

    /// Truth: the table value 1.12 for short edge cracks, and F(0.5) = 2.83 of the single edge notch.
    #[test]
    fn short_and_long_edge_cracks_have_their_known_factors() {
        assert!((edge_crack(1e-6) - 1.122).abs() < 1e-3);
        assert!((edge_crack(0.5) - 2.83).abs() < 0.02);
    }

    /// Truth: the construction, and similarity. Pulled apart across the crack, at any turn; ten times the size, a √10
    /// times the force.
    #[test]
    fn the_pull_opens_the_crack() {
        let glass = material_preset("glass").unwrap();
        for turn in [0.0, 0.7, 2.0, -2.5] {
            let place = |x: f64, y: f64| nalgebra::Rotation2::new(turn) * Point::new(x, y);
            let of = |s: f64| {
                let exterior = vec![place(-s, -s), place(s, -s), place(s, s), place(-s, s)];
                let region = Region { exterior, holes: Vec::new() };
                let points = vec![place(-s, 0.0), place(-0.5 * s, 0.0)];
                Pull::across(&Piece { points, mouths: [true, false], from: 0.0 }, &region, &glass)
            };
            let (small, large) = (of(1.0), of(10.0));
            assert!((large.force.norm() / small.force.norm() - 10.0_f64.sqrt()).abs() < 1e-9);
            let middle = |band: [Point; 4]| (band[0].coords + band[2].coords) / 2.0;
            let apart = middle(small.bands[0]) - middle(small.bands[1]);
            assert!(apart.dot(&small.force) > 0.99 * apart.norm() * small.force.norm());
            assert!(apart.dot(&(place(1.0, 0.0).coords)).abs() < 1e-9);
        }
    }
}
