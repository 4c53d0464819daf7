//! First bending frequency of a cantilever.
//!
//! Length L, depth h, held at its left end; bent by a force at its right end, brought to rest and let go. The frequency
//! is counted from the zero crossings of the displacement, weighted by the shape of the first mode, over three periods.
//! Reference: ωL√(ρ/E) of an own finite element solution, ν = 0.3 (Euler and Bernoulli's beam is 0.7 to 2.8 % stiffer).
//! Cells are counted through the depth.

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, linear_material, rectangle};
use crate::report::Tally;
use fissure_scene::{BoxSide, Curve, LoadKind, PlaneState, Selection, Vector};
use fissure_sim::SimulationError;
use std::f64::consts::{PI, TAU};

pub(crate) const CASE: Case =
    Case::new("cantilever", "first bending frequency of a cantilever", ("through the depth", 8.0), compute);

/// (h/L, ωL√(ρ/E) in plane stress, in plane strain).
const FREQUENCIES: [(f64, f64, f64); 2] = [(0.1, 0.100830, 0.105763), (0.2, 0.197401, 0.206960)];

/// First mode of Euler and Bernoulli's cantilever at `x` from 0 to 1.
fn shape(x: f64) -> f64 {
    let z = 1.875_104_07 * x;
    z.cosh() - z.cos() - 0.734_095_5 * (z.sinh() - z.sin())
}

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cells = options.cells_or(CASE.cells.1).round();
    for (ratio, stress, strain) in FREQUENCIES {
        for (plane, name, reference) in
            [(PlaneState::Stress, "plane stress", stress), (PlaneState::Strain, "plane strain", strain)]
        {
            let of = format!("h/L {ratio}, {name}");
            tally.say(&of);
            // In cells, one cell being one metre.
            let (length, depth) = (cells / ratio, cells);
            let material = linear_material();
            let slow = (material.young_modulus / material.density).sqrt() / length;
            let period = TAU / (reference * slow);
            let force = Vector::new(0.0, 1e-6 * LINEAR_YOUNG * depth / length);
            let release = Curve { points: vec![(0.0, 1.0), (0.02 * period, 0.0)] };
            let right = Selection::Edge { side: BoxSide::Right, bodies: None };
            let left = Selection::Edge { side: BoxSide::Left, bodies: None };
            let problem = Problem::new("cantilever", rectangle((0.0, 0.0), (length, depth)), material, plane, 1.0)
                .support(left, [Some(0.0), Some(0.0)])
                .load(right, LoadKind::Traction(force), release)
                .until(3.0 * period, 240);
            let mut placed = tally.rest(&problem)?;
            let mut crossings = Vec::new();
            let mut last: Option<(f64, f64)> = None;
            tally.run_frames(&mut placed, |now| {
                let p = now.frame().particles;
                let bent: f64 =
                    p.rest.iter().zip(&p.position).map(|(rest, now)| shape(rest.x / length) * (now.y - rest.y)).sum();
                if let Some((time, before)) = last
                    && (before < 0.0) != (bent < 0.0)
                {
                    crossings.push(time + (now.time() - time) * before / (before - bent));
                }
                last = Some((now.time(), bent));
            })?;
            let found = match crossings.as_slice() {
                [first, .., last] => PI * (crossings.len() - 1) as f64 / (last - first) / slow,
                _ => f64::NAN,
            };
            tally.relative(format!("ωL√(ρ/E), {of}"), "", found, reference, 0.02);
        }
    }
    Ok(())
}
