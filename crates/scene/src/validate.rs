//! What a scene must fulfil to be simulated. Every range is written here, once.

use crate::document::PolygonKeys;
use crate::fault::{KeyPath, SceneFault, short, show};
use crate::geometry::{Point, Region, Vector, bounds, orientation, polyline_length, segments_touch, signed_area};
use crate::outline::{find_crossing, nearest_on_rings, nearest_on_segment};
use crate::scene::*;
use geo::{Area, BooleanOps};

type Check = Result<(), SceneFault>;

/// A range of numbers and the words for it.
#[derive(Clone, Copy)]
struct Range {
    holds: fn(f64) -> bool,
    words: &'static str,
}

const POSITIVE: Range = Range { holds: |v| v > 0.0 && v.is_finite(), words: "a finite number above 0" };
const NOT_NEGATIVE: Range = Range { holds: |v| v >= 0.0 && v.is_finite(), words: "a finite number of at least 0" };
const FRICTION: Range = Range { holds: |v| v >= 0.0, words: "at least 0 (inf: stick)" };
const FINITE: Range = Range { holds: f64::is_finite, words: "finite" };
const FRACTION: Range = Range { holds: |v| v > 0.0 && v <= 1.0, words: "above 0 and at most 1" };
const UNIT: Range = Range { holds: |v| (0.0..=1.0).contains(&v), words: "from 0 to 1" };
const POISSON: Range = Range { holds: |v| v > -1.0 && v < 0.5, words: "above -1 and below 0.5" };
const BELOW_ONE: Range = Range { holds: |v| v > 0.0 && v < 1.0, words: "above 0 and below 1" };

/// Most particles along the larger side of a body: beyond it a spacing is a slip of the pen.
const MOST_ALONG_A_SIDE: f64 = 1e5;

impl Range {
    fn check(self, path: KeyPath, what: &str, value: f64) -> Check {
        if (self.holds)(value) {
            return Ok(());
        }
        Err(SceneFault::new(path, format!("{what} is {value}"), format!("it must be {}", self.words)))
    }
}

/// That both components are finite.
pub(crate) fn finite_pair(path: KeyPath, what: &str, value: [f64; 2]) -> Check {
    value.into_iter().try_for_each(|v| FINITE.check(path.clone(), what, v))
}

/// That all points are finite.
pub(crate) fn finite_points(path: &KeyPath, what: &str, points: &[Point]) -> Check {
    points.iter().try_for_each(|p| finite_pair(path.clone(), what, [p.x, p.y]))
}

/// That a scale is above 0.
pub(crate) fn positive(path: KeyPath, what: &str, value: f64) -> Check {
    POSITIVE.check(path, what, value)
}

/// That an inline polygon has corners to make rings of.
pub(crate) fn enough_corners(path: &KeyPath, polygon: &PolygonKeys) -> Check {
    std::iter::once(&polygon.exterior).chain(&polygon.holes).find(|ring| ring.len() < 3).map_or(Ok(()), |ring| {
        Err(SceneFault::new(
            path.clone(),
            format!("a ring has {} corners", ring.len()),
            "a ring needs at least 3 corners",
        ))
    })
}

impl Scene {
    /// Checks that every number is finite and in its range, every index exists, and the geometry is simple, oriented
    /// and inside of what it belongs to. [`crate::load`] gives scenes that pass; scenes made in code should call it too.
    ///
    /// Paths of faults count items as in this scene.
    ///
    /// # Errors
    /// The first fault found.
    pub fn validate(&self) -> Check {
        let gravity = self.gravity;
        finite_pair(KeyPath::top("gravity"), "gravity", [gravity.x, gravity.y])?;
        self.validate_materials()?;
        self.validate_bodies()?;
        self.validate_resolution()?;
        self.validate_settings()?;
        self.colliders.iter().enumerate().try_for_each(|(i, c)| validate_collider(&KeyPath::item("collider", i), c))?;
        self.loads.iter().enumerate().try_for_each(|(i, l)| self.validate_load(&KeyPath::item("load", i), l))?;
        self.supports
            .iter()
            .enumerate()
            .try_for_each(|(i, s)| self.validate_support(&KeyPath::item("support", i), s))?;
        self.validate_cracks()
    }

    fn validate_materials(&self) -> Check {
        for (i, m) in self.materials.iter().enumerate() {
            let path = KeyPath::item("material", i);
            let check = |key: &str, words: &str, range: Range, value: f64| {
                range.check(path.then(key), &format!("{words} of material `{}`", m.name), value)
            };
            check("young_modulus", "Young's modulus", POSITIVE, m.young_modulus)?;
            check("poisson_ratio", "Poisson's ratio", POISSON, m.poisson_ratio)?;
            check("density", "density", POSITIVE, m.density)?;
            check("fracture_toughness", "fracture toughness", POSITIVE, m.fracture_toughness)?;
            if let Some(speed) = m.limiting_speed {
                check("limiting_speed", "the highest crack speed", POSITIVE, speed)?;
            }
            if let Some(p) = m.plasticity {
                check("plasticity", "critical compression", BELOW_ONE, p.critical_compression)?;
                check("plasticity", "critical stretch", POSITIVE, p.critical_stretch)?;
                check("plasticity", "hardening", NOT_NEGATIVE, p.hardening)?;
            }
        }
        Ok(())
    }

    fn validate_bodies(&self) -> Check {
        if self.bodies.is_empty() {
            return Err(SceneFault::new(KeyPath::top("body"), "the scene has no body", "add a `[[body]]`"));
        }
        for (i, body) in self.bodies.iter().enumerate() {
            let path = KeyPath::item("body", i);
            unique_name(&path, "body", &body.name, self.bodies[..i].iter().map(|b| b.name.as_str()))?;
            if body.material >= self.materials.len() {
                let message = format!("body `{}` has material number {}", body.name, body.material);
                let remedy = format!("there are {}, numbered from 0", self.materials.len());
                return Err(SceneFault::new(path.then("material"), message, remedy));
            }
            validate_region(&path.then("shape"), &format!("the outline of body `{}`", body.name), &body.region)?;
            for v in &body.velocities {
                let what = format!("the initial velocity of body `{}`", body.name);
                finite_pair(path.then("velocity"), &what, [v.velocity.x, v.velocity.y])?;
                FINITE.check(path.then("angular_velocity"), &what, v.angular_velocity)?;
                finite_pair(path.then("center"), &what, [v.center.x, v.center.y])?;
                self.validate_selection(&path, &v.selection)?;
            }
        }
        self.validate_overlaps()
    }

    /// Bodies may abut but not overlap. The tolerance covers the rounding of shared borders.
    fn validate_overlaps(&self) -> Check {
        for (i, a) in self.bodies.iter().enumerate() {
            for b in &self.bodies[..i] {
                let ((a_low, a_high), (b_low, b_high)) = (a.region.bounds(), b.region.bounds());
                let apart = a_low.x >= b_high.x || b_low.x >= a_high.x || a_low.y >= b_high.y || b_low.y >= a_high.y;
                if apart {
                    continue;
                }
                let shared = polygon(&a.region).intersection(&polygon(&b.region)).unsigned_area();
                if shared > 1e-6 * a.region.area().min(b.region.area()) {
                    return Err(SceneFault::new(
                        KeyPath::item("body", i).then("shape"),
                        format!("body `{}` overlaps body `{}` by {} m²", a.name, b.name, short(shared)),
                        "move them apart or make them one body",
                    ));
                }
            }
        }
        Ok(())
    }

    fn validate_resolution(&self) -> Check {
        let path = KeyPath::setting("grid", "particle_spacing");
        POSITIVE.check(path.clone(), "the particle spacing", self.particle_spacing)?;
        POSITIVE.check(KeyPath::setting("grid", "cell_size"), "the cell size", self.cell_size)?;
        for body in &self.bodies {
            let (low, high) = body.region.bounds();
            let (width, height) = (high.x - low.x, high.y - low.y);
            let (spacing, name) = (self.particle_spacing, &body.name);
            let size = format!("body `{name}` ({} m x {} m)", short(width), short(height));
            if spacing > width.min(height) {
                return Err(SceneFault::new(
                    path,
                    format!("the particle spacing {} m is larger than {size}", short(spacing)),
                    format!("make it at most {} m", short(width.min(height) / 4.0)),
                ));
            }
            if width.max(height) / spacing > MOST_ALONG_A_SIDE {
                return Err(SceneFault::new(
                    path,
                    format!(
                        "the particle spacing {} m puts more than {MOST_ALONG_A_SIDE} particles along {size}",
                        short(spacing)
                    ),
                    format!("something like {} m is usual", short(width.max(height) / 128.0)),
                ));
            }
        }
        if self.cell_size < self.particle_spacing {
            return Err(SceneFault::new(
                KeyPath::setting("grid", "cell_size"),
                format!(
                    "the cell size {} m is below the particle spacing {} m",
                    short(self.cell_size),
                    short(self.particle_spacing)
                ),
                "leave `grid.cell_size` out: it is then twice the particle spacing",
            ));
        }
        Ok(())
    }

    fn validate_settings(&self) -> Check {
        let (s, g, f, o) = (&self.solver, &self.growth, &self.frames, &self.output);
        let solver = |key: &str| KeyPath::setting("solver", key);
        if let Some(step) = s.time_step {
            POSITIVE.check(solver("time_step"), "the time step", step)?;
        }
        FRACTION.check(solver("courant"), "`courant`", s.courant)?;
        NOT_NEGATIVE.check(solver("damping"), "`damping`", s.damping)?;
        FRICTION.check(solver("crack_friction"), "`crack_friction`", s.crack_friction)?;
        POSITIVE.check(solver("j_radius"), "`j_radius`", s.j_radius)?;
        if let crate::settings::Transfer::Flip(flip) = s.transfer {
            UNIT.check(solver("transfer"), "the FLIP share", flip)?;
        }
        let growth = |key: &str| KeyPath::setting("growth", key);
        POSITIVE.check(growth("increment"), "`increment`", g.increment)?;
        NOT_NEGATIVE.check(growth("bending"), "`bending`", g.bending)?;
        FRACTION.check(growth("speed_limit"), "`speed_limit`", g.speed_limit)?;
        let frames = |key: &str| KeyPath::setting("frames", key);
        POSITIVE.check(frames("rate"), "the frame rate", f.rate)?;
        if f.first < 0 {
            let message = format!("the first frame is {}", f.first);
            return Err(SceneFault::new(frames("first"), message, "frame numbers start at 0 or above"));
        }
        if f.last < f.first {
            let message = format!("the last frame {} comes before the first frame {}", f.last, f.first);
            return Err(SceneFault::new(frames("last"), message, "make `last` at least `first`"));
        }
        POSITIVE.check(KeyPath::setting("output", "thickness"), "the thickness", o.thickness)?;
        NOT_NEGATIVE.check(
            KeyPath::setting("output", "smallest_fragment"),
            "the smallest fragment",
            o.smallest_fragment,
        )
    }

    fn validate_load(&self, path: &KeyPath, load: &Load) -> Check {
        self.validate_selection(path, &load.selection)?;
        validate_curve(path, &load.curve)?;
        match &load.kind {
            LoadKind::Force(f) => finite_pair(path.then("force"), "the force", [f.x, f.y]),
            LoadKind::Traction(t) => {
                finite_pair(path.then("traction"), "the traction", [t.x, t.y])?;
                if matches!(load.selection, Selection::Edge { .. }) {
                    return Ok(());
                }
                let message = "a traction acts on an edge, but none is selected";
                Err(SceneFault::new(
                    path.then("traction"),
                    message,
                    "add `select = { edge = \"...\" }` or give a `force`",
                ))
            }
            LoadKind::PerPoint(forces) => forces.iter().try_for_each(|(at, f)| {
                finite_pair(path.then("per_point"), "the place of a force", [at.x, at.y])?;
                finite_pair(path.then("per_point"), "a force", [f.x, f.y])
            }),
        }
    }

    fn validate_support(&self, path: &KeyPath, support: &Support) -> Check {
        self.validate_selection(path, &support.selection)?;
        validate_curve(path, &support.curve)?;
        for (key, v) in ["velocity_x", "velocity_y"].into_iter().zip(support.velocity) {
            FINITE.check(path.then(key), "the velocity of a support", v.unwrap_or(0.0))?;
        }
        Ok(())
    }

    fn validate_selection(&self, path: &KeyPath, selection: &Selection) -> Check {
        let path = path.then("select");
        let body_exists = |body: usize| {
            if body < self.bodies.len() {
                return Ok(());
            }
            let remedy = format!("there are {}, numbered from 0", self.bodies.len());
            Err(SceneFault::new(path.then("body"), format!("body number {body} is selected"), remedy))
        };
        match selection {
            Selection::All | Selection::Edge { body: None, .. } => Ok(()),
            Selection::Body(body) | Selection::Edge { body: Some(body), .. } => body_exists(*body),
            Selection::Region(region) => validate_region(&path.then("region"), "the selected region", region),
            Selection::Near { points, radius } => {
                finite_points(&path.then("near"), "a point", points)?;
                POSITIVE.check(path.then("radius"), "the radius", *radius)
            }
        }
    }

    fn validate_cracks(&self) -> Check {
        for (i, crack) in self.cracks.iter().enumerate() {
            let path = KeyPath::item("crack", i);
            unique_name(&path, "crack", &crack.name, self.cracks[..i].iter().map(|c| c.name.as_str()))?;
            let Some(body) = self.bodies.get(crack.body) else {
                let remedy = format!("there are {}, numbered from 0", self.bodies.len());
                return Err(SceneFault::new(
                    path.then("body"),
                    format!("crack `{}` has body number {}", crack.name, crack.body),
                    remedy,
                ));
            };
            self.validate_crack(&path, crack, body)?;
            for other in &self.cracks[..i] {
                if let Some(at) = meeting(&crack.points, &other.points) {
                    let message = format!("crack `{}` meets crack `{}` at {} m", crack.name, other.name, show(at));
                    return Err(SceneFault::new(
                        path.then("line"),
                        message,
                        "keep the cracks apart, if only by a cell",
                    ));
                }
            }
        }
        Ok(())
    }

    fn validate_crack(&self, path: &KeyPath, crack: &Crack, body: &Body) -> Check {
        let name = &crack.name;
        let line = path.then("line");
        validate_polyline(&line, &format!("crack `{name}`"), &crack.points)?;
        let on_ring =
            |p: Point| nearest_on_rings(&body.region, p).is_some_and(|place| is_on(&body.region, place.distance));
        let [first, .., last] = crack.points.as_slice() else { return Ok(()) };
        for (end, point, live, guide) in
            [("start", *first, crack.start_live, &crack.start_guide), ("end", *last, crack.end_live, &crack.end_guide)]
        {
            if !body.region.contains(point) && !on_ring(point) {
                let message =
                    format!("the {end} {} m of crack `{name}` lies outside body `{}`", show(point), body.name);
                return Err(SceneFault::new(line, message, "move it into the body or onto its outline"));
            }
            if live && on_ring(point) {
                return Err(live_mouth(path, name, end, point));
            }
            let Some(guide) = guide else { continue };
            let key = path.then(format!("guide_{end}").as_str());
            if !live {
                let message = format!("guide `{}` leads the {end} of crack `{name}`, which is no live tip", guide.name);
                return Err(SceneFault::new(key, message, "name that end in `tips`, or take the guide away"));
            }
            validate_polyline(&key, &format!("guide `{}`", guide.name), &guide.points)?;
            if guide.points.first() != Some(&point) {
                let message =
                    format!("guide `{}` does not start at the {end} {} m of crack `{name}`", guide.name, show(point));
                return Err(SceneFault::new(key, message, "make its first point the tip"));
            }
        }
        if let Some(at) = leaves(&body.region, &crack.points) {
            let message = format!("crack `{name}` leaves body `{}` at {} m", body.name, show(at));
            return Err(SceneFault::new(
                line,
                message,
                "only its ends may reach the outline; draw a crack for each part",
            ));
        }
        Ok(())
    }
}

/// The fault of naming an end live that lies on the outline.
pub(crate) fn live_mouth(path: &KeyPath, crack: &str, end: &str, at: Point) -> SceneFault {
    SceneFault::new(
        path.then("tips"),
        format!("the {end} of crack `{crack}` is named live, but it lies on the outline at {} m", show(at)),
        "name the other end, or leave `tips` out: ends inside the body are then live",
    )
}

/// A polyline has length, and does not cross itself.
fn validate_polyline(path: &KeyPath, what: &str, points: &[Point]) -> Check {
    finite_points(path, what, points)?;
    if points.len() < 2 || polyline_length(points) == 0.0 {
        let at = points.first().map_or_else(|| "it has no points".to_owned(), |&p| format!("it lies at {} m", show(p)));
        return Err(SceneFault::new(
            path.clone(),
            format!("{what} has no length: {at}"),
            "give it at least two different points",
        ));
    }
    if let Some(twice) = points.windows(2).find(|w| w[0] == w[1]) {
        return Err(SceneFault::new(
            path.clone(),
            format!("{what} has the point {} twice in a row", show(twice[0])),
            "take one away",
        ));
    }
    if let Some(at) = find_crossing(&[points], false) {
        return Err(SceneFault::new(
            path.clone(),
            format!("{what} crosses itself at {} m", show(at)),
            "draw it without a loop",
        ));
    }
    Ok(())
}

/// A region is finite, simple, oriented, and its holes lie inside and apart.
pub(crate) fn validate_region(path: &KeyPath, what: &str, region: &Region) -> Check {
    let fault = |message: String, remedy: &str| Err(SceneFault::new(path.clone(), message, remedy));
    for ring in region.rings() {
        finite_points(path, what, ring)?;
        if ring.windows(3).all(|w| orientation(w[0], w[1], w[2]) == 0.0) {
            return fault(
                format!("{what} encloses no area ({} different corners)", ring.len()),
                "give it at least three corners, not on one line",
            );
        }
    }
    let rings: Vec<&[Point]> = region.rings().collect();
    if let Some(at) = find_crossing(&rings, true) {
        return fault(
            format!("{what} crosses or touches itself at {} m", show(at)),
            "draw each ring without crossings, and holes apart from each other and from the edge",
        );
    }
    if signed_area(&region.exterior) < 0.0 || region.holes.iter().any(|h| signed_area(h) > 0.0) {
        return fault(format!("{what} turns the wrong way"), "exteriors run counter-clockwise, holes clockwise");
    }
    let simple = |ring: &[Point]| Region { exterior: ring.to_vec(), holes: Vec::new() };
    let exterior = simple(&region.exterior);
    for (i, hole) in region.holes.iter().enumerate() {
        let inside_other = region.holes[..i].iter().any(|o| {
            let reverse = |r: &[Point]| r.iter().rev().copied().collect::<Vec<_>>();
            simple(&reverse(o)).contains(hole[0]) || simple(&reverse(hole)).contains(o[0])
        });
        if !exterior.contains(hole[0]) || inside_other {
            return fault(
                format!("a hole of {what} at {} m does not lie inside it", show(hole[0])),
                "holes lie inside the outline and not inside each other",
            );
        }
    }
    Ok(())
}

fn validate_collider(path: &KeyPath, collider: &Collider) -> Check {
    let name = &collider.name;
    FRICTION.check(path.then("friction"), &format!("the friction of collider `{name}`"), collider.friction)?;
    let shape = path.then("shape");
    match &collider.shape {
        ColliderShape::HalfPlane { normal } => {
            if (normal.norm() - 1.0).abs() > 1e-9 || !normal.norm().is_finite() {
                let message = format!("the normal of collider `{name}` is ({}, {})", normal.x, normal.y);
                return Err(SceneFault::new(shape, message, "it must have a length above 0 and be finite"));
            }
        }
        ColliderShape::Disc { radius } => {
            POSITIVE.check(shape, &format!("the radius of collider `{name}`"), *radius)?
        }
        ColliderShape::Box { half_extents } => {
            for (side, v) in [("width", half_extents.x), ("height", half_extents.y)] {
                POSITIVE.check(shape.clone(), &format!("half the {side} of collider `{name}`"), v)?;
            }
        }
        ColliderShape::Polygon { ring } => {
            let region = Region { exterior: ring.clone(), holes: Vec::new() };
            validate_region(&shape, &format!("the outline of collider `{name}`"), &region)?;
        }
    }
    let path = path.then("keyframes");
    if collider.keyframes.is_empty() {
        return Err(SceneFault::new(path, format!("collider `{name}` has no pose"), "give it one keyframe at least"));
    }
    for (i, (time, pose)) in collider.keyframes.iter().enumerate() {
        let path = path.then(i);
        FINITE.check(path.then("time"), "the time of a keyframe", *time)?;
        finite_pair(path.then("position"), "the position of a keyframe", [pose.position.x, pose.position.y])?;
        FINITE.check(path.then("angle"), "the angle of a keyframe", pose.angle)?;
        if i > 0 && collider.keyframes[i - 1].0 >= *time {
            return Err(not_rising(
                path,
                &format!("the keyframes of collider `{name}`"),
                collider.keyframes[i - 1].0,
                *time,
            ));
        }
    }
    Ok(())
}

fn validate_curve(path: &KeyPath, curve: &Curve) -> Check {
    let path = path.then("curve");
    for (i, &(time, factor)) in curve.points.iter().enumerate() {
        finite_pair(path.then(i), "a point of the curve", [time, factor])?;
        if i > 0 && curve.points[i - 1].0 >= time {
            return Err(not_rising(path.then(i), "the points of the curve", curve.points[i - 1].0, time));
        }
    }
    Ok(())
}

fn not_rising(path: KeyPath, what: &str, before: f64, after: f64) -> SceneFault {
    SceneFault::new(
        path,
        format!("the times of {what} do not rise: {after} s comes after {before} s"),
        "sort them by time, each time once",
    )
}

fn unique_name<'a>(path: &KeyPath, what: &str, name: &str, mut before: impl Iterator<Item = &'a str>) -> Check {
    if name.is_empty() || before.any(|b| b == name) {
        let message = if name.is_empty() {
            format!("a {what} has an empty name")
        } else {
            format!("two of them are called {what} `{name}`")
        };
        return Err(SceneFault::new(path.then("name"), message, "give each its own name"));
    }
    Ok(())
}

/// Whether a distance from a ring is rounding only.
fn is_on(region: &Region, distance: f64) -> bool {
    let (low, high) = bounds(&region.exterior);
    distance <= 1e-12 * (low.coords.amax().max(high.coords.amax()))
}

/// Where a crack touches the rings of its body other than with its two ends.
pub(crate) fn leaves(region: &Region, points: &[Point]) -> Option<Point> {
    let (first, last) = (points.first()?, points.last()?);
    for (i, w) in points.windows(2).enumerate() {
        let (p, q) = (w[0], w[1]);
        for ring in region.rings() {
            for k in 0..ring.len() {
                let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
                if !segments_touch(p, q, a, b) {
                    continue;
                }
                let along = |from: Point, to: Point, from_ring: Point, other: Point| {
                    from == from_ring && orientation(from, to, other) == 0.0 && (to - from).dot(&(other - from)) > 0.0
                };
                let joins = |end: Point, inner: Point, is_end: bool| {
                    // The mouth itself, unless the crack runs on along the ring.
                    is_end && {
                        let touches_elsewhere = segments_touch(inner, inner, a, b);
                        let place = nearest_on_segment(a, b, end);
                        is_on(region, (place - end).norm())
                            && !touches_elsewhere
                            && !along(end, inner, a, b)
                            && !along(end, inner, b, a)
                    }
                };
                let starts = joins(p, q, i == 0 && p == *first);
                let ends = joins(q, p, i + 2 == points.len() && q == *last);
                if !(starts || ends) {
                    return Some(nearest_on_segment(a, b, p));
                }
            }
        }
    }
    let middle = nalgebra::center(&points[0], &points[1]);
    (!region.contains(middle)).then_some(*first)
}

fn meeting(a: &[Point], b: &[Point]) -> Option<Point> {
    a.windows(2).find_map(|v| {
        b.windows(2).find(|w| segments_touch(v[0], v[1], w[0], w[1])).map(|w| nearest_on_segment(w[0], w[1], v[1]))
    })
}

fn polygon(region: &Region) -> geo::Polygon<f64> {
    let ring = |points: &[Point]| geo::LineString::from_iter(points.iter().map(|p| (p.x, p.y)));
    geo::Polygon::new(ring(&region.exterior), region.holes.iter().map(|h| ring(h)).collect())
}

/// A unit vector, or the vector itself when it has no direction (which [`Scene::validate`] reports).
pub(crate) fn unit(v: Vector) -> Vector {
    v.try_normalize(0.0).unwrap_or(v)
}
