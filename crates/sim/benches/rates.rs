//! How fast the total Lagrangian formulation is, with and without cracks: a table of whole runs.
//!
//!     cargo bench --bench rates                # 250 cells along a side: 2.5e5 particles
//!     cargo bench --bench rates -- 87          # 3e4 particles
//!     RAYON_NUM_THREADS=1 cargo bench --bench rates
//!
//! A square plate is pulled at two sides. Cracks at rest are as tough as can be and their tips are looked at as in any
//! run; growing ones are weak. The clock starts when the first wave has been to the middle and back, and stops after as
//! many steps as fill some seconds. Rates are particles times steps over the time of all threads ("CPU") and over that
//! of a clock ("wall"); "of bulk" compares CPU time with that of the plate without a crack. Rates of a busy machine say
//! nothing: take the best of several.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[allow(dead_code)]
#[path = "../tests/cases/common.rs"]
mod common;

use common::{add_crack, plate, pull};
use fissure_scene::Scene;
use fissure_sim::Simulation;
use rustix::time::{ClockId, clock_gettime};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Steps that are timed, at least, and for how long.
const LEAST_STEPS: u64 = 40;
const LEAST_TIME: Duration = Duration::from_secs(2);

/// Steps before the clock starts, per cell along a side: waves take some two steps for a cell.
const STEPS_TO_LOAD: u64 = 2;

/// Tractions [Pa], and a toughness that no tip reaches [Pa √m].
const STRESS: f64 = 1e5;
const UNBREAKABLE: f64 = 1e12;

/// What a run took.
struct Timed {
    particles: usize,
    steps: u64,
    /// Increments of cracks in these steps.
    increments: u64,
    cpu: Duration,
    wall: Duration,
}

impl Timed {
    /// Particles times steps per time [1/s].
    fn rate(&self, time: Duration) -> f64 {
        self.particles as f64 * self.steps as f64 / time.as_secs_f64()
    }
}

/// Time that all threads have computed.
fn cpu_time() -> Duration {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(now.tv_sec as u64, now.tv_nsec as u32)
}

fn time(scene: &Scene, cells: u16) -> Timed {
    let mut simulation = Simulation::new(scene).unwrap();
    let particles = simulation.frame().particles.position.len();
    let first = STEPS_TO_LOAD * u64::from(cells);
    let mut started: Option<(u64, u64, Duration, Instant)> = None;
    let mut timed = None;
    let run = simulation.advance_observed(&mut |simulation, _| {
        let counts = simulation.counts();
        match started {
            None if counts.steps >= first => started = Some((counts.steps, counts.recuts, cpu_time(), Instant::now())),
            Some((steps, increments, cpu, wall)) => {
                let (steps, wall) = (counts.steps - steps, wall.elapsed());
                if steps >= LEAST_STEPS && wall >= LEAST_TIME {
                    let (increments, cpu) = (counts.recuts - increments, cpu_time() - cpu);
                    timed = Some(Timed { particles, steps, increments, cpu, wall });
                    return ControlFlow::Break(());
                }
            }
            None => (),
        }
        ControlFlow::Continue(())
    });
    run.unwrap();
    timed.unwrap()
}

/// A plate of 1 m × 1 m with an edge crack, or with `flaws` × `flaws` cracks of four cells.
fn cracked(cells: u16, flaws: Option<u16>, toughness: f64) -> Scene {
    let mut scene = plate([1.0, 1.0], 1.0 / f64::from(cells), 1.0);
    scene.frames.last = 1;
    scene.materials[0].fracture_toughness = toughness;
    pull(&mut scene, STRESS);
    let h = scene.cell_size;
    let Some(flaws) = flaws else {
        add_crack(&mut scene, &[[0.0, 0.503], [0.2, 0.503]]);
        return scene;
    };
    let columns = flaws.min(10);
    for k in 0..flaws {
        let (column, row) = (f64::from(k % columns), f64::from(k / columns));
        let middle = [
            (column + 0.5) / f64::from(columns),
            (row + 0.5) / f64::from(flaws.div_ceil(columns)) + 0.013 * f64::from(k % 3),
        ];
        add_crack(&mut scene, &[[middle[0] - 2.0 * h, middle[1]], [middle[0] + 2.0 * h, middle[1] + 0.3 * h]]);
    }
    scene
}

fn main() {
    let cells = std::env::args().filter_map(|word| word.parse().ok()).next().unwrap_or(250);
    let threads = std::env::var("RAYON_NUM_THREADS").ok().and_then(|count| count.parse().ok()).unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build_global().unwrap();
    let threads = rayon::current_num_threads();
    println!("{threads} threads, f64, {}\n", fissure_sim::widest_instructions());
    println!("| scene | particles | steps | increments | M/s CPU | M/s wall | of bulk |");
    println!("|---|---|---|---|---|---|---|");
    let mut bulk = plate([1.0, 1.0], 1.0 / f64::from(cells), 1.0);
    bulk.frames.last = 1;
    pull(&mut bulk, STRESS);
    let weak = bulk.materials[0].fracture_toughness;
    let scenes = [
        ("no crack", bulk),
        ("1 crack at rest", cracked(cells, None, UNBREAKABLE)),
        ("1 crack growing", cracked(cells, None, weak)),
        ("10 flaws at rest", cracked(cells, Some(10), UNBREAKABLE)),
        ("10 flaws growing", cracked(cells, Some(10), weak)),
        ("100 flaws at rest", cracked(cells, Some(100), UNBREAKABLE)),
        ("100 flaws growing", cracked(cells, Some(100), weak)),
    ];
    // One of them alone, for a profile: the words of its name.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word.parse::<u16>().is_err()).collect();
    let chosen = words.into_iter().filter(|word| !word.starts_with("--")).collect::<Vec<_>>().join(" ");
    let mut whole = None;
    for (name, scene) in scenes.iter().filter(|(name, _)| chosen.is_empty() || *name == chosen) {
        let timed = time(scene, cells);
        let (cpu, wall) = (timed.rate(timed.cpu), timed.rate(timed.wall));
        let part = 100.0 * cpu / *whole.get_or_insert(cpu);
        println!(
            "| {name} | {} | {} | {} | {:.1} | {:.1} | {part:.0} % |",
            timed.particles,
            timed.steps,
            timed.increments,
            cpu * 1e-6,
            wall * 1e-6
        );
    }
}
