//! Beam with three holes (Ingraffea & Grigoriu 1990; Bittencourt et al. 1996), specimen II: the path of a crack past
//! and into holes.
//!
//! In inches of 0.0254 m: beam 20 × 8, supports at x = 1 and 19 below, load at (10, 8), holes of diameter 0.5 at x = 6,
//! y = 2.75, 4.75, 6.75, notch of length 1 at x = 4. The path depends on the geometry alone; the material is PMMA in
//! plane stress. The load is constant and 30 % above what starts the crack. The beam is brought to rest whenever the
//! crack has grown by half a cell, so that the tip feels its load as if at rest.
//!
//! Reference: own finite element solution with increments of 0.015 (`assets/reference`): the crack enters the middle
//! hole, as in the experiment. Cells are counted per inch.

use crate::case::{Case, Options};
use crate::interpolate::columns;
use crate::problem::{Problem, material, rectangle};
use crate::report::{Expected, Tally};
use fissure_scene::{Curve, LoadKind, PlaneState, Point, Selection, TipState, Vector};
use fissure_sim::{Elastic, SimulationError};
use std::f64::consts::TAU;

pub(crate) const CASE: Case = Case::new(
    "three-holes",
    "path of a crack in a bent beam with three holes (specimen II)",
    ("per inch", 8.0),
    compute,
)
.family_cells(4.0)
.long();

/// Kinetic energy at rest between increments, as a part of the strain energy. With 1e-5 a beam that has only begun to
/// give way counts as at rest: K_I stayed behind by a quarter, and the path went astray by 0.1 in whatever the cells.
const PAUSE: f64 = 1e-7;
const INCH: f64 = 0.0254;
/// Heights of the holes at x = 6 [in].
const HOLES: [f64; 3] = [2.75, 4.75, 6.75];
const RADIUS: f64 = 0.25;
/// K_I at the start per load, in √in/in: 0.3369; K_II 0.0381.
const START: [f64; 2] = [0.3369, 0.0381];

/// The beam under a load of one K_Ic at the start times `over`.
fn problem(cells: f64, over: f64) -> Problem {
    let material = material(3.24e9, 0.35, 1190.0, 1e6);
    let load = over * material.fracture_toughness / START[0] * INCH.sqrt();
    let mut beam = rectangle((0.0, 0.0), (20.0 * INCH, 8.0 * INCH));
    for y in HOLES {
        // Clockwise, because it is a hole.
        let corner = |k: u8| -TAU * f64::from(k) / 64.0;
        let place = |angle: f64| Point::new((6.0 + RADIUS * angle.cos()) * INCH, (y + RADIUS * angle.sin()) * INCH);
        beam.holes.push((0..64).map(|k| place(corner(k))).collect());
    }
    // At least one particle: from 3 cells on .15 holds one wherever the grid lies.
    let radius = 0.15_f64.max(0.45 / cells) * INCH;
    let near = |x: f64, y: f64| Selection::Near { points: vec![Point::new(x * INCH, y * INCH)], radius };
    let cell_size = INCH / cells;
    Problem::new("three-holes", beam, material, PlaneState::Stress, cell_size)
        .crack(&[(4.0 * INCH, 0.0), (4.0 * INCH, INCH)], [false, true])
        .support(near(1.0, 0.0), [Some(0.0), Some(0.0)])
        .support(near(19.0, 0.0), [None, Some(0.0)])
        .load(near(10.0, 8.0), LoadKind::Force(Vector::new(0.0, -load)), Curve::default())
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    // Whole cells along the beam.
    let cells = 0.5 * (2.0 * options.cells_or(CASE.cells.1)).round();
    let mut problem = problem(cells, 1.3).growing();
    let scene = &mut problem.scene;
    // A frame is the time over which a tip averages its direction; it grows by an eighth of a cell in it.
    let window = 2.0 * scene.cell_size / Elastic::new(&scene.materials[0], scene.plane).shear_wave_speed();
    scene.growth.speed_limit = 0.067;
    scene.frames.rate = 1.0 / window;
    scene.frames.last = 1500;
    let half_cell = 0.5 * scene.cell_size;
    tally.say("coming to rest");
    let mut placed = tally.rest(&problem)?;
    let first = placed.now().tips()[0];
    let unit = 1.3 * 1e6 / START[0];
    tally.relative("K_I √inch/P at the start", "", first.mode_1 / unit, START[0], None);
    tally.absolute("K_II √inch/P at the start", "", first.mode_2 / unit, START[1], None);
    let angle = first.kink_angle.abs().to_degrees();
    tally.absolute("first kink", "°", angle, 12.6, None);
    tally.say("growing");
    let mut length = first.length;
    while !placed.is_finished() && placed.now().tips()[0].state.is_live() {
        placed.advance()?;
        let now = placed.now().tips()[0].length;
        if now > length + half_cell {
            length = now;
            tally.relax_to(PAUSE, &mut placed)?;
        }
    }
    tally.count_run(&placed);
    let frame = placed.now().frame();
    let found: Vec<Point> = frame.cracks[0].rest.iter().map(|p| p / INCH).collect();
    let reference: Vec<Point> = columns(include_str!("../../../../assets/reference/three_holes_path.csv"))
        .iter()
        .map(|c| Point::new(c[0], c[1]))
        .collect();
    // The reference ends short of the hole: its points are compared with the path found, which goes on.
    let apart = reference.iter().map(|&p| distance(p, &found)).fold(0.0, f64::max);
    tally.bound("largest distance from the reference path", "in", apart, Expected::AtMost(0.08));
    let end = found[found.len() - 1];
    let left = frame.tips[0].state == TipState::LeftBody;
    let into_middle = left && ((end - Point::new(6.0, HOLES[1])).norm() - RADIUS).abs() < 0.05;
    tally.bound("ends in the middle hole (1: yes)", "", f64::from(u8::from(into_middle)), Expected::AtLeast(1.0));
    tally.absolute("end of the path, x", "in", end.x, 5.77, None);
    tally.absolute("end of the path, y", "in", end.y, 4.65, None);
    Ok(())
}

/// Distance from a point to an open polyline.
fn distance(point: Point, line: &[Point]) -> f64 {
    line.windows(2)
        .map(|w| {
            let along = w[1] - w[0];
            let t = ((point - w[0]).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (point - (w[0] + along * t)).norm()
        })
        .fold(f64::INFINITY, f64::min)
}
