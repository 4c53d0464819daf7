//! Whether the particles of a body hang together as its outline does.

use super::groups::groups;
use super::samples::two_digits;
use super::width::width;
use crate::particles::Particles;
use fissure_plane::{Point, Region, nearest_on_segment};
use fissure_scene::{KeyPath, Scene, SceneFault};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Range;

/// A group of particles is a part of the body where it is two particles wide both ways, or when it has at least so
/// many. Others are the ends of corners: what lies beyond a place too narrow for particles in a shape that gets
/// narrower and narrower is nowhere two wide, and holds fewer than this while the angle is 1° or more, at any spacing.
const FEWEST_OF_PART: usize = 30;
/// An outline that runs so far, in spacings, without a particle of a part beside it has lost what it encloses. In a
/// corner of 2° or more it is shorter.
const LONGEST_BARE: f64 = 60.0;
/// A particle lies this near, in spacings, to a straight edge of material that is wide enough for particles, however it
/// is turned.
const BESIDE: f64 = 1.25;
/// Outlines are looked at in so many places per spacing.
const LOOKS: f64 = 4.0;
/// A body of so many spacings is wide enough for particles everywhere.
const WIDE_ENOUGH: f64 = 2.0;

/// That no body falls apart, and no long piece of one is left without particles, because it is too narrow for them.
pub(super) fn check_wholeness(scene: &Scene, particles: &Particles) -> Result<(), SceneFault> {
    match too_narrow(scene, particles) {
        Some((index, narrow)) => Err(narrow.fault(&scene.bodies[index].name, index, scene.particle_spacing)),
        None => Ok(()),
    }
}

/// The first body that is somewhere too narrow to be whole, and where.
fn too_narrow(scene: &Scene, particles: &Particles) -> Option<(usize, Narrow)> {
    let group = groups(scene, particles);
    let mut first = 0;
    scene.bodies.iter().enumerate().find_map(|(index, body)| {
        let own = first..first + particles.body[first..].partition_point(|&b| b as usize == index);
        first = own.end;
        let layout = Layout { particles, group: &group, parts: parts(particles, &group, own.clone()), body: index };
        let narrow = if layout.parts.is_empty() {
            let falls_apart = own.clone().any(|p| group[p] != group[own.start]);
            let (place, width) = (particles.rest[own.start], width(&body.region));
            falls_apart.then_some(Narrow { place, width, outcome: Outcome::FallsApart })
        } else {
            layout.lost(&body.region)
        };
        Some((index, narrow?))
    })
}

/// What becomes of a narrow place.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    /// What lies on its two sides is not held together.
    FallsApart,
    /// It is left out.
    LeftOut,
}

/// A place too narrow for particles.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Narrow {
    place: Point,
    width: f64,
    outcome: Outcome,
}

impl Narrow {
    fn fault(&self, body: &str, index: usize, spacing: f64) -> SceneFault {
        let digits = |value: f64| -> f64 { format!("{value:.3e}").parse().unwrap_or(value) };
        let (what, outcome) = match self.outcome {
            Outcome::FallsApart => ("falls apart", "its two sides share no particle and no node"),
            Outcome::LeftOut => ("loses a part", "a long piece of it holds no particle"),
        };
        let message = format!(
            "body `{body}` {what}: it is {} m wide near ({}, {}) m, {:.2} particle spacings, and {outcome}",
            digits(self.width),
            digits(self.place.x),
            digits(self.place.y),
            self.width / spacing
        );
        let enough = two_digits(self.width / WIDE_ENOUGH, f64::floor);
        let remedy = format!("set `grid.particle_spacing` to {enough} m or less, or draw it wider");
        SceneFault::new(KeyPath::item("body", index).then("shape"), message, remedy)
    }
}

/// The groups of a body that are parts of it.
fn parts(particles: &Particles, group: &[u32], own: Range<usize>) -> BTreeSet<u32> {
    let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
    for run in group[own.clone()].chunk_by(|a, b| a == b) {
        *counts.entry(run[0]).or_default() += run.len();
    }
    let mut parts: BTreeSet<u32> = counts.iter().filter(|(_, n)| **n >= FEWEST_OF_PART).map(|(g, _)| *g).collect();
    if parts.len() < counts.len() {
        let body = particles.body[own.start];
        let is_there = |place: [i32; 2]| particles.at(place).is_some_and(|q| particles.body[q] == body);
        for p in own {
            let [i, j] = particles.place[p];
            if !parts.contains(&group[p]) && [[i + 1, j], [i, j + 1], [i + 1, j + 1]].into_iter().all(is_there) {
                parts.insert(group[p]);
            }
        }
    }
    parts
}

/// The particles of a body, and what they are parts of.
struct Layout<'a> {
    particles: &'a Particles,
    group: &'a [u32],
    parts: BTreeSet<u32>,
    body: usize,
}

/// A piece of a ring between two places that lie beside particles.
struct Stretch {
    /// Places a quarter of a spacing apart or less.
    points: Vec<Point>,
    /// Length of what lies beside none [m].
    bare: f64,
    /// Whether its ends lie beside different parts.
    changes: bool,
}

impl Layout<'_> {
    /// The part beside a place of the outline.
    fn part_beside(&self, place: Point) -> Option<u32> {
        let reach = BESIDE * self.particles.spacing;
        let box_of = fissure_scene::Vector::new(reach, reach);
        let distance = |p: usize| (self.particles.rest[p] - place).norm();
        self.particles
            .in_box(place - box_of, place + box_of)
            .filter(|&p| self.particles.body[p] as usize == self.body && self.parts.contains(&self.group[p]))
            .map(|p| (distance(p), p))
            .filter(|(distance, _)| *distance <= reach)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, p)| self.group[p])
    }

    /// The narrowest place where the body falls apart, or else one where a part of it is left out.
    fn lost(&self, region: &Region) -> Option<Narrow> {
        let spacing = self.particles.spacing;
        let stretches: Vec<Stretch> = region.rings().flat_map(|ring| self.stretches(ring)).collect();
        let changes: Vec<&Stretch> = stretches.iter().filter(|stretch| stretch.changes).collect();
        if let Some(first) = changes.first() {
            // What holds no particle is narrower than a spacing.
            let middle = first.points[first.points.len() / 2];
            let (width, place) = narrowest_between(&changes, spacing).unwrap_or((spacing, middle));
            return Some(Narrow { place, width, outcome: Outcome::FallsApart });
        }
        let longest = stretches.iter().max_by(|a, b| a.bare.total_cmp(&b.bare))?;
        // Half way to its end, where the outline comes back on the other side.
        let (there, back) = longest.points.split_at(longest.points.len() / 2);
        let from = there[there.len() / 2];
        let across = back.iter().min_by(|a, b| (*a - from).norm().total_cmp(&(*b - from).norm()))?;
        let place = nalgebra::center(&from, across);
        let is_lost = longest.bare > LONGEST_BARE * spacing;
        is_lost.then(|| Narrow { place, width: (across - from).norm(), outcome: Outcome::LeftOut })
    }

    /// The pieces of a ring along which no part is beside it, or the part beside it changes. Those that change reach on
    /// for a spacing.
    fn stretches(&self, ring: &[Point]) -> Vec<Stretch> {
        let points = looked_at(ring, self.particles.spacing / LOOKS);
        let beside: Vec<Option<u32>> = points.iter().map(|&place| self.part_beside(place)).collect();
        let n = points.len();
        let Some(start) = beside.iter().position(Option::is_some) else { return Vec::new() };
        let mut stretches = Vec::new();
        let mut last = start;
        for next in start + 1..=start + n {
            if beside[next % n].is_none() {
                continue;
            }
            let changes = beside[next % n] != beside[last % n];
            if changes || next > last + 1 {
                let length =
                    |range: Range<usize>| -> f64 { range.map(|k| (points[(k + 1) % n] - points[k % n]).norm()).sum() };
                let bare = length(last..next);
                let mut ends = (last, next);
                if changes {
                    while ends.1 - ends.0 < n && length(ends.0.saturating_sub(1)..last) < self.particles.spacing {
                        ends.0 = if ends.0 == 0 { break } else { ends.0 - 1 };
                    }
                    while ends.1 - ends.0 < n && length(next..ends.1 + 1) < self.particles.spacing {
                        ends.1 += 1;
                    }
                }
                let points = (ends.0..=ends.1).map(|k| points[k % n]).collect();
                stretches.push(Stretch { points, bare, changes });
            }
            last = next;
        }
        stretches
    }
}

/// The corners of a ring, and places between them not farther apart than `longest` [m].
fn looked_at(ring: &[Point], longest: f64) -> Vec<Point> {
    let edges = (0..ring.len()).map(|i| (ring[i], ring[(i + 1) % ring.len()]));
    edges
        .flat_map(|(a, b)| {
            let count = ((b - a).norm() / longest).ceil().max(1.0) as usize;
            (0..count).map(move |k| a + (b - a) * (k as f64 / count as f64))
        })
        .collect()
}

/// Where two of the stretches are nearest to each other: how far apart [m], and the middle between them.
fn narrowest_between(stretches: &[&Stretch], spacing: f64) -> Option<(f64, Point)> {
    // Necks that hold no particle are narrower than a spacing, and steps along stretches shorter than half of one.
    let size = 1.5 * spacing;
    let cell = |p: Point| [(p.x / size).floor() as i64, (p.y / size).floor() as i64];
    let mut cells: HashMap<[i64; 2], Vec<(usize, Point, Point)>> = HashMap::new();
    for (k, stretch) in stretches.iter().enumerate() {
        for pair in stretch.points.windows(2) {
            cells.entry(cell(pair[0])).or_default().push((k, pair[0], pair[1]));
        }
    }
    let mut narrowest: Option<(f64, Point)> = None;
    for (k, stretch) in stretches.iter().enumerate() {
        for &place in &stretch.points {
            let [x, y] = cell(place);
            let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
            for (_, a, b) in around.filter_map(|c| cells.get(&c)).flatten().filter(|(other, ..)| *other != k) {
                let foot = nearest_on_segment(*a, *b, place);
                let distance = (foot - place).norm();
                if narrowest.is_none_or(|(least, _)| distance < least) {
                    narrowest = Some((distance, nalgebra::center(&foot, &place)));
                }
            }
        }
    }
    narrowest
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{free_body, rectangle};
    use fissure_scene::Vector;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn placed(list: &[(f64, f64)], scale: f64, turn: f64, shift: (f64, f64)) -> Region {
        let place = |&(x, y): &(f64, f64)| {
            nalgebra::Rotation2::new(turn) * Point::new(scale * x, scale * y) + Vector::new(shift.0, shift.1) * scale
        };
        Region { exterior: list.iter().map(place).collect(), holes: Vec::new() }
    }

    /// Two plates of the given sizes around (0, 0), joined by a bridge of half the width `w`; of length 0 by the place
    /// between two notches.
    fn dumbbell(w: f64, length: f64, left: (f64, f64), right: (f64, f64)) -> Vec<(f64, f64)> {
        let l = 0.5 * length;
        let half = |side: f64, (wide, high): (f64, f64)| {
            let notch = if length == 0.0 { 0.3 * wide } else { 0.0 };
            let (near, far) = (l + notch, l + wide);
            [(near, -high), (far, -high), (far, high), (near, high)].map(|(x, y)| (side * x, y))
        };
        let (right, left) = (half(1.0, right), half(-1.0, left));
        let mut list = if length == 0.0 { vec![(0.0, -w)] } else { vec![(-l, -w), (l, -w)] };
        list.extend(right);
        list.extend(if length == 0.0 { vec![(0.0, w)] } else { vec![(l, w), (-l, w)] });
        list.extend([left[3], left[2], left[1], left[0]]);
        list
    }

    fn found_in(region: Region, spacing: f64) -> (Scene, Particles, Option<Narrow>) {
        let mut scene = free_body(region, spacing);
        // The kernel that reaches least.
        scene.solver.kernel = fissure_scene::Kernel::Bilinear;
        let particles = Particles::fill(&scene).unwrap();
        let found = too_narrow(&scene, &particles).map(|(_, narrow)| narrow);
        (scene, particles, found)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// Truth: whether the particles in the middles of the plates share nodes with each other, and the construction
        /// of the neck. With the spacing of the remedy the body holds together.
        #[test]
        fn a_dumbbell_without_a_neck_is_refused(
            width in 0.1_f64..3.0, length in prop_oneof![Just(0.0), 1.0_f64..30.0], size in -3.0_f64..3.0, turn in -PI..PI,
            left in (4.0_f64..12.0, 3.0_f64..8.0), right in (4.0_f64..12.0, 3.0_f64..8.0), shift in (-1.0_f64..1.0, -1.0_f64..1.0),
            wide_kernel in any::<bool>(),
        ) {
            let scale = 10.0_f64.powf(size);
            let list = dumbbell(0.5 * width, length, left, right);
            let mut scene = free_body(placed(&list, scale, turn, shift), scale);
            scene.solver.kernel = if wide_kernel { fissure_scene::Kernel::Cubic } else { fissure_scene::Kernel::Bilinear };
            let particles = Particles::fill(&scene).unwrap();
            let group = groups(&scene, &particles);
            let middle = |x: f64| placed(&[(x, 0.0)], scale, turn, shift).exterior[0];
            let group_at = |to: Point| {
                let nearest = |a: &usize, b: &usize| (particles.rest[*a] - to).norm().total_cmp(&(particles.rest[*b] - to).norm());
                group[(0..particles.len()).min_by(nearest).unwrap()]
            };
            let [a, b] = [-0.5 * length - 0.5 * left.0, 0.5 * length + 0.5 * right.0].map(|x| group_at(middle(x)));
            match too_narrow(&scene, &particles) {
                None => prop_assert!(a == b),
                Some((_, found)) => {
                    prop_assert!(a != b, "{:?}", found);
                    prop_assert!((found.width / scale - width).abs() < 0.02 * width, "{} {:?}", width, found.width / scale);
                    prop_assert!((found.place - middle(0.0)).norm() < (0.5 * length + 1.0) * scale, "{:?}", found.place);
                    let remedy = found.fault("body", 0, scale).remedy;
                    let enough: f64 = remedy.split(' ').nth(3).unwrap().parse().unwrap();
                    prop_assert!(enough > 0.4 * found.width, "{}", remedy);
                    let region = scene.bodies[0].region.clone();
                    prop_assert_eq!(found_in(region, enough).2, None);
                }
            }
        }

        /// Truth: the construction. Corners down to 2°, blunt or sharp, discs, crescents and plates at any turn are
        /// whole at any spacing.
        #[test]
        fn ordinary_shapes_are_whole(points in 3_usize..9, sharp in 2.0_f64..60.0, turn in -PI..PI, spacing in 0.2_f64..2.0, x in 0.0_f64..1.0) {
            let radius = 12.0;
            let half = 0.8 * PI / points as f64;
            let deep = radius * half.sin() / (0.5 * sharp.to_radians()).tan() - radius * (1.0 - half.cos());
            let star: Vec<(f64, f64)> = (0..points).flat_map(|k| {
                let a = 2.0 * PI * k as f64 / points as f64;
                [(a - half, radius), (a, radius + deep), (a + half, radius)].map(|(t, r)| (r * t.cos(), r * t.sin()))
            }).collect();
            prop_assert_eq!(found_in(placed(&star, 1.0, turn, (x, 0.3)), spacing).2, None);
            // A crescent of two discs whose circles cross at about the same angle.
            let edge = (0.999 * (0.5 * sharp.to_radians()).cos()).asin();
            let outer = (0..=200).map(|k| edge + (2.0 * PI - 2.0 * edge) * f64::from(k) / 200.0);
            let outer = outer.map(|t| (radius * t.cos(), radius * t.sin()));
            let inner = (0..200).map(|k| 2.0 * PI - edge - (2.0 * PI - 2.0 * edge) * f64::from(k) / 200.0).skip(1);
            let cut = 2.0 * radius * edge.cos();
            let inner = inner.map(|t| (cut - radius * t.cos(), radius * t.sin())).filter(|&(x, _)| x < radius * edge.cos());
            let moon: Vec<_> = outer.chain(inner).collect();
            let moon = placed(&moon, 1.0, turn, (x, 0.3));
            prop_assert!(moon.area() > 0.0);
            prop_assert_eq!(found_in(moon, spacing).2, None);
        }
    }

    /// Truth: the construction. A plate with a long bar, or a spike, that runs between two rows of particles; a hair
    /// that is nowhere wide.
    #[test]
    fn long_thin_parts_are_told() {
        let with_bar = |low: f64, high: f64, length: f64| {
            let list = [
                (0.0, 0.0),
                (10.0, 0.0),
                (10.0, low),
                (10.0 + length, low),
                (10.0 + length, high),
                (10.0, high),
                (10.0, 10.0),
                (0.0, 10.0),
            ];
            found_in(placed(&list, 1.0, 0.0, (0.0, 0.0)), 1.0).2
        };
        let lost = with_bar(4.6, 5.4, 80.0).unwrap();
        assert_eq!(lost.outcome, Outcome::LeftOut);
        assert!(
            (lost.width - 0.8).abs() < 1e-9 && lost.place.x > 20.0 && (lost.place.y - 5.0).abs() < 1e-9,
            "{lost:?}"
        );
        assert_eq!(with_bar(4.4, 5.6, 80.0), None);
        assert_eq!(with_bar(4.6, 5.4, 10.0), None);
        let hair = [(0.0, 0.0), (120.0, 0.0), (120.0, 0.4), (0.0, 0.4)];
        let hair = found_in(placed(&hair, 1.0, 0.02, (0.0, 0.0)), 1.0).2.unwrap();
        assert_eq!(hair.outcome, Outcome::FallsApart);
        assert!((hair.width - 0.4).abs() < 1e-9, "{hair:?}");
        assert_eq!(found_in(rectangle([0.0, 0.0], [40.0, 0.4]), 0.3).2, None);
    }

    /// Truth: the construction, in millimetres. The message shows the neck, and the key is that of the body's shape.
    #[test]
    fn a_neck_of_four_tenths_of_a_spacing_is_told_with_its_place() {
        let list = dumbbell(0.2, 10.0, (10.0, 6.0), (10.0, 6.0));
        let scene = free_body(placed(&list, 1e-3, 0.0, (0.0, 0.0)), 1e-3);
        let fault = check_wholeness(&scene, &Particles::fill(&scene).unwrap()).unwrap_err();
        assert_eq!(fault.path.to_string(), "body[0].shape");
        for words in ["body `body` falls apart", "0.0004 m wide", "0.40 particle spacings"] {
            assert!(fault.message.contains(words), "{}", fault.message);
        }
        assert!(fault.remedy.contains("0.0002 m or less"), "{}", fault.remedy);
    }
}
