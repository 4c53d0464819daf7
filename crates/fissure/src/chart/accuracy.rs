//! Errors of cases with known solutions against the time they take, one curve for each way to solve them.

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Axis, Figure, Line, Panel, Plot};
use fissure_scene::{Kernel, Transfer};
use fissure_verify::{Measure, STUDIES, Scheme, Study};

/// Name of the table and of the first figure.
const NAME: &str = "accuracy";
const COLUMNS: &str = "study,scheme,measure,cells,places,worst,rms,cpu_seconds,particles,steps";

/// CPU time that one point may take, all places together [s]: curves end where the next would take more.
const MOST_SECONDS: f64 = 12.0;
const MOST_SECONDS_QUICK: f64 = 3.0;
/// The default goes so many times further.
const DEFAULT_GOES_ON: f64 = 4.0;
/// Errors above this are not drawn: they are no solutions [–].
const MOST_ERROR: f64 = 3.0;
/// Places when only the shape is wanted.
const PLACES_QUICK: usize = 2;
/// Resolutions that are measured of every curve, however long they take; one in the case that takes longest.
const LEAST_POINTS: usize = 2;
/// Time goes with the third power of resolution: particles in two dimensions, and steps.
const GROWTH_OF_TIME: f64 = 3.0;

/// A curve.
struct Curve {
    name: &'static str,
    scheme: Scheme,
    colour: usize,
    dashes: &'static str,
    /// Whether it is the default, which is ringed and measured in more cases.
    is_default: bool,
    /// Whether it is measured in the case that takes longest.
    in_long_case: bool,
}

fn curves() -> Vec<Curve> {
    let curve = |name, scheme, colour, dashes| Curve {
        name,
        scheme,
        colour,
        dashes,
        is_default: name == DEFAULT,
        in_long_case: [DEFAULT, "updated AFLIP quadratic", "thesis"].contains(&name),
    };
    vec![
        curve(DEFAULT, Scheme::total(Kernel::Bilinear), 0, ""),
        curve("total GIMP", Scheme::total(Kernel::Gimp), 0, "6 3"),
        curve("total quadratic", Scheme::total(Kernel::Quadratic), 0, "2 2"),
        curve("total cubic", Scheme::total(Kernel::Cubic), 0, "8 2 2 2"),
        curve("updated AFLIP quadratic", Scheme::updated(Transfer::Aflip, Kernel::Quadratic), 2, ""),
        curve("updated AFLIP GIMP", Scheme::updated(Transfer::Aflip, Kernel::Gimp), 2, "6 3"),
        curve("updated AFLIP cubic", Scheme::updated(Transfer::Aflip, Kernel::Cubic), 2, "8 2 2 2"),
        curve("updated APIC quadratic", Scheme::updated(Transfer::Apic, Kernel::Quadratic), 3, ""),
        curve("updated FLIP quadratic", Scheme::updated(Transfer::Flip(1.0), Kernel::Quadratic), 4, ""),
        curve("updated XPIC quadratic", Scheme::updated(Transfer::Xpic, Kernel::Quadratic), 5, ""),
        curve("updated PIC quadratic", Scheme::updated(Transfer::Pic, Kernel::Quadratic), 6, ""),
        curve("thesis", Scheme::thesis(), 1, ""),
        curve(CONTOUR, Scheme::total(Kernel::Bilinear).with_contour(true), 2, ""),
        curve(BARE_CONTOUR, Scheme::total(Kernel::Bilinear).with_contour(false), 3, ""),
    ]
}

/// The default, as `standard` has it for brittle bodies.
const DEFAULT: &str = "total bilinear";
const CONTOUR: &str = "total contour";
const BARE_CONTOUR: &str = "total contour without area term";
/// Curves that differ in how tips are measured only.
const MEASURES: [&str; 2] = [CONTOUR, BARE_CONTOUR];

/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    for study in &STUDIES {
        for curve in curves() {
            let is_wanted = if charting.quick { curve.is_default } else { curve.in_long_case };
            if !study.is_long || is_wanted {
                measure(charting, study, &curve, &mut table)?;
            }
        }
        // What is there can be looked at while the rest is measured.
        charting.draw(NAME, &schemes(charting, &table))?;
        charting.draw("measures", &measures(charting, &table))?;
    }
    Ok(())
}

/// Measures a curve, from coarse to fine, as far as it goes.
fn measure(charting: &Charting<'_>, study: &Study, curve: &Curve, table: &mut Table<'_>) -> Result<(), Failure> {
    let most = if charting.quick { MOST_SECONDS_QUICK } else { MOST_SECONDS };
    let most = if curve.is_default { DEFAULT_GOES_ON * most } else { most };
    let places = if charting.quick { study.places.min(PLACES_QUICK) } else { study.places };
    let mut last: Option<(f64, f64)> = None;
    for (index, &cells) in study.cells.iter().enumerate() {
        if let Some((coarser, seconds)) = last
            && index >= if study.is_long { 1 } else { LEAST_POINTS }
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
            let mut row = [study.name, curve.name, measure, &at, &count].map(str::to_owned).to_vec();
            row.extend([worst, rms].into_iter().chain(cost));
            row
        };
        match found {
            Ok(found) => {
                let seconds = format!("{:.4}", found.cpu_seconds);
                last = Some((cells, found.cpu_seconds * places as f64));
                let cost = [seconds, found.particles.to_string(), found.steps.to_string()];
                for (measure, worst, rms) in found.errors {
                    // A place that could not be computed has no error.
                    let worst = if found.failed > 0 { f64::INFINITY } else { worst };
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

/// One measured point of a curve.
#[derive(Debug, Clone, Copy)]
struct Point {
    cells: f64,
    seconds: f64,
    worst: f64,
}

/// The points of a curve that have an error.
fn points(table: &Table<'_>, study: &Study, curve: &str, measure: Measure) -> Vec<Point> {
    let rows = table.rows().iter();
    let of_curve = rows.filter(|row| row[0] == study.name && row[1] == curve && row[2] == measure.name());
    let point = |row: &Vec<String>| Point { cells: number(&row[3]), seconds: number(&row[7]), worst: number(&row[5]) };
    of_curve.map(point).filter(|p| (0.0..=MOST_ERROR).contains(&p.worst) && p.worst > 0.0 && p.seconds > 0.0).collect()
}

/// What nothing measured is both faster and more accurate than, from fast to accurate.
fn front(mut all: Vec<Point>) -> Vec<(f64, f64)> {
    all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.worst.total_cmp(&b.worst)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in all {
        if front.last().is_none_or(|last| point.worst < last.1) {
            front.push((point.seconds, point.worst));
        }
    }
    front
}

fn line(curve: &Curve, name: String, study: &Study, points: &[Point]) -> Line {
    let ringed = points.iter().position(|p| curve.is_default && p.cells == study.standard_cells());
    let points = points.iter().map(|p| (p.seconds, p.worst)).collect();
    Line { name, points, colour: curve.colour, dashes: curve.dashes, ringed, ..Line::default() }
}

/// K or the way of the crack, whatever a study has.
fn main_measure(study: &Study) -> Measure {
    if study.grows { Measure::Growth } else { Measure::StressIntensity }
}

fn seconds() -> Axis {
    Axis::logarithmic("CPU time of a run [s]")
}

fn error() -> Axis {
    Axis::logarithmic("error at the worst place").in_percent()
}

/// One panel per case, one curve per formulation, transfer and kernel.
fn schemes(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STUDIES.iter().map(|study| {
        let measure = main_measure(study);
        let mut lines = Vec::new();
        let mut all = Vec::new();
        for curve in curves().iter().filter(|curve| !MEASURES.contains(&curve.name)) {
            let points = points(table, study, curve.name, measure);
            all.extend_from_slice(&points);
            lines.push(line(curve, curve.name.into(), study, &points));
        }
        lines.push(Line { name: "front".into(), points: front(all), behind: true, ..Line::default() });
        Panel { title: study.about.into(), plot: Plot::Lines { x: seconds(), y: error(), lines } }
    });
    Figure {
        title: "How accurate, for how much time".into(),
        caption: vec![
            format!(
                "Points of a curve are resolutions, from few cells on the left to many on the right ({}). The broad line is the front: \
                 nothing measured is both faster and more accurate. Ringed: the default at the resolution that is advised. \
                 The worst of several places, turns and spacings on the grid counts; errors above 300 % are not shown. Dashes tell kernels.",
                STUDIES.map(|study| format!("{}: {} {}", study.name, list(study.cells), study.along)).join("; ")
            ),
            charting.origin.to_string(),
        ],
        columns: 2,
        panels: panels.collect(),
    }
}

/// Ways to measure a tip, in the default formulation and in that of the thesis.
fn measures(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STUDIES.iter().filter(|study| !study.is_long).map(|study| {
        let ways: &[(&str, Measure, &str, usize, &str)] = if study.grows {
            &[
                (DEFAULT, Measure::Growth, "domain J", 0, ""),
                (CONTOUR, Measure::Growth, "contour J", 2, ""),
                (BARE_CONTOUR, Measure::Growth, "contour J without area term", 3, ""),
                ("thesis", Measure::Growth, "thesis: contour J, growth", 1, "6 3"),
            ]
        } else {
            &[
                (DEFAULT, Measure::StressIntensity, "interaction K", 4, ""),
                (DEFAULT, Measure::EnergyRelease, "domain J", 0, ""),
                (CONTOUR, Measure::EnergyRelease, "contour J", 2, ""),
                (BARE_CONTOUR, Measure::EnergyRelease, "contour J without area term", 3, ""),
                ("thesis", Measure::StressIntensity, "thesis: K by opening", 1, ""),
                ("thesis", Measure::EnergyRelease, "thesis: contour J", 1, "6 3"),
            ]
        };
        let lines = ways.iter().map(|&(curve, measure, name, colour, dashes)| Line {
            name: name.into(),
            points: points(table, study, curve, measure).iter().map(|p| (p.seconds, p.worst)).collect(),
            colour,
            dashes,
            ..Line::default()
        });
        Panel { title: study.about.into(), plot: Plot::Lines { x: seconds(), y: error(), lines: lines.collect() } }
    });
    Figure {
        title: "How a tip is measured".into(),
        caption: vec![
            "J as K = √(E'J). All but the thesis in the total formulation, which differ in what is integrated only. At rest \
             the contours are one: there is no inertia."
                .into(),
            charting.origin.to_string(),
        ],
        columns: 2,
        panels: panels.collect(),
    }
}

fn list(cells: &[f64]) -> String {
    cells.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand; the third point is slower and worse than the second.
    #[test]
    fn nothing_on_the_front_is_beaten() {
        let point = |seconds, worst| Point { cells: 8.0, seconds, worst };
        let all = vec![point(4.0, 0.05), point(1.0, 0.1), point(2.0, 0.02), point(8.0, 0.01), point(2.0, 0.03)];
        assert_eq!(front(all), [(1.0, 0.1), (2.0, 0.02), (8.0, 0.01)]);
    }
}
