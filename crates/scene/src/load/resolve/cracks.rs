//! Cracks.

use super::guides::{DrawnGuides, seat_on_guides};
use super::{Resolved, Resolver};
use crate::document::CrackKeys;
use crate::fault::{KeyPath, SceneFault, show};
use crate::load::nearest::nearest;
use crate::load::seating::{Seated, seat_crack, seat_on_cracks};
use crate::scene::*;
use crate::validate::no_tip;
use fissure_plane::Point;

/// Crack ends this near to the outline or to another crack, in particle spacings, lie on it, and so do those within
/// twice of what flattening may move it by.
const MOUTH_TOLERANCE: f64 = 0.1;

impl<'d> Resolver<'d> {
    pub(super) fn cracks(&mut self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        let document = self.document;
        let reach = (MOUTH_TOLERANCE * scene.particle_spacing).max(2.0 * tolerance);
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
        let mut guides = self.drawn_guides(scene, tolerance)?;
        let mut free = Vec::new();
        for (i, ((keys, line), pieces)) in document.crack.iter().zip(lines).zip(pieces).enumerate() {
            let path = KeyPath::item("crack", i);
            let opens: Vec<[bool; 2]> = pieces.iter().map(|(_, piece)| piece.opens()).collect();
            let mut cracks = self.cracks_of(&path, keys, &name_of(i, keys), pieces, &guides)?;
            self.guides(&path, keys, &mut cracks, &line, scene, &mut guides)?;
            free.extend(
                opens.iter().zip(&cracks).map(|(opens, c)| [!opens[0] && !c.start_live, !opens[1] && !c.end_live]),
            );
            scene.cracks.extend(cracks);
        }
        self.check_branches(&guides)?;
        seat_on_guides(&mut scene.cracks, &free, guides.reach());
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

    /// Numbers of the cracks of that name: all pieces of a drawn one, or the one of the scene that is called so.
    pub(super) fn cracks_called(&self, path: KeyPath, name: &str, cracks: &[Crack]) -> Resolved<Vec<usize>> {
        let drawn: Vec<String> = self.document.crack.iter().enumerate().map(|(i, keys)| name_of(i, keys)).collect();
        let is_piece = |k: &usize| self.origin.cracks.get(*k).is_some_and(|&i| drawn[i] == name);
        let pieces: Vec<usize> = (0..cracks.len()).filter(is_piece).collect();
        if !pieces.is_empty() {
            return Ok(pieces);
        }
        if let Some(one) = cracks.iter().position(|crack| crack.name == name) {
            return Ok(vec![one]);
        }
        let mut known: Vec<&str> = drawn.iter().map(String::as_str).collect();
        known.extend(cracks.iter().map(|crack| crack.name.as_str()).filter(|of| !drawn.iter().any(|d| d == of)));
        Err(SceneFault::new(path, format!("there is no crack `{name}`"), nearest(name, &known)))
    }

    /// The cracks of the scene that the pieces of a drawn one are: of its name, or `name.1`, `name.2`, ...
    ///
    /// Live are the ends of the drawn line that are named, or all that lie inside a body, on no other crack and on no
    /// guide of another crack.
    fn cracks_of(
        &self,
        path: &KeyPath,
        keys: &CrackKeys,
        name: &str,
        pieces: Vec<(usize, Seated)>,
        guides: &DrawnGuides,
    ) -> Resolved<Vec<Crack>> {
        let count = pieces.len();
        let mut cracks = Vec::with_capacity(count);
        for (k, (body, piece)) in pieces.into_iter().enumerate() {
            let mut live = [false; 2];
            for (end, word) in ["start", "end"].into_iter().enumerate() {
                let is_end_of_line = k == [0, count - 1][end];
                let named = keys.tips.map(|tips| tips.live()[end] && is_end_of_line);
                let is_free = !piece.opens()[end];
                let place = piece.points[end * (piece.points.len() - 1)];
                live[end] = named.unwrap_or_else(|| is_free && !guides.pass(place, keys, &self.document.guide));
                if live[end] && !is_free {
                    let on = if piece.mouths[end] { "the outline" } else { "another crack" };
                    return Err(no_tip(path, name, word, place, on));
                }
            }
            cracks.push(Crack {
                name: if count > 1 { format!("{name}.{}", k + 1) } else { name.to_owned() },
                body,
                points: piece.points,
                start_live: live[0],
                end_live: live[1],
                start_guide: None,
                end_guide: None,
                crosses: keys.crosses,
            });
        }
        Ok(cracks)
    }
}

fn name_of(position: usize, keys: &CrackKeys) -> String {
    keys.name.clone().unwrap_or_else(|| format!("crack-{}", position + 1))
}
