//! Cracks while they live: where they run at rest, what their ends are, how far their tips have come.

pub(crate) mod assessment;
pub(crate) mod changes;
pub(crate) mod contact;
pub(crate) mod cracks;
pub(crate) mod crossing;
pub(crate) mod division;
pub(crate) mod fragments;
pub(crate) mod guide;
pub(crate) mod split;
pub(crate) mod tip;

use crate::crack::cracks::{ENDS, TipId};
use crate::crack::division::{CrackLine, LineEnd};
use crate::crack::guide::GuideWalk;
use crate::crack::tip::Tip;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector, bounds, polyline_length};
use fissure_scene::{CrackEnd, End, Formed, Scene, TipRecord};
use serde::{Deserialize, Serialize};

/// A crack. All positions are at rest; a solver knows where they are now.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Crack {
    /// Body it runs in.
    pub(crate) body: u32,
    /// Points from start to end [m].
    pub(crate) points: Vec<Point>,
    /// How each point came about; none for those that were reached since cracks were dated last.
    formed: Vec<Option<Formed>>,
    /// What the first and the last point are.
    ends: [CrackEnd; 2],
    /// How each end is on its way.
    ways: [Way; 2],
    /// The tips at the first and the last point; none where the drawing has no live tip.
    tips: [Option<Tip>; 2],
    /// Whether its tips run across other cracks.
    pub(crate) crosses: bool,
    /// Corners of a box around all its points [m].
    bounds: [Point; 2],
}

/// How an end of a crack is on its way through an increment.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Way {
    /// Where the end was when lines were last cut for it; it may have moved on since. None before a point was added.
    cut_at: Option<Point>,
    /// Where the increment ends; none between increments.
    target: Option<Point>,
}

/// A polyline with no segment longer than `longest` [m]; its own points stay. The faces of a crack are known at its
/// points only.
fn subdivided(points: &[Point], longest: f64) -> Vec<Point> {
    let mut result = vec![points[0]];
    for w in points.windows(2) {
        // A segment of just the length asked for is not split for its last bit.
        let pieces = ((w[1] - w[0]).norm() / longest - 1e-9).ceil().max(1.0) as usize;
        result.extend((1..pieces).map(|k| w[0] + (w[1] - w[0]) * (k as f64 / pieces as f64)));
        result.push(w[1]);
    }
    result
}

/// Position in a pair [start, end].
fn slot(end: End) -> usize {
    match end {
        End::Start => 0,
        End::End => 1,
    }
}

/// Length of the chord that gives the direction of a crack at its tip, in cells: as long as the smallest radius of an
/// integral.
pub(crate) const DIRECTION_LENGTH: f64 = 2.0;

/// A turn at a point of a crack by more than this is a kink [rad]: over it the energy of a field along the crack is no
/// longer that of one direction. Growth in quarter cells along a smooth path turns by less.
pub(crate) const KINK: f64 = 0.26;

/// Whether a crack that goes `before` and then `after` has a kink between the two.
pub(crate) fn is_kink(before: Vector, after: Vector) -> bool {
    let (sine, cosine) = (before.perp(&after), before.dot(&after));
    // As most turns are; a tangent is larger than its angle.
    if sine.abs() < KINK * cosine {
        return false;
    }
    sine.atan2(cosine).abs() > KINK
}

/// A branch shorter than this part of the chord is too short to have a field of its own that could be measured.
const SHORTEST_BRANCH: f64 = 0.124;

/// The place on a polyline at the arc length `over` [m] from one end, or its other end when it is shorter.
pub(crate) fn chord_start(points: &[Point], end: End, over: f64) -> Point {
    let n = points.len();
    let at = |k: usize| match end {
        End::Start => points[k],
        End::End => points[n - 1 - k],
    };
    let mut left = over;
    for k in 1..n {
        let length = (at(k) - at(k - 1)).norm();
        if left <= length {
            return at(k - 1) + (at(k) - at(k - 1)) * (left / length);
        }
        left -= length;
    }
    at(n - 1)
}

/// The direction to the left of a polyline at its point number `k`, at a vertex midway between those of both segments:
/// on the left of both, however sharp the turn. Unit vector; zero where nothing has a length.
pub(crate) fn left_at(points: &[Point], k: usize) -> Vector {
    let along = |from: usize| (points[from + 1] - points[from]).try_normalize(0.0).unwrap_or_default();
    let before = if k > 0 { along(k - 1) } else { Vector::zeros() };
    let after = if k + 1 < points.len() { along(k) } else { Vector::zeros() };
    let tangent = (before + after).try_normalize(0.0).unwrap_or_default();
    Vector::new(-tangent.y, tangent.x)
}

impl Crack {
    /// The crack of a scene at its beginning.
    fn drawn(scene: &Scene, crack: &fissure_scene::Crack) -> Self {
        let region = &scene.bodies[crack.body].region;
        let tolerance = 1e-6 * scene.cell_size;
        let is_other = |other: &&fissure_scene::Crack| other.body == crack.body && other.name != crack.name;
        let end_at = |p: Point| {
            let on_ring = region.distance_to_rings(p) <= tolerance;
            if on_ring || !region.contains(p) {
                return CrackEnd::Mouth;
            }
            let trunk = scene.cracks.iter().position(|other| is_other(&other) && other.points.contains(&p));
            trunk.map_or(CrackEnd::Tip, |trunk| CrackEnd::Junction { crack: trunk as u32 })
        };
        let ends = [end_at(crack.points[0]), end_at(crack.points[crack.points.len() - 1])];
        let tip = |end: End, live: bool| {
            (live && ends[slot(end)] == CrackEnd::Tip)
                .then(|| Tip::new(crack.guide(end).map(|guide| GuideWalk::new(guide, 0.0))))
        };
        let points = subdivided(&crack.points, 0.5 * scene.cell_size);
        Self {
            body: crack.body as u32,
            bounds: bounds(&points).into(),
            formed: vec![Some(Formed::default()); points.len()],
            points,
            ends,
            ways: [Way::default(); 2],
            tips: [tip(End::Start, crack.start_live), tip(End::End, crack.end_live)],
            crosses: crack.crosses,
        }
    }

    /// A branch of this crack, which has the number `number`, that begins at it, with a tip at its end.
    pub(crate) fn branch(&self, number: usize, points: Vec<Point>, tip: Tip) -> Self {
        let ends = [CrackEnd::Junction { crack: number as u32 }, CrackEnd::Tip];
        let (body, crosses) = (self.body, self.crosses);
        let (bounds, formed) = (bounds(&points).into(), vec![None; points.len()]);
        Self { body, points, formed, ends, ways: [Way::default(); 2], tips: [None, Some(tip)], crosses, bounds }
    }

    /// The tip at an end; none where the drawing has no live tip.
    pub(crate) fn tip(&self, end: End) -> Option<&Tip> {
        self.tips[slot(end)].as_ref()
    }

    fn tip_mut(&mut self, end: End) -> Option<&mut Tip> {
        self.tips[slot(end)].as_mut()
    }

    fn tips_mut(&mut self) -> impl Iterator<Item = &mut Tip> {
        self.tips.iter_mut().flatten()
    }

    /// What is at an end: a tip, a mouth, another crack.
    pub(crate) fn end(&self, end: End) -> CrackEnd {
        self.ends[slot(end)]
    }

    fn set_end(&mut self, end: End, kind: CrackEnd) {
        self.ends[slot(end)] = kind;
    }

    /// Whether the crack begins or ends on the crack number `other`.
    pub(crate) fn is_joined_to(&self, other: usize) -> bool {
        self.ends.contains(&CrackEnd::Junction { crack: other as u32 })
    }

    /// Checks a crack that was read, one of `count`, against its scene.
    ///
    /// # Errors
    /// [`SimulationError::BadState`]
    pub(crate) fn check(&self, scene: &Scene, count: usize) -> Fits {
        saved::below("a crack", [self.body], scene.bodies.len())?;
        let (low, high) = scene.bodies[self.body as usize].region.bounds();
        // A mouth may stick out by rounding.
        let margin = Vector::repeat(scene.cell_size);
        let is_inside = |p: &Point| *p >= low - margin && *p <= high + margin;
        let has_length = self.points.len() >= 2 && self.points.windows(2).all(|w| w[0] != w[1]);
        let is_held = |p: &Point| *p >= self.bounds[0] && *p <= self.bounds[1];
        let fits = |p: &Point| is_inside(p) && is_held(p);
        saved::ensure(has_length && self.points.iter().all(fits), "the line of a crack")?;
        saved::ensure(self.formed.len() == self.points.len(), "the age of a crack")?;
        saved::finite("the age of a crack", self.formed.iter().flatten().flat_map(|f| [&f.time, &f.mode_1]))?;
        let trunk = |end: &CrackEnd| if let CrackEnd::Junction { crack } = end { Some(*crack) } else { None };
        saved::below("the end of a crack", self.ends.iter().filter_map(trunk), count)?;
        let mut places = self.ways.iter().flat_map(|way| way.cut_at.iter().chain(&way.target));
        saved::ensure(places.all(is_inside), "the place of a tip")?;
        self.tips.iter().flatten().try_for_each(|tip| tip.check(count))
    }

    /// The points as lines were last cut for them. A tip on its way through an increment is where it was at the
    /// beginning of it: were what is cut anew for other cracks cut for the tip as it is now, nodes at the edge of what
    /// is cut anew would be split by halves.
    pub(crate) fn points_as_cut(&self) -> Vec<Point> {
        let mut points = self.points.clone();
        let last = points.len() - 1;
        [points[0], points[last]] = self.ends_as_cut();
        points
    }

    /// The first and the last of [`Crack::points_as_cut`].
    pub(crate) fn ends_as_cut(&self) -> [Point; 2] {
        ENDS.map(|end| match (self.end(end), self.ways[slot(end)].cut_at) {
            (CrackEnd::Tip, Some(place)) => place,
            _ => self.tip_position(end),
        })
    }

    /// Position of an end at rest [m].
    pub(crate) fn tip_position(&self, end: End) -> Point {
        match end {
            End::Start => self.points[0],
            End::End => self.points[self.points.len() - 1],
        }
    }

    /// The last points at an end, from it backwards, at most so many.
    pub(crate) fn last_points(&self, end: End, count: usize) -> Vec<Point> {
        match end {
            End::Start => self.points.iter().take(count).copied().collect(),
            End::End => self.points.iter().rev().take(count).copied().collect(),
        }
    }

    /// The last point at an end that stays where it is [m]: that of the end itself between increments.
    pub(crate) fn fixed_point(&self, end: End) -> Point {
        let on_its_way = usize::from(self.ways[slot(end)].target.is_some());
        self.points[if end == End::Start { on_its_way } else { self.points.len() - 1 - on_its_way }]
    }

    /// Unit vector of the last segment at rest, pointing ahead of the end.
    pub(crate) fn last_direction(&self, end: End) -> Vector {
        let n = self.points.len();
        match end {
            End::Start => (self.points[0] - self.points[1]).normalize(),
            End::End => (self.points[n - 1] - self.points[n - 2]).normalize(),
        }
    }

    /// Adds a point at an end, for which lines will be cut.
    fn push(&mut self, end: End, point: Point) {
        let at = if end == End::Start { 0 } else { self.points.len() };
        self.points.insert(at, point);
        self.formed.insert(at, None);
        self.ways[slot(end)].cut_at = Some(point);
        self.reach_to(point);
    }

    /// Makes the box around the points hold another one.
    fn reach_to(&mut self, point: Point) {
        let [low, high] = self.bounds;
        self.bounds = [low.inf(&point), high.sup(&point)];
    }

    /// A distance [m] that no point of the crack is nearer to `place` than.
    pub(crate) fn least_distance(&self, place: Point) -> f64 {
        let [low, high] = self.bounds;
        (low - place).sup(&(place - high)).sup(&Vector::zeros()).norm()
    }

    /// Whether the way from `from` to `to` comes into the box around the crack; it meets none of it otherwise.
    pub(crate) fn may_meet(&self, from: Point, to: Point) -> bool {
        let [low, high] = self.bounds;
        from.inf(&to) <= high && from.sup(&to) >= low
    }

    /// What is left of the increment that an end is on its way through [m]; none between increments.
    fn left_of_increment(&self, end: End) -> Option<f64> {
        self.ways[slot(end)].target.map(|target| (target - self.tip_position(end)).norm())
    }

    /// Moves the point of an end on by `distance` [m] along its increment, whose end it reaches when no more is left.
    fn slide(&mut self, end: End, distance: f64) {
        let Some(target) = self.ways[slot(end)].target else { return };
        let (from, last) = (self.tip_position(end), self.points.len() - 1);
        let left = (target - from).norm();
        let at = if end == End::Start { 0 } else { last };
        self.formed[at] = None;
        let place = &mut self.points[at];
        if distance >= left {
            *place = target;
            self.ways[slot(end)].target = None;
        } else {
            *place = from + (target - from) * (distance / left);
        }
        let place = *place;
        self.reach_to(place);
    }

    /// Says of the points that its tips have reached since this was called last that they came about at `time` [s], by
    /// the K_I that was measured last.
    pub(crate) fn date(&mut self, time: f64) {
        let count = self.points.len();
        for (tip, end) in self.tips.iter().zip(ENDS) {
            let Some(tip) = tip else { continue };
            let mode_1 = Some(tip.assessment.mode_1).filter(|mode_1| mode_1.is_finite()).unwrap_or_default();
            let at = |k: usize| if end == End::Start { k } else { count - 1 - k };
            for k in (0..count).map(at) {
                if self.formed[k].is_some() {
                    break;
                }
                self.formed[k] = Some(Formed { time, mode_1 });
            }
        }
    }

    /// How each of its points came about.
    pub(crate) fn formed(&self) -> Vec<Formed> {
        self.formed.iter().map(|formed| formed.unwrap_or_default()).collect()
    }

    /// Length at rest [m].
    pub(crate) fn length(&self) -> f64 {
        polyline_length(&self.points)
    }

    /// Number of tips that may grow.
    pub(crate) fn live_tips(&self) -> usize {
        self.tips.iter().flatten().filter(|t| t.state.is_live()).count()
    }

    /// The crack as the division sees it, its points being at `points` (rest or current); open ends go `beyond` [m]
    /// farther.
    pub(crate) fn line(&self, crack: usize, points: Vec<Point>, beyond: f64) -> CrackLine {
        let [start, end] = self.line_ends(beyond);
        CrackLine { crack: crack as u32, points, start, end, trunk: Vec::new() }
    }

    /// Its ends as the division sees them; open ones go `beyond` [m] farther.
    pub(crate) fn line_ends(&self, beyond: f64) -> [LineEnd; 2] {
        self.ends.map(|end| match end {
            CrackEnd::Tip => LineEnd::Tip,
            CrackEnd::Mouth => LineEnd::Open(beyond),
            CrackEnd::Junction { crack } => LineEnd::Junction { crack, beyond },
        })
    }

    /// The record of a tip for a frame; `position` [m] and `direction` [rad] are the current ones, `interval` [s] the
    /// time since the last frame.
    pub(crate) fn record(&self, id: TipId, position: Point, direction: f64, interval: f64) -> Option<TipRecord> {
        let tip = self.tip(id.end)?;
        let m = tip.assessment;
        let speed = if interval > 0.0 { (tip.run() - tip.run_at_frame) / interval } else { 0.0 };
        Some(TipRecord {
            crack: id.crack as u32,
            end: id.end,
            state: tip.state,
            position,
            direction,
            j_integral: m.j_integral,
            mode_1: m.mode_1,
            mode_2: m.mode_2,
            kink_angle: m.kink_angle,
            equivalent: m.equivalent,
            fracture_toughness: m.fracture_toughness,
            speed,
            length: self.length(),
            contour_radius: m.contour_radius,
            radius_shrunk: m.radius_shrunk,
        })
    }
}
