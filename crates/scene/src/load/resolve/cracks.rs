//! Cracks and their guides.

use super::motion::pairs;
use super::settings::in_seconds;
use super::{Resolved, Resolver};
use crate::document::{CrackKeys, Tips};
use crate::fault::{KeyPath, SceneFault, nearest, show};
use crate::geometry::Point;
use crate::load::seating::{Seated, fit_guide, seat_crack, seat_on_cracks};
use crate::scene::*;
use crate::validate::{Clock, no_tip, validate_schedule, validate_strength};

/// Crack ends this near to the outline or to another crack, in particle spacings, lie on it: twice what flattening may move it by.
const MOUTH_TOLERANCE: f64 = 2.0 * super::FLATTENING;
/// A guide this near to the tip or crack, in particle spacings, starts there or runs along it.
const GUIDE_TOLERANCE: f64 = 0.5;

impl<'d> Resolver<'d> {
    pub(super) fn cracks(&self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        let reach = MOUTH_TOLERANCE * scene.particle_spacing;
        let (mut lines, mut bodies, mut all_seated) = (Vec::new(), Vec::new(), Vec::new());
        for (i, keys) in self.document.crack.iter().enumerate() {
            let path = KeyPath::item("crack", i);
            let name = name_of(i, keys);
            let line_path = path.then("line");
            let line = self.line(&line_path, &keys.line, tolerance)?;
            let body = self.body_of_crack(&path, keys, &name, &line, scene)?;
            let body_name = scene.bodies[body].name.clone();
            let seated = seat_crack(&line, &mut scene.bodies[body].region, reach).map_err(|(message, remedy)| {
                let message = format!("crack `{name}` is not inside body `{body_name}`: {message}");
                SceneFault::new(line_path.clone(), message, remedy)
            })?;
            lines.push(line);
            bodies.push(body);
            all_seated.push(seated);
        }
        seat_on_cracks(&mut all_seated, &bodies, reach);
        for (i, ((keys, line), (body, seated))) in
            self.document.crack.iter().zip(lines).zip(bodies.into_iter().zip(all_seated)).enumerate()
        {
            let (path, name) = (KeyPath::item("crack", i), name_of(i, keys));
            let live = live_ends(&path, keys.tips, &name, &seated)?;
            let mut crack = Crack {
                body,
                start_live: live[0],
                end_live: live[1],
                start_guide: None,
                end_guide: None,
                points: seated.points,
                name,
            };
            self.guides(&path, keys, &mut crack, &line, scene, tolerance)?;
            scene.cracks.push(crack);
        }
        Ok(())
    }

    pub(super) fn body_of_crack(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        name: &str,
        line: &[Point],
        scene: &Scene,
    ) -> Resolved<usize> {
        let candidates = self.bodies(path.then("body"), keys.body.as_deref(), scene)?;
        if let [only] = candidates.as_slice() {
            return Ok(*only);
        }
        let inside: Vec<usize> = candidates
            .iter()
            .copied()
            .filter(|&b| {
                let region = &scene.bodies[b].region;
                let middles = line.windows(2).map(|w| nalgebra::center(&w[0], &w[1]));
                line.iter().copied().chain(middles).any(|p| region.contains(p))
            })
            .collect();
        match inside.as_slice() {
            [only] => Ok(*only),
            [] => {
                let message = format!("crack `{name}` is outside of every body (it starts at {} m)", show(line[0]));
                Err(SceneFault::new(path.then("line"), message, "move it into a body"))
            }
            several => {
                let names: Vec<_> = several.iter().map(|&b| format!("`{}`", scene.bodies[b].name)).collect();
                let message = format!("crack `{name}` runs through the bodies {}", names.join(", "));
                Err(SceneFault::new(path.then("line"), message, "say which one it belongs to: `body = \"...\"`"))
            }
        }
    }

    /// Fits the guides of one crack; `drawn` is its line before it was cut at the outline.
    pub(super) fn guides(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        crack: &mut Crack,
        drawn: &[Point],
        scene: &Scene,
        tolerance: f64,
    ) -> Resolved<()> {
        let only_live = match (crack.start_live, crack.end_live) {
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
            let live = [crack.start_live, crack.end_live][end];
            let (Some(&tip), true) = ([crack.points.first(), crack.points.last()][end], live) else {
                let word = ["start", "end"][end];
                let message =
                    format!("guide `{guide}` leads the {word} of crack `{}`, which is no live tip", crack.name);
                return Err(SceneFault::new(path, message, "guide a live tip"));
            };
            let names: Vec<&str> = self.document.guide.iter().map(|g| g.name.as_str()).collect();
            let Some(index) = names.iter().position(|n| n == guide) else {
                return Err(SceneFault::new(path, format!("there is no guide `{guide}`"), nearest(guide, &names)));
            };
            let guide_path = KeyPath::item("guide", index);
            let guide_keys = &self.document.guide[index];
            let line_path = guide_path.then("line");
            let line = self.line(&line_path, &guide_keys.line, tolerance)?;
            let reach = GUIDE_TOLERANCE * scene.particle_spacing;
            let points = fit_guide(&line, tip, drawn, reach).map_err(|(message, remedy)| {
                let message = format!("guide `{guide}` does not fit crack `{}`: {message}", crack.name);
                SceneFault::new(line_path, message, remedy)
            })?;
            let strength = guide_keys.strength.unwrap_or(1.0);
            validate_strength(&guide_path, guide, strength)?;
            let keyframes = pairs(&guide_keys.keyframes);
            validate_schedule(&guide_path.then("keyframes"), guide, Clock::Frames, &keyframes)?;
            let schedule = in_seconds(&keyframes, &scene.frames);
            let fitted = Some(Guide { name: guide.clone(), points, strength, schedule });
            *[&mut crack.start_guide, &mut crack.end_guide][end] = fitted;
        }
        Ok(())
    }
}

fn name_of(position: usize, keys: &CrackKeys) -> String {
    keys.name.clone().unwrap_or_else(|| format!("crack-{}", position + 1))
}

/// Which ends are live: as named, or every end inside the body and on no other crack.
fn live_ends(path: &KeyPath, tips: Option<Tips>, name: &str, seated: &Seated) -> Resolved<[bool; 2]> {
    let Seated { points, mouths, junctions } = seated;
    let live = tips.map_or([0, 1].map(|end| !mouths[end] && !junctions[end]), Tips::live);
    for (end, word) in ["start", "end"].into_iter().enumerate() {
        if live[end] && (mouths[end] || junctions[end]) {
            let on = if mouths[end] { "the outline" } else { "another crack" };
            return Err(no_tip(path, name, word, points[end * (points.len() - 1)], on));
        }
    }
    Ok(live)
}
