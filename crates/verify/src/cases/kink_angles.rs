//! First kink of slanted cracks: the angle a crack under mixed load turns by.
//!
//! The plates of the slanted cracks, all slants on one grid. The plate is brought to rest; then K_Ic is put 2 % below
//! the K_eq of its tips, so that they grow. The kink is that of the first increment: beyond it the path bends at once,
//! in proportion to the root of the length and to the stress along the crack (Cotterell & Rice 1980), for β = 15° by a
//! quarter of the kink over three cells. Reference: maximum hoop stress (Erdogan & Sih 1963), θ = 2 atan2(−2 K_II,
//! K_I + √(K_I² + 8 K_II²)), with the ratio K_II/K_I of a finite element solution of the plate. Cells are counted along
//! half the crack.

use super::slanted_crack::{FACTORS, problem};
use crate::case::{Case, Options};
use crate::report::Tally;
use fissure_scene::End;
use fissure_sim::{SimulationError, StressIntensity};
use std::ops::ControlFlow;

pub(crate) const CASE: Case = Case::new(
    "kink-angles",
    "angle at which slanted cracks go on, all slants on one grid",
    ("along half the crack", 16.0),
    compute,
);

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    for (degrees, mode_1, mode_2) in FACTORS {
        tally.say(&format!("slant {degrees}°"));
        let exact = StressIntensity { mode_1, mode_2 }.kink_angle(1.0).to_degrees();
        let mut problem = problem(degrees, cells);
        let tips = tally.rest(&problem)?.now().tips();
        for (name, tip) in ["left", "right"].into_iter().zip(&tips) {
            let found = tip.kink_angle.to_degrees();
            tally.absolute(format!("angle asked for at rest, β {degrees}°, {name} tip"), "°", found, exact, 2.0);
        }
        // The same plate again, at the edge of growth: the toughness is part of the scene.
        let scene = &mut problem.scene;
        scene.materials[0].fracture_toughness = 0.98 * tips.iter().map(|t| t.equivalent).fold(f64::INFINITY, f64::min);
        scene.growth.enabled = true;
        // Ten crossings of the plate by a wave are plenty.
        let time = 40.0 * cells / (scene.materials[0].young_modulus / scene.materials[0].density).sqrt();
        scene.frames.rate = 100.0 / time;
        scene.frames.last = 100;
        let drawn = [End::Start, End::End].map(|end| scene_tip(scene, end));
        let mut placed = tally.rest(&problem)?;
        tally.run(&mut placed, |now, _| {
            let moved = now.tips().iter().zip(&drawn).all(|(tip, from)| (tip.position - from).norm() > 0.1);
            if moved { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        let frame = placed.now().frame();
        let slant = degrees.to_radians();
        for (name, end) in [("left", End::Start), ("right", End::End)] {
            let mut points = frame.cracks[0].rest.clone();
            if end == End::Start {
                points.reverse();
            }
            let ahead = if end == End::Start { slant + std::f64::consts::PI } else { slant };
            let found = kink(&points, scene_tip(&problem.scene, end), ahead);
            tally.absolute(format!("kink of the crack, β {degrees}°, {name} tip"), "°", found, exact, 2.0);
        }
    }
    Ok(())
}

/// Where the drawn crack of the scene ends [m].
fn scene_tip(scene: &fissure_scene::Scene, end: End) -> fissure_scene::Point {
    let points = &scene.cracks[0].points;
    if end == End::Start { points[0] } else { points[points.len() - 1] }
}

/// Angle between `ahead` [rad] and the chord from `tip` to the next point of the polyline [°]; NaN when there is none.
fn kink(points: &[fissure_scene::Point], tip: fissure_scene::Point, ahead: f64) -> f64 {
    let Some(begin) = points.iter().position(|p| (p - tip).norm() < 1e-6) else { return f64::NAN };
    let Some(next) = points.get(begin + 1) else { return f64::NAN };
    let turn = (next.y - tip.y).atan2(next.x - tip.x) - ahead;
    turn.sin().atan2(turn.cos()).to_degrees()
}
