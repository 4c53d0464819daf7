//! The layer of particles below an edge: how the edge moves, and how what acts on it acts on them, wherever it is on
//! the grid of a step.
//!
//! The velocity of an edge is that of the material below it, and what the strain between adds. With a weight φ over the
//! depth s, ∫ φ ds = 1, and Φ(s) = ∫_s φ ds', by parts
//!
//! v(0) = ∫ φ v ds − ∫ Φ ∂v/∂s ds,
//!
//! both as sums over particles, where the forces of stress come from, too. So a support, or a traction, acts on nodes
//! as the stress does that answers it: under a uniform one they cancel wherever the edge lies, but for the rule of
//! quadrature on (1 − Φ) N, which begins and ends smoothly. Means of the kernel along the edge itself leave nodes
//! outside of it with a quarter more or less of that stress: strains of the outer two cells were off by 30 %, and a bar
//! of 16 cells was soft by 1.2 %.

use super::lattice::Lattice;
use super::points::Points;
use super::setup::Setup;
use crate::boundary::edges::{Chain, EdgeMean, OnChain};
use fissure_plane::{bounds, segments_touch};
use fissure_scene::{Kernel, Matrix, Point, Vector};
use std::collections::BTreeMap;

/// Knots are no closer than this, in cells, wherever the grid lies beside them: waves between them are then longer than
/// those that the kernels cannot follow. Half a cell beside the nodes no quadratic spline tells hats of one cell apart.
const SPACING: f64 = 1.5;
/// Depth of the layer, in cells.
const DEPTH: f64 = 3.0;
/// That with the bilinear kernel, where each particle tells by itself how the edge moves: gradients do not vanish with
/// its weights, and a particle that has just entered a cell would act on a node of hardly any mass with the strain of
/// all that lies below. This holds one row of particles at least.
const BILINEAR_DEPTH: f64 = 0.6;
/// A line of material is counted with no more than so many times its length at rest, be it never so much torn.
const MOST_STRETCH: f64 = 4.0;

/// The layer below an edge.
#[derive(Debug)]
pub(super) struct EdgeLayer {
    /// Length that each hat along the edge stands for [m].
    lengths: Vec<f64>,
    /// Whether each of them has particles.
    is_whole: bool,
    /// Whether forces act on particles themselves, not beyond them.
    is_bilinear: bool,
    particles: Vec<LayerParticle>,
}

/// A particle of the layer.
#[derive(Debug)]
struct LayerParticle {
    particle: u32,
    /// Towards the edge at rest, of length 1.
    outwards: Vector,
    /// The hats that are not zero beside it, each with the particle's part of its mean.
    hats: [(usize, Part); 2],
}

/// How much of a particle is in the velocity at the edge, v + ∇v · `reach` n with n its line outwards.
#[derive(Debug, Clone, Copy, Default)]
struct Part {
    velocity: f64,
    /// [m].
    reach: f64,
}

/// A force that acts on a particle of a layer, and beyond it.
#[derive(Debug, Clone, Copy)]
pub(super) struct LayerForce {
    particle: u32,
    outwards: Vector,
    /// Per traction: on the particle [m], and along its line outwards [m²].
    part: Part,
}

/// What hats are made of: sums over particles.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    velocity: f64,
    depth: f64,
    strain: f64,
}

impl EdgeLayer {
    /// The layer below a chain.
    pub(super) fn new(setup: &Setup, chain: &Chain) -> Self {
        let (length, h) = (chain.length(), setup.scene.cell_size);
        let is_bilinear = setup.scene.solver.kernel == Kernel::Bilinear;
        let depth = h * if is_bilinear { BILINEAR_DEPTH } else { DEPTH };
        let pieces = (length / (SPACING * h)).floor().max(1.0);
        // That of a closed chain begins where it ends.
        let knots = if chain.is_closed { pieces as usize } else { pieces as usize + 1 };
        let ways: Vec<f64> = (0..knots).map(|k| length * k as f64 / pieces).collect();
        let is_end = |k: usize| !chain.is_closed && (k == 0 || k + 1 == knots);
        let lengths = (0..knots).map(|k| length / pieces * if is_end(k) { 0.5 } else { 1.0 }).collect();

        let gaps = gaps_near(setup, chain, depth);
        let mut sums = vec![Sums::default(); knots];
        let mut particles: Vec<LayerParticle> = Vec::new();
        for (p, at) in below(setup, chain, depth) {
            let up = at.place - setup.particles.rest[p];
            let t = up.norm() / depth;
            if at.is_beyond || t <= 0.0 || t >= 1.0 {
                continue;
            }
            // A hair below the edge, where cracks begin.
            let (rest, top) = (setup.particles.rest[p], at.place - up * 1e-6);
            if gaps.iter().any(|gap| segments_touch(rest, top, gap[0], gap[1])) {
                continue;
            }
            // φ and Φ, without dimension.
            let [velocity, strain] = match is_bilinear {
                true => [1.0, t],
                false => [6.0 * t * (1.0 - t), 1.0 - t * t * (3.0 - 2.0 * t)],
            };
            let hats = chain.hats(&ways, at.way).map(|(knot, hat)| {
                let weight = setup.particles.volume[p] * hat;
                let sum = &mut sums[knot];
                sum.velocity += weight * velocity;
                sum.depth += weight * velocity * up.norm();
                sum.strain += weight * strain;
                (knot, Part { velocity: weight * velocity, reach: weight * strain })
            });
            particles.push(LayerParticle { particle: p as u32, outwards: up.normalize(), hats });
        }
        for (knot, part) in particles.iter_mut().flat_map(|of| &mut of.hats) {
            let sum = &sums[*knot];
            if sum.velocity > 0.0 {
                // So that a velocity that is linear in depth is found as it is at the edge.
                part.velocity /= sum.velocity;
                part.reach *= sum.depth / (sum.velocity * sum.strain);
            }
        }
        Self { lengths, is_whole: sums.iter().all(|sum| sum.velocity > 0.0), is_bilinear, particles }
    }

    /// Whether material is below all of the edge.
    pub(super) fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Means of the velocity along the edge, on the grid of a step.
    pub(super) fn means(&self, points: &Points, lattice: &Lattice) -> Vec<EdgeMean> {
        let mut sums: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.lengths.len()];
        for of in &self.particles {
            let p = of.particle as usize;
            let line = line_outwards(points, p, of.outwards);
            lattice.for_each_slope(p, points.point[p].position, |field, w, slope| {
                let slope = slope.dot(&line);
                for &(knot, part) in of.hats.iter().filter(|(_, part)| part.velocity > 0.0) {
                    sums[knot].push((field as u32, part.velocity * w + part.reach * slope));
                }
            });
        }
        sums.into_iter().filter_map(mean).collect()
    }

    /// How a traction of 1 all along the edge acts; with the bilinear kernel on particles alone: what acts along its
    /// gradients meets nodes of hardly any mass, which gained up to 9 % of energy from a sudden traction.
    pub(super) fn forces(&self) -> impl Iterator<Item = LayerForce> {
        let beyond = if self.is_bilinear { 0.0 } else { 1.0 };
        self.particles.iter().map(move |of| {
            let mut sum = Part::default();
            for &(knot, part) in &of.hats {
                sum.velocity += self.lengths[knot] * part.velocity;
                sum.reach += beyond * self.lengths[knot] * part.reach;
            }
            LayerForce { particle: of.particle, outwards: of.outwards, part: sum }
        })
    }
}

impl LayerForce {
    pub(super) fn particle(&self) -> usize {
        self.particle as usize
    }

    /// Calls `visit` with each field and the part of a traction of 1 that acts on it [m].
    pub(super) fn for_each_entry(&self, points: &Points, lattice: &Lattice, mut visit: impl FnMut(usize, f64)) {
        let p = self.particle();
        let line = line_outwards(points, p, self.outwards) * self.part.reach;
        let place = points.point[p].position;
        lattice.for_each_slope(p, place, |field, w, slope| visit(field, self.part.velocity * w + slope.dot(&line)));
    }

    /// Velocity of the edge that it acts on times the length that it stands for [m²/s], for the `velocity` of its
    /// particle [m/s] and the `gradient` of that [1/s].
    pub(super) fn velocity(&self, points: &Points, velocity: Vector, gradient: Matrix) -> Vector {
        velocity * self.part.velocity
            + gradient * (line_outwards(points, self.particle(), self.outwards) * self.part.reach)
    }
}

/// The particles of a body within boxes as much larger than the edges of a chain as `depth` [m], each with the place on
/// it that is nearest.
fn below(setup: &Setup, chain: &Chain, depth: f64) -> BTreeMap<usize, OnChain> {
    let particles = &setup.particles;
    let mut nearest: BTreeMap<usize, OnChain> = BTreeMap::new();
    for (k, ends) in chain.points.windows(2).enumerate() {
        let reach = Vector::repeat(depth);
        let around = particles.in_box(ends[0].inf(&ends[1]) - reach, ends[0].sup(&ends[1]) + reach);
        for p in around.filter(|&p| particles.body[p] as usize == chain.body) {
            let at = chain.nearest_on(k, particles.rest[p]);
            let known = nearest.entry(p).or_insert(at);
            if at.distance < known.distance {
                *known = at;
            }
        }
    }
    nearest
}

/// Drawn cracks, and edges of the body that are not of the chain, within `depth` of it [m]: what lies behind them does
/// not move as the edge does.
fn gaps_near(setup: &Setup, chain: &Chain, depth: f64) -> Vec<[Point; 2]> {
    let reach = Vector::repeat(depth);
    let (low, high) = bounds(&chain.points);
    let cracks = setup.scene.cracks.iter().flat_map(|crack| crack.points.windows(2).map(|w| [w[0], w[1]]));
    let of_ring = |ring: &[Point]| (0..ring.len()).map(|k| [ring[k], ring[(k + 1) % ring.len()]]).collect::<Vec<_>>();
    let rings = setup.scene.bodies[chain.body].region.rings().flat_map(of_ring);
    let others = rings.filter(|edge| !chain.points.windows(2).any(|w| w == edge.as_slice()));
    let is_near = |gap: &[Point; 2]| gap[0].sup(&gap[1]) >= low - reach && gap[0].inf(&gap[1]) <= high + reach;
    cracks.chain(others).filter(is_near).collect()
}

/// What has become of a line of length 1 at a particle, `outwards` at rest.
fn line_outwards(points: &Points, particle: usize, outwards: Vector) -> Vector {
    ((Matrix::identity() + points.total_gradient(particle)) * outwards).cap_magnitude(MOST_STRETCH)
}

/// Weights as a mean, those of a field together; none of nothing.
pub(super) fn mean(mut weights: Vec<(u32, f64)>) -> Option<EdgeMean> {
    weights.sort_by_key(|(field, _)| *field);
    let total: f64 = weights.iter().map(|(_, w)| w).sum();
    let of_fields = weights.chunk_by(|a, b| a.0 == b.0);
    let mean = of_fields.map(|same| (same[0].0, same.iter().map(|(_, w)| w).sum::<f64>() / total));
    (total > 0.0).then(|| mean.filter(|(_, w)| w.abs() > 1e-12).collect())
}
