//! Guides of crack tips, and the trees that guides make.

use super::motion::pairs;
use super::settings::in_seconds;
use super::{Resolved, Resolver};
use crate::curve::Curve;
use crate::document::{CrackKeys, GuideKeys};
use crate::fault::{KeyPath, SceneFault, Warning, short};
use crate::frame::End;
use crate::load::nearest::nearest;
use crate::load::seating::{fit_guide, nearest_on_polyline};
use crate::range::FRAMES_LONG;
use crate::scene::*;
use crate::validate::{Clock, MOST_GENERATIONS, validate_schedule, validate_strength};
use fissure_plane::Point;

const ENDS: [End; 2] = [End::Start, End::End];

/// A guide this near to the tip or crack, in particle spacings, starts there or runs along it; one with an end this
/// near to another guide is a branch of it, and a crack with an end this near to one opens into the crack on it.
pub(in crate::load) const TOLERANCE: f64 = 0.5;

/// The guides of a document, drawn.
#[derive(Debug)]
pub(super) struct DrawnGuides {
    lines: Vec<Vec<Point>>,
    /// Whether a tip follows it, or it is a branch already.
    used: Vec<bool>,
    /// [m]
    reach: f64,
}

impl DrawnGuides {
    /// How near something is that lies on a guide [m].
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether an end at `place`, of the crack that `own` draws, opens into a crack that will pass there: it lies on a
    /// guide of strength 1 of another one, between the ends of that guide.
    pub(super) fn pass(&self, place: Point, own: &CrackKeys, document: &[GuideKeys]) -> bool {
        self.lines.iter().zip(document).any(|(line, keys)| {
            let is_exact = keys.strength.is_none_or(|strength| strength >= 1.0);
            let is_near = |p: &Point| (p - place).norm() <= self.reach;
            is_exact
                && !names(own).any(|name| *name == keys.name)
                && is_near(&nearest_on_polyline(line, place).1)
                && ![line.first(), line.last()].into_iter().flatten().any(is_near)
        })
    }
}

/// The guides that a crack refers to.
fn names(crack: &CrackKeys) -> impl Iterator<Item = &String> {
    [&crack.guide, &crack.guide_start, &crack.guide_end].into_iter().flatten()
}

impl Resolver<'_> {
    /// The lines of all guides.
    pub(super) fn drawn_guides(&self, scene: &Scene, tolerance: f64) -> Resolved<DrawnGuides> {
        let line =
            |(i, keys): (usize, &GuideKeys)| self.line(&KeyPath::item("guide", i).then("line"), &keys.line, tolerance);
        let lines = self.document.guide.iter().enumerate().map(line).collect::<Resolved<Vec<_>>>()?;
        let is_followed =
            |keys: &GuideKeys| self.document.crack.iter().any(|c| names(c).any(|name| *name == keys.name));
        let used = self.document.guide.iter().map(is_followed).collect();
        Ok(DrawnGuides { lines, used, reach: TOLERANCE * scene.particle_spacing })
    }

    /// Fits the guides of one crack, given by its pieces; `drawn` is its line before it was cut at the outline.
    pub(super) fn guides(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        pieces: &mut [Crack],
        drawn: &[Point],
        scene: &Scene,
        guides: &mut DrawnGuides,
    ) -> Resolved<()> {
        let Some(last) = pieces.len().checked_sub(1) else { return Ok(()) };
        // The line begins in its first piece and ends in its last one.
        let lives = [pieces[0].start_live, pieces[last].end_live];
        let only_live = match (lives[0], lives[1]) {
            (true, false) => Some(0),
            (false, true) => Some(1),
            _ => None,
        };
        let mut wanted =
            [keys.guide_start.as_ref().map(|g| (g, "guide_start")), keys.guide_end.as_ref().map(|g| (g, "guide_end"))];
        if let Some(guide) = &keys.guide {
            let Some(end) = only_live.filter(|&end| wanted[end].is_none()) else {
                let message = format!("`guide = \"{guide}\"` needs exactly one live tip without a guide of its own");
                return Err(SceneFault::new(
                    path.then("guide"),
                    message,
                    "use `guide_start` or `guide_end`, or name one end in `tips`",
                ));
            };
            wanted[end] = Some((guide, "guide"));
        }
        for (end, (guide, key)) in wanted.into_iter().enumerate().filter_map(|(end, w)| Some((end, w?))) {
            let path = path.then(key);
            let crack = &mut pieces[[0, last][end]];
            let (Some(&tip), true) = ([crack.points.first(), crack.points.last()][end], lives[end]) else {
                let word = ["start", "end"][end];
                let message =
                    format!("guide `{guide}` leads the {word} of crack `{}`, which is no live tip", crack.name);
                return Err(SceneFault::new(path, message, "guide a live tip"));
            };
            let index = self.guide_called(path, guide)?;
            let line_path = KeyPath::item("guide", index).then("line");
            let points = fit_guide(&guides.lines[index], tip, drawn, guides.reach).map_err(|(message, remedy)| {
                let message = format!("guide `{guide}` does not fit crack `{}`: {message}", crack.name);
                SceneFault::new(line_path, message, remedy)
            })?;
            let mut fitted = self.guide(index, points, false, scene)?;
            self.branch(&mut fitted, index, guides, scene, 1)?;
            *[&mut crack.start_guide, &mut crack.end_guide][end] = Some(fitted);
        }
        Ok(())
    }

    fn guide_called(&self, path: KeyPath, name: &str) -> Resolved<usize> {
        let names: Vec<&str> = self.document.guide.iter().map(|g| g.name.as_str()).collect();
        let found = names.iter().position(|n| *n == name);
        found.ok_or_else(|| {
            let remedy = match names.as_slice() {
                [] => format!(
                    "there are none: draw one with `[[guide]]`, `name = \"{name}\"` and its `line` below it, or leave this key out"
                ),
                names => nearest(name, names),
            };
            SceneFault::new(path, format!("there is no guide `{name}`"), remedy)
        })
    }

    /// A guide through `points`, without what branches off it.
    fn guide(&self, index: usize, points: Vec<Point>, is_branch: bool, scene: &Scene) -> Resolved<Guide> {
        let (path, keys) = (KeyPath::item("guide", index), &self.document.guide[index]);
        let name = &keys.name;
        let strength = keys.strength.unwrap_or(1.0);
        validate_strength(&path, name, strength)?;
        let keyframes = pairs(&keys.keyframes);
        validate_schedule(&path.then("keyframes"), name, Clock::Frames, &keyframes)?;
        for (key, frames) in [("delay", keys.delay), ("duration", keys.duration)] {
            let Some(frames) = frames else { continue };
            FRAMES_LONG.check(path.then(key), &format!("the {key} of guide `{name}`"), frames)?;
            if !is_branch {
                let message = format!("guide `{name}` has a `{key}`, but it is no branch of another guide");
                return Err(SceneFault::new(path.then(key), message, "use `keyframes`"));
            }
        }
        let schedule = match keys.duration {
            Some(frames) if keyframes.is_empty() => {
                let seconds = frames / scene.frames.rate;
                let rise = [(0.0, 0.0), (seconds, 1.0)];
                Curve { points: if seconds > 0.0 { keys.ease.between(&rise) } else { vec![rise[1]] } }
            }
            Some(_) => {
                let message = format!("guide `{name}` has both `keyframes` and a `duration`");
                return Err(SceneFault::new(path.then("duration"), message, "keep one of them"));
            }
            None => in_seconds(&keys.ease.between(&keyframes), &scene.frames),
        };
        Ok(Guide { name: name.clone(), points, strength, schedule, branches: Vec::new() })
    }

    /// Gives a guide, number `index` of the document, the guides that branch off it and what branches off those.
    fn branch(
        &self,
        trunk: &mut Guide,
        index: usize,
        guides: &mut DrawnGuides,
        scene: &Scene,
        generation: usize,
    ) -> Resolved<()> {
        let mut found: Vec<(usize, Point)> = Vec::new();
        for (k, keys) in self.document.guide.iter().enumerate() {
            let is_named = keys.branch_of.as_ref() == Some(&trunk.name);
            if k == index || guides.used[k] || (keys.branch_of.is_some() && !is_named) {
                continue;
            }
            let Some(place) = self.foot(trunk, k, is_named, guides)? else { continue };
            if generation > MOST_GENERATIONS {
                let message = format!(
                    "guide `{}` is a branch of a branch, {MOST_GENERATIONS} times over",
                    self.document.guide[k].name
                );
                return Err(SceneFault::new(KeyPath::item("guide", k), message, "let it be one of an earlier guide"));
            }
            guides.used[k] = true;
            found.push((k, place));
        }
        for (k, place) in found {
            let line = &guides.lines[k];
            let is_forwards = line.first().map(|p| (p - place).norm()) <= line.last().map(|p| (p - place).norm());
            let mut points: Vec<Point> = vec![place];
            let is_off = |p: &Point| (p - place).norm() > 0.1 * guides.reach;
            if is_forwards {
                points.extend(line.iter().copied().skip(1).skip_while(|p| !is_off(p)));
            } else {
                points.extend(line.iter().rev().copied().skip(1).skip_while(|p| !is_off(p)));
            }
            if points.len() < 2 {
                let message = format!("guide `{}` ends where it branches off", self.document.guide[k].name);
                return Err(SceneFault::new(KeyPath::item("guide", k).then("line"), message, "draw it longer"));
            }
            let keys = &self.document.guide[k];
            let mut guide = self.guide(k, points, true, scene)?;
            self.branch(&mut guide, k, guides, scene, generation + 1)?;
            let delay = keys.delay.unwrap_or(0.0) / scene.frames.rate;
            let kind = BranchKind::Begins { guide, delay, from_passing: keys.duration.is_some() };
            let point = put_on(trunk, place);
            trunk.branches.push(GuideBranch { point, kind });
        }
        trunk.branches.sort_by_key(|branch| branch.point);
        Ok(())
    }

    /// Where the guide number `k` leaves `trunk`, on that one; none where neither of its ends lies on it. One that is
    /// named as its branch has to.
    fn foot(&self, trunk: &Guide, k: usize, is_named: bool, guides: &DrawnGuides) -> Resolved<Option<Point>> {
        let line = &guides.lines[k];
        let ends = [line.first(), line.last()].into_iter().flatten();
        let foot = |end: &Point| {
            let (piece, place) = nearest_on_polyline(&trunk.points, *end);
            let vertex = [piece, piece + 1].into_iter().filter_map(|at| trunk.points.get(at));
            let vertex = vertex.copied().find(|p| (p - place).norm() <= 0.1 * guides.reach);
            ((place - end).norm(), vertex.unwrap_or(place))
        };
        let Some((distance, place)) = ends.map(foot).min_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(None) };
        let begins = trunk.points.first().is_some_and(|p| *p == place);
        let is_there = distance <= guides.reach && !begins;
        if is_there || !is_named {
            return Ok(is_there.then_some(place));
        }
        let name = &self.document.guide[k].name;
        let (message, remedy) = if distance <= guides.reach {
            let message = format!("guide `{name}` branches off guide `{}` where that begins", trunk.name);
            (message, "let it leave farther on, or give it to a tip of its own")
        } else {
            let message = format!(
                "guide `{name}` is a branch of guide `{}`, but begins {} m away from it",
                trunk.name,
                short(distance)
            );
            (message, "draw one of its ends on the other guide, ahead of the tip")
        };
        Err(SceneFault::new(KeyPath::item("guide", k).then("line"), message, remedy))
    }

    /// That every guide that is called a branch has become one; tells of others that nothing follows.
    pub(super) fn check_branches(&self, guides: &DrawnGuides) -> Resolved<()> {
        for (k, keys) in self.document.guide.iter().enumerate() {
            let Some(trunk) = &keys.branch_of else {
                if !guides.used[k] {
                    self.warn_of_idle(k, guides);
                }
                continue;
            };
            let path = KeyPath::item("guide", k).then("branch_of");
            let followed = self.document.crack.iter().find(|c| names(c).any(|name| *name == keys.name));
            if followed.is_some() {
                let message = format!("guide `{}` is a branch of `{trunk}`, but a crack refers to it", keys.name);
                return Err(SceneFault::new(path, message, "take away the one or the other"));
            }
            self.guide_called(path.clone(), trunk)?;
            if !guides.used[k] {
                let message = format!("guide `{}` is a branch of `{trunk}`, which no crack follows", keys.name);
                return Err(SceneFault::new(path, message, "let a crack follow the first guide of the tree"));
            }
        }
        Ok(())
    }
}

impl Resolver<'_> {
    /// Tells of guide `k`, which nothing follows, and how near to another one it is.
    fn warn_of_idle(&self, k: usize, guides: &DrawnGuides) {
        let keys = &self.document.guide;
        let ends = || [guides.lines[k].first(), guides.lines[k].last()].into_iter().flatten();
        let others = (0..keys.len()).filter(|&other| other != k && guides.lines[other].len() > 1);
        let nearest = others
            .flat_map(|other| ends().map(move |end| (other, nearest_on_polyline(&guides.lines[other], *end).1 - end)))
            .map(|(other, way)| (other, way.norm()))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let name = &keys[k].name;
        let (message, remedy) = match nearest {
            Some((other, distance)) if distance > guides.reach => (
                format!(
                    "no crack follows guide `{name}`: it ends {} m from the nearest one, `{}`",
                    short(distance),
                    keys[other].name
                ),
                format!(
                    "draw one of its ends on that one, within {} m, to make it a branch, or name it as `guide` of a crack",
                    short(guides.reach)
                ),
            ),
            _ => (
                format!("no crack follows guide `{name}`"),
                "name it as `guide` of a crack, or take it away".to_owned(),
            ),
        };
        self.warn(Warning::new(KeyPath::item("guide", k).then("line"), message, remedy));
    }
}

/// Lets cracks with a free end on a guide of strength 1 open into the crack that will pass there. `free`: of each
/// crack, whether its ends are no live tips and lie on no outline or crack.
pub(super) fn seat_on_guides(cracks: &mut [Crack], free: &[[bool; 2]], reach: f64) {
    for trunk in 0..cracks.len() {
        for of in ENDS {
            let Some(mut guide) = cracks[trunk].guide(of).cloned() else { continue };
            for other in (0..cracks.len()).filter(|&other| other != trunk) {
                for (end, _) in ENDS.into_iter().zip(free[other]).filter(|(_, is_free)| *is_free) {
                    if cracks[other].body == cracks[trunk].body {
                        seat_on_guide(&mut guide, cracks, other, end, reach);
                    }
                }
            }
            let crack = &mut cracks[trunk];
            *(if of == End::Start { &mut crack.start_guide } else { &mut crack.end_guide }) = Some(guide);
        }
    }
}

/// Moves an end of a crack that lies on a guide, or on one that branches off it, onto it.
fn seat_on_guide(guide: &mut Guide, cracks: &mut [Crack], crack: usize, end: End, reach: f64) {
    let points = &mut cracks[crack].points;
    let Some(at) = (if end == End::Start { points.first_mut() } else { points.last_mut() }) else { return };
    guide.for_each_mut(&mut |guide| {
        let place = nearest_on_polyline(&guide.points, *at).1;
        let ends = [guide.points.first(), guide.points.last()];
        let is_inner = ends.into_iter().flatten().all(|p| (p - place).norm() > reach);
        if guide.strength >= 1.0 && is_inner && (place - *at).norm() <= reach {
            *at = place;
            let point = put_on(guide, place);
            guide.branches.push(GuideBranch { point, kind: BranchKind::Drawn { crack, end } });
            guide.branches.sort_by_key(|branch| branch.point);
        }
    });
}

/// Makes `place`, which lies on the line of a guide, a point of it. Returns its number.
fn put_on(guide: &mut Guide, place: Point) -> usize {
    if let Some(point) = guide.points.iter().position(|p| *p == place) {
        return point;
    }
    let point = nearest_on_polyline(&guide.points, place).0 + 1;
    guide.points.insert(point, place);
    guide.branches.iter_mut().filter(|branch| branch.point >= point).for_each(|branch| branch.point += 1);
    point
}
