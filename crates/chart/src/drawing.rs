//! Drawings: lines to scale, without axes.

use crate::figure::Area;
use crate::style::COLOURS;
use crate::svg::Svg;

/// A line of a drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stroke {
    /// Number of its colour.
    pub colour: usize,
    /// Its points, y upwards, in a unit that all strokes share.
    pub points: Vec<(f64, f64)>,
}

/// Draws strokes as large as fits.
pub(crate) fn draw(svg: &mut Svg, area: Area, strokes: &[Stroke]) {
    let points = || strokes.iter().flat_map(|stroke| &stroke.points).filter(|p| p.0.is_finite() && p.1.is_finite());
    let span = |of: fn(&(f64, f64)) -> f64| {
        points().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (x, y) = (span(|p| p.0), span(|p| p.1));
    let scale = (area.width / (x.1 - x.0)).min(area.height / (y.1 - y.0));
    if !scale.is_finite() {
        return;
    }
    let left = area.x + 0.5 * (area.width - scale * (x.1 - x.0));
    let place = |&(px, py): &(f64, f64)| (left + scale * (px - x.0), area.y + scale * (y.1 - py));
    for stroke in strokes {
        let places: Vec<_> = stroke.points.iter().map(place).collect();
        svg.polyline(&format!("t s{}", stroke.colour % COLOURS), &places, "");
    }
}
