//! How quantities of a scene converge, as a figure: their distance from what they come to over the size of cells.

use crate::convergence_files::TITLE;
use crate::richardson::Trend;
use fissure_chart::{Axis, Figure, Line, Panel, Plot};

/// Lines that can be told from each other; the first quantities of the table have them.
const MOST_LINES: usize = 8;

/// A quantity of a figure: its name, its values from coarse to fine, and what these come to.
pub(crate) type Quantity<'a> = (&'a str, [f64; 3], Trend);

/// The figure of the quantities that converge, in cells of these sizes [m], from coarse to fine; none where none does.
pub(crate) fn figure(cells: [f64; 3], quantities: &[Quantity<'_>]) -> Option<Figure> {
    let line = |&(name, values, trend): &Quantity<'_>| {
        let Trend::Converges { order, extrapolated, uncertainty } = trend else { return None };
        // What may be anything has no distance from it.
        if uncertainty >= 1.0 {
            return None;
        }
        let distance = |value: f64| (value / extrapolated - 1.0).abs();
        let points = cells.into_iter().zip(values.map(distance)).filter(|(_, d)| d.is_finite() && *d > 0.0).collect();
        Some(Line { name: format!("{name}: order {order:.1}"), points, ..Line::default() })
    };
    let mut lines: Vec<Line> = quantities.iter().filter_map(line).take(MOST_LINES).collect();
    lines.iter_mut().enumerate().for_each(|(colour, line)| line.colour = colour);
    if lines.is_empty() {
        return None;
    }
    let (x, y) = (Axis::logarithmic("size of cells [m]"), Axis::logarithmic("from what it comes to").in_percent());
    Some(Figure {
        title: TITLE.into(),
        caption: vec![
            "Distance of each quantity from its value without cells, extrapolated by the order that three resolutions have \
             (Roache 1994). What goes up and down, or does not settle, is in the table only."
                .into(),
        ],
        columns: 1,
        panels: vec![Panel { title: String::new(), plot: Plot::Lines { x, y, lines } }],
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::richardson::trend;

    /// Truth: f = 2 + 3h². Distances are 1.5 h², and what does not converge is left out.
    #[test]
    fn distances_are_those_from_the_limit() {
        let cells = [0.4, 0.2, 0.1];
        let values = cells.map(|h| 2.0 + 3.0 * h * h);
        let up_and_down = [1.0, 2.0, 1.5];
        let all = [("f", values, trend(values, 2.0)), ("g", up_and_down, trend(up_and_down, 2.0))];
        let figure = figure(cells, &all).unwrap();
        let Plot::Lines { lines, .. } = &figure.panels[0].plot else { unreachable!() };
        assert_eq!((lines.len(), lines[0].name.as_str()), (1, "f: order 2.0"));
        assert!(lines[0].points.iter().all(|(h, d)| (d - 1.5 * h * h).abs() < 1e-9), "{lines:?}");
        assert!(super::figure(cells, &all[1..]).is_none());
    }
}
