//! Errors of cases with known solutions against the time they take, one curve for each way to solve them.

mod curves;
mod figures;
mod front;

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use curves::{Curve, curves};
use fissure_verify::{STUDIES, Study};

/// Name of the table and of the first figure.
const NAME: &str = "accuracy";
const COLUMNS: &str = "study,scheme,measure,cells,places,worst,rms,cpu_seconds,particles,steps";

/// CPU time that one point may take, all places together [s]: curves end where the next would take more.
const MOST_SECONDS: f64 = 12.0;
const MOST_SECONDS_QUICK: f64 = 1.0;
/// The default goes so many times further.
const DEFAULT_GOES_ON: f64 = 4.0;
/// Places when only the shape is wanted.
const PLACES_QUICK: usize = 2;
/// Resolutions that are measured of every curve, however long they take.
const LEAST_POINTS: usize = 4;
const LEAST_POINTS_QUICK: usize = 2;
/// The same of the updated formulation in the case that takes minutes a point.
const LEAST_POINTS_LONG: usize = 2;
/// Time goes with the third power of resolution: particles in two dimensions, and steps.
const GROWTH_OF_TIME: f64 = 3.0;

/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    for study in &STUDIES {
        for curve in curves() {
            if !study.is_long || curve.is_in_long_case(charting.quick) {
                measure(charting, study, &curve, &mut table)?;
            }
        }
        // What is there can be looked at while the rest is measured.
        charting.draw(NAME, &figures::schemes(charting, &table))?;
        charting.draw("transfers", &figures::transfers(charting, &table))?;
        charting.draw("measures", &figures::measures(charting, &table))?;
    }
    Ok(())
}

/// Measures a curve, from coarse to fine, as far as it goes.
fn measure(charting: &Charting<'_>, study: &Study, curve: &Curve, table: &mut Table<'_>) -> Result<(), Failure> {
    let most = if charting.quick { MOST_SECONDS_QUICK } else { MOST_SECONDS };
    let most = if curve.is_default() { DEFAULT_GOES_ON * most } else { most };
    let least = match study.is_long && !curve.is_total() {
        _ if charting.quick => LEAST_POINTS_QUICK,
        true => LEAST_POINTS_LONG,
        false => LEAST_POINTS,
    };
    let places = if charting.quick { study.places.min(PLACES_QUICK) } else { study.places };
    let mut last: Option<(f64, f64)> = None;
    for (index, &cells) in study.cells.iter().enumerate() {
        if let Some((coarser, seconds)) = last
            && index >= least
            && seconds * (cells / coarser).powf(GROWTH_OF_TIME) > most
        {
            break;
        }
        let (at, count) = (cells.to_string(), places.to_string());
        let is_of_point = |row: &Vec<String>| row[0] == study.name && row[1] == curve.name && row[3] == at;
        if let Some(row) = table.rows().iter().find(|row| is_of_point(row)) {
            last = Some((cells, number(&row[7]) * places as f64));
            continue;
        }
        let task = format!("{}, {}, {cells} cells", study.name, curve.name);
        let found = charting.showing(&task, |say| study.run(curve.scheme, cells, places, say));
        let row = |measure: &str, worst: String, rms: String, cost: [String; 3]| {
            let mut row = [study.name, &curve.name, measure, &at, &count].map(str::to_owned).to_vec();
            row.extend([worst, rms].into_iter().chain(cost));
            row
        };
        match found {
            Ok(found) => {
                let seconds = format!("{:.4}", found.cpu_seconds);
                last = Some((cells, found.cpu_seconds * places as f64));
                let cost = [seconds, found.particles.to_string(), found.steps.to_string()];
                for failure in &found.failures {
                    charting.report.warn(&format!("{task}, {failure}"));
                }
                for (measure, worst, rms) in found.errors {
                    // A place that could not be computed has no error.
                    let worst = if found.failures.is_empty() { worst } else { f64::INFINITY };
                    table.add(row(measure.name(), format!("{worst:.3e}"), format!("{rms:.3e}"), cost.clone()))?;
                }
            }
            Err(error) => {
                charting.report.warn(&format!("{task}: {error}"));
                let none = || String::new();
                table.add(row("failed", none(), none(), [none(), none(), none()]))?;
            }
        }
    }
    Ok(())
}
