//! Figures: panels beside and below each other, with a title, a legend and a caption.

use crate::axis::Axis;
use crate::bars::{self, Bar};
use crate::drawing::{self, Stroke};
use crate::lines::{self, Line};
use crate::map::{self, Map};
use crate::style::{COLOURS, sheet};
use crate::svg::{Anchor, Svg, width};

/// Width of a figure [px]: that of a page of text.
const WIDTH: f64 = 880.0;
/// Height of a panel of lines [px].
const PANEL: f64 = 300.0;
/// Height of a panel with a drawing [px].
const DRAWING: f64 = 240.0;
const MARGIN: f64 = 12.0;
/// Height of a line of small text [px].
const LEADING: f64 = 16.0;

/// What a panel shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Plot {
    /// Lines on two axes.
    Lines {
        /// The axis along.
        x: Axis,
        /// The axis upwards.
        y: Axis,
        /// The lines; later ones lie on top.
        lines: Vec<Line>,
    },
    /// Bars of equal length, divided into parts.
    Bars {
        /// Names of the parts, for the legend.
        parts: Vec<String>,
        /// The bars, from above.
        bars: Vec<Bar>,
    },
    /// A map of two parameters.
    Map(Map),
    /// Lines to scale.
    Drawing(Vec<Stroke>),
}

/// One plot with its title.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title; empty: none.
    pub title: String,
    /// What it shows.
    pub plot: Plot,
}

/// A picture of one or several panels.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Title.
    pub title: String,
    /// Lines of text below, wrapped to the width.
    pub caption: Vec<String>,
    /// How many panels lie beside each other.
    pub columns: usize,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

/// A rectangle of the figure [px].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Area {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Figure {
    /// The figure as a file.
    pub fn to_svg(&self) -> String {
        let mut svg = Svg::default();
        svg.bold((MARGIN, 26.0), 17.0, &self.title);
        let mut y = self.legend(&mut svg, 44.0);
        let columns = self.columns.max(1);
        let column = (WIDTH - 2.0 * MARGIN) / columns as f64;
        for row in self.panels.chunks(columns) {
            let height = row.iter().map(height).fold(0.0, f64::max);
            for (k, panel) in row.iter().enumerate() {
                let x = MARGIN + column * k as f64;
                svg.bold((x + 4.0, y + 14.0), 13.0, &panel.title);
                let area = Area { x, y: y + 20.0, width: column - 6.0, height: height - 20.0 };
                match &panel.plot {
                    Plot::Lines { x, y, lines } => lines::draw(&mut svg, area, (x, y), lines),
                    Plot::Bars { parts, bars } => bars::draw(&mut svg, area, parts, bars),
                    Plot::Map(map) => map::draw(&mut svg, area, map),
                    Plot::Drawing(strokes) => drawing::draw(&mut svg, area, strokes),
                }
            }
            y += height + 10.0;
        }
        for line in self.caption.iter().flat_map(|text| wrapped(text, WIDTH - 2.0 * MARGIN, 11.5)) {
            y += LEADING;
            svg.text("m", (MARGIN, y), 11.5, Anchor::Start, &line);
        }
        svg.finish((WIDTH, y + MARGIN), &self.title, &sheet())
    }

    /// Draws the names of all lines and parts from `y` on; returns where it ends.
    fn legend(&self, svg: &mut Svg, mut y: f64) -> f64 {
        let mut entries: Vec<(&str, usize, &str)> = Vec::new();
        for panel in &self.panels {
            match &panel.plot {
                Plot::Lines { lines, .. } => {
                    let named = lines.iter().filter(|l| !l.name.is_empty() && l.words.is_empty() && !l.behind);
                    entries.extend(named.map(|l| (l.name.as_str(), l.colour % COLOURS, l.dashes)));
                }
                Plot::Bars { parts, .. } => {
                    entries.extend(parts.iter().enumerate().map(|(k, part)| (part.as_str(), k % COLOURS, "bar")));
                }
                Plot::Map(_) | Plot::Drawing(_) => {}
            }
        }
        let mut x = MARGIN;
        for (position, (name, colour, dashes)) in entries.iter().enumerate() {
            if entries[..position].iter().any(|(earlier, ..)| earlier == name) {
                continue;
            }
            let length = 34.0 + width(name, 12.0) + 10.0;
            if x + length > WIDTH - MARGIN {
                (x, y) = (MARGIN, y + 18.0);
            }
            if *dashes == "bar" {
                svg.rectangle(&format!("f{colour}"), (x + 12.0, y - 4.0), (14.0, 11.0), "");
            } else {
                svg.polyline(&format!("l s{colour}"), &[(x, y + 2.0), (x + 26.0, y + 2.0)], dashes);
                svg.disc(&format!("f{colour}"), (x + 13.0, y + 2.0), 2.6, "");
            }
            svg.text("", (x + 32.0, y + 6.0), 12.0, Anchor::Start, name);
            x += length;
        }
        if entries.is_empty() { y - 6.0 } else { y + 18.0 }
    }
}

/// Height of a panel with its title [px].
fn height(panel: &Panel) -> f64 {
    match &panel.plot {
        Plot::Lines { .. } => PANEL,
        Plot::Bars { bars, .. } => 26.0 + bars::PITCH * bars.len() as f64,
        Plot::Map(map) => 24.0 + map::height(map),
        Plot::Drawing(_) => DRAWING,
    }
}

/// Text in lines of a width [px].
fn wrapped(text: &str, room: f64, size: f64) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if line.is_empty() {
            line.push_str(word);
        } else if width(line, size) + width(word, size) < room {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.into());
        }
    }
    lines
}
