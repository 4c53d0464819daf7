//! A case at many places on the grid: run side by side, merged row by row.

use crate::case::{Compute, Options};
use crate::placement::Placement;
use crate::report::{Expected, Progress, Report, Row, Spread, Tally};
use fissure_sim::SimulationError;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{MutexGuard, PoisonError};

/// What one place gave.
type Outcome = Result<Report, SimulationError>;

/// Runs a case at the places that `options` ask for.
///
/// Each place is computed by one thread, and as many at once as there are threads. What is returned does not depend on
/// their number.
///
/// # Errors
/// That of the first place, when none could be computed; when some could, the report counts the others.
pub(crate) fn run(compute: Compute, options: &Options, progress: Progress<'_>) -> Outcome {
    let count = options.places.max(1);
    if count == 1 {
        let mut tally = Tally::new(Placement::NATURAL, progress).solved_by(options.scheme);
        compute(options, &mut tally)?;
        return Ok(tally.finish());
    }
    let next = AtomicUsize::new(0);
    let outcomes: Mutex<Vec<Option<Outcome>>> = Mutex::new((0..count).map(|_| None).collect());
    let progress = Mutex::new(progress);
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                break;
            }
            let mut say = |what: &str| lock(&progress)(&format!("place {} of {count}, {what}", index + 1));
            let placement = Placement::draw(options.seed, index);
            let mut tally = Tally::new(placement, &mut say).solved_by(options.scheme);
            let outcome = compute(options, &mut tally).map(|()| tally.finish());
            lock(&outcomes)[index] = Some(outcome);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads().min(count) {
            // The loops of a simulation stay on its thread: places are shared out instead.
            scope.spawn(|| match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
                Ok(alone) => alone.install(work),
                Err(_) => work(),
            });
        }
    });
    let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
    merge(outcomes.into_iter().flatten().collect(), options.seed)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One report of all places: the rows of the first that has them, each with the worst it came to.
fn merge(outcomes: Vec<Outcome>, seed: u64) -> Outcome {
    let place = |index| Placement::draw(seed, index).to_string();
    let mut merged = Report::default();
    let mut rows: Vec<Vec<(usize, Row)>> = Vec::new();
    let mut failures = Vec::new();
    let mut first_error = None;
    for (index, outcome) in outcomes.into_iter().enumerate() {
        let report = match outcome {
            Ok(report) => report,
            Err(error) => {
                failures.push(format!("place {}, {}: {error}", index + 1, place(index)));
                first_error.get_or_insert(error);
                continue;
            }
        };
        merged.particles = merged.particles.max(report.particles);
        merged.steps += report.steps;
        merged.looks += report.looks;
        merged.recuts += report.recuts;
        for row in report.rows {
            match rows.iter_mut().find(|same| same[0].1.quantity == row.quantity) {
                Some(same) => same.push((index, row)),
                None => rows.push(vec![(index, row)]),
            }
        }
        for note in report.notes {
            if !merged.notes.contains(&note) {
                merged.notes.push(note);
            }
        }
    }
    if rows.is_empty()
        && let Some(error) = first_error
    {
        return Err(error);
    }
    merged.rows = rows.into_iter().map(|same| worst(same, place)).collect();
    if !failures.is_empty() {
        merged.rows.push(Row {
            quantity: "places that could not be computed".into(),
            unit: "",
            computed: failures.len() as f64,
            expected: Expected::AtMost(0.0),
            spread: None,
        });
        merged.notes.extend(failures);
    }
    Ok(merged)
}

/// The row of the place where it is worst, with the spread over all.
fn worst(rows: Vec<(usize, Row)>, place: impl Fn(usize) -> String) -> Row {
    let values: Vec<f64> = rows.iter().map(|(_, row)| row.error().unwrap_or(row.computed)).collect();
    let count = values.len();
    let mean = values.iter().sum::<f64>() / count as f64;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count as f64;
    // The first of equals, so that the choice does not depend on anything else.
    let mut chosen = 0;
    for k in 1..count {
        if badness(&rows[k].1) > badness(&rows[chosen].1) {
            chosen = k;
        }
    }
    let (index, row) = rows[chosen].clone();
    Row { spread: Some(Spread { places: count, mean, deviation: variance.sqrt(), worst: place(index) }), ..row }
}

/// How bad a row is beside the same row of other places; what is not a number is worst.
fn badness(row: &Row) -> f64 {
    let badness = match row.expected {
        Expected::Relative { .. } | Expected::Absolute { .. } => row.error().map_or(f64::NAN, f64::abs),
        Expected::AtMost(_) => row.computed,
        Expected::AtLeast(_) => -row.computed,
        Expected::Between(low, high) => (row.computed - 0.5 * (low + high)).abs(),
    };
    if badness.is_nan() { f64::INFINITY } else { badness }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(value: f64) -> Outcome {
        let mut say = |_: &str| ();
        let mut tally = Tally::new(Placement::NATURAL, &mut say);
        tally.relative("K", "", value, 2.0, 0.1);
        tally.bound("gap", "", value, Expected::AtLeast(1.0));
        Ok(tally.finish())
    }

    /// Truth: mean and standard deviation of -0.1, 0.05 and 0.2, worked out by hand.
    #[test]
    fn rows_are_merged_to_the_worst_place() {
        let merged = merge(vec![report(1.8), report(2.1), report(2.4)], 1).unwrap_or_default();
        let (error, bound) = (&merged.rows[0], &merged.rows[1]);
        assert_eq!(error.computed, 2.4);
        assert_eq!(error.met(), Some(false));
        let spread = error.spread.clone().unwrap_or_default();
        assert_eq!(spread.places, 3);
        assert!((spread.mean - 0.05).abs() < 1e-15);
        assert!((spread.deviation - (0.045_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(spread.worst, Placement::draw(1, 2).to_string());
        assert_eq!(bound.computed, 1.8);
    }

    /// A number that is none is worse than any error, and not hidden by the others.
    #[test]
    fn what_is_no_number_is_worst() {
        let merged = merge(vec![report(1.8), report(f64::NAN), report(2.4)], 1).unwrap_or_default();
        assert!(merged.rows.iter().all(|row| row.computed.is_nan() && row.met() == Some(false)));
    }
}
