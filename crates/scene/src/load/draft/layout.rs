//! What a drawn scene needs besides its elements: notches, guides of tips, pulls, resolution and time.

use super::pull::Pull;
use super::sketch::Sketch;
use crate::load::drawing::LoadedDrawing;
use crate::load::resolve::GUIDE_TOLERANCE;
use crate::load::seating::Complaint;
use crate::load::split::{Piece, pieces_inside};
use crate::scene::Material;
use fissure_plane::{Point, Region, bounds, nearest_on_segment, polyline_length};

/// Particles along the larger side of the bodies, at least.
const PARTICLES: f64 = 128.0;
/// The same at most, however short the cracks are.
const MOST_PARTICLES: f64 = 400.0;
/// Particles along the shortest crack, within these bounds.
const PARTICLES_OF_A_CRACK: f64 = 24.0;
/// Curves are flattened to this part of the larger side, to take measure.
const FLATTENING: f64 = 1.0 / 2560.0;
/// A crack this near to an outline, in parts of the larger side, opens there.
const NEAR: f64 = 0.5 / PARTICLES;
/// Part of the way across a body that a notch takes where no crack is drawn.
const NOTCH: f64 = 0.35;
/// How far a notch reaches out of the body, in parts of the way across: the outline is flattened anew when it is
/// loaded.
const OVERSHOOT: f64 = 0.01;

/// Places and sizes, in metres and seconds.
#[derive(Debug)]
pub(super) struct Layout {
    /// A notch that starts a crack where nobody has drawn one.
    pub(super) notch: Option<[Point; 2]>,
    /// Of each guide: the crack and the key that gives it to one of its tips; none of one that branches off another.
    pub(super) guided: Vec<Option<(usize, &'static str)>>,
    /// One pull for each body, or part of it, with a crack.
    pub(super) pulls: Vec<Pull>,
    /// Distance between particles [m].
    pub(super) particle_spacing: f64,
}

impl Layout {
    /// Takes measure of what was drawn.
    ///
    /// # Errors
    /// When an element is not what its name says, or a crack lies in no body.
    pub(super) fn of(sketch: &Sketch, drawing: &LoadedDrawing, material: &Material) -> Result<Self, Complaint> {
        let mut corners = Vec::new();
        for body in &sketch.bodies {
            let (low, high) = drawing.bounds(body)?;
            corners.extend([low, high]);
        }
        let (low, high) = bounds(&corners);
        let side = (high - low).max();
        let tolerance = FLATTENING * side;
        let mut regions = Vec::new();
        for body in &sketch.bodies {
            regions.extend(drawing.regions(body, tolerance)?);
        }
        let lines =
            |names: &[String]| names.iter().map(|name| drawing.line(name, tolerance)).collect::<Result<Vec<_>, _>>();
        let (cracks, guides) = (lines(&sketch.cracks)?, lines(&sketch.guides)?);
        for (name, line) in sketch.cracks.iter().zip(&cracks) {
            if longest_piece(regions.iter().flat_map(|region| pieces_inside(line, region, NEAR * side, 0.0))).is_none()
            {
                let message = format!("the crack `{name}` lies in no body");
                return Err((message, "draw it into a body, from its outline or from a hole".into()));
            }
        }
        let notch = if cracks.is_empty() { Some(notch(&regions)?) } else { None };
        let drawn_or_notch: Vec<Vec<Point>> = cracks.iter().cloned().chain(notch.map(Vec::from)).collect();
        let mut pulls = Vec::new();
        let mut shortest = f64::INFINITY;
        for region in &regions {
            let pieces = drawn_or_notch.iter().flat_map(|line| pieces_inside(line, region, NEAR * side, 0.0));
            let pieces: Vec<Piece> = pieces.collect();
            shortest = pieces.iter().map(|piece| polyline_length(&piece.points)).fold(shortest, f64::min);
            pulls.extend(longest_piece(pieces.into_iter()).map(|longest| Pull::across(&longest, region, material)));
        }
        let particle_spacing = (side / PARTICLES).min(shortest / PARTICLES_OF_A_CRACK).max(side / MOST_PARTICLES);
        let tip = |k: usize| {
            let nearest = nearest_tip(&guides[k], &drawn_or_notch, &regions);
            let is_near = |distance: f64| distance <= GUIDE_TOLERANCE * particle_spacing;
            let branches = !is_near(nearest.0)
                && (0..guides.len()).any(|of| of != k && branches_off(&guides[k], &guides[of], is_near));
            (!branches).then_some(nearest)
        };
        let tips: Vec<_> = (0..guides.len()).map(tip).collect();
        // A tip follows one guide, the nearest; `check` tells of others, which end short of what they were drawn on.
        let mut guided: Vec<Option<(usize, &'static str)>> = vec![None; guides.len()];
        let mut nearest: Vec<_> = tips.into_iter().enumerate().filter_map(|(k, tip)| Some((k, tip?))).collect();
        nearest.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        for (k, (_, crack, key)) in nearest {
            if !guided.contains(&Some((crack, key))) {
                guided[k] = Some((crack, key));
            }
        }
        Ok(Self { notch, guided, pulls, particle_spacing })
    }
}

fn longest_piece(pieces: impl Iterator<Item = Piece>) -> Option<Piece> {
    pieces.max_by(|a, b| polyline_length(&a.points).total_cmp(&polyline_length(&b.points)))
}

/// A notch into the largest body, from the left side of what is widest at half its height.
fn notch(regions: &[Region]) -> Result<[Point; 2], Complaint> {
    let largest = regions.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
    let found = largest.and_then(|region| {
        let (low, high) = region.bounds();
        let y = 0.5 * (low.y + high.y);
        let out = high.x - low.x;
        let level = [Point::new(low.x - out, y), Point::new(high.x + out, y)];
        let widest = longest_piece(pieces_inside(&level, region, 0.0, 0.0).into_iter())?;
        let (left, right) = (*widest.points.first()?, *widest.points.last()?);
        Some([left - (right - left) * OVERSHOOT, left + (right - left) * NOTCH])
    });
    found.ok_or_else(|| ("the body has no place for a crack".into(), "draw an open line called `crack`".into()))
}

/// Whether a guide has an end on another one, whose own ends are not there.
fn branches_off(guide: &[Point], trunk: &[Point], is_near: impl Fn(f64) -> bool) -> bool {
    let ends = |line: &[Point]| [line.first().copied(), line.last().copied()].into_iter().flatten();
    ends(guide).any(|end| is_near(distance(trunk, end)) && !ends(trunk).any(|other| is_near((other - end).norm())))
}

/// Distance of a point from a line [m].
fn distance(line: &[Point], point: Point) -> f64 {
    let places = line.windows(2).map(|w| (nearest_on_segment(w[0], w[1], point) - point).norm());
    places.fold(f64::INFINITY, f64::min)
}

/// The crack whose tip is nearest to a guide, after the distance [m], and the key that gives the guide to it.
fn nearest_tip(guide: &[Point], cracks: &[Vec<Point>], regions: &[Region]) -> (f64, usize, &'static str) {
    let distance = |tip: Point| distance(guide, tip);
    let ends = |line: &[Point]| Some((*line.first()?, *line.last()?));
    let tips = cracks.iter().enumerate().filter_map(|(k, line)| Some((k, ends(line)?)));
    let tips = tips.flat_map(|(k, (first, last))| [(k, "guide_start", first), (k, "guide_end", last)]);
    let inside = tips.filter(|(_, _, tip)| regions.iter().any(|region| region.contains(*tip)));
    let nearest = inside.min_by(|a, b| distance(a.2).total_cmp(&distance(b.2)));
    nearest.map_or((f64::INFINITY, 0, "guide_end"), |(k, key, tip)| (distance(tip), k, key))
}
