//! Reports as text: columns for a terminal, or Markdown.

use crate::report::{Expected, Report, Row};
use std::fmt::Write;

/// Headings of the columns for one place, and for several.
const HEADINGS: [&[&str]; 2] = [
    &["quantity", "computed", "reference", "error", "target"],
    &["quantity", "worst", "reference", "error", "mean", "sd", "target"],
];

/// Headings and cells of a report. Words are in the first and the last column, numbers between.
fn table(report: &Report) -> Vec<Vec<String>> {
    let is_family = report.rows.iter().any(|row| row.spread.is_some());
    let headings = HEADINGS[usize::from(is_family)].iter().map(|h| h.to_string()).collect();
    std::iter::once(headings).chain(report.rows.iter().map(|row| cells(row, is_family))).collect()
}

/// The report as columns for a terminal; `threads` is only printed.
pub fn text(report: &Report, threads: usize) -> String {
    let table = table(report);
    let mut width = vec![0; table[0].len()];
    for row in &table {
        for (w, cell) in width.iter_mut().zip(row) {
            *w = (*w).max(cell.chars().count());
        }
    }
    let mut out = format!("{}: {} [{}]\n", report.name, report.about, resolution(report));
    for row in &table {
        for (column, cell) in row.iter().enumerate() {
            let _ = match column {
                0 => write!(out, "  {cell:<0$}", width[0]),
                last if last + 1 == row.len() => write!(out, "  {cell}"),
                _ => write!(out, "  {cell:>0$}", width[column]),
            };
        }
        out.push('\n');
    }
    for (quantity, place) in missed_at(report) {
        let _ = writeln!(out, "  {quantity}: worst {place}");
    }
    for note in &report.notes {
        let _ = writeln!(out, "  {note}");
    }
    let _ = writeln!(out, "  {}", cost(report, threads));
    out
}

/// The report as a section of a Markdown page.
pub fn markdown(report: &Report, threads: usize) -> String {
    let mut out = format!("## `{}`\n\n{} {}\n\n", report.name, sentence(&report.about), sentence(&resolution(report)));
    let mut table = table(report).into_iter();
    let headings = table.next().unwrap_or_default();
    let numbers = "--:|".repeat(headings.len() - 2);
    let _ = writeln!(out, "| {} |\n|---|{numbers}---|", headings.join(" | "));
    for row in table {
        let row: Vec<_> = row.iter().map(|c| c.replace('|', "\\|")).collect();
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out.push('\n');
    let missed = missed_at(report);
    for (quantity, place) in &missed {
        let _ = writeln!(out, "- {quantity}: worst {place}");
    }
    if !missed.is_empty() {
        out.push('\n');
    }
    for note in &report.notes {
        let _ = writeln!(out, "{}\n", sentence(note));
    }
    let _ = writeln!(out, "{}\n", sentence(&cost(report, threads)));
    out
}

/// "16 cells along the crack, 32 places".
fn resolution(report: &Report) -> String {
    let (cells, along) = report.cells;
    let places = report.rows.iter().filter_map(|row| row.spread.as_ref()).map(|spread| spread.places).max();
    let places = places.map_or_else(String::new, |count| format!(", {count} places"));
    format!("{cells} cells {along}{places}")
}

/// The places where missed targets are missed most.
fn missed_at(report: &Report) -> Vec<(&str, &str)> {
    let missed = report.rows.iter().filter(|row| row.met() == Some(false));
    missed.filter_map(|row| Some((row.quantity.as_str(), row.spread.as_ref()?.worst.as_str()))).collect()
}

fn cost(report: &Report, threads: usize) -> String {
    format!(
        "{} particles at most, {} steps in all, {:.1} s with {threads} {}",
        report.particles,
        report.steps,
        report.seconds,
        if threads == 1 { "thread" } else { "threads" }
    )
}

/// With a capital and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    let end = if text.ends_with('.') { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

fn cells(row: &Row, is_family: bool) -> Vec<String> {
    let unit = |value: f64| if row.unit.is_empty() { number(value) } else { format!("{} {}", number(value), row.unit) };
    let percent = |part: f64| format!("{:.2} %", 100.0 * part);
    let signed = |value: f64| format!("{}{}", if value >= 0.0 { "+" } else { "" }, unit(value));
    let met = match row.met() {
        Some(true) => ": yes",
        Some(false) => ": NO",
        None => "",
    };
    let (reference, error, target) = match row.expected {
        Expected::Relative { reference, within } => (
            unit(reference),
            row.error().map_or_else(String::new, |e| format!("{:+.2} %", 100.0 * e)),
            within.map_or_else(String::new, |w| format!("within {}", trimmed(&percent(w)))),
        ),
        Expected::Absolute { reference, within } => (
            unit(reference),
            row.error().map_or_else(String::new, signed),
            within.map_or_else(String::new, |w| format!("within {}", unit(w))),
        ),
        Expected::AtMost(high) => (String::new(), String::new(), format!("at most {}", unit(high))),
        Expected::AtLeast(low) => (String::new(), String::new(), format!("at least {}", unit(low))),
        Expected::Between(low, high) => (String::new(), String::new(), format!("{} to {}", number(low), unit(high))),
    };
    let mut cells = vec![row.quantity.clone(), unit(row.computed), reference, error];
    if is_family {
        let statistics = row.spread.as_ref().map(|spread| match row.expected {
            Expected::Relative { .. } => [format!("{:+.2} %", 100.0 * spread.mean), percent(spread.deviation)],
            Expected::Absolute { .. } => [signed(spread.mean), unit(spread.deviation)],
            _ => [unit(spread.mean), unit(spread.deviation)],
        });
        cells.extend(statistics.unwrap_or_default());
    }
    cells.push(target + met);
    cells
}

/// "1.50 %" as "1.5 %", "2.00 %" as "2 %".
fn trimmed(percent: &str) -> String {
    let digits = percent.trim_end_matches(" %").trim_end_matches('0').trim_end_matches('.');
    format!("{digits} %")
}

/// A number with five digits, without an exponent where it stays short.
fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    match magnitude {
        -4..=5 => {
            let decimals = (4 - magnitude).clamp(0, 6) as usize;
            let digits = format!("{value:.decimals$}");
            if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.').into() } else { digits }
        }
        _ => format!("{value:.3e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let pairs = [
            (0.0, "0"),
            (1.5, "1.5"),
            (2.11274, "2.1127"),
            (-0.0123456, "-0.012346"),
            (123456.7, "123457"),
            (1.5e-7, "1.500e-7"),
            (2e9, "2.000e9"),
        ];
        for (value, text) in pairs {
            assert_eq!(number(value), text);
        }
        assert_eq!(trimmed("1.50 %"), "1.5 %");
        assert_eq!(trimmed("10.00 %"), "10 %");
    }

    #[test]
    fn a_missed_target_is_said_to_be_missed() {
        let expected = Expected::Relative { reference: 2.0, within: Some(0.015) };
        let row = |computed| Row { quantity: "K_I".into(), unit: "", computed, expected, spread: None };
        assert_eq!(cells(&row(2.02), false), ["K_I", "2.02", "2", "+1.00 %", "within 1.5 %: yes"]);
        assert_eq!(cells(&row(2.04), false)[4], "within 1.5 %: NO");
        assert_eq!(row(f64::NAN).met(), Some(false));
    }
}
