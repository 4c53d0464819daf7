//! Thick ring under pressure on its inner or its outer edge, at rest (Lamé).
//!
//! Radii a = b/2 and b, plane strain, linear; nothing is held. Reference (closed form): σ_r = A − B/r² with
//! A = (p_a a² − p_b b²)/(b² − a²) and B = (p_a − p_b) a² b²/(b² − a²), so that
//! u_r = (1 + ν)/E [(1 − 2ν) A r + B/r]. Strain energy: half the work of the pressures. Cells are counted across the
//! ring.

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, disc, linear_material};
use crate::report::{Expected, Tally};
use fissure_scene::{Curve, LoadKind, OutlineStretch, PlaneState, Point, Selection};
use fissure_sim::SimulationError;
use std::f64::consts::TAU;

pub(crate) const CASE: Case = Case::new(
    "thick-ring",
    "displacement and energy of a thick ring under pressure inside or outside",
    ("across the ring", 12.0),
    compute,
);

/// a and b [m].
const RADII: [f64; 2] = [1.0, 2.0];
/// [Pa].
const PRESSURE: f64 = 1e3;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    let [a, b] = RADII;
    let material = linear_material();
    for (pressed, name) in [(0, "inside"), (1, "outside")] {
        tally.say(&format!("pressed {name}"));
        let mut region = disc(b);
        region.holes.push(disc(a).exterior.into_iter().rev().collect());
        let ring = if pressed == 0 { &region.holes[0] } else { &region.exterior };
        let side = |k: usize| OutlineStretch { body: 0, from: ring[k], to: ring[(k + 1) % ring.len()] };
        let edge = Selection::Outline((0..ring.len()).map(side).collect());
        let problem = Problem::new("thick-ring", region, material.clone(), PlaneState::Strain, (b - a) / cells)
            .at_rest()
            .load(edge, LoadKind::Pressure(PRESSURE), Curve::default());
        let placed = tally.rest(&problem)?;
        let p = [0, 1].map(|k| if k == pressed { PRESSURE } else { 0.0 });
        let square = b * b - a * a;
        let (uniform, radial) = ((p[0] * a * a - p[1] * b * b) / square, (p[0] - p[1]) * a * a * b * b / square);
        let poisson = material.poisson_ratio;
        let exact = |r: f64| (1.0 + poisson) / LINEAR_YOUNG * ((1.0 - 2.0 * poisson) * uniform * r + radial / r);
        let frame = placed.now().frame();
        let mut farthest = 0.0_f64;
        for (radius, edge) in [(a, "inner"), (b, "outer")] {
            let (mut sum, mut count) = (0.0, 0.0);
            let all = frame.outlines.iter().flat_map(|outline| outline.rest.iter().zip(&outline.position));
            for (rest, now) in all.filter(|(rest, _)| (from_middle(**rest) - radius).abs() < 1e-3 * radius) {
                let moved = (now - rest).dot(&rest.coords.normalize());
                sum += moved;
                count += 1.0;
                farthest = farthest.max((moved / exact(radius) - 1.0).abs());
            }
            let what = format!("mean radial displacement of the {edge} edge, pressed {name}");
            tally.relative(what, "m", sum / count, exact(radius), 0.01);
        }
        let what = format!("radial displacement of a corner, farthest off, pressed {name}");
        tally.bound(what, "%", 100.0 * farthest, Expected::AtMost(2.0));
        let energy = 0.5 * TAU * (p[0] * a * exact(a) - p[1] * b * exact(b));
        tally.relative(format!("strain energy, pressed {name}"), "J/m", placed.now().energies().strain, energy, 0.01);
    }
    Ok(())
}

fn from_middle(place: Point) -> f64 {
    place.coords.norm()
}
