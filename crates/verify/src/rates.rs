//! How fast the total formulation is, with and without cracks.
//!
//! A square plate is pulled at two sides. Cracks at rest are as tough as can be and their tips are looked at as in any
//! run; growing ones are weak. The clock starts when the first wave has been to the middle and back, and stops after as
//! many steps as fill some seconds. Cracks soon have crossed a small plate: it is pulled again and again, and only the
//! time counts in which one grows.

use crate::cpu_time::cpu_time;
use crate::problem::{LINEAR_YOUNG, Problem, material, rectangle};
use fissure_scene::{BoxSide, Formulation, PlaneState, Scene};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A plate that is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimedPlate {
    /// Its name, as in tables.
    pub name: &'static str,
    cracks: Cracks,
    grows: bool,
}

/// What cracks a plate has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cracks {
    None,
    /// One from the edge, a fifth of the plate long.
    Edge,
    /// So many of four cells: ten, each in a row of its own, or rows of ten.
    Flaws(u16),
}

/// All plates.
pub const TIMED_PLATES: [TimedPlate; 7] = [
    TimedPlate { name: "no crack", cracks: Cracks::None, grows: false },
    TimedPlate { name: "1 crack at rest", cracks: Cracks::Edge, grows: false },
    TimedPlate { name: "1 crack growing", cracks: Cracks::Edge, grows: true },
    TimedPlate { name: "10 flaws at rest", cracks: Cracks::Flaws(10), grows: false },
    TimedPlate { name: "10 flaws growing", cracks: Cracks::Flaws(10), grows: true },
    TimedPlate { name: "100 flaws at rest", cracks: Cracks::Flaws(100), grows: false },
    TimedPlate { name: "100 flaws growing", cracks: Cracks::Flaws(100), grows: true },
];

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Number of particles.
    pub particles: usize,
    /// Steps that were timed.
    pub steps: u64,
    /// Increments of cracks in these steps.
    pub increments: u64,
    /// Time of all threads.
    pub cpu: Duration,
    /// Time of a clock.
    pub wall: Duration,
}

impl Rate {
    /// This one and another one of the same plate together.
    fn and(self, other: Rate) -> Rate {
        Rate {
            particles: self.particles,
            steps: self.steps + other.steps,
            increments: self.increments + other.increments,
            cpu: self.cpu + other.cpu,
            wall: self.wall + other.wall,
        }
    }

    /// Particles times steps per time [1/s].
    pub fn per_second(&self, time: Duration) -> f64 {
        self.particles as f64 * self.steps as f64 / time.as_secs_f64()
    }
}

/// Tractions [Pa], and toughnesses [Pa √m]: that of cracks that grow, and one that no tip reaches.
const STRESS: f64 = 1e5;
const WEAK: f64 = 1e4;
const UNBREAKABLE: f64 = 1e12;

/// Rows of flaws, and places in a row.
const ROWS: u16 = 10;

/// Steps that are timed, at least.
const LEAST_STEPS: u64 = 40;
/// What has not grown for so many steps grows no more.
const STEPS_BETWEEN_INCREMENTS: u64 = 16;
/// Steps before the clock starts, per cell along a side: waves take some two steps for a cell.
const STEPS_TO_LOAD: u64 = 2;

impl TimedPlate {
    /// The plate, 1 m × 1 m, with so many cells along a side; none: its flaws would touch.
    pub fn scene(&self, cells: u16) -> Option<Scene> {
        let h = 1.0 / f64::from(cells);
        let toughness = if self.grows { WEAK } else { UNBREAKABLE };
        let material = material(LINEAR_YOUNG, 0.3, 1000.0, toughness);
        let square = rectangle((0.0, 0.0), (1.0, 1.0));
        let mut problem = Problem::new("plate", square, material, PlaneState::Strain, h)
            .traction(BoxSide::Top, 0.0, STRESS)
            .traction(BoxSide::Bottom, 0.0, -STRESS)
            .growing()
            .until(1.0, 1);
        problem.scene.solver.formulation = Formulation::Total;
        match self.cracks {
            Cracks::None => {}
            Cracks::Edge => problem = problem.crack(&[(0.0, 0.503), (0.2, 0.503)], [false, true]),
            Cracks::Flaws(count) => {
                // Four cells of crack, and as many between two.
                if cells < 8 * ROWS {
                    return None;
                }
                // Side by side in one row they would have run into each other before the clock starts.
                let place = |k: u16| if count > ROWS { (k % ROWS, k / ROWS) } else { (3 * k % ROWS, k) };
                for k in 0..count {
                    let (column, row) = place(k);
                    let x = (f64::from(column) + 0.5) / f64::from(ROWS);
                    let y = (f64::from(row) + 0.5) / f64::from(ROWS) + 0.013 * f64::from(k % 3);
                    problem = problem.crack(&[(x - 2.0 * h, y), (x + 2.0 * h, y + 0.3 * h)], [true, true]);
                }
            }
        }
        Some(problem.scene)
    }

    /// Times the plate for `least` at least, in as many runs as that takes; none: it cannot have its flaws with so few
    /// cells. Of cracks that grow only the time counts in which one does.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn time(&self, cells: u16, least: Duration) -> Result<Option<Rate>, SimulationError> {
        let Some(scene) = self.scene(cells) else { return Ok(None) };
        let mut whole: Option<Rate> = None;
        loop {
            let left = least.saturating_sub(whole.map_or(Duration::ZERO, |rate| rate.wall));
            let found = self.time_once(&scene, cells, left)?;
            if found.steps == 0 {
                return Ok(whole);
            }
            let sum = whole.map_or(found, |rate| rate.and(found));
            whole = Some(sum);
            if sum.wall >= least && sum.steps >= LEAST_STEPS {
                return Ok(whole);
            }
        }
    }

    /// Times one run, for `least` if it goes on for so long.
    fn time_once(&self, scene: &Scene, cells: u16, least: Duration) -> Result<Rate, SimulationError> {
        let mut simulation = Simulation::new(scene)?;
        simulation.spare_looks();
        let particles = simulation.particles();
        let first = STEPS_TO_LOAD * u64::from(cells);
        let mut started: Option<(u64, u64, Duration, Instant)> = None;
        let rate = |(steps, recuts, cpu, wall): (u64, u64, Duration, Instant), simulation: &Simulation| {
            let counts = simulation.counts();
            let (steps, increments) = (counts.steps - steps, counts.recuts - recuts);
            Rate { particles, steps, increments, cpu: cpu_time() - cpu, wall: wall.elapsed() }
        };
        let mut timed = None;
        // The last step with an increment, and how many there had been.
        let mut grown = (0, 0);
        simulation.advance_observed(&mut |simulation, _| {
            let counts = simulation.counts();
            if counts.recuts > grown.1 {
                grown = (counts.steps, counts.recuts);
            }
            match started {
                None if counts.steps >= first && (!self.grows || grown.0 == counts.steps) => {
                    started = Some((counts.steps, counts.recuts, cpu_time(), Instant::now()));
                }
                Some(start) => {
                    let is_enough = counts.steps - start.0 >= LEAST_STEPS && start.3.elapsed() >= least;
                    if is_enough || self.grows && counts.steps - grown.0 > STEPS_BETWEEN_INCREMENTS {
                        timed = Some(rate(start, simulation));
                        return ControlFlow::Break(());
                    }
                }
                None => (),
            }
            ControlFlow::Continue(())
        })?;
        let nothing = Rate { particles, steps: 0, increments: 0, cpu: Duration::ZERO, wall: Duration::ZERO };
        Ok(timed.or_else(|| started.map(|start| rate(start, &simulation))).unwrap_or(nothing))
    }
}
