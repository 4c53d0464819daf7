//! Cracks and their guides.

use super::motion::pairs;
use super::settings::in_seconds;
use super::{Resolved, Resolver};
use crate::document::{CrackKeys, Tips};
use crate::fault::{KeyPath, SceneFault, show};
use crate::load::nearest::nearest;
use crate::load::seating::{Seated, fit_guide, seat_crack, seat_on_cracks};
use crate::scene::*;
use crate::validate::{Clock, no_tip, validate_schedule, validate_strength};
use fissure_plane::Point;

/// Crack ends this near to the outline or to another crack, in particle spacings, lie on it: twice what flattening may
/// move it by.
const MOUTH_TOLERANCE: f64 = 2.0 * super::FLATTENING;
/// A guide this near to the tip or crack, in particle spacings, starts there or runs along it.
const GUIDE_TOLERANCE: f64 = 0.5;

impl<'d> Resolver<'d> {
    pub(super) fn cracks(&mut self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        let document = self.document;
        let reach = MOUTH_TOLERANCE * scene.particle_spacing;
        let (mut lines, mut bodies, mut seated) = (Vec::new(), Vec::new(), Vec::new());
        for (i, keys) in document.crack.iter().enumerate() {
            let path = KeyPath::item("crack", i);
            let line = self.line(&path.then("line"), &keys.line, tolerance)?;
            for (body, piece) in self.pieces(&path, keys, &name_of(i, keys), &line, scene, reach)? {
                self.origin.cracks.push(i);
                bodies.push(body);
                seated.push(piece);
            }
            lines.push(line);
        }
        seat_on_cracks(&mut seated, &bodies, reach);
        let mut pieces: Vec<Vec<(usize, Seated)>> = vec![Vec::new(); lines.len()];
        for ((&i, body), piece) in self.origin.cracks.iter().zip(bodies).zip(seated) {
            pieces[i].push((body, piece));
        }
        for (i, ((keys, line), pieces)) in document.crack.iter().zip(lines).zip(pieces).enumerate() {
            let path = KeyPath::item("crack", i);
            let mut cracks = cracks_of(&path, keys.tips, &name_of(i, keys), pieces)?;
            self.guides(&path, keys, &mut cracks, &line, scene, tolerance)?;
            scene.cracks.extend(cracks);
        }
        Ok(())
    }

    /// The pieces of a crack in the material of its bodies, each with its body, in the order of the line.
    fn pieces(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        name: &str,
        line: &[Point],
        scene: &mut Scene,
        reach: f64,
    ) -> Resolved<Vec<(usize, Seated)>> {
        let bodies = self.bodies(path.then("body"), keys.body.as_deref(), scene)?;
        let mut pieces = Vec::new();
        for &body in &bodies {
            let inside = seat_crack(line, &mut scene.bodies[body].region, reach);
            pieces.extend(inside.into_iter().map(|piece| (body, piece)));
        }
        pieces.sort_by(|(_, a), (_, b)| a.from.total_cmp(&b.from));
        if pieces.is_empty() {
            let whose = match bodies.as_slice() {
                [only] => format!("body `{}`", scene.bodies[*only].name),
                _ => "every body".to_owned(),
            };
            let message = format!("crack `{name}` is outside of {whose} (it starts at {} m)", show(line[0]));
            return Err(SceneFault::new(path.then("line"), message, "move it into a body"));
        }
        Ok(pieces)
    }

    /// Fits the guides of one crack, given by its pieces; `drawn` is its line before it was cut at the outline.
    pub(super) fn guides(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        pieces: &mut [Crack],
        drawn: &[Point],
        scene: &Scene,
        tolerance: f64,
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

/// The cracks of the scene that the pieces of a drawn one are: of its name, or `name.1`, `name.2`, ...
///
/// Live are the ends of the drawn line that are named, or all that lie inside a body and on no other crack.
fn cracks_of(path: &KeyPath, tips: Option<Tips>, name: &str, pieces: Vec<(usize, Seated)>) -> Resolved<Vec<Crack>> {
    let count = pieces.len();
    let mut cracks = Vec::with_capacity(count);
    for (k, (body, Seated { points, mouths, junctions, .. })) in pieces.into_iter().enumerate() {
        let mut live = [false; 2];
        for (end, word) in ["start", "end"].into_iter().enumerate() {
            let is_end_of_line = k == [0, count - 1][end];
            let named = tips.map(|tips| tips.live()[end] && is_end_of_line);
            let is_free = !mouths[end] && !junctions[end];
            live[end] = named.unwrap_or(is_free);
            if live[end] && !is_free {
                let on = if mouths[end] { "the outline" } else { "another crack" };
                return Err(no_tip(path, name, word, points[end * (points.len() - 1)], on));
            }
        }
        cracks.push(Crack {
            name: if count > 1 { format!("{name}.{}", k + 1) } else { name.to_owned() },
            body,
            points,
            start_live: live[0],
            end_live: live[1],
            start_guide: None,
            end_guide: None,
        });
    }
    Ok(cracks)
}
