//! Bars, each divided into parts.

use crate::figure::Area;
use crate::style::COLOURS;
use crate::svg::{Anchor, Svg, width};

/// A bar with its parts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bar {
    /// What it is of.
    pub name: String,
    /// The sizes of its parts, in the order of the names of all parts.
    pub parts: Vec<f64>,
    /// A word at its end.
    pub note: String,
}

/// Height of a bar with the gap below it [px].
pub(crate) const PITCH: f64 = 24.0;

/// Draws bars, each as long as all others: its parts are shares.
pub(crate) fn draw(svg: &mut Svg, area: Area, parts: &[String], bars: &[Bar]) {
    let left = area.x + 12.0 + bars.iter().map(|bar| width(&bar.name, 12.0)).fold(0.0, f64::max);
    let right = area.x + area.width - 12.0 - bars.iter().map(|bar| width(&bar.note, 11.0)).fold(0.0, f64::max);
    for (row, bar) in bars.iter().enumerate() {
        let top = area.y + PITCH * row as f64;
        svg.text("", (left - 8.0, top + 14.0), 12.0, Anchor::End, &bar.name);
        svg.text("m", (right + 8.0, top + 14.0), 11.0, Anchor::Start, &bar.note);
        let whole: f64 = bar.parts.iter().filter(|p| p.is_finite()).sum();
        let mut at = left;
        for (k, &part) in bar.parts.iter().enumerate() {
            let share = if whole > 0.0 && part.is_finite() { part / whole } else { 0.0 };
            let length = share * (right - left);
            let title = format!("{}: {} {:.0} %", bar.name, parts.get(k).map_or("", String::as_str), 100.0 * share);
            svg.rectangle(&format!("f{}", k % COLOURS), (at, top + 2.0), (length, PITCH - 7.0), &title);
            if length > 34.0 {
                let word = format!("{:.0} %", 100.0 * share);
                svg.text("b", (at + 0.5 * length, top + 14.5), 11.0, Anchor::Middle, &word);
            }
            at += length;
        }
    }
}
