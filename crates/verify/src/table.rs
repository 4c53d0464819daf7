//! Reports as text: columns for a terminal, or Markdown.

use crate::report::{Expected, Report, Row};
use std::fmt::Write;

/// Headings of the columns.
const HEADINGS: [&str; 5] = ["quantity", "computed", "reference", "error", "target"];

/// The report as columns for a terminal; `threads` is only printed.
pub fn text(report: &Report, threads: usize) -> String {
    let rows: Vec<[String; 5]> = report.rows.iter().map(cells).collect();
    let mut width = HEADINGS.map(|h| h.chars().count());
    for row in &rows {
        for (w, cell) in width.iter_mut().zip(row) {
            *w = (*w).max(cell.chars().count());
        }
    }
    let mut out = format!("{}: {}\n", report.name, report.about);
    let mut line = |cells: &[String; 5]| {
        let [first, second, third, fourth, last] = cells;
        // Words to the left, numbers to the right.
        let _ = writeln!(
            out,
            "  {first:<0$}  {second:>1$}  {third:>2$}  {fourth:>3$}  {last}",
            width[0], width[1], width[2], width[3]
        );
    };
    line(&HEADINGS.map(String::from));
    rows.iter().for_each(line);
    for note in &report.notes {
        let _ = writeln!(out, "  {note}");
    }
    let _ = writeln!(out, "  {}", cost(report, threads));
    out
}

/// The report as a section of a Markdown page.
pub fn markdown(report: &Report, threads: usize) -> String {
    let mut out = format!("## `{}`\n\n{}\n\n", report.name, sentence(&report.about));
    let _ = writeln!(out, "| {} |\n|---|--:|--:|--:|---|", HEADINGS.join(" | "));
    for row in &report.rows {
        let _ = writeln!(out, "| {} |", cells(row).map(|c| c.replace('|', "\\|")).join(" | "));
    }
    out.push('\n');
    for note in &report.notes {
        let _ = writeln!(out, "{}\n", sentence(note));
    }
    let _ = writeln!(out, "{}\n", sentence(&cost(report, threads)));
    out
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

fn cells(row: &Row) -> [String; 5] {
    let unit = |value: f64| if row.unit.is_empty() { number(value) } else { format!("{} {}", number(value), row.unit) };
    let percent = |part: f64| format!("{:.2} %", 100.0 * part);
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
            row.error().map_or_else(String::new, |e| format!("{}{}", if e >= 0.0 { "+" } else { "" }, unit(e))),
            within.map_or_else(String::new, |w| format!("within {}", unit(w))),
        ),
        Expected::AtMost(high) => (String::new(), String::new(), format!("at most {}", unit(high))),
        Expected::AtLeast(low) => (String::new(), String::new(), format!("at least {}", unit(low))),
        Expected::Between(low, high) => (String::new(), String::new(), format!("{} to {}", number(low), unit(high))),
    };
    [row.quantity.clone(), unit(row.computed), reference, error, target + met]
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
        let row = |computed| Row { quantity: "K_I".into(), unit: "", computed, expected };
        assert_eq!(cells(&row(2.02)), ["K_I", "2.02", "2", "+1.00 %", "within 1.5 %: yes"]);
        assert_eq!(cells(&row(2.04))[4], "within 1.5 %: NO");
        assert_eq!(row(f64::NAN).met(), Some(false));
    }
}
