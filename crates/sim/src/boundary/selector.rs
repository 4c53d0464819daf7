//! Which places of the bodies a selection means.

use fissure_plane::{Point, Region, Vector, bounds};
use fissure_scene::{BoxSide, OutlineStretch, Scene, Selection};

/// A selection in a scene, ready to be asked for many places.
#[derive(Debug, Clone)]
pub(crate) enum Selector<'s> {
    /// Everything.
    All,
    /// Bodies, whole.
    Bodies(&'s [usize]),
    /// Places in a region, its edges to within the slack [m] included.
    Region { region: &'s Region, slack: f64 },
    /// Places near to points.
    Near { points: &'s [Point], radius: f64 },
    /// An edge: one side of the box around bodies.
    Side(Side<'s>),
    /// An edge: stretches of outlines.
    Outline(&'s [OutlineStretch]),
}

/// One side of the box around `bodies` (or around all).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side<'s> {
    bodies: Option<&'s [usize]>,
    side: BoxSide,
    /// Its x or y [m].
    at: f64,
}

impl<'s> Selector<'s> {
    /// The selector of a selection in `scene`.
    pub(crate) fn new(scene: &Scene, selection: &'s Selection) -> Self {
        match selection {
            Selection::All => Self::All,
            Selection::Bodies(bodies) => Self::Bodies(bodies),
            Selection::Region(region) => {
                let (low, high) = region.bounds();
                Self::Region { region, slack: 1e-9 * (high - low).norm() }
            }
            Selection::Near { points, radius } => Self::Near { points, radius: *radius },
            Selection::Edge { side, bodies } => Self::Side(Side::of(scene, *side, bodies.as_deref())),
            Selection::Outline(stretches) => Self::Outline(stretches),
        }
    }

    /// Whether a place of a body at rest is meant. Of an edge: whether it is less than `inside` deep in the material,
    /// or at most `outside` beyond the edge [m]; a side of a box goes on outside without end.
    pub(crate) fn selects(&self, place: Point, body: usize, inside: f64, outside: f64) -> bool {
        match self {
            Self::All => true,
            Self::Bodies(bodies) => bodies.contains(&body),
            Self::Region { region, slack } => region.contains(place) || region.distance_to_rings(place) <= *slack,
            Self::Near { points, radius } => points.iter().any(|q| (place - q).norm() <= *radius),
            Self::Side(side) => {
                let depth = side.depth(place);
                side.is_of(body) && (depth < inside || depth <= 0.0)
            }
            Self::Outline(stretches) => along(stretches, place, body, inside, outside),
        }
    }

    /// The pieces of the outlines that are selected: of an edge its own, of other selections those that lie in them.
    pub(crate) fn pieces(&self, scene: &Scene) -> Vec<OutlineStretch> {
        if let Self::Outline(stretches) = self {
            return stretches.to_vec();
        }
        let slack = 1e-6 * scene.cell_size;
        edges(scene).filter(|edge| self.has_piece(edge.body, [edge.from, edge.to], slack)).collect()
    }

    /// The parts of the outlines that lie in a region, however it cuts them; the pieces of other selections.
    pub(crate) fn parts(&self, scene: &Scene) -> Vec<OutlineStretch> {
        let Self::Region { region, .. } = self else { return self.pieces(scene) };
        let slack = 1e-6 * scene.cell_size;
        let (low, high) = region.bounds();
        let reach = Vector::repeat(slack);
        let mut parts = Vec::new();
        for edge in edges(scene) {
            let (a, b) = (edge.from, edge.to);
            if a.sup(&b) < low - reach || a.inf(&b) > high + reach {
                continue;
            }
            let mut cuts = vec![0.0, 1.0];
            for ring in region.rings() {
                cuts.extend((0..ring.len()).filter_map(|k| meeting(a, b, ring[k], ring[(k + 1) % ring.len()])));
            }
            cuts.sort_unstable_by(f64::total_cmp);
            for cut in cuts.windows(2).filter(|cut| (cut[1] - cut[0]) * (b - a).norm() > slack) {
                let at = |t: f64| if t == 1.0 { b } else { a + (b - a) * t };
                let middle = at(0.5 * (cut[0] + cut[1]));
                if region.contains(middle) || region.distance_to_rings(middle) <= slack {
                    parts.push(OutlineStretch { from: at(cut[0]), to: at(cut[1]), ..edge });
                }
            }
        }
        parts
    }

    /// Whether the piece from `a` to `b` of a ring of `body` is selected, to within `slack` [m].
    fn has_piece(&self, body: usize, [a, b]: [Point; 2], slack: f64) -> bool {
        let within = |p: Point| match self {
            Self::Side(side) => side.is_of(body) && side.depth(p).abs() <= slack,
            Self::Region { region, .. } => region.contains(p) || region.distance_to_rings(p) <= slack,
            Self::Near { points, radius } => points.iter().any(|q| (p - q).norm() <= radius + slack),
            Self::All | Self::Bodies(_) | Self::Outline(_) => self.selects(p, body, 0.0, slack),
        };
        [a, nalgebra::center(&a, &b), b].into_iter().all(within)
    }
}

impl<'s> Side<'s> {
    fn of(scene: &Scene, side: BoxSide, bodies: Option<&'s [usize]>) -> Self {
        let (mut low, mut high) = bounds(&[]);
        for (index, body) in scene.bodies.iter().enumerate() {
            if bodies.is_none_or(|of| of.contains(&index)) {
                let (l, h) = body.region.bounds();
                (low, high) = (low.inf(&l), high.sup(&h));
            }
        }
        let at = match side {
            BoxSide::Left => low.x,
            BoxSide::Right => high.x,
            BoxSide::Bottom => low.y,
            BoxSide::Top => high.y,
        };
        Self { bodies, side, at }
    }

    fn is_of(&self, body: usize) -> bool {
        self.bodies.is_none_or(|of| of.contains(&body))
    }

    /// Distance from the side into the box [m], negative outside.
    fn depth(&self, point: Point) -> f64 {
        match self.side {
            BoxSide::Left => point.x - self.at,
            BoxSide::Right => self.at - point.x,
            BoxSide::Bottom => point.y - self.at,
            BoxSide::Top => self.at - point.y,
        }
    }
}

/// All edges of the outlines.
fn edges(scene: &Scene) -> impl Iterator<Item = OutlineStretch> {
    scene.bodies.iter().enumerate().flat_map(|(body, of)| {
        of.region.rings().flat_map(move |ring| {
            (0..ring.len()).map(move |k| OutlineStretch { body, from: ring[k], to: ring[(k + 1) % ring.len()] })
        })
    })
}

/// Where on the way from `a` to `b`, as a part of it, the line from `c` to `d` is met.
fn meeting(a: Point, b: Point, c: Point, d: Point) -> Option<f64> {
    let (way, other) = (b - a, d - c);
    let turn = way.perp(&other);
    let (t, u) = ((c - a).perp(&other) / turn, (c - a).perp(&way) / turn);
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u)).then_some(t)
}

/// Whether a place lies beside one of the stretches, or around the corner of two that follow on each other.
fn along(stretches: &[OutlineStretch], place: Point, body: usize, inside: f64, outside: f64) -> bool {
    (0..stretches.len()).any(|i| {
        let stretch = &stretches[i];
        if stretch.body != body {
            return false;
        }
        let (way, arm) = (stretch.to - stretch.from, place - stretch.from);
        let length = way.norm();
        let direction = way / length;
        let (depth, along) = (Vector::new(-direction.y, direction.x).dot(&arm), direction.dot(&arm));
        let reaches = |distance: f64| if depth > 0.0 { distance < inside } else { distance <= outside };
        if (-1e-9 * length..=(1.0 + 1e-9) * length).contains(&along) {
            return reaches(depth.abs());
        }
        let next = &stretches[(i + 1) % stretches.len()];
        along > length && next.from == stretch.to && reaches((place - stretch.to).norm())
    })
}
