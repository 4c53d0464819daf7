//! Plates as somebody may draw them: any proportions, cracks, holes, loads and materials, none of which a formula is
//! known for.

use crate::problem::{Problem, material, rectangle};
use fissure_scene::{BoxSide, Curve, LoadKind, PlaneState, Point, Scene, Selection, Vector};
use fissure_sim::Elastic;
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

/// Traction [Pa]: strains of 1e-6.
const STRESS: f64 = 1e3;
const YOUNG: f64 = 1e9;
/// Cells until others are chosen [m].
const CELL_SIZE: f64 = 0.025;
/// What is strewn keeps so far from all else, in widths of the plate.
const CLEARANCE: f64 = 0.07;
/// Places tried for a hole or another crack.
const TRIES: u32 = 40;

/// Random numbers of one plate.
pub(super) struct Random(Pcg64);

impl Random {
    /// Those of plate number `index` of the family `seed`. Every plate has a sequence of its own, so that it does not
    /// depend on how many there are.
    pub(super) fn of(seed: u64, index: usize) -> Self {
        let number = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        Self(Pcg64::seed_from_u64(seed.wrapping_mul(31).wrapping_add(number)))
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        // From 0 to below 1, in multiples of 2^-53.
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Any part of a range as likely as any other of the same ratio.
    pub(super) fn logarithmic(&mut self, [low, high]: [f64; 2]) -> f64 {
        low * (high / low).powf(self.uniform(0.0, 1.0))
    }

    fn happens(&mut self, part: f64) -> bool {
        self.uniform(0.0, 1.0) < part
    }
}

/// The next plate, 1 m wide: a crack from its left edge or in its middle, sometimes another one and a hole; pulled at
/// both ends or held at one, at once or gradually, and followed until waves have gone to and fro. Nothing grows.
pub(super) fn plate(random: &mut Random) -> Scene {
    let height = random.uniform(0.7, 2.0);
    let plane = if random.happens(0.5) { PlaneState::Strain } else { PlaneState::Stress };
    let elastic = material(YOUNG, random.uniform(0.0, 0.42), 1000.0, 1e30);
    let wave = Elastic::new(&elastic, plane).dilatational_wave_speed();
    let mut lines = vec![first_crack(random, height)];
    if random.happens(0.25) {
        lines.extend(other_crack(random, height, &lines));
    }
    let mut region = rectangle((0.0, 0.0), (1.0, height));
    if random.happens(0.3) {
        region.holes.extend(hole(random, height, &lines));
    }
    let crossing = height / wave;
    let rise = if random.happens(0.25) { 0.0 } else { random.uniform(0.0, 4.0) * crossing };
    let curve = if rise > 0.0 { Curve { points: vec![(0.0, 0.0), (rise, 1.0)] } } else { Curve::default() };
    let mut problem =
        Problem::new("plate", region, elastic, plane, CELL_SIZE).until(rise + 4.0 * crossing, super::FRAMES);
    let edge = |side| Selection::Edge { side, bodies: None };
    let pull = |stress| LoadKind::Traction(Vector::new(0.0, stress));
    problem = problem.load(edge(BoxSide::Top), pull(STRESS), curve.clone());
    problem = if random.happens(0.3) {
        problem.support(edge(BoxSide::Bottom), [Some(0.0), Some(0.0)])
    } else {
        problem.load(edge(BoxSide::Bottom), pull(-STRESS), curve)
    };
    for line in lines {
        let is_of_edge = line[0].x == 0.0 || line[0].x == 1.0;
        problem = problem.crack(&line.map(|p| (p.x, p.y)), [!is_of_edge, true]);
    }
    problem.scene
}

/// From the left edge, or in the middle.
fn first_crack(random: &mut Random, height: f64) -> [Point; 2] {
    if random.happens(0.6) {
        let from = Point::new(0.0, height * random.uniform(0.35, 0.65));
        return [from, from + along(random.uniform(-0.6, 0.6)) * random.uniform(0.12, 0.65)];
    }
    let middle = Point::new(random.uniform(0.35, 0.65), height * random.uniform(0.4, 0.6));
    let half = along(random.uniform(-1.0, 1.0)) * random.uniform(0.08, 0.27);
    [middle - half, middle + half]
}

/// From the right edge.
fn other_crack(random: &mut Random, height: f64, lines: &[[Point; 2]]) -> Option<[Point; 2]> {
    (0..TRIES).find_map(|_| {
        let from = Point::new(1.0, height * random.uniform(0.25, 0.75));
        let line = [from, from - along(random.uniform(-0.6, 0.6)) * random.uniform(0.1, 0.4)];
        let is_clear = samples(line).all(|p| lines.iter().all(|&other| distance(p, other) > CLEARANCE));
        is_clear.then_some(line)
    })
}

/// A polygon of 24 corners.
fn hole(random: &mut Random, height: f64, lines: &[[Point; 2]]) -> Option<Vec<Point>> {
    (0..TRIES).find_map(|_| {
        let radius = random.uniform(0.05, 0.12);
        let room = radius + CLEARANCE;
        let middle = Point::new(random.uniform(room, 1.0 - room), random.uniform(room, height - room));
        let is_clear = lines.iter().all(|&line| distance(middle, line) > room);
        let corner = |k: u8| middle + along(-TAU * f64::from(k) / 24.0) * radius;
        is_clear.then(|| (0..24).map(corner).collect())
    })
}

fn along(angle: f64) -> Vector {
    Vector::new(angle.cos(), angle.sin())
}

fn samples(line: [Point; 2]) -> impl Iterator<Item = Point> {
    (0..=20).map(move |k| line[0] + (line[1] - line[0]) * (f64::from(k) / 20.0))
}

fn distance(point: Point, line: [Point; 2]) -> f64 {
    samples(line).map(|p| (p - point).norm()).fold(f64::INFINITY, f64::min)
}
