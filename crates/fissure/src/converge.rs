//! `fissure converge`: one scene at three resolutions.

use crate::args::ConvergeArguments;
use crate::drawn::Wanted;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress::duration;
use crate::report::{self, Report};
use crate::richardson::{Trend, trend};
use crate::{convergence_files, convergence_plot, scene_file, threads};
use fissure_plane::Point;
use fissure_scene::{Crack, End, Frame, Scene, TipRecord};
use fissure_sim::Simulation;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::time::Instant;

/// A number that a run gave; runs are compared by its name.
#[derive(Debug, Clone, PartialEq)]
struct Quantity {
    name: String,
    unit: &'static str,
    value: f64,
}

/// What a run gave.
struct Outcome {
    /// Of particles and of nodes [m].
    spacing: f64,
    cell_size: f64,
    /// Wall time [s].
    seconds: f64,
    quantities: Vec<Quantity>,
    /// Each crack at rest at the end [m].
    paths: Vec<Vec<Point>>,
}

/// Runs a scene with cells r², r and once as large as it asks for, and prints what changes.
pub(crate) fn converge(arguments: &ConvergeArguments, interrupt: &Interrupt, report: &Report) -> Result<Exit, Failure> {
    convergence_files::check(arguments)?;
    threads::set(arguments.threads)?;
    let wanted = Wanted { thickness: None, written: false, output: None };
    let file = scene_file::read(&arguments.scene, &wanted, report)?;
    interrupt.finish_cleanly();
    let mut outcomes = Vec::new();
    let ratio = arguments.ratio;
    for factor in [ratio * ratio, ratio, 1.0] {
        let mut scene = file.scene().clone();
        scene.particle_spacing *= factor;
        scene.cell_size *= factor;
        let spacing = scene.particle_spacing;
        let Some(outcome) = run(&scene, interrupt)
            .map_err(|failure| file.show(failure).during(format!("with particles {spacing:.4e} m apart")))?
        else {
            report.warn("interrupted; nothing is written of runs that are not complete");
            return Ok(Exit::Interrupted);
        };
        report.note(&format!(
            "particles {:.4e} m apart: {} for {} frames",
            outcome.spacing,
            duration(outcome.seconds),
            scene.frames.count()
        ));
        outcomes.push(outcome);
    }
    let [coarse, middle, fine] = &outcomes[..] else { return Ok(Exit::Done) };
    let rows = rows([coarse, middle, fine], ratio);
    report::print(&text([coarse, middle, fine], &rows))?;
    if let Some(path) = &arguments.csv {
        convergence_files::write(path, &csv([coarse, middle, fine], &rows), report)?;
    }
    if let Some(path) = &arguments.svg {
        let cells = [coarse, middle, fine].map(|outcome| outcome.cell_size);
        let quantities: Vec<_> = rows.iter().map(|row| (row.name.as_str(), row.values, row.trend)).collect();
        match convergence_plot::figure(cells, &quantities) {
            Some(figure) => convergence_files::write(path, &figure.to_svg(), report)?,
            None => report.warn(&format!("nothing converges, so that `{}` is not written", path.display())),
        }
    }
    Ok(Exit::Done)
}

/// Runs a scene to its end; none: the user has asked to stop.
fn run(scene: &Scene, interrupt: &Interrupt) -> Result<Option<Outcome>, Failure> {
    let started = Instant::now();
    let mut simulation = Simulation::new(scene)?;
    let drawn: Vec<TipRecord> = simulation.tips();
    let mut starts: Vec<Option<Start>> = vec![None; drawn.len()];
    let mut highest = vec![0.0_f64; drawn.len()];
    while !simulation.is_finished() {
        let goes_on = simulation.advance_observed(&mut |simulation, now| {
            let tips = simulation.tips();
            for (k, first) in drawn.iter().enumerate() {
                let Some(tip) = tips.iter().find(|tip| (tip.crack, tip.end) == (first.crack, first.end)) else {
                    continue;
                };
                if starts[k].is_none() {
                    highest[k] = highest[k].max(tip.mode_1);
                    if tip.length > first.length {
                        let work = simulation.energies().external_work;
                        starts[k] = Some(Start { time: now.time, work });
                    }
                }
            }
            if interrupt.is_set() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if !goes_on {
            return Ok(None);
        }
    }
    let frame = simulation.frame();
    let quantities = quantities(scene, &frame, &drawn, &starts, &highest);
    let paths = frame.cracks.iter().map(|crack| crack.rest.clone()).collect();
    let seconds = started.elapsed().as_secs_f64();
    let (spacing, cell_size) = (scene.particle_spacing, scene.cell_size);
    Ok(Some(Outcome { spacing, cell_size, seconds, quantities, paths }))
}

/// When a crack began to grow.
#[derive(Debug, Clone, Copy)]
struct Start {
    /// [s].
    time: f64,
    /// What had been done on the scene until then [J/m].
    work: f64,
}

/// The numbers of a run that is complete.
fn quantities(
    scene: &Scene,
    frame: &Frame,
    drawn: &[TipRecord],
    starts: &[Option<Start>],
    highest: &[f64],
) -> Vec<Quantity> {
    let mut all = Vec::new();
    let mut add = |name: String, unit, value| all.push(Quantity { name, unit, value });
    for (k, first) in drawn.iter().enumerate() {
        let of = tip_name(&scene.cracks, first);
        add(format!("{of}: highest K_I before it grows"), "Pa√m", highest[k]);
        if let Some(start) = starts[k] {
            add(format!("{of}: begins to grow at"), "s", start.time);
            add(format!("{of}: work done until then"), "J/m", start.work);
        }
        let Some(last) = frame.tips.iter().find(|tip| (tip.crack, tip.end) == (first.crack, first.end)) else {
            continue;
        };
        if last.state.is_live() {
            add(format!("{of}: K_I at the end"), "Pa√m", last.mode_1);
            add(format!("{of}: K_II at the end"), "Pa√m", last.mode_2);
            add(format!("{of}: J at the end"), "J/m²", last.j_integral);
        }
        if starts[k].is_some() {
            add(format!("{of}: length of the crack"), "m", last.length);
            let crack = frame.cracks.iter().find(|crack| crack.crack == first.crack);
            let end = crack.and_then(|c| if first.end == End::Start { c.rest.first() } else { c.rest.last() });
            if let Some(end) = end {
                add(format!("{of}: end of the path, x"), "m", end.x);
                add(format!("{of}: end of the path, y"), "m", end.y);
            }
        }
    }
    let energies = frame.energies;
    for (name, value) in [
        ("kinetic energy", energies.kinetic),
        ("strain energy", energies.strain),
        ("external work", energies.external_work),
        ("energy of cracks", energies.crack),
    ] {
        add(name.into(), "J/m", value);
    }
    for (k, support) in frame.supports.iter().enumerate() {
        add(format!("support {k}: work"), "J/m", support.work);
    }
    all
}

fn tip_name(cracks: &[Crack], tip: &TipRecord) -> String {
    let name = cracks.get(tip.crack as usize).map_or("crack", |crack| crack.name.as_str());
    format!("{name}, {}", if tip.end == End::Start { "start" } else { "end" })
}

/// A quantity at three resolutions, from coarse to fine.
struct Row {
    name: String,
    unit: &'static str,
    values: [f64; 3],
    trend: Trend,
}

/// The quantities that all three runs have.
fn rows(outcomes: [&Outcome; 3], ratio: f64) -> Vec<Row> {
    let of = |outcome: &Outcome, name: &str| outcome.quantities.iter().find(|q| q.name == name).map(|q| q.value);
    let mut rows: Vec<Row> = Vec::new();
    for quantity in &outcomes[2].quantities {
        let [Some(coarse), Some(middle), Some(fine)] = outcomes.map(|outcome| of(outcome, &quantity.name)) else {
            continue;
        };
        let values = [coarse, middle, fine];
        if values == [0.0; 3] {
            continue;
        }
        rows.push(Row { name: quantity.name.clone(), unit: quantity.unit, values, trend: trend(values, ratio) });
    }
    rows
}

/// Largest distance of a corner of one path from the other [m], of the cracks that both runs have.
fn apart(one: &Outcome, other: &Outcome) -> f64 {
    let pairs = one.paths.iter().zip(&other.paths);
    pairs.flat_map(|(a, b)| a.iter().map(move |&p| distance(p, b))).fold(0.0, f64::max)
}

/// Distance from a point to a polyline [m].
fn distance(point: Point, line: &[Point]) -> f64 {
    let of_segment = |w: &[Point]| {
        let along = w[1] - w[0];
        let part = ((point - w[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (point - (w[0] + along * part)).norm()
    };
    line.windows(2).map(of_segment).fold(f64::INFINITY, f64::min)
}

fn text(outcomes: [&Outcome; 3], rows: &[Row]) -> String {
    let number = |value: f64| format!("{value:>12.4e}");
    let width =
        rows.iter().map(|row| row.name.chars().count() + row.unit.chars().count() + 3).max().unwrap_or(0).max(20);
    let mut out = format!("{:<width$}", "particle spacing [m]");
    for outcome in outcomes {
        let _ = write!(out, " {}", number(outcome.spacing));
    }
    let _ = writeln!(out, " {:>8} {:>6} {:>12} {:>7}", "change", "order", "extrapolated", "within");
    for row in rows {
        let name = format!("{} [{}]", row.name, row.unit);
        let _ = write!(out, "{name:<width$}");
        for value in row.values {
            let _ = write!(out, " {}", number(value));
        }
        let change = 100.0 * (row.values[2] / row.values[1] - 1.0);
        let change = if change.is_finite() { format!("{change:+.1} %") } else { "-".into() };
        let _ = write!(out, " {change:>8} ");
        let _ = match row.trend {
            Trend::Converges { order, extrapolated, uncertainty } => {
                writeln!(out, "{order:>6.1} {} {:>5.1} %", number(extrapolated), 100.0 * uncertainty)
            }
            Trend::Constant => writeln!(out, "constant"),
            Trend::Oscillates => writeln!(out, "up and down: no order"),
            Trend::Diverges => writeln!(out, "does not settle: finer cells are needed"),
        };
    }
    let [coarse, middle, fine] = outcomes;
    let _ = writeln!(
        out,
        "paths are {:.4e} m apart from coarse to middle, {:.4e} m from middle to fine ({:.2} and {:.2} of its cells)",
        apart(middle, coarse),
        apart(fine, middle),
        apart(middle, coarse) / middle.cell_size,
        apart(fine, middle) / fine.cell_size
    );
    out
}

fn csv(outcomes: [&Outcome; 3], rows: &[Row]) -> String {
    let mut out = format!("{}\n", convergence_files::COLUMNS);
    let [coarse, middle, fine] = outcomes;
    let _ = writeln!(out, "particle spacing,m,{:e},{:e},{:e},,,,", coarse.spacing, middle.spacing, fine.spacing);
    for row in rows {
        let name = row.name.replace(',', ";");
        let [coarse, middle, fine] = row.values;
        let _ = write!(out, "{name},{},{coarse:e},{middle:e},{fine:e},", row.unit);
        let _ = match row.trend {
            Trend::Converges { order, extrapolated, uncertainty } => {
                writeln!(out, "converges,{order:.4},{extrapolated:e},{uncertainty:.4e}")
            }
            Trend::Constant => writeln!(out, "constant,,,"),
            Trend::Oscillates => writeln!(out, "oscillates,,,"),
            Trend::Diverges => writeln!(out, "diverges,,,"),
        };
    }
    out
}
