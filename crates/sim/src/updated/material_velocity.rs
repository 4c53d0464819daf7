//! How fast the material at a place moves, by the velocities on the grid.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::setup::Setup;
use fissure_scene::{Matrix, Point, Vector};

/// Nodes with less than this part of a particle's mass are left out: force over mass is mostly noise there.
const LEAST_MASS: f64 = 1e-3;

/// Sums for the value of a velocity field at a place.
///
/// Where all nodes have material this is Σ v_i w_i. Elsewhere it is the linear field that fits the nodes with material
/// best, in the sense of weighted least squares: exact for rigid and any other linear motion.
#[derive(Debug, Clone, Copy, Default)]
struct LinearFit {
    weight: f64,
    arm: Vector,
    spread: Matrix,
    velocity: Vector,
    product: Matrix,
}

impl LinearFit {
    /// `arm`: from the place to the node.
    fn add(&mut self, weight: f64, arm: Vector, velocity: Vector) {
        self.weight += weight;
        self.arm += arm * weight;
        self.spread += arm * arm.transpose() * weight;
        self.velocity += velocity * weight;
        self.product += velocity * arm.transpose() * weight;
    }

    fn value(&self) -> Option<Vector> {
        if self.weight <= 0.0 {
            return None;
        }
        let (arm, mean) = (self.arm / self.weight, self.velocity / self.weight);
        if self.weight > 1.0 - 1e-9 {
            return Some(mean);
        }
        let spread = self.spread - arm * self.arm.transpose();
        let product = self.product - mean * self.arm.transpose();
        // Nodes on one line, or a single one, leave the slope open.
        let flat = spread.determinant() <= 1e-6 * self.spread.trace() * self.spread.trace();
        match spread.try_inverse() {
            Some(inverse) if !flat => Some(mean - product * inverse * arm),
            _ => Some(mean),
        }
    }
}

/// The velocities of the material in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct MaterialVelocity<'a> {
    pub(super) setup: &'a Setup,
    pub(super) lattice: &'a Lattice,
    pub(super) nodes: &'a Nodes,
}

impl MaterialVelocity<'_> {
    /// A field with less mass is left out [kg/m].
    fn least_mass(&self) -> Option<f64> {
        Some(LEAST_MASS * self.setup.particles.mass.first()?)
    }

    /// Velocity at `place` of the material that a particle at `side` would belong to [m/s]; none where there is none.
    pub(super) fn at(&self, place: Point, side: Point) -> Option<Vector> {
        let Lattice { grid, division, fields, .. } = self.lattice;
        let near = division.is_near(side);
        let least = self.least_mass()?;
        let stencil = self.lattice.stencil(place);
        let nodes = grid.stencil(&stencil);
        let mut fit = LinearFit::default();
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let w = stencil.weight(a, b);
                let Some(node) = nodes.at(a, b) else { continue };
                let node_place = nodes.place(a, b);
                let mut add = |field: usize, w: f64| {
                    if self.nodes.mass[field] > least && w > 0.0 {
                        fit.add(w, node_place - place, self.nodes.velocity(field));
                    }
                };
                if !near {
                    add(node, w);
                    continue;
                }
                for share in division.pair(side, node_place) {
                    if let Some(field) = fields.find(node, None, &share.crossed) {
                        add(field, w * share.fraction);
                    }
                }
            }
        }
        fit.value()
    }

    /// Velocity at `place` of the centres of mass of all fields of the nodes [m/s] (thesis eq. 20 and 21).
    pub(super) fn mean_at(&self, place: Point) -> Option<Vector> {
        let least = self.least_mass()?;
        let stencil = self.lattice.stencil(place);
        let nodes = self.lattice.grid.stencil(&stencil);
        let mut fit = LinearFit::default();
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let Some(node) = nodes.at(a, b) else { continue };
                let (mut mass, mut momentum) = (0.0, Vector::zeros());
                for field in self.lattice.fields_of(node) {
                    mass += self.nodes.mass[field];
                    momentum += self.nodes.velocity(field) * self.nodes.mass[field];
                }
                let w = stencil.weight(a, b);
                if mass > least && w > 0.0 {
                    fit.add(w, nodes.place(a, b) - place, momentum / mass);
                }
            }
        }
        fit.value()
    }
}
