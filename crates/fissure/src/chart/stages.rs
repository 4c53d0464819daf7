//! Where the time goes: the shares of the stages in each example.

use super::Charting;
use super::examples::{Example, examples};
use super::table::{Table, number};
use crate::failure::Failure;
use fissure_chart::{Bar, Figure, Panel, Plot};
use fissure_post::{PostOptions, post_frame};
use fissure_scene::Scene;
use fissure_sim::{Simulation, Stage};
use fissure_verify::cpu_time;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

const NAME: &str = "stages";
const COLUMNS: &str = "example,particles,steps,start,motion,looks,growth,between,frames,meshes";
/// Stages as the figure names them, in the order of their columns.
const STAGES: [&str; 7] = ["start", "motion", "looks at tips", "growth", "between steps", "frames", "meshes"];

/// How much coarser examples are when only the shape is wanted.
const COARSER_QUICK: f64 = 2.0;

/// Time of each stage.
#[derive(Debug, Default)]
struct Clock {
    spent: [Duration; STAGES.len()],
    now: usize,
    since: Duration,
}

impl Clock {
    fn enter(&mut self, stage: usize) {
        let time = cpu_time();
        self.spent[self.now] += time.saturating_sub(self.since);
        (self.now, self.since) = (stage, time);
    }
}

const START: usize = 0;
const BETWEEN: usize = 4;
const FRAMES: usize = 5;
const MESHES: usize = 6;

/// Measures what is missing and draws.
pub(super) fn chart(charting: &Charting<'_>, folder: &Path) -> Result<(), Failure> {
    let mut table = Table::open(&charting.folder, NAME, &charting.origin, COLUMNS)?;
    for Example { name, file } in examples(folder)? {
        if !table.rows().iter().any(|row| row[0] == name) {
            let mut scene = fissure_scene::load(&file, &[])?;
            if charting.quick {
                scene.particle_spacing *= COARSER_QUICK;
                scene.cell_size *= COARSER_QUICK;
            }
            let row = charting.showing(&name, |say| measure(&scene, say));
            match row {
                Ok(row) => table.add([name].into_iter().chain(row).collect())?,
                // With coarser cells there may be no room for what is thin.
                Err(failure) if charting.quick => charting.report.warn(&failure.during(name).to_string()),
                Err(failure) => return Err(failure.during(name)),
            }
        }
    }
    charting.draw(NAME, &figure(charting, &table))
}

/// Runs a scene to its end with the meshes of every frame, in memory: particles, steps and the time of each stage.
fn measure(scene: &Scene, say: &mut (dyn FnMut(&str) + Send)) -> Result<Vec<String>, Failure> {
    let clock = Arc::new(Mutex::new(Clock { since: cpu_time(), ..Clock::default() }));
    let mut simulation = Simulation::new(scene)?;
    let of_solver = clock.clone();
    simulation.watch_stages(Box::new(move |stage| {
        lock(&of_solver).enter(match stage {
            Stage::Motion => 1,
            Stage::Looks => 2,
            Stage::Growth => 3,
            Stage::Between => BETWEEN,
        });
    }));
    let options = PostOptions::from(&scene.output);
    loop {
        lock(&clock).enter(FRAMES);
        let frame = simulation.frame();
        simulation.save()?;
        lock(&clock).enter(MESHES);
        post_frame(scene, &frame, &options)?;
        if simulation.is_finished() {
            break;
        }
        lock(&clock).enter(BETWEEN);
        say(&format!("frame {}", frame.number));
        simulation.advance(&mut |_| std::ops::ControlFlow::Continue(()))?;
    }
    let mut clock = lock(&clock);
    clock.enter(START);
    let spent = clock.spent.map(|time| format!("{:.4}", time.as_secs_f64()));
    Ok([simulation.particles().to_string(), simulation.steps().to_string()].into_iter().chain(spent).collect())
}

fn lock(clock: &Mutex<Clock>) -> MutexGuard<'_, Clock> {
    clock.lock().unwrap_or_else(PoisonError::into_inner)
}

fn figure(charting: &Charting<'_>, table: &Table<'_>) -> Figure {
    let bar = |row: &Vec<String>| {
        let parts: Vec<f64> = row[3..].iter().map(|cell| number(cell)).collect();
        let seconds: f64 = parts.iter().sum();
        Bar { name: row[0].clone(), parts, note: format!("{seconds:.1} s, {} particles", row[1]) }
    };
    let bars = table.rows().iter().map(bar).collect();
    Figure {
        title: "Where the time goes".into(),
        caption: vec![
            "CPU time of whole runs of the examples, checked meshes of every frame included; nothing is written to disk. \
             Motion: forces, motion and contact. Between steps: limits of stability, energies, fragments."
                .into(),
            charting.origin.to_string(),
        ],
        columns: 1,
        panels: vec![Panel { title: String::new(), plot: Plot::Bars { parts: STAGES.map(str::to_owned).to_vec(), bars } }],
    }
}
