//! Live tips, with their stress intensity.

use crate::layout::Layout;
use crate::lettering::{self, Anchor};
use crate::picture::{Picture, paint};
use crate::theme::Theme;
use fissure_scene::{BoundaryEdge, End, Fragments, Frame, Line, TipRecord, Vector};
use std::collections::BTreeMap;
use tiny_skia::{FillRule, PathBuilder, Transform};

/// Tips that have a number beside them: those that carry most.
const LABELS: usize = 8;

/// Marks the live tips, and writes K_I beside those that come nearest to their toughness [MPa·√m].
pub(crate) fn draw(picture: &mut Picture, tips: &[TipRecord], z: f64, layout: &Layout, theme: Theme) {
    let mut live: Vec<&TipRecord> = tips.iter().filter(|tip| tip.state.is_live()).collect();
    live.sort_by(|a, b| load(b).total_cmp(&load(a)));
    let places = live.iter().map(|tip| layout.projection.pixel([tip.position.x, tip.position.y, z]));
    let places: Vec<[f64; 3]> = places.collect();
    let radius = 0.26 * layout.letters;
    let mut dots = PathBuilder::new();
    places.iter().for_each(|&[x, y, _]| dots.push_circle(x as f32, y as f32, radius as f32));
    if let Some(dots) = dots.finish() {
        picture.pixels.fill_path(&dots, &paint(theme.tip()), FillRule::Winding, Transform::identity(), None);
    }
    let size = 0.85 * layout.letters;
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for (tip, &[x, y, _]) in live.iter().zip(&places).take(LABELS) {
        let text = format!("{:.2}", tip.mode_1 / 1e6);
        let width = lettering::width(&text, size);
        // To the right of the tip; to its left where the picture ends.
        let left = if x + 1.6 * radius + width > f64::from(layout.width) {
            x - 1.6 * radius - width
        } else {
            x + 1.6 * radius
        };
        let label = [left, y - size, left + width, y + 0.3 * size];
        let meets =
            |other: &[f64; 4]| label[0] < other[2] && other[0] < label[2] && label[1] < other[3] && other[1] < label[3];
        if !taken.iter().any(meets) {
            let at = [left, y - 0.1 * size];
            lettering::surround(picture, &text, size, at, theme.background());
            lettering::write(picture, &text, size, at, Anchor::Left, theme.ink());
            taken.push(label);
        }
    }
}

/// The tips of a frame where `moves` take the fragments that they are in, known by body and number [m].
pub(crate) fn moved(frame: &Frame, moves: &BTreeMap<(u32, u32), Vector>) -> Vec<TipRecord> {
    let fragments = Fragments::of_frame(frame);
    let numbers = fragments.numbers(&frame.particles);
    let way = |tip: &TipRecord| {
        let crack = frame.cracks.iter().position(|crack| crack.crack == tip.crack)?;
        let point = match tip.end {
            End::Start => 0,
            End::End => frame.cracks[crack].rest.len().checked_sub(1)?,
        };
        let reaches = |edge: &BoundaryEdge| {
            let ends = edge.span.map(|part| edge.points[usize::from(part > 0.5)]);
            let is_whole = edge.span.iter().all(|part| [0.0, 1.0].contains(part));
            edge.line == Line::Above(crack) && is_whole && ends.contains(&point)
        };
        let has_tip = |k: &usize| fragments.list()[*k].boundaries.iter().flatten().any(reaches);
        let fragment = (0..fragments.list().len()).find(has_tip)?;
        moves.get(&(fragments.list()[fragment].body, numbers[fragment]?)).copied()
    };
    let moved = |tip: &TipRecord| TipRecord { position: tip.position + way(tip).unwrap_or_default(), ..*tip };
    frame.tips.iter().map(moved).collect()
}

/// Whether tips are marked with numbers at all.
pub(crate) fn are_labelled(tips: &[TipRecord]) -> bool {
    tips.iter().any(|tip| tip.state.is_live())
}

/// Share of the toughness that a tip carries.
fn load(tip: &TipRecord) -> f64 {
    tip.equivalent / tip.fracture_toughness
}
