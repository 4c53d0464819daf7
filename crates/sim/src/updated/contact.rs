//! Contact between the two faces of a crack, at nodes that have fields on both sides of it (thesis 3.1.3).
//!
//! Nairn 2003, Guo & Nairn 2006: only if the fields approach, (v_a − v_b)·n < 0, *and* overlap, (u_a − u_b)·n < 0, with n from below to
//! above; then both get the normal velocity of their centre of mass. Friction after Coulomb; an infinite coefficient sticks. n is the mean of the
//! normals of all segments that lines from particles to the node cross.
//!
//! The thesis takes the displacement of a node as the mean of x_p − X_p (eq. 8). The particles above and below are about a cell apart, so that mean
//! has a jump of about h times the strain and of h(1 − cos θ) after a turn by θ, with faces that touch. Here every particle
//! says which place at rest it would see at the node, X_p + F⁻¹(x_i − x_p), and the jump u_a − u_b = X_b − X_a of the means is exact for
//! homogeneous deformation on either side. It is a vector of the rest configuration and is measured along the normal at rest.

use super::Updated;
use crate::crack::crossing::Side;
use crate::crack::division::facing;
use crate::grid::kernel;
use fissure_scene::{Matrix, Point, Vector};

/// Faces that overlap by less than this part of a cell touch by round-off only.
const ROUND_OFF: f64 = 1e-9;

/// Two overlapping fields of one node.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactPair {
    above: u32,
    below: u32,
    crack: u32,
    /// Force on the field above in this step, per unit thickness [N/m].
    force: [f64; 2],
    /// Current unit normal, from below to above.
    normal: Vector,
}

/// Sums over the particles of a field, for its mean place at rest.
#[derive(Debug, Clone, Copy, Default)]
struct RestPlace {
    mass: f64,
    /// Σ m w (X − x_i).
    moment: Vector,
}

impl Updated {
    /// All pairs of fields that overlap across one crack.
    pub(super) fn crack_contacts(&self) -> Vec<ContactPair> {
        if !self.settings.crack_contact || self.cut.further.is_empty() {
            return Vec::new();
        }
        let mut pairs = Vec::new();
        let rest = self.rest_places();
        let nodes = self.nodes.mass.len() - self.cut.further.len();
        // Further fields of one node are linked; each node is met at its first one only.
        let mut visited = vec![false; nodes];
        for field in &self.cut.further {
            let node = field.node as usize;
            if std::mem::replace(&mut visited[node], true) {
                continue;
            }
            let none = (Vec::new(), Vec::new());
            let mut all = vec![(node, &none.0, &none.1)];
            all.extend(self.cut.further_of(node).map(|(number, f)| (number, &f.crossed, &f.normals)));
            all.retain(|f| rest[f.0].mass > 0.0);
            for (k, first) in all.iter().enumerate() {
                for second in &all[k + 1..] {
                    let Some((crack, side)) = facing(first.1, second.1) else { continue };
                    let mut now = Vector::zeros();
                    let mut at_rest = Vector::zeros();
                    for (_, crossed, normals) in [first, second] {
                        if let Some(at) = crossed.iter().position(|c| c.0 == crack) {
                            now += normals[at].0;
                            at_rest += normals[at].1;
                        }
                    }
                    let (above, below) = if side == Side::Above { (first.0, second.0) } else { (second.0, first.0) };
                    let mean = |field: usize| rest[field].moment / rest[field].mass;
                    let jump = mean(below) - mean(above);
                    let overlap = -jump.dot(&at_rest);
                    if overlap > ROUND_OFF * self.scene.cell_size * at_rest.norm() && now != Vector::zeros() {
                        let normal = now.normalize();
                        pairs.push(ContactPair {
                            above: above as u32,
                            below: below as u32,
                            crack,
                            force: [0.0; 2],
                            normal,
                        });
                    }
                }
            }
        }
        pairs
    }

    /// Mean place at rest of every field of the divided nodes; others stay empty.
    fn rest_places(&self) -> Vec<RestPlace> {
        let grid = &self.grid;
        let mut places = vec![RestPlace::default(); self.nodes.mass.len()];
        // Lower left nodes of the stencils that reach a divided node.
        let width = kernel::width(self.settings.kernel) as i32;
        let mut reaches = vec![false; grid.len()];
        let (mut lowest, mut highest) = (grid.rows(), 0);
        for field in &self.cut.further {
            let [i, j] = grid.place_of(field.node as usize);
            for b in 0..width {
                for a in 0..width {
                    // Without such a node there is no such stencil.
                    if let Some(node) = grid.node([i - a, j - b]) {
                        reaches[node] = true;
                    }
                }
            }
            let rows = || (0..width).filter_map(|b| grid.row_index(j - b));
            lowest = rows().fold(lowest, usize::min);
            highest = rows().fold(highest, usize::max);
        }
        if lowest > highest {
            return places;
        }
        let rows = &self.order.first;
        let range = rows[lowest] as usize..rows[highest + 1] as usize;
        for &p in &self.order.particles[range] {
            let p = p as usize;
            let point = &self.state.points[p];
            let stencil = self.stencil(point.position);
            if grid.node(stencil.first).is_none_or(|node| !reaches[node]) {
                continue;
            }
            let f = Matrix::identity() + self.total_gradient(p);
            let inverse = f.try_inverse().unwrap_or_else(Matrix::identity);
            let m = self.particles.mass[p];
            self.for_each_entry(p, |field, w| {
                let node_place = grid.position(self.cut.node(field));
                let seen = self.particles.rest[p] - node_place + inverse * (node_place - point.position);
                places[field].mass += m * w;
                places[field].moment += seen * (m * w);
            });
        }
        places
    }

    /// Applies contact to the overlapping pairs, at nodes where they approach: impulses within a step [s].
    pub(super) fn resolve_crack_contact(&mut self, time_step: f64) {
        let mut pairs = std::mem::take(&mut self.contacts);
        let friction = self.settings.crack_friction;
        for pair in &mut pairs {
            let (a, b) = (pair.above as usize, pair.below as usize);
            let speed = self.nodes.velocity(a) - self.nodes.velocity(b);
            let approach = speed.dot(&pair.normal);
            if approach >= 0.0 {
                continue;
            }
            let (mass_a, mass_b) = (self.nodes.mass[a], self.nodes.mass[b]);
            let reduced = mass_a * mass_b / (mass_a + mass_b);
            let sliding = speed - pair.normal * approach;
            let sliding_speed = sliding.norm();
            let mut impulse = pair.normal * (-approach * reduced);
            if friction > 0.0 && sliding_speed > 0.0 {
                impulse -= sliding * (reduced * (friction * -approach / sliding_speed).min(1.0));
            }
            for axis in 0..2 {
                pair.force[axis] += impulse[axis] / time_step;
                self.nodes.after[axis][a] += impulse[axis] / mass_a;
                self.nodes.after[axis][b] -= impulse[axis] / mass_b;
            }
        }
        self.contacts = pairs;
    }

    /// The forces of the last step between the faces of a crack: place of the node [m] and force on the face above [N/m].
    pub(super) fn face_forces(&self, crack: usize) -> impl Iterator<Item = (Point, Vector)> {
        let pressed = self.contacts.iter().filter(move |p| p.crack as usize == crack && p.force != [0.0; 2]);
        pressed.map(move |p| (self.grid.position(self.cut.node(p.above as usize)), Vector::from(p.force)))
    }
}
