//! How far the walls of cracks are moved to be rough.
//!
//! At places one step apart along a crack at rest its walls move by r (d · n) n: n is the normal of the path, d a
//! vector that depends on place and depth alone. Between them the way is linear in the length along the path. So both
//! faces of a crack move alike, and still fit each other, whatever corners they have. Each turns the way as it has
//! turned.
//!
//! r is the amplitude, or less: within a part of the distance to other lines, to tips, and to corners too sharp for it,
//! walls that are moved cannot come to cross each other.

use crate::body_size::body_size;
use crate::options::PostOptions;
use crate::smooth::SmoothCracks;
use fissure_plane::distance_to_segment;
use fissure_scene::{CrackEnd, Frame, Point, Roughness, Scene, Vector, Walls};
use std::collections::BTreeMap;

/// What a wall may move by, as a part of its distance from others. Two that come towards each other leave a third.
const ROOM: f64 = 1.0 / 3.0;
/// The same of the distance from a tip: a crack that is open by a few hundredths of that has faces that would cross if
/// they moved by more, as they have other corners.
const ROOM_AT_TIP: f64 = 0.05;
/// No wall moves nearer than so many shortest edges to others, nor within so many of a tip: readers merge vertices over
/// half of one.
const CLEAR: f64 = 1.0;
const CLEAR_AT_TIP: f64 = 5.0;
/// Vertices of walls are farther from each other than so many shortest edges; where they are cut at rest.
const APART: f64 = 0.52;
const APART_AT_REST: f64 = 0.26;
/// What lies along the same crack, not much farther away along it than straight, is the wall itself.
const WINDING: f64 = 2.0;
/// Weights of the relief and of one of half its length.
const WEIGHTS: [f64; 2] = [2.0 / 3.0, 1.0 / 3.0];

/// How far walls are moved.
#[derive(Debug)]
pub(crate) struct Relief {
    settings: Roughness,
    thickness: f64,
    /// The shortest edge, as a part of the size of a body; none where faces may lie on each other.
    shortest: f64,
    paths: Vec<Path>,
    /// Tips at rest, and how far from them walls stay [m].
    tips: Vec<(Point, f64)>,
    /// Width of a bin [m], and what is in each or within its width of it.
    bin: f64,
    obstacles: BTreeMap<[i32; 2], Vec<Obstacle>>,
}

/// A crack at rest.
#[derive(Debug)]
struct Path {
    points: Vec<Point>,
    /// Length up to each point [m].
    arcs: Vec<f64>,
}

/// A place on a crack: its number, and the length along it [m].
pub(crate) type OnCrack = (usize, f64);

/// What walls keep away from.
#[derive(Debug, Clone, Copy)]
struct Obstacle {
    /// Its ends at rest [m].
    ends: [Point; 2],
    /// What a wall may move by right there [m].
    room: f64,
    /// How far off walls do not move by more than that [m].
    clear: f64,
    /// The crack it is of, and where along it it begins [m]: no obstacle to what is near along the same crack.
    along: Option<(usize, f64)>,
}

/// How walls are moved in the depth, at one place along a crack.
pub(crate) struct Profile<'a> {
    relief: &'a Relief,
    /// The places before and after it, what walls may move by there [m], along the normal, and that.
    ends: [(Point, Vector, Vector); 2],
    /// Where it is between them: 0 is the first, 1 the second.
    part: f64,
    /// What walls may move by at the place itself [m].
    room: f64,
}

impl Profile<'_> {
    /// How far walls are moved at depth `z` [m], at rest [m].
    pub(crate) fn shift(&self, z: f64) -> Vector {
        let Relief { settings, thickness, .. } = self.relief;
        let fade = (0.5 * thickness).min(settings.length);
        let inside = smooth(((0.5 * thickness - z.abs()) / fade).clamp(0.0, 1.0));
        let [low, high] = self
            .ends
            .map(|(place, way, normal)| way * (inside * self.relief.direction(place, z).dot(&normal).clamp(-1.0, 1.0)));
        (low + self.part * (high - low)).cap_magnitude(self.room)
    }
}

impl Relief {
    /// The relief that `options` ask for, if any; `cracks` of the frame at rest, as they are shown.
    pub(crate) fn new(scene: &Scene, options: &PostOptions, frame: &Frame, cracks: &SmoothCracks<'_>) -> Option<Self> {
        let settings = options.roughness?;
        let shortest = if options.walls == Walls::All { 0.0 } else { options.shortest_edge };
        let clear = |body: u32| shortest * body_size(scene, body);
        let farthest = (0..scene.bodies.len() as u32).map(clear).fold(0.0, f64::max);
        let mut relief = Self {
            paths: Vec::new(),
            tips: Vec::new(),
            settings,
            thickness: options.thickness,
            shortest,
            bin: settings.amplitude / ROOM + CLEAR * farthest,
            obstacles: BTreeMap::new(),
        };
        for outline in &frame.outlines {
            let next = outline.rest.iter().cycle().skip(1);
            outline.rest.iter().zip(next).for_each(|(a, b)| relief.add([*a, *b], 0.0, clear(outline.body), None));
        }
        for (number, (crack, offsets)) in cracks.cracks.iter().zip(&cracks.offsets).enumerate() {
            let clear = clear(crack.body);
            let path = Path::new(crack.rest.iter().zip(offsets).map(|(p, offset)| p + offset).collect());
            for (i, ends) in path.points.windows(2).enumerate() {
                relief.add([ends[0], ends[1]], 0.0, clear, Some((number, path.arcs[i])));
                if let Some(after) = path.points.get(i + 2) {
                    relief.add([ends[1]; 2], bend([ends[0], ends[1], *after]), 0.0, None);
                }
            }
            for (end, place) in [(crack.start, path.points.first()), (crack.end, path.points.last())] {
                if let (CrackEnd::Tip, Some(place)) = (end, place) {
                    relief.tips.push((*place, CLEAR_AT_TIP * clear));
                }
            }
            relief.paths.push(path);
        }
        Some(relief)
    }

    /// Distance of places along a wall and in its depth, so that the relief is seen [m].
    pub(crate) fn step(&self) -> f64 {
        0.25 * self.settings.length
    }

    /// Most that a wall is moved [m].
    pub(crate) fn amplitude(&self) -> f64 {
        self.settings.amplitude
    }

    /// How far vertices of walls are to be from each other, as a part of the size of their body, cut `at_rest` or not.
    pub(crate) fn room_to_others(&self, at_rest: bool) -> f64 {
        self.shortest * if at_rest { APART_AT_REST } else { APART }
    }

    /// The place on a crack that is at `rest` [m]; none where there is no crack.
    pub(crate) fn place(&self, rest: Point) -> Option<OnCrack> {
        self.nearest(rest, |_| true)
    }

    /// The place nearest to `rest` [m] on a crack that passes there.
    pub(crate) fn place_on(&self, crack: usize, rest: Point) -> Option<OnCrack> {
        self.nearest(rest, |other| other == crack)
    }

    fn nearest(&self, rest: Point, is_meant: impl Fn(usize) -> bool) -> Option<OnCrack> {
        let place = |obstacle: &Obstacle| {
            let (crack, arc) = obstacle.along.filter(|(crack, _)| is_meant(*crack))?;
            let way = obstacle.ends[1] - obstacle.ends[0];
            let part = ((rest - obstacle.ends[0]).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            let distance = (obstacle.ends[0] + part * way - rest).norm();
            distance.is_finite().then_some((distance, (crack, arc + part * way.norm())))
        };
        self.near(rest).iter().filter_map(place).min_by(|p, q| p.0.total_cmp(&q.0)).map(|(_, place)| place)
    }

    /// The profile of the walls of the crack at `place`, which is at `rest` [m].
    pub(crate) fn profile(&self, place: OnCrack, rest: Point) -> Profile<'_> {
        let (path, step, arc) = (&self.paths[place.0], self.step(), place.1);
        let first = step * (arc / step).floor();
        // The path ends before the next place: at its end.
        let next = (first + step).min(path.length());
        let ends = [first, next].map(|arc| {
            let (here, normal) = path.at(arc, 0.5 * step);
            (here, self.room(here) * normal, normal)
        });
        let part = if next > first { (arc - first) / (next - first) } else { 0.0 };
        Profile { relief: self, ends, part, room: self.room(rest) }
    }

    fn near(&self, rest: Point) -> &[Obstacle] {
        self.obstacles.get(&self.bin_of(rest)).map(Vec::as_slice).unwrap_or_default()
    }

    /// What a wall at `rest` may move by [m].
    fn room(&self, rest: Point) -> f64 {
        let own = self.place(rest);
        let is_own = |obstacle: &Obstacle, distance: f64| {
            let (Some((crack, arc)), Some((other, from))) = (own, obstacle.along) else { return false };
            let to = from + (obstacle.ends[1] - obstacle.ends[0]).norm();
            let along = (from - arc).max(arc - to).max(0.0);
            crack == other && along <= WINDING * distance + 1e-6 * self.bin
        };
        let from_tip = |(tip, clear): &(Point, f64)| ROOM_AT_TIP * ((rest - tip).norm() - clear).max(0.0);
        let mut room = self.tips.iter().map(from_tip).fold(self.settings.amplitude, f64::min);
        for obstacle in self.near(rest) {
            let distance = distance_to_segment(rest, obstacle.ends[0], obstacle.ends[1]);
            if !is_own(obstacle, distance) {
                room = room.min(obstacle.room + ROOM * (distance - CLEAR * obstacle.clear).max(0.0));
            }
        }
        room
    }

    /// Adds an obstacle to the bins in and beside which it lies, in pieces no longer than these are wide.
    fn add(&mut self, ends: [Point; 2], room: f64, clear: f64, along: Option<(usize, f64)>) {
        if room >= self.settings.amplitude {
            return;
        }
        let way = ends[1] - ends[0];
        let pieces = (way.norm() / self.bin).ceil().max(1.0);
        for i in 0..pieces as usize {
            let [from, to] = [i as f64, i as f64 + 1.0].map(|k| k / pieces);
            let ends = [ends[0] + from * way, ends[0] + to * way];
            let along = along.map(|(crack, arc)| (crack, arc + from * way.norm()));
            let [p, q] = ends.map(|end| self.bin_of(end));
            let columns = p[0].min(q[0]).saturating_sub(1)..=p[0].max(q[0]).saturating_add(1);
            for column in columns {
                for row in p[1].min(q[1]).saturating_sub(1)..=p[1].max(q[1]).saturating_add(1) {
                    self.obstacles.entry([column, row]).or_default().push(Obstacle { ends, room, clear, along });
                }
            }
        }
    }

    fn bin_of(&self, place: Point) -> [i32; 2] {
        [place.x, place.y].map(|x| (x / self.bin).floor() as i32)
    }

    /// The vector d, each component of it from −1 to 1: value noise, drawn at the corners of cubes and blended between.
    fn direction(&self, rest: Point, z: f64) -> Vector {
        let component = |axis: u64| {
            let octave = |(i, weight): (usize, f64)| {
                let length = self.settings.length / (1 << i) as f64;
                let seed = [self.settings.seed, axis, i as u64].into_iter().fold(0, mixed);
                weight * value_noise([rest.x, rest.y, z].map(|x| x / length), seed)
            };
            WEIGHTS.into_iter().enumerate().map(octave).sum::<f64>()
        };
        Vector::new(component(0), component(1))
    }
}

impl Path {
    fn new(points: Vec<Point>) -> Self {
        let mut arcs = vec![0.0; points.len()];
        for i in 1..points.len() {
            arcs[i] = arcs[i - 1] + (points[i] - points[i - 1]).norm();
        }
        Self { points, arcs }
    }

    fn length(&self) -> f64 {
        self.arcs.last().copied().unwrap_or(0.0)
    }

    /// Where the path is after a length `arc`, and its normal to the left as it is between places so far off on both
    /// sides.
    fn at(&self, arc: f64, off: f64) -> (Point, Vector) {
        let place = |arc: f64| {
            let next = self.arcs.partition_point(|a| *a < arc).clamp(1, self.arcs.len() - 1);
            let length = self.arcs[next] - self.arcs[next - 1];
            let part = if length > 0.0 { ((arc - self.arcs[next - 1]) / length).clamp(0.0, 1.0) } else { 0.0 };
            self.points[next - 1] + part * (self.points[next] - self.points[next - 1])
        };
        let along = place(arc + off) - place(arc - off);
        (place(arc), Vector::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default())
    }
}

/// By how much a path may be moved across itself at the corner between two segments before one of them is gone: their
/// shorter length over the tangents of half the turn at both of its ends [m].
fn bend([before, here, after]: [Point; 3]) -> f64 {
    let (one, two) = (here - before, after - here);
    let turn = one.perp(&two).atan2(one.dot(&two)).abs();
    let length = one.norm().min(two.norm());
    if turn == 0.0 { f64::INFINITY } else { 0.5 * length / (0.5 * turn).tan() }
}

/// 3 t² − 2 t³.
fn smooth(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// Numbers from −1 to 1, one drawn for each place of whole coordinates, blended between.
fn value_noise(place: [f64; 3], seed: u64) -> f64 {
    let floor = place.map(f64::floor);
    let blend: [f64; 3] = std::array::from_fn(|i| smooth(place[i] - floor[i]));
    let mut sum = 0.0;
    for corner in 0..8_u64 {
        let offset: [u64; 3] = std::array::from_fn(|i| (corner >> i) & 1);
        let weights = (0..3).map(|i| if offset[i] == 1 { blend[i] } else { 1.0 - blend[i] });
        let at = (0..3).map(|i| (floor[i] as i64 as u64).wrapping_add(offset[i]));
        let drawn = at.fold(seed, mixed) >> 11;
        sum += weights.product::<f64>() * (drawn as f64 / (1_u64 << 52) as f64 - 1.0);
    }
    sum
}

/// `state` and `value` mixed: the step of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014, 453–472).
fn mixed(state: u64, value: u64) -> u64 {
    let mut z = (state ^ value).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
