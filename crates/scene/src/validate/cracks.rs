//! Cracks and guides.

use super::curve::{Clock, validate_schedule};
use super::name::unique_name;
use super::region::is_on;
use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault, show};
use crate::frame::End;
use crate::range::{COORDINATE, POINTS, TIME, UNIT};
use crate::scene::{Body, BranchKind, Crack, Guide, Scene};
use fissure_plane::{Point, Region, find_crossing, nearest_on_segment, orientation, polyline_length, segments_touch};

impl Scene {
    pub(super) fn validate_cracks(&self) -> Check {
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
                if other.body != crack.body {
                    continue;
                }
                for (guest, trunk) in [(crack, other), (other, crack)] {
                    let live = [guest.start_live, guest.end_live];
                    let ends = [guest.points.first(), guest.points.last()];
                    for ((end, live), word) in ends.into_iter().zip(live).zip(["start", "end"]) {
                        if let (Some(&at), true) = (end.filter(|&&end| is_inside(&trunk.points, end)), live) {
                            return Err(no_tip(&path, &guest.name, word, at, "another crack"));
                        }
                    }
                }
                if let Some(at) = meeting(&crack.points, &other.points) {
                    let message = format!("crack `{}` meets crack `{}` at {} m", crack.name, other.name, show(at));
                    return Err(SceneFault::new(
                        path.then("line"),
                        message,
                        "let one end on the line of the other, draw them as one, or keep them apart, if only by a cell",
                    ));
                }
            }
        }
        Ok(())
    }

    pub(super) fn validate_crack(&self, path: &KeyPath, crack: &Crack, body: &Body) -> Check {
        let name = &crack.name;
        let line = path.then("line");
        validate_polyline(&line, &format!("crack `{name}`"), &crack.points)?;
        let on_ring = |p: Point| body.region.nearest(p).is_some_and(|place| is_on(&body.region, place.distance));
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
                return Err(no_tip(path, name, end, point, "the outline"));
            }
            let Some(guide) = guide else { continue };
            let key = path.then(format!("guide_{end}").as_str());
            if !live {
                let message = format!("guide `{}` leads the {end} of crack `{name}`, which is no live tip", guide.name);
                return Err(SceneFault::new(key, message, "name that end in `tips`, or take the guide away"));
            }
            if guide.points.first() != Some(&point) {
                let message =
                    format!("guide `{}` does not start at the {end} {} m of crack `{name}`", guide.name, show(point));
                return Err(SceneFault::new(key, message, "make its first point the tip"));
            }
            self.validate_guide(&key, guide, 0)?;
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

impl Scene {
    /// A guide and what branches off it, `generation` steps below the one that a tip of the drawing follows.
    fn validate_guide(&self, path: &KeyPath, guide: &Guide, generation: usize) -> Check {
        let name = &guide.name;
        validate_polyline(path, &format!("guide `{name}`"), &guide.points)?;
        validate_strength(path, name, guide.strength)?;
        validate_schedule(&path.then("keyframes"), name, Clock::Seconds, &guide.schedule.points)?;
        for branch in &guide.branches {
            let place = guide.points.get(branch.point).copied().filter(|_| branch.point > 0);
            let begins = match &branch.kind {
                BranchKind::Begins { guide, delay, .. } => {
                    TIME.check(path.then("delay"), &format!("the delay of guide `{}`", guide.name), *delay)?;
                    if generation == MOST_GENERATIONS {
                        let message = format!("guide `{}` is too many branches of branches away", guide.name);
                        return Err(SceneFault::new(path.clone(), message, "let it be one of an earlier guide"));
                    }
                    self.validate_guide(path, guide, generation + 1)?;
                    guide.points.first().copied()
                }
                BranchKind::Drawn { crack, end } => self.cracks.get(*crack).and_then(|crack| match end {
                    End::Start => crack.points.first().copied().filter(|_| !crack.start_live),
                    End::End => crack.points.last().copied().filter(|_| !crack.end_live),
                }),
            };
            if place.is_none() || place != begins {
                let message = format!("what branches off guide `{name}` does not begin at point {}", branch.point);
                return Err(SceneFault::new(
                    path.clone(),
                    message,
                    "let it begin at a point of the guide, not the first",
                ));
            }
        }
        Ok(())
    }
}

/// Most guides that may follow each other as branches of branches.
pub(crate) const MOST_GENERATIONS: usize = 16;

/// The strength of a guide.
pub(crate) fn validate_strength(path: &KeyPath, guide: &str, strength: f64) -> Check {
    UNIT.check(path.then("strength"), &format!("the strength of guide `{guide}`"), strength)
}

/// The fault of naming an end live that lies `on` the outline or another crack.
pub(crate) fn no_tip(path: &KeyPath, crack: &str, end: &str, at: Point, on: &str) -> SceneFault {
    SceneFault::new(
        path.then("tips"),
        format!("the {end} of crack `{crack}` is named live, but it lies on {on} at {} m", show(at)),
        "name the other end, or leave `tips` out: ends inside the body and on no other crack are then live",
    )
}

/// A polyline has length, and does not cross itself.
pub(super) fn validate_polyline(path: &KeyPath, what: &str, points: &[Point]) -> Check {
    POINTS.check(path, what, points.len())?;
    COORDINATE.check_points(path, what, points)?;
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

/// Where two cracks meet other than in an end of one that is a vertex inside the other.
pub(super) fn meeting(a: &[Point], b: &[Point]) -> Option<Point> {
    a.windows(2).find_map(|v| {
        let meets = |w: &&[Point]| segments_touch(v[0], v[1], w[0], w[1]) && !joined(a, v, b, w) && !joined(b, w, a, v);
        b.windows(2).find(meets).map(|w| nearest_on_segment(w[0], w[1], v[1]))
    })
}

/// Whether `point` is a vertex of a line other than its ends.
fn is_inside(line: &[Point], point: Point) -> bool {
    line.len() > 2 && line[1..line.len() - 1].contains(&point)
}

/// Whether the piece `v` of `guest` ends the line, on a vertex inside `trunk` that its piece `w` has, and runs off to
/// the side from there.
fn joined(guest: &[Point], v: &[Point], trunk: &[Point], w: &[Point]) -> bool {
    let (first, last) = (guest[0], guest[guest.len() - 1]);
    [(first, v[0], v[1]), (last, v[1], v[0])].into_iter().any(|(end, own, inner)| {
        own == end && is_inside(trunk, end) && w.contains(&end) && {
            let other = if w[0] == end { w[1] } else { w[0] };
            orientation(end, other, inner) != 0.0 || (other - end).dot(&(inner - end)) < 0.0
        }
    })
}
