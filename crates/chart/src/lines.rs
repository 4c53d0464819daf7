//! Plots of lines.

use crate::axis::{Axis, Ruler};
use crate::figure::Area;
use crate::style::COLOURS;
use crate::svg::{Anchor, Svg, width};

/// A line of a plot.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Its name in the legend, which has each name once; empty: not in the legend.
    pub name: String,
    /// Its points, in order.
    pub points: Vec<(f64, f64)>,
    /// Number of its colour.
    pub colour: usize,
    /// Lengths of strokes and gaps, as SVG has them; empty: drawn through.
    pub dashes: &'static str,
    /// Points only.
    pub loose: bool,
    /// A point that is ringed, by its number.
    pub ringed: Option<usize>,
    /// A broad pale line behind all others, such as a front.
    pub behind: bool,
    /// A word beside each of its points; empty: none.
    pub words: Vec<String>,
}

/// Draws lines on two axes into an area.
pub(crate) fn draw(svg: &mut Svg, area: Area, axes: (&Axis, &Axis), lines: &[Line]) {
    let inner = Area { x: area.x + 52.0, y: area.y + 8.0, width: area.width - 62.0, height: area.height - 48.0 };
    let values = |of: fn(&(f64, f64)) -> f64| lines.iter().flat_map(move |l| l.points.iter().map(of));
    let x = Ruler::new(axes.0, values(|p| p.0), (inner.x, inner.x + inner.width));
    let y = Ruler::new(axes.1, values(|p| p.1), (inner.y + inner.height, inner.y));
    let bottom = inner.y + inner.height;
    let mut written = f64::NEG_INFINITY;
    for (value, word) in x.ticks() {
        let Some(at) = x.place(value) else { continue };
        svg.line("g", (at, inner.y), (at, bottom));
        // In a narrow panel not every one has room.
        let half = 0.5 * width(&word, 11.0);
        if at - half > written + 4.0 {
            svg.text("m", (at, bottom + 15.0), 11.0, Anchor::Middle, &word);
            written = at + half;
        }
    }
    // An axis without a name only puts things below each other.
    for (value, word) in y.ticks().into_iter().filter(|_| !axes.1.label.is_empty()) {
        let Some(at) = y.place(value) else { continue };
        svg.line("g", (inner.x, at), (inner.x + inner.width, at));
        svg.text("m", (inner.x - 5.0, at + 4.0), 11.0, Anchor::End, &word);
    }
    svg.rectangle("k", (inner.x, inner.y), (inner.width, inner.height), "");
    svg.text("m", (inner.x + 0.5 * inner.width, bottom + 32.0), 12.0, Anchor::Middle, &axes.0.label);
    svg.upright("m", (area.x + 10.0, inner.y + 0.5 * inner.height), 12.0, &axes.1.label);
    let behind = lines.iter().filter(|l| l.behind).chain(lines.iter().filter(|l| !l.behind));
    for line in behind {
        draw_line(svg, line, &x, &y);
    }
}

fn draw_line(svg: &mut Svg, line: &Line, x: &Ruler, y: &Ruler) {
    let places: Vec<_> = line.points.iter().map(|p| Some((x.place(p.0)?, y.place(p.1)?))).collect();
    let colour = line.colour % COLOURS;
    if line.behind {
        svg.polyline("p", &places.into_iter().flatten().collect::<Vec<_>>(), "");
        return;
    }
    if !line.loose {
        // What has no place parts the line.
        for part in places.split(Option::is_none).filter(|part| part.len() > 1) {
            let part: Vec<_> = part.iter().copied().flatten().collect();
            svg.polyline(&format!("l s{colour}"), &part, line.dashes);
        }
    }
    for (k, place) in places.iter().enumerate() {
        let Some(place) = *place else { continue };
        let (px, py) = line.points[k];
        let title = format!("{}: {}, {}", line.name, crate::axis::word(px), crate::axis::word(py));
        svg.disc(&format!("f{colour}"), place, if line.loose { 4.5 } else { 2.6 }, &title);
        if line.ringed == Some(k) {
            svg.ring(&format!("s{colour}"), place, 6.5);
        }
        if let Some(word) = line.words.get(k) {
            svg.text("m", (place.0 + 7.0, place.1 + 4.0), 10.5, Anchor::Start, word);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the widths of the words, in panels from narrow to broad, with few decades and with many.
    #[test]
    fn words_along_an_axis_do_not_overlap() {
        for panel in [150.0, 200.0, 400.0, 800.0] {
            for decades in [0.5, 1.7, 3.9, 6.0, 12.0] {
                let line = Line { points: vec![(1e-3, 1.0), (1e-3 * 10.0_f64.powf(decades), 2.0)], ..Line::default() };
                let (mut svg, area) = (Svg::default(), Area { x: 0.0, y: 0.0, width: panel, height: 300.0 });
                draw(&mut svg, area, (&Axis::logarithmic(""), &Axis::linear("")), &[line]);
                let text = svg.finish((panel, 300.0), "", "");
                let ticks: Vec<(f64, &str)> = text.lines().filter_map(tick).collect();
                assert!(ticks.len() >= 2 || decades < 1.0, "{panel} {decades}: {ticks:?}");
                let end = |(at, word): (f64, &str), side: f64| at + side * 0.5 * width(word, 11.0);
                for pair in ticks.windows(2) {
                    assert!(end(pair[0], 1.0) < end(pair[1], -1.0), "{panel} {decades}: {pair:?}");
                }
            }
        }
    }

    /// Place and word of a tick along the axis.
    fn tick(line: &str) -> Option<(f64, &str)> {
        let rest = line.strip_prefix(r#"<text class="m" x=""#)?;
        let (at, rest) = rest.split_once('"')?;
        let word = rest.split_once(r#"font-size="11" text-anchor="middle">"#)?.1.strip_suffix("</text>")?;
        Some((at.parse().ok()?, word)).filter(|(_, word)| !word.is_empty())
    }
}
