//! What meshes cost, stage by stage. `cargo bench --bench meshes`.
//!
//! | bench | what is timed |
//! |---|---|
//! | boolean | a plate less a crack of 1000 points, with `i_overlay` as it is used here and with `geo` |
//! | solid | a frame made a checked solid: boolean, triangles, extrusion |
//! | export | its file in memory |
//!
//! Here each edge of the result knows where it came from, and places are exact to the grid step in 64 bits; with `geo`
//! no edge does, and places have 32 bits of the size of the whole.
//!
//! Before that 10,000 openings from 1e-9 to 1e-1 m are taken off a plate with both engines, and it is told how many
//! areas come out wrong by more than rounding to the grid may make of 30 m, 1.1e-4 m².
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{Opened, frame, options, scene, square};
use criterion::Criterion;
use fissure_post::bench::twice_enclosed;
use fissure_post::{encode, post_frame};
use fissure_scene::{CrackEnd, Format, Point};
use geo::{Area, BooleanOps, Coord, LineString, Polygon};
use std::time::Duration;

/// Step of the grid for places of up to 20 m [m].
const STEP: f64 = 1.0 / 524_288.0;
/// Half a side of the plate, 20 m × 20 m, in grid steps.
const HALF: i64 = 5_242_880;

/// A ring of grid points, counter-clockwise.
type Ring = Vec<[i64; 2]>;

fn plate() -> Ring {
    vec![[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]]
}

fn polygon(ring: &Ring) -> Polygon<f64> {
    let corners = ring.iter().map(|&[x, y]| Coord { x: x as f64 * STEP, y: y as f64 * STEP });
    Polygon::new(LineString::new(corners.collect()), Vec::new())
}

/// Area of the plate less `opening` [m²], with the engine and the integers that are used here.
fn rest_on_the_grid(opening: &Ring) -> f64 {
    let clockwise: Ring = opening.iter().rev().copied().collect();
    0.5 * twice_enclosed(&[plate(), clockwise]) as f64 * STEP * STEP
}

/// The same with `geo`, in floating point.
fn rest_with_geo(opening: &Ring) -> f64 {
    polygon(&plate()).difference(&polygon(opening)).unsigned_area()
}

/// Numbers from 0 to below 1, the same every time.
fn uniform() -> impl FnMut() -> f64 {
    let mut state = 20_261_126_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A triangle whose base of some width lies 1 m above the plate and whose tip is in the plate, and the area that the
/// two have in common [m²].
fn opening(next: &mut impl FnMut() -> f64) -> (Ring, f64) {
    let width = ((10.0_f64.powf(-9.0 + 8.0 * next()) / STEP).round() as i64).max(1);
    let above = HALF + 524_288;
    let left = ((2.0 * next() - 1.0) * 0.9 * HALF as f64) as i64;
    let tip = [0.9, 0.9].map(|part| ((2.0 * next() - 1.0) * part * HALF as f64) as i64);
    let part = (HALF - tip[1]) as f64 / (above - tip[1]) as f64;
    let area = 0.5 * width as f64 * part * (HALF - tip[1]) as f64 * STEP * STEP;
    (vec![[left + width, above], [left, above], tip], area)
}

/// Counts areas that are off by more than rounding the crossings to the grid can make.
fn count_wrong_areas() {
    let mut next = uniform();
    let mut wrong = [0, 0];
    for _ in 0..10_000 {
        let (ring, area) = opening(&mut next);
        let expected = (2.0 * HALF as f64 * STEP).powi(2) - area;
        // Either side may move by a step along 30 m at most, and so many digits has the sum.
        let rounding = 2.0 * 30.0 * STEP + 1e-12 * expected;
        for (count, found) in wrong.iter_mut().zip([rest_on_the_grid(&ring), rest_with_geo(&ring)]) {
            *count += u32::from((found - expected).abs() > rounding);
        }
    }
    println!("wrong areas of 10000 openings: {} on the grid, {} with geo", wrong[0], wrong[1]);
    assert_eq!(wrong[0], 0);
}

/// A crack of `points` from the left side of a plate of 20 m that is open by a centimetre.
fn crack(points: u32) -> Opened {
    let at = |k: u32| f64::from(k) / f64::from(points - 1);
    let rest = (0..points).map(|k| Point::new(15.0 * at(k), 10.0 + 0.3 * (40.0 * at(k)).sin())).collect();
    let opening: Vec<f64> = (0..points).map(|k| 0.01 * (1.0 - at(k))).collect();
    Opened::symmetric(rest, &opening, CrackEnd::Mouth, CrackEnd::Tip)
}

fn booleans(criterion: &mut Criterion) {
    let crack = crack(1000);
    let grid = |p: &Point| [((p.x - 10.0) / STEP).round() as i64, ((p.y - 10.0) / STEP).round() as i64];
    let (above, below) = (crack.face(&crack.above), crack.face(&crack.below));
    let ring: Ring = below.iter().chain(above.iter().rev().skip(1)).map(grid).collect();
    let mut group = criterion.benchmark_group("boolean");
    group.bench_function("i_overlay on the grid", |b| b.iter(|| rest_on_the_grid(&ring)));
    group.bench_function("geo", |b| b.iter(|| rest_with_geo(&ring)));
    group.finish();
}

fn solids(criterion: &mut Criterion) {
    let region = square(20.0);
    let scene = scene(region.clone());
    let frame = frame(&region, 250, &[crack(1000)]);
    let make = || post_frame(&scene, &frame, &options(&scene)).unwrap();
    let mut group = criterion.benchmark_group("solid");
    group.bench_function("crack of 1000 points", |b| b.iter(|| make().parts.len()));
    group.finish();
    let made = make();
    let shot = made.shots(&scene, &frame).next().unwrap();
    let mut group = criterion.benchmark_group("export");
    for format in Format::ALL {
        group.bench_function(format.name(), |b| b.iter(|| encode(format, &shot).unwrap().len()));
    }
    group.finish();
}

fn main() {
    let (warm_up, measurement) = (Duration::from_millis(300), Duration::from_millis(1500));
    let criterion = Criterion::default().sample_size(10).warm_up_time(warm_up).measurement_time(measurement);
    let mut criterion = criterion.configure_from_args();
    count_wrong_areas();
    booleans(&mut criterion);
    solids(&mut criterion);
    criterion.final_summary();
}
