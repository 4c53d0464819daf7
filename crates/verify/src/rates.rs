//! How fast the total formulation is, with and without cracks.
//!
//! A square plate is pulled at two sides. Cracks at rest are as tough as can be and their tips are looked at as in any
//! run; growing ones are weak. The clock starts when the first wave has been to the middle and back, and stops after as
//! many steps as fill some seconds.

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
    TimedPlate { name: "no crack", cracks: Cracks::None, grows: true },
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

    /// Times the plate for `least` at least; none: it cannot have its flaws with so few cells.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn time(&self, cells: u16, least: Duration) -> Result<Option<Rate>, SimulationError> {
        let Some(scene) = self.scene(cells) else { return Ok(None) };
        let mut simulation = Simulation::new(&scene)?;
        simulation.spare_looks();
        let particles = simulation.particles();
        let first = STEPS_TO_LOAD * u64::from(cells);
        let mut started: Option<(u64, u64, Duration, Instant)> = None;
        let mut rate = None;
        simulation.advance_observed(&mut |simulation, _| {
            let counts = simulation.counts();
            match started {
                None if counts.steps >= first => {
                    started = Some((counts.steps, counts.recuts, cpu_time(), Instant::now()));
                }
                Some((steps, recuts, cpu, wall)) => {
                    let (steps, wall) = (counts.steps - steps, wall.elapsed());
                    if steps >= LEAST_STEPS && wall >= least {
                        let (increments, cpu) = (counts.recuts - recuts, cpu_time() - cpu);
                        rate = Some(Rate { particles, steps, increments, cpu, wall });
                        return ControlFlow::Break(());
                    }
                }
                None => (),
            }
            ControlFlow::Continue(())
        })?;
        Ok(rate)
    }
}
