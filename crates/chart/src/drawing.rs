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
    for group in strokes.chunk_by(|a, b| a.colour == b.colour) {
        let lines: Vec<Vec<_>> = group.iter().map(|stroke| stroke.points.iter().map(place).collect()).collect();
        svg.paths(&format!("t s{}", group[0].colour % COLOURS), &lines);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the points themselves, to half a tenth of a pixel however far along a line; a drawing of thousands of
    /// points takes some six bytes for each.
    #[test]
    fn lines_are_written_shortly_and_stay_in_place() {
        let spiral = |k: usize| {
            let angle = 0.01 * k as f64;
            (angle * angle.cos(), angle * angle.sin())
        };
        let stroke = |colour, from| Stroke { colour, points: (from..from + 2000).map(spiral).collect() };
        let mut svg = Svg::default();
        let area = Area { x: 30.0, y: 20.0, width: 200.0, height: 200.0 };
        draw(&mut svg, area, &[stroke(0, 0), stroke(0, 2000), stroke(1, 1000)]);
        let text = svg.finish((260.0, 240.0), "", "");
        let paths: Vec<&str> = text.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(paths.len(), 2, "one for each run of a colour");
        assert!(paths.iter().map(|path| path.len()).sum::<usize>() < 6 * 6000, "{}", text.len());
        let found = places(paths[0]);
        let expected: Vec<_> = (0..4000).map(spiral).collect();
        let span = |of: fn(&(f64, f64)) -> f64| {
            expected.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (x, y) = (span(|p| p.0), span(|p| p.1));
        let scale = (area.width / (x.1 - x.0)).min(area.height / (y.1 - y.0));
        let left = area.x + 0.5 * (area.width - scale * (x.1 - x.0));
        assert_eq!(found.len(), expected.len());
        for (found, p) in found.iter().zip(&expected) {
            let (at_x, at_y) = (left + scale * (p.0 - x.0), area.y + scale * (y.1 - p.1));
            assert!((0.1 * found.0 - at_x).abs() < 0.051 && (0.1 * found.1 - at_y).abs() < 0.051, "{found:?} {p:?}");
        }
    }

    /// Reads `M x y l dx dy ...` back.
    fn places(path: &str) -> Vec<(f64, f64)> {
        let mut found: Vec<(f64, f64)> = Vec::new();
        for line in path.split('M').skip(1) {
            let spaced = line.replace('l', " ").replace('-', " -");
            let numbers: Vec<f64> = spaced.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            let mut at = (0.0, 0.0);
            for step in numbers.chunks_exact(2) {
                at = (at.0 + step[0], at.1 + step[1]);
                found.push(at);
            }
        }
        found
    }
}
