//! Places that ride on the material: the vertices of the outlines and the points of the crack faces.

use super::lattice::Lattice;
use super::motion::{FieldVectors, Motion, at};
use crate::crack::Crack;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::faces::outlines::{Outlines, Vertex};
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use fissure_scene::{CrackEnd, End, Scene};
use serde::{Deserialize, Serialize};

/// A place at rest that rides on the material: a vertex of an outline, a point of a crack face, a place of a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Probe {
    /// Where it is at rest [m].
    pub(super) rest: Point,
    /// A hair beside it, on the side of the crack it belongs to [m].
    pub(super) nudged: Point,
    /// (field, weight).
    pub(super) entries: Vec<(u32, f64)>,
}

impl Vertex for Probe {
    fn rest(&self) -> Point {
        self.rest
    }

    fn is_at_mouth(&self) -> bool {
        // Only the faces of cracks are decided on beside where they are.
        self.nudged != self.rest
    }
}

impl Probe {
    /// Checks a probe that was read against so many `fields`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize) -> Fits {
        saved::finite(
            "a probe",
            self.rest.iter().chain(self.nudged.iter()).chain(self.entries.iter().map(|(_, w)| w)),
        )?;
        saved::below("a probe", self.entries.iter().map(|(field, _)| *field), fields)
    }

    /// Value of a field vector at the probe.
    pub(super) fn value(&self, u: &FieldVectors) -> Vector {
        let mut value = Vector::zeros();
        for &(field, w) in &self.entries {
            value += at(u, field as usize) * w;
        }
        value
    }

    /// Where it is for the displacement `u` [m].
    pub(super) fn moved(&self, u: &FieldVectors) -> Point {
        self.rest + self.value(u)
    }
}

/// A weight below this comes from the rounding of a place [–].
const ROUND_OFF: f64 = 1e-9;

/// How far beside a crack the side of a face point is decided, in cells.
const NUDGE: f64 = 1e-6;

impl Lattice {
    /// A probe at `rest` that belongs to the material at `nudged`.
    pub(super) fn probe(&self, rest: Point, nudged: Point) -> Probe {
        Probe { rest, nudged, entries: self.probe_entries(rest, nudged) }
    }

    /// (field, weight) of a probe. Where a node has no material on the probe's side, the nearest particle carries the
    /// probe along linearly instead: w_ip + ∇w_ip · (X − X_p), exact for rigid motion.
    pub(super) fn probe_entries(&self, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let stencil = self.stencil(rest);
        let nodes = self.grid.stencil(&stencil);
        let mass = |field: usize| self.layout.mass[field];
        let has_material = |&node: &usize| {
            mass(node) > 0.0 || self.layout.fields.of(node).iter().any(|&field| mass(field as usize) > 0.0)
        };
        let mut entries = Vec::with_capacity(8);
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let w = stencil.weight(a, b);
                if w <= 1e-14 {
                    continue;
                }
                let found = match nodes.at(a, b).filter(has_material) {
                    // On the last grid line of a body, up to rounding.
                    None if w <= ROUND_OFF => {
                        nodes.near(a, b).find(has_material).map(|node| (node, self.grid.position(node)))
                    }
                    node => node.map(|node| (node, nodes.place(a, b))),
                };
                let Some((node, place)) = found else { return self.carried_entries(rest, nudged) };
                for share in self.division.pair(nudged, place) {
                    match self.layout.fields.find(node, &share.crossed) {
                        Some(field) if mass(field) > 0.0 => entries.push((field as u32, w * share.fraction)),
                        _ => return self.carried_entries(rest, nudged),
                    }
                }
            }
        }
        entries
    }

    fn carried_entries(&self, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let at = (rest - self.particles.anchor) / self.particles.spacing;
        let center = [at.x.floor() as i32, at.y.floor() as i32];
        let mut nearest: Option<(bool, f64, usize)> = None;
        for reach in [2, 6] {
            for p in
                self.particles.within(center.map(|c| c.saturating_sub(reach)), center.map(|c| c.saturating_add(reach)))
            {
                let place = self.particles.rest[p];
                let across = !self.division.crossed(place, nudged).is_empty();
                let candidate = (across, (place - rest).norm_squared(), p);
                if nearest.is_none_or(|n| candidate < n) {
                    nearest = Some(candidate);
                }
            }
            if matches!(nearest, Some((false, ..))) {
                break;
            }
        }
        let Some((_, _, p)) = nearest else { return Vec::new() };
        let offset = rest - self.particles.rest[p];
        let mut entries = Vec::with_capacity(8);
        self.reader().for_each_entry(p, |field, w, g| entries.push((field as u32, w + g.dot(&offset))));
        entries
    }

    /// Probes of both faces of a crack.
    fn face_probes(&self, crack: &Crack) -> Faces {
        [Side::Above, Side::Below]
            .map(|side| (0..crack.points.len()).map(|k| self.face_probe(crack, k, side)).collect())
    }

    /// Probe of one face at point `k` of a crack.
    fn face_probe(&self, crack: &Crack, k: usize, side: Side) -> Probe {
        let before = crack.points[k.saturating_sub(1)];
        let after = crack.points[(k + 1).min(crack.points.len() - 1)];
        let tangent = (after - before).normalize();
        let normal = Vector::new(-tangent.y, tangent.x) * side.sign();
        self.probe(crack.points[k], crack.points[k] + normal * (NUDGE * self.grid.cell_size))
    }
}

/// The faces of one crack, above and below, with one probe at each of its points.
pub(super) type Faces = [Vec<Probe>; 2];

/// All outlines and faces.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Probes {
    /// The rings of all bodies, doubled at mouths.
    pub(super) outlines: Outlines<Probe>,
    /// Of each crack.
    pub(super) faces: Vec<Faces>,
}

impl Probes {
    /// Lays the probes of outlines and crack faces.
    pub(super) fn new(scene: &Scene, lattice: &Lattice, cracks: &Cracks) -> Self {
        let faces = cracks.iter().map(|c| lattice.face_probes(c)).collect();
        let outlines = Outlines::at_rest(scene, |place| lattice.probe(place, place));
        let mut probes = Self { outlines, faces };
        for id in cracks.ids().filter(|&id| cracks.end(id) == CrackEnd::Mouth) {
            probes.open_mouth(lattice, cracks, id);
        }
        probes
    }

    /// Checks probes that were read against so many `fields`, the bodies of the scene and the cracks.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(super) fn check(&self, fields: usize, scene: &Scene, cracks: &Cracks) -> Fits {
        self.outlines.check(scene)?;
        let same_points = |(faces, crack): (&Faces, &Crack)| faces.iter().all(|f| f.len() == crack.points.len());
        let are_faces = self.faces.len() == cracks.len() && self.faces.iter().zip(cracks.iter()).all(same_points);
        saved::ensure(are_faces, "the faces of a crack")?;
        let mut all = self.outlines.vertices().chain(self.faces.iter().flatten().flatten());
        all.try_for_each(|probe| probe.check(fields))
    }

    /// The faces of a crack whose last point at one end has moved along its last segment.
    pub(super) fn move_last_faces(&mut self, lattice: &Lattice, cracks: &Cracks, id: TipId) {
        let crack = cracks.of(id);
        let n = crack.points.len();
        // The point before has a tangent that depends on the last one only by its direction, which stays.
        let last = if id.end == End::Start { 0 } else { n - 1 };
        for (face, side) in [Side::Above, Side::Below].into_iter().enumerate() {
            self.faces[id.crack][face][last] = lattice.face_probe(crack, last, side);
        }
    }

    /// Lays the probes anew that may have changed: the faces of the cracks with a `changed` end, and all within
    /// `boxes`.
    pub(super) fn refresh(&mut self, lattice: &Lattice, cracks: &Cracks, changed: &[TipId], boxes: &[(Point, Point)]) {
        // Faces: a changed crack anew (points have been added), the others where they lie in a box.
        let within = |p: Point| boxes.iter().any(|(low, high)| p >= *low && p <= *high);
        for (index, crack) in cracks.iter().enumerate() {
            if index >= self.faces.len() {
                self.faces.push(lattice.face_probes(crack));
            } else if changed.iter().any(|id| id.crack == index) || crack.points.iter().any(|&p| within(p)) {
                self.faces[index] = lattice.face_probes(crack);
            }
        }
        for probe in self.outlines.vertices_mut().filter(|probe| within(probe.rest)) {
            probe.entries = lattice.probe_entries(probe.rest, probe.nudged);
        }
        for &id in changed {
            if cracks.end(id) == CrackEnd::Mouth {
                let point = cracks.position(id);
                let there = |p: &Probe| (p.rest - point).norm() < 1e-12 * lattice.grid.cell_size && p.nudged != p.rest;
                if !self.outlines.vertices().any(there) {
                    self.open_mouth(lattice, cracks, id);
                }
            }
        }
    }

    /// Doubles the outline where a crack mouths at it: the two new vertices are the end points of the faces.
    fn open_mouth(&mut self, lattice: &Lattice, cracks: &Cracks, id: TipId) {
        let at = if id.end == End::Start { 0 } else { cracks.of(id).points.len() - 1 };
        let faces = self.faces[id.crack].each_ref().map(|face| face[at].clone());
        self.outlines.open_mouth(cracks.position(id), id.end, faces, lattice.grid.cell_size);
    }

    /// Number of points of each crack when its faces were laid.
    pub(super) fn points_of_cracks(&self) -> Vec<usize> {
        self.faces.iter().map(|faces| faces[0].len()).collect()
    }

    /// Normal of a segment of a crack now, from below to above: across the mean of the two faces. None where it has no
    /// length.
    pub(super) fn segment_normal(&self, crack: u32, segment: u32, motion: &Motion) -> Option<Vector> {
        let [above, below] = &self.faces[crack as usize];
        let s = segment as usize;
        let (from, to) = (above.get(s)?, above.get(s + 1)?);
        let u = &motion.displacement;
        let mean = |k: usize| (above[k].value(u) + below[k].value(u)) * 0.5;
        let tangent = (to.rest - from.rest) + (mean(s + 1) - mean(s));
        let length = tangent.norm();
        (length > 0.0).then(|| Vector::new(-tangent.y, tangent.x) / length)
    }
}
