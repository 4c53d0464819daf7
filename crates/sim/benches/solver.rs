//! What a step and growth cost, part by part. `cargo bench --bench solver`; rates are per particle and step.
//!
//! | bench | what is timed |
//! |---|---|
//! | rows | steps of a plate without cracks: the row forces |
//! | cut cells | the same with 25 cracks that are not looked at |
//! | contact | the same with the faces of the cracks pressed together |
//! | look | one measurement of each of 50 tips, per tip |
//! | recut | one increment of a crack taken up |
#![allow(clippy::unwrap_used)]

#[allow(dead_code)]
#[path = "../tests/cases/common.rs"]
mod common;

use common::{add_crack, plate, pull, updated};
use criterion::{Criterion, Throughput};
use fissure_scene::Scene;
use fissure_sim::Simulation;
use fissure_sim::bench::Bare;
use std::time::{Duration, Instant};

/// Cells along a side of the plate; four particles in each.
const CELLS: u16 = 50;

/// Simulates a formulation of a scene.
type Formulate = fn(Scene) -> Scene;

const FORMULATIONS: [(&str, Formulate); 2] = [("total", |scene| scene), ("updated", updated)];

/// A plate of 1 m × 1 m.
fn square() -> Scene {
    let mut scene = plate([1.0, 1.0], 1.0 / f64::from(CELLS), 1.0);
    scene.growth.enabled = false;
    scene
}

/// Adds 5 × 5 cracks of four cells.
fn add_cracks(scene: &mut Scene, tips: bool) {
    let h = scene.cell_size;
    for k in 0..25 {
        let middle = [10.0 * f64::from(k % 5) + 5.3, 10.0 * f64::from(k / 5) + 5.4].map(|x| x * h);
        add_crack(scene, &[[middle[0] - 2.0 * h, middle[1]], [middle[0] + 2.0 * h, middle[1] + 0.3 * h]]);
        for crack in &mut scene.cracks {
            (crack.start_live, crack.end_live) = (tips, tips);
        }
    }
}

/// Times the steps of a scene.
fn time_steps(criterion: &mut Criterion, group: &str, name: &str, scene: &Scene) {
    let mut solver = Bare::new(scene).unwrap();
    // What is pulled or pressed has begun to move.
    (0..20).for_each(|_| solver.step().unwrap());
    let mut group = criterion.benchmark_group(group);
    group.throughput(Throughput::Elements(solver.particles() as u64));
    group.bench_function(name, |b| b.iter(|| solver.step().unwrap()));
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    for (name, formulate) in FORMULATIONS {
        let mut scene = square();
        pull(&mut scene, 1e5);
        time_steps(criterion, "rows", name, &formulate(scene.clone()));
        add_cracks(&mut scene, false);
        scene.solver.crack_contact = false;
        time_steps(criterion, "cut cells", name, &formulate(scene.clone()));
        scene.solver.crack_contact = true;
        scene.loads.clear();
        pull(&mut scene, -1e5);
        time_steps(criterion, "contact", name, &formulate(scene));
    }
}

fn looks(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("look");
    for (name, formulate) in FORMULATIONS {
        let mut scene = square();
        pull(&mut scene, 1e5);
        add_cracks(&mut scene, true);
        let mut simulation = Simulation::new(&formulate(scene)).unwrap();
        simulation.measure_all();
        group.throughput(Throughput::Elements(simulation.counts().looks));
        group.bench_function(name, |b| b.iter(|| simulation.measure_all()));
    }
    group.finish();
}

fn recuts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("recut");
    for (name, formulate) in FORMULATIONS {
        let mut scene = square();
        add_crack(&mut scene, &[[0.0, 0.503], [0.2, 0.503]]);
        let scene = formulate(scene);
        // From a fifth of the plate to four fifths.
        let increments = (0.6 * f64::from(CELLS) / scene.growth.increment) as u64;
        let lay = || Bare::new(&scene).unwrap();
        group.bench_function(name, |b| {
            let (mut solver, mut left) = (lay(), increments);
            b.iter_custom(|count| {
                let mut time = Duration::ZERO;
                for _ in 0..count {
                    if left == 0 {
                        (solver, left) = (lay(), increments);
                    }
                    let start = Instant::now();
                    solver.lengthen(scene.growth.increment * scene.cell_size);
                    time += start.elapsed();
                    left -= 1;
                }
                time
            });
        });
    }
    group.finish();
}

fn main() {
    let (warm_up, measurement) = (Duration::from_millis(300), Duration::from_millis(1500));
    let criterion = Criterion::default().sample_size(10).warm_up_time(warm_up).measurement_time(measurement);
    let mut criterion = criterion.configure_from_args();
    steps(&mut criterion);
    looks(&mut criterion);
    recuts(&mut criterion);
    criterion.final_summary();
}
