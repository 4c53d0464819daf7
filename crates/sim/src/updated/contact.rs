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
use super::stencils::Cut;
use crate::crack::crossing::Side;
use crate::grid::fields::Fields;
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

/// Sums of unit normals of crossed segments, from below to above: now and at rest.
type Normals = [Vector; 2];

/// Unit normal of a segment of a polyline, to its left; zero for one without length.
fn segment_normal(points: &[Point], segment: usize) -> Vector {
    let along = points[segment + 1] - points[segment];
    let length = along.norm();
    if length > 0.0 { Vector::new(-along.y, along.x) / length } else { Vector::zeros() }
}

/// What `normals` holds for a field and one of the cracks that are crossed on the way to it.
fn normals_across(fields: &Fields, normals: &[Vec<Normals>], field: usize, crack: u32) -> Normals {
    let at = fields.crossed(field).iter().position(|c| c.0 == crack);
    // A node's own field has none.
    at.map_or([Vector::zeros(); 2], |at| normals[field - (fields.len() - normals.len())][at])
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
        if !self.settings.crack_contact || self.cut.fields.further_count() == 0 {
            return Vec::new();
        }
        let mut pairs = Vec::new();
        let rest = self.rest_places();
        let normals = self.normals_of_fields();
        let fields = &self.cut.fields;
        let mut visited = vec![false; self.grid.len()];
        for node in fields.nodes_of_further() {
            // Each node is met at its first further field only.
            if std::mem::replace(&mut visited[node], true) {
                continue;
            }
            // Impulses act one pair after the other; the field that was made last comes first.
            let all = std::iter::once(node as u32).chain(fields.of(node).iter().rev().copied());
            let all: Vec<u32> = all.filter(|&field| rest[field as usize].mass > 0.0).collect();
            for facing in fields.facing_pairs(&all) {
                let [above, below] = facing.above_and_below();
                let [now, at_rest] = [facing.first, facing.second]
                    .map(|field| normals_across(fields, &normals, field as usize, facing.crack))
                    .into_iter()
                    .fold([Vector::zeros(); 2], |sum, n| [sum[0] + n[0], sum[1] + n[1]]);
                let mean = |field: u32| rest[field as usize].moment / rest[field as usize].mass;
                let overlap = -(mean(below) - mean(above)).dot(&at_rest);
                if overlap > ROUND_OFF * self.scene.cell_size * at_rest.norm() && now != Vector::zeros() {
                    let normal = now.normalize();
                    pairs.push(ContactPair { above, below, crack: facing.crack, force: [0.0; 2], normal });
                }
            }
        }
        pairs
    }

    /// Sums of the normals of the segments that pairs cross on the way to each further field, for each crack of its set.
    fn normals_of_fields(&self) -> Vec<Vec<Normals>> {
        let Cut { fields, stencils } = &self.cut;
        let first = self.grid.len();
        let mut sums: Vec<Vec<Normals>> =
            (first..fields.len()).map(|field| vec![[Vector::zeros(); 2]; fields.crossed(field).len()]).collect();
        for (p, entries) in stencils.iter() {
            let place = self.state.points[p].position;
            for further in entries.iter().filter_map(|e| (e.field as usize).checked_sub(first)) {
                let crossed = fields.crossed(first + further);
                let node = self.grid.position(fields.node(first + further));
                for (sum, own) in sums[further].iter_mut().zip(self.crossed_normals(place, node, crossed)) {
                    sum[0] += own[0];
                    sum[1] += own[1];
                }
            }
        }
        sums
    }

    /// Sums of the normals of the segments that a pair crosses, for each crack of the set.
    fn crossed_normals(&self, place: Point, node: Point, crossed: &[(u32, Side)]) -> Vec<Normals> {
        let mut sums = vec![[Vector::zeros(); 2]; crossed.len()];
        self.division.for_each_crossed(place, node, |crack, segment| {
            let Some(at) = crossed.iter().position(|c| c.0 == crack) else { return };
            let now = &self.state.cracks[crack as usize];
            sums[at][0] += segment_normal(&now.position, segment);
            sums[at][1] += segment_normal(&now.rest, segment);
        });
        sums
    }

    /// Mean place at rest of every field of the divided nodes; others stay empty.
    fn rest_places(&self) -> Vec<RestPlace> {
        let grid = &self.grid;
        let mut places = vec![RestPlace::default(); self.nodes.mass.len()];
        // Lower left nodes of the stencils that reach a divided node.
        let width = kernel::width(self.settings.kernel) as i32;
        let mut reaches = vec![false; grid.len()];
        let (mut lowest, mut highest) = (grid.rows(), 0);
        for node in self.cut.fields.nodes_of_further() {
            let [i, j] = grid.place_of(node);
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
                let node_place = grid.position(self.cut.fields.node(field));
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
        pressed.map(move |p| (self.grid.position(self.cut.fields.node(p.above as usize)), Vector::from(p.force)))
    }
}
