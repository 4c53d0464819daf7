//! Speed and memory over the number of particles, with and without cracks.

use super::Charting;
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Axis, Figure, Line, Panel, Plot};
use fissure_sim::{Simulation, SimulationError};
use fissure_verify::{TIMED_PLATES, TimedPlate};
use std::time::Duration;

const NAME: &str = "speed";
const COLUMNS: &str = "plate,cells,particles,steps,increments,cpu_seconds,wall_seconds,bytes_per_particle";

/// Cells along a side: 1e3 to 4e6 particles.
const CELLS: [u16; 8] = [16, 32, 64, 100, 178, 316, 562, 1000];
const CELLS_QUICK: [u16; 4] = [16, 32, 64, 128];
/// How long a plate is timed.
const LEAST_TIME: Duration = Duration::from_millis(1500);
const LEAST_TIME_QUICK: Duration = Duration::from_millis(150);
/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    let sizes: &[u16] = if charting.quick { &CELLS_QUICK } else { &CELLS };
    for plate in &TIMED_PLATES {
        for &cells in sizes {
            let at = cells.to_string();
            if !table.rows().iter().any(|row| row[0] == plate.name && row[1] == at) {
                measure(charting, plate, cells, &mut table)?;
            }
        }
    }
    charting.draw(NAME, &figure(charting, &table))
}

fn measure(charting: &Charting<'_>, plate: &TimedPlate, cells: u16, table: &mut Table<'_>) -> Result<(), Failure> {
    let least = if charting.quick { LEAST_TIME_QUICK } else { LEAST_TIME };
    let task = format!("{}, {cells} cells along a side", plate.name);
    let Some(scene) = plate.scene(cells) else { return Ok(()) };
    let found = charting.showing(&task, |say| {
        say("timing");
        let reckoned = Simulation::estimate(&scene)?;
        Ok((reckoned.memory as f64 / reckoned.particles as f64, plate.time(cells, least)?))
    });
    let (bytes, rate) = match found {
        Ok((bytes, Some(rate))) => (bytes, rate),
        Ok((_, None)) => return Ok(()),
        // A machine with little memory has no room for the largest.
        Err::<_, SimulationError>(error) => {
            charting.report.warn(&format!("{task}: {error}"));
            return Ok(());
        }
    };
    table.add(vec![
        plate.name.into(),
        cells.to_string(),
        rate.particles.to_string(),
        rate.steps.to_string(),
        rate.increments.to_string(),
        format!("{:.4}", rate.cpu.as_secs_f64()),
        format!("{:.4}", rate.wall.as_secs_f64()),
        format!("{bytes:.0}"),
    ])
}

fn figure(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let lines = |value: fn(&[String]) -> f64| -> Vec<Line> {
        let line = |(k, plate): (usize, &TimedPlate)| {
            let rows = table.rows().iter().filter(|row| row[0] == plate.name);
            let points = rows.map(|row| (number(&row[2]), value(row)));
            // Of each number of cracks two curves have one colour.
            let (colour, dashes) = (k.div_ceil(2), if plate.name.ends_with("rest") { "6 3" } else { "" });
            Line { name: plate.name.into(), points: points.collect(), colour, dashes, ..Line::default() }
        };
        TIMED_PLATES.iter().enumerate().map(line).collect()
    };
    let particles = || Axis::logarithmic("particles");
    let panels = vec![
        Panel {
            title: "Million particle steps in a second of CPU time".into(),
            plot: Plot::Lines {
                x: particles(),
                y: Axis::logarithmic("1e6/s"),
                lines: lines(|row| number(&row[2]) * number(&row[3]) / number(&row[5]) * 1e-6),
            },
        },
        Panel {
            title: "Reckoned memory of a whole run, for a particle".into(),
            plot: Plot::Lines { x: particles(), y: Axis::logarithmic("bytes"), lines: lines(|row| number(&row[7])) },
        },
    ];
    Figure {
        title: "How fast, at what size, with how many cracks".into(),
        caption: vec![
            "Total formulation, a plate pulled at two sides. Cracks at rest are as tough as can be, so that hardly any look \
             is taken at them; growing ones are weak and run all the time. Flaws are four cells long, so with few particles \
             there is no room for them. \
             The memory is what `fissure check` says: frames on their way to disk and meshes included."
                .into(),
            charting.origin.to_string(),
        ],
        columns: 2,
        panels,
    }
}
