//! What a scene will cost, from counts alone: the same scene has the same estimate every time, and none fails that
//! would run.

use super::Simulation;
use crate::foresight::{self, Accuracy, Course};
use crate::{SimulationError, formulation, memory};
use fissure_scene::{Formulation, Kernel, Scene};

/// What a scene will cost, known before it runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Number of particles.
    pub particles: usize,
    /// Number of grid cells that hold material.
    pub cells: usize,
    /// Time step [s].
    pub time_step: f64,
    /// Largest stable time step [s].
    pub stable_time_step: f64,
    /// Number of steps for all frames.
    pub steps: u64,
    /// Name of the formulation and the reason for it.
    pub formulation: String,
    /// Memory a run takes at most, frames on their way to disk and meshes included [bytes].
    pub memory: u64,
    /// How right the highest K of each tip will be; none: no tip waits for its K.
    pub accuracy: Option<Accuracy>,
    /// Length by which cracks are expected to grow [m], roughly.
    pub growth: f64,
    /// Wall time of the solver with the writing of its frames [s], on the two-core machine that the costs of its parts
    /// were measured on.
    pub seconds: f64,
    /// The same by what it is spent on.
    pub parts: TimeParts,
}

/// What the time of a run is spent on [s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeParts {
    /// Forces, motion and contact in all steps.
    pub motion: f64,
    /// J and K at tips.
    pub looks: f64,
    /// Cutting anew where cracks grow.
    pub growth: f64,
    /// The start, and frames.
    pub frames: f64,
}

/// Seconds that parts of a run take. Fitted to the stages of the examples on one core of a server of 2023 (`fissure
/// chart stages`), which has AVX-512.
struct Costs {
    /// A step of a particle in the total formulation, with the four nodes of the bilinear kernel.
    total_step: f64,
    /// A step of a cell that a crack goes through: forces of cut cells, contact of faces.
    cut_step: f64,
    /// A step of a particle in the updated one, per node of its kernel.
    updated_step: f64,
    /// One look at one tip: a domain of about 450 particles.
    look: f64,
    /// Growth of a crack by one cell: what is near is cut anew at every increment ...
    grown_cell: f64,
    /// ... which takes by this part more for every other crack, ...
    other_crack: f64,
    /// ... up to so many times as long.
    most_others: f64,
    /// One particle of one frame: recorded, written, its state saved.
    recorded: f64,
    /// A start.
    start: f64,
}

const COSTS: Costs = Costs {
    total_step: 1.4e-9,
    cut_step: 1.05e-6,
    updated_step: 8e-9,
    look: 3.1e-5,
    grown_cell: 0.002,
    other_crack: 0.15,
    most_others: 2.0,
    recorded: 3.5e-7,
    start: 0.02,
};

/// Part of what grows that is there in the mean over a run.
const GROWN_IN_MEAN: f64 = 0.6;

/// Material that flows stiffens as it is compressed, and takes so many times the steps of the beginning.
const STIFFENING: f64 = 3.0;

/// A tip looks at every step when it is near growth and at every fourth when not: so many of the steps on the whole.
const LOOKS_PER_STEP: f64 = 0.6;

impl Simulation {
    /// What running `scene` will cost. Lays particles and grid, and takes no step.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn estimate(scene: &Scene) -> Result<Estimate, SimulationError> {
        let simulation = Self::new(scene)?;
        let time_step = simulation.largest_time_step();
        let interval = 1.0 / scene.frames.rate;
        let steps_per_frame = (interval / time_step).ceil().max(1.0);
        let frames = scene.frames.count().saturating_sub(1) as f64;
        let choice = formulation::choose(scene, &simulation.elastic);
        let name = match choice.formulation {
            Formulation::Updated => "updated Lagrangian",
            _ => "total Lagrangian",
        };
        let course = Course::of(scene, &simulation.elastic);
        let parts = simulation.expected_seconds(steps_per_frame * frames, frames + 1.0, course);
        Ok(Estimate {
            particles: simulation.particles.len(),
            cells: simulation.cells_with_material(),
            time_step: interval / steps_per_frame,
            stable_time_step: simulation.stable_time_step,
            steps: (steps_per_frame * frames) as u64,
            formulation: format!("{name}: {}", choice.reason),
            memory: memory::needed(&simulation.scene, simulation.formulation, course.growth) as u64,
            accuracy: foresight::accuracy(&simulation.scene, &simulation.elastic, simulation.formulation),
            growth: course.growth,
            seconds: parts.motion + parts.looks + parts.growth + parts.frames,
            parts,
        })
    }

    /// Wall time for so many steps and frames, with cracks that take `course`.
    fn expected_seconds(&self, steps: f64, frames: f64, course: Course) -> TimeParts {
        let particles = self.particles.len() as f64;
        let flows = self.scene.materials.iter().any(|m| m.plasticity.is_some());
        let nodes = match self.scene.solver.kernel {
            Kernel::Bilinear => 4.0,
            // At rest it is the bilinear one.
            Kernel::Gimp if self.formulation == Formulation::Total => 4.0,
            Kernel::Gimp | Kernel::Quadratic => 9.0,
            Kernel::Cubic => 16.0,
        };
        let step = match self.formulation {
            Formulation::Updated if flows => COSTS.updated_step * nodes * STIFFENING,
            Formulation::Updated => COSTS.updated_step * nodes,
            _ => COSTS.total_step * nodes / 4.0,
        };
        let end = self.scene.frames.time(self.scene.frames.last);
        let looks = if end > 0.0 { LOOKS_PER_STEP * steps * course.watched / end } else { 0.0 };
        let h = self.scene.cell_size;
        let drawn: f64 = self.scene.cracks.iter().map(|crack| fissure_plane::polyline_length(&crack.points)).sum();
        let cut = (drawn + GROWN_IN_MEAN * course.growth) / h;
        // With more increments to a cell it is cut anew more often.
        let often = (0.125 / self.scene.growth.increment).max(0.25);
        let others = (COSTS.other_crack * (self.scene.cracks.len() as f64 - 1.0)).clamp(0.0, COSTS.most_others - 1.0);
        let grown = course.growth / h * often * (1.0 + others);
        let motion = match self.formulation {
            // The step of a particle counts them there.
            Formulation::Updated => step * particles * steps,
            _ => (step * particles + COSTS.cut_step * cut) * steps,
        };
        TimeParts {
            motion,
            looks: COSTS.look * looks,
            growth: COSTS.grown_cell * grown,
            frames: COSTS.start + COSTS.recorded * particles * frames,
        }
    }

    fn cells_with_material(&self) -> usize {
        let h = self.scene.cell_size;
        let cell = |place: &fissure_scene::Point| {
            let x = (place - self.particles.anchor) / h;
            (x.x.floor() as i64, x.y.floor() as i64)
        };
        let mut cells: Vec<(i64, i64)> = self.particles.rest.iter().map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        cells.len()
    }
}
