//! Contact of two equal discs pressed together, at rest.
//!
//! Radius R, plane strain, pressed by opposite forces P per thickness far from the contact. Reference: Hertz's
//! half-width, a² = 4 P R*/(π E*) with R* = R/2 and E* = E/(2 (1 − ν²)), and the approach of the centres of a cylinder
//! between two others, 2 P (1 − ν²)/(π E) · (2 ln(4R/a) − 1) (Johnson 1985, Contact Mechanics, chapter 5). The
//! half-width is that of the gap between the outlines beside the contact, h(x) = a²/(2R*) (ξ √(ξ² − 1) − ln(ξ + √(ξ² −
//! 1))), ξ = x/a, from 1.5 to 3 half-widths away. Cells are counted over the half-width.

use crate::case::{Case, Options};
use crate::problem::{LINEAR_YOUNG, Problem, linear_material, rectangle};
use crate::report::Tally;
use fissure_scene::{Body, Curve, LoadKind, OutlineFrame, PlaneState, Point, Region, Selection, Vector};
use fissure_sim::SimulationError;
use std::f64::consts::{PI, TAU};

pub(crate) const CASE: Case =
    Case::new("hertz", "half-width and approach of two discs pressed together", ("over the half-width", 4.0), compute);

const RADIUS: f64 = 1.0;
/// Half-width a [m].
const HALF_WIDTH: f64 = 0.08;
const POISSON: f64 = 0.3;
/// Corners of the polygons that stand for the discs.
const CORNERS: u16 = 2048;
/// The forces are spread over what is so far from the far ends of the discs [m].
const GRIP: f64 = 0.15;

fn compute(options: &Options, tally: &mut Tally<'_>) -> Result<(), SimulationError> {
    let cell_size = HALF_WIDTH / options.cells_or(CASE.cells.1);
    tally.say("pressed");
    let modulus = LINEAR_YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let force = HALF_WIDTH * HALF_WIDTH * PI * modulus / (2.0 * RADIUS);
    // With a corner at the contact, and so many that their chords are nowhere more than 2e-6 R within the circle.
    let corner = |k: u16, y: f64| {
        let (sine, cosine) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
        Point::new(RADIUS * cosine, y + RADIUS * sine)
    };
    let disc = |y: f64| Region { exterior: (0..CORNERS).map(|k| corner(k, y)).collect(), holes: Vec::new() };
    let grip = |y: f64, side: f64| {
        let (low, high) = if side < 0.0 { (y - RADIUS, y - RADIUS + GRIP) } else { (y + RADIUS - GRIP, y + RADIUS) };
        Selection::Region(rectangle((-GRIP, low), (GRIP, high)))
    };
    let push = |y: f64| LoadKind::Force(Vector::new(0.0, y));
    let mut problem = Problem::new("hertz", disc(-RADIUS), linear_material(), PlaneState::Strain, cell_size)
        .load(grip(-RADIUS, -1.0), push(force), Curve::default())
        .load(grip(RADIUS, 1.0), push(-force), Curve::default());
    let upper = Body { name: "upper".into(), region: disc(RADIUS), ..problem.scene.bodies[0].clone() };
    problem.scene.bodies.push(upper);
    let placed = tally.rest(&problem)?;
    let frame = placed.now().frame();
    let center = |body: u32, y: f64| {
        let near = |p: &usize| {
            frame.particles.body[*p] == body && (frame.particles.rest[*p] - Point::new(0.0, y)).norm() < 2.0 * cell_size
        };
        let own = (0..frame.particles.body.len()).filter(near);
        let moved = |p: usize| frame.particles.position[p].y - frame.particles.rest[p].y;
        let (sum, count) = own.fold((0.0, 0.0), |(sum, count), p| (sum + moved(p), count + 1.0));
        sum / count
    };
    let approach = center(0, -RADIUS) - center(1, RADIUS);
    let expected =
        2.0 * force * (1.0 - POISSON * POISSON) / (PI * LINEAR_YOUNG) * (2.0 * (4.0 * RADIUS / HALF_WIDTH).ln() - 1.0);
    tally.relative("approach", "m", approach, expected, 0.05);
    let outline = |body: u32| frame.outlines.iter().find(|o| o.body == body);
    let (Some(lower), Some(upper)) = (outline(0), outline(1)) else { return Ok(()) };
    tally.relative("half-width", "m", half_width(lower, upper), HALF_WIDTH, 0.05);
    Ok(())
}

/// The half-width of contact from the gap beside it.
fn half_width(lower: &OutlineFrame, upper: &OutlineFrame) -> f64 {
    let mut found = Vec::new();
    for p in &lower.position {
        let x = p.x.abs();
        if p.y.abs() > 0.1 * RADIUS || !(1.5 * HALF_WIDTH..3.0 * HALF_WIDTH).contains(&x) {
            continue;
        }
        let Some(y) = height_at(upper, p.x) else { continue };
        found.push(half_width_of(y - p.y, x));
    }
    found.iter().sum::<f64>() / found.len() as f64
}

/// Height of the lower side of an outline above x.
fn height_at(outline: &OutlineFrame, x: f64) -> Option<f64> {
    let n = outline.position.len();
    let edges = (0..n).map(|k| (outline.position[k], outline.position[(k + 1) % n]));
    let over = |(a, b): (Point, Point)| {
        let t = (x - a.x) / (b.x - a.x);
        (0.0..=1.0).contains(&t).then(|| a.y + t * (b.y - a.y))
    };
    edges.filter_map(over).min_by(f64::total_cmp)
}

/// The half-width with which two discs leave a `gap` at the distance `x` from the middle [m].
fn half_width_of(gap: f64, x: f64) -> f64 {
    let gap_of = |a: f64| {
        let ratio = x / a;
        let root = (ratio * ratio - 1.0).sqrt();
        a * a / RADIUS * (ratio * root - (ratio + root).ln())
    };
    // It falls as the half-width grows.
    let (mut low, mut high) = (1e-3 * x, x);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if gap_of(middle) > gap { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
