//! What single features cost where nothing needs them.

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Axis, Figure, Line, Panel, Plot};
use fissure_verify::{FEATURES, Feature};

const NAME: &str = "features";
const COLUMNS: &str = "formulation,feature,steps,cpu_seconds,steps_by_plain,cpu_by_plain,spread,because";
/// Each plate is run so often in turn with all others; fewer times when only the shape is wanted.
const ROUNDS: [usize; 2] = [9, 3];

/// Measures all plates in turn, unless all are there, and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    if table.rows().is_empty() {
        let [many, few] = ROUNDS;
        let mut seconds: Vec<Vec<f64>> = vec![Vec::new(); FEATURES.len()];
        let mut steps = [0; FEATURES.len()];
        for round in 1..=if charting.quick { few } else { many } {
            for (k, feature) in FEATURES.iter().enumerate() {
                let cost = charting.showing(NAME, |say| {
                    say(&format!("{}, round {round}", feature.name));
                    feature.cost()
                });
                let cost = cost.map_err(|error| Failure::from(error).during(feature.name))?;
                seconds[k].push(cost.cpu.as_secs_f64());
                steps[k] = cost.steps;
            }
        }
        for (k, feature) in FEATURES.iter().enumerate() {
            let plain = FEATURES.iter().position(|other| other.is_updated == feature.is_updated).unwrap_or(0);
            // By the plain plate of the same round: what slows a round slows both.
            let ratios: Vec<f64> =
                seconds[k].iter().zip(&seconds[plain]).map(|(with, without)| with / without).collect();
            let (ratio, spread) = middle(ratios);
            let row = [
                formulation(feature).to_owned(),
                feature.name.to_owned(),
                steps[k].to_string(),
                format!("{:.4}", middle(seconds[k].clone()).0),
                format!("{:.3}", steps[k] as f64 / steps[plain] as f64),
                format!("{ratio:.3}"),
                format!("{spread:.3}"),
                feature.because.to_owned(),
            ];
            table.add(row.to_vec())?;
        }
    }
    charting.draw(NAME, &figure(charting, &table))
}

/// The median, and half of the range that the middle half of the values lies in.
fn middle(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let at = |part: f64| values.get((part * values.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    (at(0.5), 0.5 * (at(0.75) - at(0.25)))
}

fn formulation(feature: &Feature) -> &'static str {
    if feature.is_updated { "updated" } else { "total" }
}

fn figure(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panel = |formulation: &str| {
        let rows: Vec<&Vec<String>> = table.rows().iter().filter(|row| row[0] == formulation).collect();
        let count = rows.len() as f64;
        let height = |k: usize| count - k as f64;
        let lines = rows.iter().enumerate().map(|(k, row)| Line {
            points: vec![(number(&row[5]), height(k))],
            words: vec![row[1].clone()],
            loose: true,
            colour: if row[7].is_empty() { 0 } else { 1 },
            ..Line::default()
        });
        let plain = Line { points: vec![(1.0, 0.5), (1.0, count + 0.5)], colour: 2, dashes: "5 4", ..Line::default() };
        let x = Axis { range: Some((0.0, 3.5)), ..Axis::linear("time, by that of the plain plate") };
        let y = Axis { range: Some((0.0, count + 1.0)), ..Axis::linear("") };
        let plot = Plot::Lines { x, y, lines: std::iter::once(plain).chain(lines).collect() };
        Panel { title: format!("{formulation} formulation"), plot }
    };
    Figure {
        title: "What a feature costs in a scene that has no need of it".into(),
        caption: vec![
            "Medians of CPU time of a plate with an edge crack that waves cross four times, with one thing more or less. First \
             colour: should cost nothing; second: has a reason, which the table names."
                .into(),
            charting.origin.to_string(),
        ],
        columns: 1,
        panels: vec![panel("total"), panel("updated")],
    }
}
