//! Contact between the two faces of a crack, at nodes that have fields on both sides of it (thesis 3.1.3).
//!
//! Nairn 2003, Guo & Nairn 2006: only if the fields approach, (v_a − v_b)·n < 0, *and* overlap, (u_a − u_b)·n < 0, with
//! n from below to above; then both get the normal velocity of their centre of mass. Friction after Coulomb; an
//! infinite coefficient sticks. n is the mean of the normals of all segments that lines from particles to the node
//! cross.
//!
//! The thesis takes the displacement of a node as the mean of x_p − X_p (eq. 8). The particles above and below are
//! about a cell apart, so that mean has a jump of about h times the strain and of h(1 − cos θ) after a turn by θ, with
//! faces that touch. Here every particle says which place at rest it would see at the node, X_p + F⁻¹(x_i − x_p), and
//! the jump u_a − u_b = X_b − X_a of the means is exact for homogeneous deformation on either side. It is a vector of
//! the rest configuration and is measured along the normal at rest.

use super::faces::CrackNow;
use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::setup::Setup;
use crate::crack::contact::face_impulse;
use crate::crack::crossing::Side;
use crate::grid::fields::Fields;
use crate::grid::kernel;
use fissure_scene::{Matrix, Point, Vector};

/// Faces that overlap by less than this part of a cell touch by round-off only.
const ROUND_OFF: f64 = 1e-9;

/// Two fields of one node that overlap across one crack.
#[derive(Debug, Clone, Copy)]
struct Overlap {
    above: u32,
    below: u32,
    crack: u32,
    /// Force on the field above in this step, per unit thickness [N/m].
    force: [f64; 2],
    /// Current unit normal, from below to above.
    normal: Vector,
}

/// Where the faces of cracks overlap in a step.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    overlaps: Vec<Overlap>,
}

/// Sums over the particles of a field, for its mean place at rest.
#[derive(Debug, Clone, Copy, Default)]
struct RestPlace {
    mass: f64,
    /// Σ m w (X − x_i).
    moment: Vector,
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
fn normals_across(fields: &Fields, normals: &[Vec<Normals>], field: u32, crack: u32) -> Normals {
    let at = fields.crossed(field as usize).iter().position(|c| c.0 == crack);
    // A node's own field has none.
    at.map_or([Vector::zeros(); 2], |at| normals[field as usize - (fields.len() - normals.len())][at])
}

/// Where the faces of cracks are looked at for contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct CrackSurroundings<'a> {
    pub(super) setup: &'a Setup,
    pub(super) points: &'a Points,
    pub(super) lattice: &'a Lattice,
    pub(super) cracks: &'a [CrackNow],
}

impl CrackSurroundings<'_> {
    /// All pairs of fields that overlap across one crack.
    pub(super) fn overlaps(&self) -> Contacts {
        let fields = &self.lattice.fields;
        if !self.setup.scene.solver.crack_contact || fields.further_count() == 0 {
            return Contacts::default();
        }
        let mut overlaps = Vec::new();
        let rest = self.rest_places();
        let normals = self.normals_of_fields();
        for node in self.lattice.divided_nodes() {
            let all: Vec<u32> = self
                .lattice
                .fields_of(node)
                .filter(|&field| rest[field].mass > 0.0)
                .map(|field| field as u32)
                .collect();
            for facing in fields.facing_pairs(&all) {
                let crack = facing.crack;
                let [first, second] =
                    [facing.first, facing.second].map(|field| normals_across(fields, &normals, field, crack));
                let [now, at_rest] = [first[0] + second[0], first[1] + second[1]];
                let [above, below] = facing.above_and_below();
                let mean = |field: u32| rest[field as usize].moment / rest[field as usize].mass;
                let overlap = -(mean(below) - mean(above)).dot(&at_rest);
                let least = ROUND_OFF * self.setup.scene.cell_size * at_rest.norm();
                if overlap > least && now != Vector::zeros() {
                    overlaps.push(Overlap { above, below, crack, force: [0.0; 2], normal: now.normalize() });
                }
            }
        }
        Contacts { overlaps }
    }

    /// Sums of the normals of the segments that pairs cross on the way to each further field, for each crack of its
    /// set.
    fn normals_of_fields(&self) -> Vec<Vec<Normals>> {
        let Lattice { grid, fields, stencils, .. } = self.lattice;
        let first = grid.len();
        let mut sums: Vec<Vec<Normals>> =
            (first..fields.len()).map(|field| vec![[Vector::zeros(); 2]; fields.crossed(field).len()]).collect();
        for (p, entries) in stencils.iter() {
            let place = self.points.point[p].position;
            for further in entries.iter().filter_map(|e| (e.field as usize).checked_sub(first)) {
                let crossed = fields.crossed(first + further);
                let node = grid.position(fields.node(first + further));
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
        self.lattice.division.for_each_crossed(place, node, |crack, segment| {
            let Some(at) = crossed.iter().position(|c| c.0 == crack) else { return };
            let now = &self.cracks[crack as usize];
            sums[at][0] += segment_normal(&now.position, segment);
            sums[at][1] += segment_normal(&now.rest, segment);
        });
        sums
    }

    /// Mean place at rest of every field of the divided nodes; others stay empty.
    fn rest_places(&self) -> Vec<RestPlace> {
        let Lattice { grid, fields, order, .. } = self.lattice;
        let mut places = vec![RestPlace::default(); fields.len()];
        // Lower left nodes of the stencils that reach a divided node.
        let width = kernel::width(self.lattice.kernel) as i32;
        let mut reaches = vec![false; grid.len()];
        let (mut lowest, mut highest) = (grid.rows(), 0);
        for node in fields.nodes_of_further() {
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
        for &p in order.of_nodes(grid.row(lowest).nodes.start..grid.row(highest).nodes.end) {
            let p = p as usize;
            let position = self.points.point[p].position;
            let stencil = self.lattice.stencil(position);
            if grid.node(stencil.first).is_none_or(|node| !reaches[node]) {
                continue;
            }
            let f = Matrix::identity() + self.points.total_gradient(p);
            let inverse = f.try_inverse().unwrap_or_else(Matrix::identity);
            let m = self.setup.particles.mass[p];
            self.lattice.for_each_entry(p, position, |field, w| {
                let node_place = grid.position(fields.node(field));
                let seen = self.setup.particles.rest[p] - node_place + inverse * (node_place - position);
                places[field].mass += m * w;
                places[field].moment += seen * (m * w);
            });
        }
        places
    }
}

impl Contacts {
    /// Number of pairs.
    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.overlaps.len()
    }

    /// Applies contact to the overlapping pairs, at nodes where they approach: impulses within a step [s], with a
    /// coefficient of `friction`.
    pub(super) fn resolve(&mut self, nodes: &mut Nodes, friction: f64, time_step: f64) {
        for pair in &mut self.overlaps {
            let (a, b) = (pair.above as usize, pair.below as usize);
            let speed = nodes.velocity(a) - nodes.velocity(b);
            let mass = [nodes.mass[a], nodes.mass[b]];
            let Some(impulse) = face_impulse(speed, pair.normal, 0.0, mass, friction) else { continue };
            for axis in 0..2 {
                pair.force[axis] += impulse[axis] / time_step;
                nodes.after[axis][a] += impulse[axis] / mass[0];
                nodes.after[axis][b] -= impulse[axis] / mass[1];
            }
        }
    }

    /// The forces of the last step between the faces of a crack: place of the node [m] and force on the face above
    /// [N/m].
    pub(super) fn face_forces<'a>(
        &'a self,
        lattice: &'a Lattice,
        crack: usize,
    ) -> impl Iterator<Item = (Point, Vector)> + 'a {
        let pressed = self.overlaps.iter().filter(move |p| p.crack as usize == crack && p.force != [0.0; 2]);
        let node_of = |pair: &Overlap| lattice.fields.node(pair.above as usize);
        pressed.map(move |pair| (lattice.grid.position(node_of(pair)), Vector::from(pair.force)))
    }
}
