//! Maps: a value for each pair of two parameters.

use crate::figure::Area;
use crate::style::MAP_STEPS;
use crate::svg::{Anchor, Svg, width};

/// A map: rows of cells, each with a value and a word.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Map {
    /// What goes along, with its unit, and the words of its columns.
    pub across: (String, Vec<String>),
    /// What goes upwards, with its unit, and the words of its rows, from below.
    pub up: (String, Vec<String>),
    /// Values by row from below, then column; none: there is no value, the word says why.
    pub cells: Vec<Vec<Option<f64>>>,
    /// What is written into each cell.
    pub words: Vec<Vec<String>>,
    /// From which value on a cell has the second colour, the third, ...; at most six.
    pub limits: Vec<f64>,
}

/// Height of a row [px].
const ROW: f64 = 22.0;
/// Room below the rows, for words and label [px].
const BELOW: f64 = 40.0;

/// Height that a map takes [px].
pub(crate) fn height(map: &Map) -> f64 {
    ROW * map.cells.len() as f64 + BELOW
}

/// Draws a map.
pub(crate) fn draw(svg: &mut Svg, area: Area, map: &Map) {
    let words = map.up.1.iter().map(|word| width(word, 11.0)).fold(0.0, f64::max);
    let left = area.x + 14.0 + words;
    let column = (area.x + area.width - 8.0 - left) / map.across.1.len().max(1) as f64;
    let bottom = area.y + ROW * map.cells.len() as f64;
    for (row, values) in map.cells.iter().enumerate() {
        let top = bottom - ROW * (row + 1) as f64;
        let word = map.up.1.get(row).map_or("", String::as_str);
        svg.text("m", (left - 6.0, top + 15.0), 11.0, Anchor::End, word);
        for (k, value) in values.iter().enumerate() {
            let corner = (left + column * k as f64, top);
            let class = value.map_or_else(|| "n".into(), |value| format!("q{}", step(value, &map.limits)));
            let word = map.words.get(row).and_then(|words| words.get(k)).map_or("", String::as_str);
            svg.rectangle(&class, (corner.0 + 0.5, corner.1 + 0.5), (column - 1.0, ROW - 1.0), word);
            let middle = (corner.0 + 0.5 * column, top + 15.0);
            svg.text("c", middle, 10.5, Anchor::Middle, word);
        }
    }
    for (k, word) in map.across.1.iter().enumerate() {
        svg.text("m", (left + column * (k as f64 + 0.5), bottom + 15.0), 11.0, Anchor::Middle, word);
    }
    let middle = left + 0.5 * column * map.across.1.len() as f64;
    svg.text("m", (middle, bottom + 32.0), 12.0, Anchor::Middle, &map.across.0);
    if !map.up.0.is_empty() {
        // Few rows have no room for a text that runs upwards.
        svg.text("m", (area.x + 4.0, bottom + 32.0), 12.0, Anchor::Start, &format!("↑ {}", map.up.0));
    }
}

/// Number of the colour of a value; what is no number has the last.
fn step(value: f64, limits: &[f64]) -> usize {
    let passed = limits.iter().filter(|&&limit| value.is_nan() || value >= limit).count();
    passed.min(MAP_STEPS - 1)
}
