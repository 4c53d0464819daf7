//! From the grid to the particles: deformation, velocity, collision and advection (thesis 3.1.5 and 3.1.6).

use super::gather::{FromGrid, Wanted};
use super::gather_batch::{BATCH, Batch};
use super::lattice::Lattice;
use super::nodes::Nodes;
use super::plastic::PlasticPart;
use super::points::{MaterialPoint, Motion, Points};
use super::setup::Setup;
use super::survey::{Survey, SurveyOfPart};
use crate::SimulationError;
use crate::boundary::collider::PlacedObstacle;
use crate::threads::prelude::*;
use crate::wide::{Loop, run_widest};
use fissure_scene::{Kernel, Matrix, Point, Transfer};

/// Particles that one task takes.
const CHUNK: usize = 512;

/// A task: neighbouring particles and what they carry.
struct Task<'a> {
    first: usize,
    points: &'a mut [MaterialPoint],
    affine: &'a mut [Matrix],
    plastic: &'a mut [PlasticPart],
    motion: &'a mut [Motion],
    /// Where their lowest nodes are after the step, and their numbers.
    places: &'a mut [[i32; 2]],
    nodes: &'a mut [u32],
}

/// What a task reports.
#[derive(Debug)]
struct Report {
    /// Work of colliders on particles [J/m].
    work: f64,
    failure: Option<Failure>,
    /// Where its particles are after the step.
    survey: Survey,
}

/// A particle with which the run cannot go on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Failure {
    pub(super) particle: usize,
    cause: Cause,
}

#[derive(Debug, Clone, Copy)]
enum Cause {
    NotFinite,
    Inverted(f64),
    TooFast(f64),
}

impl Failure {
    /// The error of a particle that has come to `place` at `time` [s].
    pub(super) fn at(&self, place: Point, time: f64) -> SimulationError {
        let particle = self.particle;
        let cause = match self.cause {
            Cause::NotFinite => {
                format!("particle {particle} has lost its finite state; use a smaller `solver.courant` or weaker loads")
            }
            Cause::Inverted(ratio) => format!(
                "particle {particle} is turned inside out (volume ratio {ratio:.2}); use a smaller `solver.courant`, \
                 weaker loads, or a finer `grid.particle_spacing`"
            ),
            Cause::TooFast(cells) => format!(
                "particle {particle} moves by {cells:.2} cells in a step; use a smaller `solver.courant` or \
                 `solver.time_step`"
            ),
        };
        SimulationError::Unstable { time, x: place.x, y: place.y, cause }
    }
}

/// One step on the particles' side.
pub(super) struct ParticleStep<'a> {
    pub(super) from: FromGrid<'a>,
    /// The colliders where they are in the middle of the step.
    pub(super) obstacles: Vec<PlacedObstacle<'a>>,
    /// [s].
    pub(super) time_step: f64,
}

impl ParticleStep<'_> {
    /// Moves all particles; gives the work of colliders on them [J/m] and where they are then, with their `lowest`
    /// nodes.
    ///
    /// # Errors
    /// When a particle is no longer finite, is turned inside out, or moves by more than a cell.
    pub(super) fn advance(
        &self,
        points: &mut Points,
        lowest: &mut (Vec<[i32; 2]>, Vec<u32>),
    ) -> (Result<f64, Failure>, Survey) {
        match self.from.lattice.kernel {
            Kernel::Bilinear => self.all_tasks::<2>(points, lowest),
            Kernel::Gimp | Kernel::Quadratic => self.all_tasks::<3>(points, lowest),
            Kernel::Cubic => self.all_tasks::<4>(points, lowest),
        }
    }

    /// Cuts what all particles carry into tasks and runs them.
    fn all_tasks<const W: usize>(
        &self,
        all: &mut Points,
        (places, nodes): &mut (Vec<[i32; 2]>, Vec<u32>),
    ) -> (Result<f64, Failure>, Survey) {
        let mut affine = all.affine.chunks_mut(CHUNK);
        let mut plastic = all.plastic.chunks_mut(CHUNK);
        let mut motion = all.motion.chunks_mut(CHUNK);
        let mut places = places.chunks_mut(CHUNK);
        let mut nodes = nodes.chunks_mut(CHUNK);
        let cut = |(k, points)| Task {
            first: k * CHUNK,
            points,
            affine: affine.next().unwrap_or_default(),
            plastic: plastic.next().unwrap_or_default(),
            motion: motion.next().unwrap_or_default(),
            places: places.next().unwrap_or_default(),
            nodes: nodes.next().unwrap_or_default(),
        };
        let tasks: Vec<Task<'_>> = all.point.chunks_mut(CHUNK).enumerate().map(cut).collect();
        let run = |task: Task<'_>| run_widest(TaskOfStep::<W> { step: self, task });
        let reports: Vec<Report> = if self.from.setup.is_parallel() {
            tasks.into_par_iter().map(run).collect()
        } else {
            tasks.into_iter().map(run).collect()
        };
        let (mut work, mut survey) = (0.0, Survey::NONE);
        for report in &reports {
            work += report.work;
            survey = survey.with(report.survey);
        }
        (reports.iter().find_map(|report| report.failure).map_or(Ok(work), Err), survey)
    }
}

/// A task of a step, for a kernel of `W` nodes along an axis.
struct TaskOfStep<'a, 't, const W: usize> {
    step: &'a ParticleStep<'a>,
    task: Task<'t>,
}

impl<const W: usize> Loop for TaskOfStep<'_, '_, W> {
    type Output = Report;

    #[inline(always)]
    fn run(self) -> Report {
        let ParticleStep { from: FromGrid { setup, lattice, nodes }, obstacles, time_step } = self.step;
        run_task::<W>(setup, lattice, nodes, obstacles, *time_step, self.task)
    }
}

/// Runs a task. As arguments of their own the parts are known not to overlap what the task changes.
#[inline(always)]
fn run_task<const W: usize>(
    setup: &Setup,
    lattice: &Lattice,
    nodes: &Nodes,
    obstacles: &[PlacedObstacle<'_>],
    time_step: f64,
    task: Task<'_>,
) -> Report {
    let settings = &setup.scene.solver;
    let from = FromGrid { setup, lattice, nodes };
    let mut walker = from.walker();
    let mut wanted = Wanted::by(settings.transfer, settings.kernel);
    wanted.before |= !task.motion.is_empty();
    let (mut work, mut failure) = (0.0, None);
    let mut batch = Batch::<W>::NONE;
    for k in 0..task.points.len() {
        if k % BATCH == 0 {
            let points = &task.points[k..task.points.len().min(k + BATCH)];
            batch.fill(&from, &mut walker, points, wanted);
        }
        let (p, point) = (task.first + k, &mut task.points[k]);
        let g = batch.gathered(k % BATCH, &from, p, point, wanted);
        if let Some(motion) = task.motion.get_mut(k) {
            *motion = g.motion(time_step);
        }
        // F_E* = (I + Δt ∇v) F_E, eq. 13.
        let h = point.elastic_gradient;
        point.elastic_gradient = h + (g.gradient + g.gradient * h) * time_step;
        if let Some(part) = task.plastic.get_mut(k)
            && let Some(law) = &setup.scene.materials[setup.particles.material[p] as usize].plasticity
        {
            point.elastic_gradient = part.flow(point.elastic_gradient, law);
        }
        if let Some(c) = task.affine.get_mut(k) {
            *c = match settings.transfer {
                // The affine weights of the bilinear kernel are its gradients: of velocities that a node of hardly any
                // mass may have they would become anything.
                _ if W == 2 => g.gradient,
                Transfer::Aflip => *c * nodes.kept + g.affine,
                _ => g.affine,
            };
        }
        point.velocity = g.new_velocity(point.velocity, nodes.kept, settings.transfer);
        let mut advection = g.velocity;
        for obstacle in obstacles {
            let before = point.velocity;
            point.velocity = obstacle.resolve(before, point.position);
            if point.velocity != before {
                let impulse = (point.velocity - before) * setup.particles.mass[p];
                work += impulse.dot(&obstacle.velocity(point.position));
            }
            advection = obstacle.resolve(advection, point.position);
        }
        let motion = advection * time_step;
        point.position += motion;
        let ratio = 1.0 + crate::volume_change(&point.elastic_gradient);
        if failure.is_none() {
            failure = cause_of_failure(ratio, motion.norm_squared(), lattice.grid.cell_size)
                .map(|cause| Failure { particle: p, cause });
        }
    }
    let Task { points, places, nodes, .. } = task;
    Report { work, failure, survey: SurveyOfPart { lattice, points, places, nodes }.run() }
}

/// Why a particle with this volume ratio [–] that moves by this distance squared [m²] through cells of size `h` [m]
/// cannot go on.
#[inline(always)]
fn cause_of_failure(ratio: f64, way_squared: f64, h: f64) -> Option<Cause> {
    if ratio > 0.0 && way_squared < h * h {
        return None;
    }
    let is_finite = ratio.is_finite() && way_squared.is_finite();
    Some(match is_finite {
        false => Cause::NotFinite,
        true if ratio <= 0.0 => Cause::Inverted(ratio),
        true => Cause::TooFast(way_squared.sqrt() / h),
    })
}
