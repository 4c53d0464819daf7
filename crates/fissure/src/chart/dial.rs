//! Whether what is said before a run holds: errors and times that were asked for beside those that came out.

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Axis, Figure, Line, Panel, Plot};
use fissure_verify::dial_trial;

const NAME: &str = "dial";
const COLUMNS: &str =
    "plate,error_asked,error_said,error_found,limit,cells,seconds_asked,seconds_said,seconds_found,particles,message";
/// Which plates these are: none of those that the tables of errors were made from.
const SEED: u64 = 19;
/// Plates that are tried; fewer when only the shape is wanted.
const PLATES: [usize; 2] = [48, 8];
/// Columns of what was said and found of errors and of times.
const ERROR: [usize; 2] = [2, 3];
const SECONDS: [usize; 2] = [6, 8];

/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    let [many, few] = PLATES;
    for index in 0..if charting.quick { few } else { many } {
        let plate = index.to_string();
        if table.rows().iter().any(|row| row[0] == plate) {
            continue;
        }
        let found = charting.showing(NAME, |say| {
            say(&format!("plate {index}"));
            dial_trial(SEED, index)
        });
        let cells = match found {
            Ok(trial) => {
                let error = trial.error.map(|error| format!("{error:.3e}"));
                let seconds = trial.seconds.map(|seconds| format!("{seconds:.3}"));
                let limit = format!("{:?}", trial.limit).to_lowercase();
                let [particles, cells] = [trial.particles.to_string(), format!("{:.1}", trial.cells)];
                [&error[..], &[limit, cells], &seconds, &[particles, String::new()]].concat()
            }
            Err(error) => [&vec![String::new(); 9][..], &[error.to_string()]].concat(),
        };
        table.add([vec![plate], cells].concat())?;
    }
    charting.report.note(&verdict(&table));
    charting.draw(NAME, &figure(charting, &table))
}

/// What was found by what was said, of each plate, the least first.
fn ratios(table: &Table<'_>, [said, found]: [usize; 2]) -> Vec<f64> {
    let mut ratios: Vec<f64> = table.rows().iter().map(|row| number(&row[found]) / number(&row[said])).collect();
    ratios.retain(|ratio| !ratio.is_nan());
    ratios.sort_by(f64::total_cmp);
    ratios
}

/// How well all of it held.
fn verdict(table: &Table<'_>) -> String {
    let part = |of: &[f64], holds: &dyn Fn(f64) -> bool| {
        100.0 * of.iter().filter(|&&ratio| holds(ratio)).count() as f64 / of.len().max(1) as f64
    };
    let middle = |of: &[f64]| of.get(of.len() / 2).copied().unwrap_or(f64::NAN);
    let (errors, seconds) = (ratios(table, ERROR), ratios(table, SECONDS));
    format!(
        "{} plates: K within what was said in {:.0} %, {:.2} of it in the median and {:.2} at the worst; time within a factor of \
         two of what was asked for in {:.0} %, {:.2} to {:.2} of it",
        errors.len(),
        part(&errors, &|ratio| ratio <= 1.0),
        middle(&errors),
        errors.last().copied().unwrap_or(f64::NAN),
        part(&seconds, &|ratio| (0.5..=2.0).contains(&ratio)),
        seconds.first().copied().unwrap_or(f64::NAN),
        seconds.last().copied().unwrap_or(f64::NAN),
    )
}

fn figure(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let points = |[said, found]: [usize; 2], scale: f64| -> Vec<(f64, f64)> {
        let of = |row: &Vec<String>| (scale * number(&row[said]), scale * number(&row[found]));
        table.rows().iter().map(of).filter(|p| p.0.is_finite() && p.1.is_finite()).collect()
    };
    let panel = |title: &str, x: &str, y: &str, points: Vec<(f64, f64)>, factors: &[(f64, &str)]| {
        let low = points.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|p| p.0).fold(0.0, f64::max);
        let mut lines: Vec<Line> = factors
            .iter()
            .map(|&(factor, name)| Line {
                name: name.into(),
                points: vec![(low, factor * low), (high, factor * high)],
                colour: if factor == 1.0 { 1 } else { 2 },
                dashes: if factor == 1.0 { "" } else { "5 4" },
                ..Line::default()
            })
            .collect();
        lines.push(Line { name: "a plate".into(), points, loose: true, ..Line::default() });
        Panel { title: title.into(), plot: Plot::Lines { x: Axis::logarithmic(x), y: Axis::logarithmic(y), lines } }
    };
    let errors = panel("Error of the highest K", "said [%]", "found [%]", points(ERROR, 100.0), &[(1.0, "as said")]);
    let factors = [(1.0, "as said"), (2.0, "a factor of two"), (0.5, "a factor of two")];
    let seconds = panel("Time", "asked for [s]", "found, CPU [s]", points(SECONDS, 1.0), &factors);
    Figure {
        title: "What is said before a run, and what comes out".into(),
        caption: vec![
            "Random plates with cracks, holes and loads. Errors are those of the worst tip against cells 2.5 and more times smaller, \
             at the spacing that --accuracy has chosen; times those of growing cracks at the spacing that --budget has chosen."
                .into(),
            verdict(table),
            charting.origin.to_string(),
        ],
        columns: 2,
        panels: vec![errors, seconds],
    }
}
