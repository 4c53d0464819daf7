//! What more cells buy to the eye: an example at four resolutions.

use super::Charting;
use super::examples::examples;
use super::shape::{shape, strokes};
use super::table::Table;
use crate::exit::Exit;
use crate::failure::Failure;
use fissure_chart::{Figure, Panel, Plot};
use fissure_sim::Simulation;
use fissure_verify::cpu_time;
use std::ops::ControlFlow;
use std::path::Path;

const NAME: &str = "visual";
const COLUMNS: &str = "coarser,spacing,particles,steps,cpu_seconds,shape";
/// The example: cracks that start, turn, divide and meet.
const EXAMPLE: &str = "glass-impact";
/// Factors on its spacing.
const COARSER: [f64; 4] = [4.0, 2.0, std::f64::consts::SQRT_2, 1.0];
const COARSER_QUICK: [f64; 4] = [4.0, 2.8, 2.0, std::f64::consts::SQRT_2];
/// Runs what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>, folder: &Path) -> Result<(), Failure> {
    let found = examples(folder)?.into_iter().find(|example| example.name == EXAMPLE).ok_or_else(|| {
        Failure::new(
            Exit::File,
            format!("no example `{EXAMPLE}` in `{}`", folder.display()),
            "say where it is with --examples",
        )
    })?;
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    let factors = if charting.quick { COARSER_QUICK } else { COARSER };
    for factor in factors {
        let at = format!("{factor:.3}");
        if table.rows().iter().any(|row| row[0] == at) {
            continue;
        }
        let mut scene = fissure_scene::load(&found.file, &[])?;
        scene.particle_spacing *= factor;
        scene.cell_size *= factor;
        let (before, mut simulation) = (cpu_time(), Simulation::new(&scene)?);
        let task = format!("{EXAMPLE}, cells × {factor:.1}");
        let run = charting.showing(&task, |say| {
            while !simulation.is_finished() {
                say(&format!("frame {}", simulation.frame_number()));
                simulation.advance(&mut |_| ControlFlow::Continue(()))?;
            }
            Ok::<(), Failure>(())
        });
        if let Err(failure) = run {
            // Coarse cells may not carry it through; what is shown is how far it came.
            charting.report.warn(&failure.during(task).to_string());
        }
        let seconds = (cpu_time() - before).as_secs_f64();
        table.add(vec![
            at,
            format!("{:e}", scene.particle_spacing),
            simulation.particles().to_string(),
            simulation.steps().to_string(),
            format!("{seconds:.3}"),
            shape(&scene, &simulation.frame()),
        ])?;
    }
    charting.draw(NAME, &figure(charting, &table, &factors))
}

fn figure(charting: &Charting<'_>, table: &Table<'_>, factors: &[f64]) -> Figure {
    let panel = |factor: &f64| {
        let at = format!("{factor:.3}");
        let row = table.rows().iter().find(|row| row[0] == at)?;
        let title = format!("{} particles: {} s", row[2], row[4]);
        Some(Panel { title, plot: Plot::Drawing(strokes(&row[5])) })
    };
    Figure {
        title: format!("What more cells buy: the last frame of {EXAMPLE}"),
        caption: vec!["CPU time of the solver. Outlines blue, cracks red.".into(), charting.origin.to_string()],
        columns: 4,
        panels: factors.iter().filter_map(panel).collect(),
    }
}
