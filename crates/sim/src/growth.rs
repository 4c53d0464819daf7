//! When and where a crack grows, and how it ends.
//!
//! A tip advances by one increment whenever K_eq(θ) reaches the toughness, amplitude from J. With the area term J is the energy release rate of the
//! moving tip, so the speed follows from the energy balance by itself; a cap keeps it below a fraction of c_R. Direction: maximum hoop
//! stress, or along a guide. Close to a ring or another crack the tip goes the rest of the way at once and ends exactly there.

use crate::crack::{Crack, Measured, slot};
use fissure_scene::{CrackEnd, End, Point, Scene, TipState, Vector, orientation, segments_touch};

/// A ligament of less than this many cells breaks at once: no integral can be taken in it.
const LAST_LIGAMENT: f64 = 1.5;

/// What one tip does.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Advance {
    /// New points, in the order they are reached [m].
    pub(crate) points: Vec<Point>,
    /// What the new end is.
    pub(crate) end: CrackEnd,
    /// State of the tip afterwards.
    pub(crate) state: TipState,
}

impl Advance {
    /// Length added [m].
    pub(crate) fn length(&self, from: Point) -> f64 {
        let mut last = from;
        let mut length = 0.0;
        for &p in &self.points {
            length += (p - last).norm();
            last = p;
        }
        length
    }
}

/// Whether a tip grows, given what was measured.
pub(crate) fn wants_to_grow(crack: &Crack, end: End, measured: &Measured, scene: &Scene) -> bool {
    let Some(tip) = &crack.tips[slot(end)] else { return false };
    if !scene.growth.enabled || !tip.state.is_live() {
        return false;
    }
    // NaN compares false: nothing known, no growth.
    let needed = measured.fracture_toughness;
    direction(crack, end, measured, scene).is_some_and(|(_, equivalent)| equivalent >= needed && needed > 0.0)
}

/// Kink angle [rad] and K_eq for it; along the guide when there is one. None: the guide has ended.
fn direction(crack: &Crack, end: End, measured: &Measured, scene: &Scene) -> Option<(f64, f64)> {
    let tip = crack.tips[slot(end)].as_ref()?;
    let Some(guide) = &tip.guide else { return Some((measured.kink_angle, measured.equivalent)) };
    let position = crack.tip_position(end);
    let (target, _) = guide.ahead(scene.growth.increment * scene.cell_size);
    let to = target - position;
    if to.norm() <= 1e-9 * scene.cell_size {
        return None;
    }
    let ahead = crack.ahead(end, crate::crack::DIRECTION_LENGTH * scene.cell_size);
    let angle = ahead.perp(&to).atan2(ahead.dot(&to));
    let split = crate::StressIntensity { mode_1: measured.mode_1.max(0.0), mode_2: measured.mode_2 };
    // The amplitude of J, the ratio of the modes.
    let own = split.equivalent(split.kink_angle(1.0));
    let scale = if own > 0.0 { measured.equivalent / own } else { 0.0 };
    Some((angle, split.equivalent(angle) * scale))
}

/// The direction that the stress asks for now: unit vector, at rest.
fn asked(crack: &Crack, end: End, measured: &Measured, scene: &Scene) -> Vector {
    let ahead = crack.ahead(end, crate::crack::DIRECTION_LENGTH * scene.cell_size);
    let (sine, cosine) = measured.kink_angle.sin_cos();
    Vector::new(cosine * ahead.x - sine * ahead.y, sine * ahead.x + cosine * ahead.y)
}

/// The heading of a tip after one more measurement, `time_step` [s] after the last one.
///
/// Every increment sends out waves, and the ratio of the modes swings with them at a period that is the lattice's, not the body's. A running tip follows
/// the mean over the time that a shear wave takes for [`HEADING_CELLS`]; a resting one has no waves of its own and starts as the stress is.
pub(crate) fn heading(
    crack: &Crack,
    end: End,
    measured: &Measured,
    scene: &Scene,
    elastic: &[crate::Elastic],
    time_step: f64,
) -> Vector {
    let now = asked(crack, end, measured, scene);
    let Some(tip) = &crack.tips[slot(end)] else { return now };
    if tip.state != TipState::Growing || tip.heading == Vector::zeros() {
        return now;
    }
    let slowest = elastic.iter().map(crate::Elastic::shear_wave_speed).fold(f64::INFINITY, f64::min);
    let window = HEADING_CELLS * scene.cell_size / slowest;
    tip.heading + (now - tip.heading) * (1.0 - (-time_step / window).exp())
}

/// Distance over which the heading is averaged, in cells.
const HEADING_CELLS: f64 = 2.0;

/// The next increment of a tip that wants to grow.
pub(crate) fn advance(cracks: &[Crack], index: usize, end: End, measured: &Measured, scene: &Scene) -> Option<Advance> {
    let crack = &cracks[index];
    let tip = crack.tips[slot(end)].as_ref()?;
    let h = scene.cell_size;
    let step = scene.growth.increment * h;
    let from = crack.tip_position(end);
    let region = &scene.bodies[crack.body as usize].region;
    if let Some(guide) = &tip.guide {
        // Along the guide, looking a ligament ahead.
        let (target, ended) = guide.ahead(step);
        let mut points = vec![target];
        let mut last = from;
        let pieces = (LAST_LIGAMENT / scene.growth.increment).ceil() as usize;
        for piece in 1..=pieces + 1 {
            let (next, _) = guide.ahead(step * piece as f64);
            if let Some(hit) = first_obstacle(cracks, index, end, region, last, next) {
                points.truncate(0);
                points.extend((1..piece).map(|k| guide.ahead(step * k as f64).0));
                return Some(hit.finish(points, from));
            }
            last = next;
        }
        if (target - from).norm() <= 1e-9 * h {
            return Some(Advance { points: Vec::new(), end: CrackEnd::Tip, state: TipState::GuideEnded });
        }
        points.dedup();
        let state = if ended { TipState::GuideEnded } else { TipState::Growing };
        return Some(Advance { points, end: CrackEnd::Tip, state });
    }
    let toward = tip.heading.try_normalize(0.0).unwrap_or_else(|| asked(crack, end, measured, scene));
    if let Some(hit) = first_obstacle(cracks, index, end, region, from, from + toward * (step + LAST_LIGAMENT * h)) {
        return Some(hit.finish(Vec::new(), from));
    }
    Some(Advance { points: vec![from + toward * step], end: CrackEnd::Tip, state: TipState::Growing })
}

#[derive(Debug, Clone, Copy)]
struct Obstacle {
    at: Point,
    end: CrackEnd,
}

impl Obstacle {
    fn finish(self, mut points: Vec<Point>, from: Point) -> Advance {
        let last = points.last().copied().unwrap_or(from);
        if (self.at - last).norm() > 0.0 {
            points.push(self.at);
        }
        let state = match self.end {
            CrackEnd::Junction { .. } => TipState::MetCrack,
            _ => TipState::LeftBody,
        };
        Advance { points, end: self.end, state }
    }
}

/// The first ring or crack on the way from `from` to `to`.
fn first_obstacle(
    cracks: &[Crack],
    index: usize,
    end: End,
    region: &fissure_scene::Region,
    from: Point,
    to: Point,
) -> Option<Obstacle> {
    let mut nearest: Option<(f64, Obstacle)> = None;
    let mut consider = |a: Point, b: Point, what: CrackEnd| {
        if let Some((t, at)) = intersection(from, to, a, b)
            && nearest.is_none_or(|n| t < n.0)
        {
            nearest = Some((t, Obstacle { at, end: what }));
        }
    };
    for ring in region.rings() {
        for i in 0..ring.len() {
            consider(ring[i], ring[(i + 1) % ring.len()], CrackEnd::Mouth);
        }
    }
    for (other, crack) in cracks.iter().enumerate() {
        if crack.body != cracks[index].body {
            continue;
        }
        let n = crack.points.len();
        for k in 1..n {
            // Not the segment the tip itself stands on.
            let own = other == index && if end == End::End { k + 1 == n } else { k == 1 };
            if !own {
                consider(crack.points[k - 1], crack.points[k], CrackEnd::Junction { crack: other as u32 });
            }
        }
    }
    nearest.map(|n| n.1)
}

/// Where the way from `p` to `q` meets the segment `a`–`b`: (fraction of the way, place), the start of the way left out.
fn intersection(p: Point, q: Point, a: Point, b: Point) -> Option<(f64, Point)> {
    if p == q || !segments_touch(p, q, a, b) {
        return None;
    }
    let (at_a, at_b) = (orientation(p, q, a), orientation(p, q, b));
    let span = at_a - at_b;
    let at = if span == 0.0 {
        // Along the same line: the nearer end of the segment.
        if (a - p).norm_squared() < (b - p).norm_squared() { a } else { b }
    } else {
        a + (b - a) * (at_a / span)
    };
    let way = q - p;
    let t = (at - p).dot(&way) / way.norm_squared();
    (t > 1e-9).then_some((t, at))
}

/// Lowest speed limit for a tip in m/s: the cap is a fraction of the Rayleigh wave speed of the slowest material.
pub(crate) fn speed_limit(scene: &Scene, elastic: &[crate::Elastic]) -> f64 {
    let slowest = elastic.iter().map(crate::Elastic::rayleigh_wave_speed).fold(f64::INFINITY, f64::min);
    scene.growth.speed_limit * slowest
}
