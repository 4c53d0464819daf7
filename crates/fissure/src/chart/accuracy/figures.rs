//! The figures of what was measured.

use super::super::Charting;
use super::super::table::{Table, number};
use super::curves::{BARE_CONTOUR, CONTOUR, Curve, DEFAULT, Family, KERNELS, SAME_AS_DEFAULT, THESIS, curves};
use super::front::{Point, front, lead};
use fissure_chart::{Axis, Figure, Line, Panel, Plot};
use fissure_verify::{Measure, STUDIES, Study};

/// The points of a curve, also those where it failed at some place.
fn measured(table: &Table<'_>, study: &Study, curve: &str, measure: Measure) -> Vec<Point> {
    let rows = table.rows().iter();
    let of_curve = rows.filter(|row| row[0] == study.name && row[1] == curve && row[2] == measure.name());
    let point = |row: &Vec<String>| Point { cells: number(&row[3]), seconds: number(&row[7]), worst: number(&row[5]) };
    of_curve.map(point).collect()
}

/// The points of a curve that are shown.
fn points(table: &Table<'_>, study: &Study, curve: &str, measure: Measure) -> Vec<Point> {
    measured(table, study, curve, measure).into_iter().filter(Point::is_shown).collect()
}

/// The broad line of a front.
fn broad(points: Vec<(f64, f64)>) -> Line {
    Line { name: "front".into(), points, behind: true, ..Line::default() }
}

fn line(curve: &Curve, name: String, study: &Study, points: &[Point]) -> Line {
    let ringed = points.iter().position(|p| curve.is_default() && p.cells == study.standard_cells());
    let points = points.iter().map(|p| (p.seconds, p.worst)).collect();
    Line { name, points, colour: curve.colour, dashes: curve.dashes, ringed, ..Line::default() }
}

/// The front of a study over all curves that differ in more than how tips are measured.
fn front_of(table: &Table<'_>, study: &Study) -> Vec<(f64, f64)> {
    let all = curves().into_iter().filter(|curve| curve.family != Family::Measure);
    front(&all.map(|curve| measured(table, study, &curve.name, main_measure(study))).collect::<Vec<_>>())
}

/// How many times as long as the default the fastest other way takes to an error of the default, at the error where
/// that is least; none where no other comes to any. Without what is the default under another name.
fn lead_of_default(table: &Table<'_>, study: &Study) -> Option<f64> {
    let of = |curve: &str| measured(table, study, curve, main_measure(study));
    let others = curves().into_iter().filter(|curve| curve.family != Family::Measure);
    let others = others.filter(|curve| ![DEFAULT, SAME_AS_DEFAULT].contains(&curve.name.as_str()));
    lead(&of(DEFAULT), &others.map(|curve| of(&curve.name)).collect::<Vec<_>>())
}

/// By how much times of the same computation differ at most [–]: those of the default and of what is the same.
fn scatter_of_time(table: &Table<'_>) -> f64 {
    let differences = STUDIES.iter().flat_map(|study| {
        let of = |curve: &str| measured(table, study, curve, main_measure(study));
        let (ours, same) = (of(DEFAULT), of(SAME_AS_DEFAULT));
        let pairs = ours.into_iter().filter_map(move |a| {
            let b = same.iter().find(|b| b.cells == a.cells)?;
            Some((a.seconds / b.seconds).ln().abs().exp_m1())
        });
        pairs.collect::<Vec<_>>()
    });
    differences.fold(0.0, f64::max)
}

/// What the table says of the default beside all others.
fn beside_others(table: &Table<'_>) -> String {
    let leads = STUDIES.iter().filter_map(|study| {
        let lead = lead_of_default(table, study)?;
        Some(format!("{} {}", study.name, two_digits(lead)))
    });
    format!(
        "The fastest other way to an error of the default takes, at that of its errors where this is least, so many times as long: {}. \
         The same computation, measured twice ({DEFAULT}, {SAME_AS_DEFAULT}), differs in time by up to {:.0} %.",
        leads.collect::<Vec<_>>().join(", "),
        100.0 * scatter_of_time(table)
    )
}

/// A number above zero with two digits.
fn two_digits(value: f64) -> String {
    if value < 9.95 { format!("{value:.1}") } else { format!("{value:.0}") }
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

/// One panel per case, one curve per formulation and kernel.
pub(super) fn schemes(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STUDIES.iter().map(|study| {
        let shown = curves().into_iter().filter(|curve| curve.family == Family::Formulation);
        let mut lines: Vec<Line> = shown
            .map(|curve| {
                let points = points(table, study, &curve.name, main_measure(study));
                line(&curve, curve.name.clone(), study, &points)
            })
            .collect();
        lines.push(broad(front_of(table, study)));
        Panel { title: study.about.into(), plot: Plot::Lines { x: seconds(), y: error(), lines } }
    });
    Figure {
        title: "How accurate, for how much time".into(),
        caption: vec![
            format!(
                "Points of a curve are resolutions, from few cells on the left to many on the right ({}). The broad line is the front: \
                 nothing measured is both faster and more accurate, other transfers included, where a point counts with the largest error \
                 of its curve in so many cells and in more, and curves go on between their points as they are drawn. Ringed: the default at the resolution that \
                 is advised. The worst of several places, turns and spacings on the grid counts; errors above 300 % are not shown. \
                 Dashes tell kernels.",
                STUDIES.map(|study| format!("{}: {} {}", study.name, list(study.cells), study.along)).join("; ")
            ),
            beside_others(table),
            charting.origin.to_string(),
        ],
        columns: 2,
        panels: panels.collect(),
    }
}

/// The updated formulation: one row of panels per case, one column per kernel, one curve per transfer.
pub(super) fn transfers(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STUDIES.iter().flat_map(|study| {
        let (measure, front) = (main_measure(study), front_of(table, study));
        let of_study: Vec<(Curve, Vec<Point>)> = curves()
            .into_iter()
            .filter(|curve| KERNELS.iter().any(|(kernel, ..)| curve.is_updated_by(kernel)))
            .map(|curve| {
                let points = points(table, study, &curve.name, measure);
                (curve, points)
            })
            .collect();
        // All panels of a row have the same axes.
        let all = || of_study.iter().flat_map(|(_, points)| points);
        let time = range(all().map(|p| p.seconds), front.iter().map(|p| p.0));
        let errors = range(all().map(|p| p.worst), front.iter().map(|p| p.1));
        let panel = move |(kernel, ..): (&'static str, fissure_scene::Kernel, &'static str)| {
            let shown = of_study.iter().filter(|(curve, _)| curve.is_updated_by(kernel));
            let mut lines: Vec<Line> = shown
                .map(|(curve, points)| {
                    let name = curve.name.trim_start_matches("updated ").trim_end_matches(kernel).trim();
                    Line { dashes: "", ..line(curve, name.into(), study, points) }
                })
                .collect();
            lines.push(broad(front.clone()));
            let x = Axis { range: time, label: "CPU time [s]".into(), ..seconds() };
            let y = Axis { range: errors, label: "error".into(), ..error() };
            Panel {
                title: format!("{}: {kernel}", study.name.trim_start_matches("crack-motion-")),
                plot: Plot::Lines { x, y, lines },
            }
        };
        KERNELS.map(panel)
    });
    Figure {
        title: "The updated formulation: transfers and kernels".into(),
        caption: vec![
            "Cases from above (late and early: the cracks that run), kernels from left to right; the broad line is the front of all that was measured, as in the figure of \
             formulations. The worst of several places counts; errors above 300 % are not shown."
                .into(),
            charting.origin.to_string(),
        ],
        columns: KERNELS.len(),
        panels: panels.collect(),
    }
}

/// From the least to the greatest of values, with a margin; none where there are none.
fn range(values: impl Iterator<Item = f64>, further: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) = values.chain(further).fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    (low < high).then_some((low / 1.3, high * 1.3))
}

/// Ways to measure a tip, in the default formulation and in that of the thesis.
pub(super) fn measures(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let panels = STUDIES.iter().filter(|study| !study.is_long).map(|study| {
        let ways: &[(&str, Measure, &str, usize, &str)] = if study.grows {
            &[
                (DEFAULT, Measure::Growth, "domain J", 0, ""),
                (CONTOUR, Measure::Growth, "contour J", 2, ""),
                (BARE_CONTOUR, Measure::Growth, "contour J without area term", 3, ""),
                (THESIS, Measure::Growth, "thesis: contour J, growth", 1, "6 3"),
            ]
        } else {
            &[
                (DEFAULT, Measure::StressIntensity, "interaction K", 4, ""),
                (DEFAULT, Measure::EnergyRelease, "domain J", 0, ""),
                (CONTOUR, Measure::EnergyRelease, "contour J", 2, ""),
                (BARE_CONTOUR, Measure::EnergyRelease, "contour J without area term", 3, ""),
                (THESIS, Measure::StressIntensity, "thesis: K by opening", 1, ""),
                (THESIS, Measure::EnergyRelease, "thesis: contour J", 1, "6 3"),
            ]
        };
        let found = ways.iter().map(|&(curve, measure, ..)| measured(table, study, curve, measure));
        let found: Vec<Vec<Point>> = found.collect();
        let mut lines: Vec<Line> = ways
            .iter()
            .zip(&found)
            .map(|(&(_, _, name, colour, dashes), points)| Line {
                name: name.into(),
                points: points.iter().filter(|p| p.is_shown()).map(|p| (p.seconds, p.worst)).collect(),
                colour,
                dashes,
                ..Line::default()
            })
            .collect();
        lines.push(broad(front(&found)));
        Panel { title: study.about.into(), plot: Plot::Lines { x: seconds(), y: error(), lines } }
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
