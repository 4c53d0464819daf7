//! The vertices of the outlines and the points of the crack faces, as probes that ride on the material.

use super::lattice::Lattice;
use super::motion::Motion;
use super::probe::Probe;
use crate::crack::changes::Changes;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::crack::{Crack, left_at};
use crate::faces::outlines::Outlines;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use fissure_scene::{CrackEnd, End, Scene};
use serde::{Deserialize, Serialize};

/// How far beside a crack the side of a face point is decided, in cells.
const NUDGE: f64 = 1e-6;

/// Where a crack ends on another one, how far beside it that is decided, as part of the way back along it: within the
/// wedge between the two wherever they meet at more than 6°.
const WEDGE: f64 = 0.1;

/// How far a face sees stencils, in cells: particles within six of their spacings, and their nodes.
const SEEN: f64 = 5.0;

impl Lattice {
    /// Probes of both faces of a crack.
    fn face_probes(&self, crack: &Crack) -> Faces {
        [Side::Above, Side::Below]
            .map(|side| (0..crack.points.len()).map(|k| self.face_probe(crack, k, side)).collect())
    }

    /// Lays the probes of both faces of a crack anew at its new points and where something around them `has_changed`,
    /// which it can only within `boxes`.
    fn follow_faces(
        &self,
        crack: &Crack,
        faces: &mut Faces,
        boxes: &[(Point, Point)],
        mut has_changed: impl FnMut(&Probe) -> bool,
    ) {
        let points = &crack.points;
        // Where nothing is known to have stayed, all is laid anew.
        let Some(shift) = added_at_start(crack, faces) else {
            *faces = self.face_probes(crack);
            return;
        };
        let old = shift..shift + faces[0].len();
        let is_in_box = |p: Point| boxes.iter().any(|(low, high)| p >= *low && p <= *high);
        // Old ends may have moved, and with them which way is to the left of the points beside them.
        let is_by_end = |k: usize| k < old.start + 2 || k + 2 >= old.end;
        let suspects: Vec<usize> = old.clone().filter(|&k| is_by_end(k) || is_in_box(points[k])).collect();
        for (side, face) in [Side::Above, Side::Below].into_iter().zip(faces) {
            face.splice(0..0, (0..old.start).map(|k| self.face_probe(crack, k, side)));
            face.extend((old.end..points.len()).map(|k| self.face_probe(crack, k, side)));
            for &k in &suspects {
                let probe = &face[k];
                // Between the ends no point moves, nor does what is beside it.
                let nudged = if is_by_end(k) { self.nudged(crack, k, side) } else { probe.nudged };
                if probe.rest != points[k] || probe.nudged != nudged || has_changed(probe) {
                    face[k] = self.probe(crack.body, points[k], nudged);
                }
            }
        }
    }

    /// Probe of one face at point `k` of a crack.
    pub(super) fn face_probe(&self, crack: &Crack, k: usize, side: Side) -> Probe {
        self.probe(crack.body, crack.points[k], self.nudged(crack, k, side))
    }

    /// Where the side of a face is decided at point `k` of a crack: a hair beside it.
    fn nudged(&self, crack: &Crack, k: usize, side: Side) -> Point {
        let outward = left_at(&crack.points, k) * side.sign();
        let last = crack.points.len() - 1;
        let is_junction = |end: End| matches!(crack.end(end), CrackEnd::Junction { .. });
        // On the line of another crack: what is decided on lies on the side of that one where this crack is.
        let toward = match k {
            0 if is_junction(End::Start) => outward * WEDGE - crack.last_direction(End::Start),
            _ if k == last && is_junction(End::End) => outward * WEDGE - crack.last_direction(End::End),
            _ => outward,
        };
        crack.points[k] + toward * (NUDGE * self.grid.cell_size)
    }
}

/// How many points a crack has got at its start since its faces were laid; none where that cannot be told. Its ends may
/// have moved, the points between stay.
fn added_at_start(crack: &Crack, before: &Faces) -> Option<usize> {
    let points = &crack.points;
    let added = points.len().saturating_sub(before[0].len());
    let old = before[0].get(1)?;
    (0..=added).find(|&shift| points.get(shift + 1) == Some(&old.rest))
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
        let outlines = Outlines::at_rest(scene, |body, place| lattice.probe(body, place, place));
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
        all.try_for_each(|probe| {
            saved::below("a point of a surface", [probe.body], scene.bodies.len())?;
            probe.check(fields)
        })
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

    /// Lays the probes anew that may have changed: of the faces of cracks with a `changed` end, and of all within
    /// `boxes`, of which those beyond the ones of `changes` hold particles that ride on others now.
    /// Returns whether an outline has got a mouth.
    pub(super) fn refresh(
        &mut self,
        lattice: &Lattice,
        cracks: &Cracks,
        changed: &[TipId],
        (changes, boxes): (&Changes, &[(Point, Point)]),
    ) -> bool {
        let ridden = &boxes[changes.boxes.len()..];
        let within = |boxes: &[(Point, Point)], p: Point| boxes.iter().any(|(low, high)| p >= *low && p <= *high);
        let seen = Vector::repeat(SEEN * lattice.grid.cell_size);
        // A node that has turned is as far as a stencil from what has been cut anew, and seen from as far.
        let reach = Vector::repeat(SEEN.max(2.0 * lattice.reach() + 2.0) * lattice.grid.cell_size);
        let suspicious: Vec<(Point, Point)> = boxes.iter().map(|(low, high)| (low - reach, high + reach)).collect();
        for (index, crack) in cracks.iter().enumerate() {
            let Some(faces) = self.faces.get_mut(index) else {
                self.faces.push(lattice.face_probes(crack));
                continue;
            };
            let near: Vec<(Point, Point)> =
                suspicious.iter().copied().filter(|(low, high)| crack.may_meet(*low, *high)).collect();
            if near.is_empty() && changed.iter().all(|id| id.crack != index) {
                continue;
            }
            // Of all that has changed, most is far from most cracks.
            let meets = |&(low, high): &(Point, Point)| crack.may_meet(low - seen, high + seen);
            let around: Vec<(Point, Point)> = boxes.iter().copied().filter(meets).collect();
            let mut last = None;
            lattice.follow_faces(crack, faces, &near, |probe| {
                if !probe.is_local {
                    return around.iter().any(|(low, high)| probe.rest >= low - seen && probe.rest <= high + seen);
                }
                probe.has_lost_material(lattice)
                    || within(ridden, probe.rest)
                    || (within(&around, probe.nudged) || within(&around, probe.rest))
                        && lattice.may_have_changed(changes, probe.rest, probe.nudged, &mut last)
            });
        }
        for probe in self.outlines.vertices_mut().filter(|probe| within(boxes, probe.rest)) {
            probe.entries = lattice.probe_entries(probe.body, probe.rest, probe.nudged);
        }
        let mut has_mouthed = false;
        for &id in changed {
            if cracks.end(id) == CrackEnd::Mouth {
                let point = cracks.position(id);
                let there = |p: &Probe| (p.rest - point).norm() < 1e-12 * lattice.grid.cell_size && p.nudged != p.rest;
                if !self.outlines.vertices().any(there) {
                    self.open_mouth(lattice, cracks, id);
                    has_mouthed = true;
                }
            }
        }
        has_mouthed
    }

    /// Doubles the outline where a crack mouths at it: the two new vertices are the end points of the faces.
    fn open_mouth(&mut self, lattice: &Lattice, cracks: &Cracks, id: TipId) {
        let at = if id.end == End::Start { 0 } else { cracks.of(id).points.len() - 1 };
        let faces = self.faces[id.crack].each_ref().map(|face| face[at].clone());
        self.outlines.open_mouth(cracks.position(id), id.end, faces, lattice.grid.cell_size);
    }

    /// How many points `changed` ends have added to the start of each crack since its faces were laid.
    pub(super) fn added_at_starts(&self, cracks: &Cracks, changed: &[TipId]) -> Vec<u32> {
        let mut added = vec![0; cracks.len()];
        for id in changed.iter().filter(|id| id.end == End::Start) {
            let Some(faces) = self.faces.get(id.crack) else { continue };
            let crack = cracks.of(*id);
            // Of two points both may have moved.
            let at_most = crack.points.len().saturating_sub(faces[0].len());
            added[id.crack] = added_at_start(crack, faces).unwrap_or(at_most) as u32;
        }
        added
    }

    /// How far the two faces of a crack have moved at one of its points, in the mean [m].
    pub(super) fn mean_at([above, below]: &Faces, point: usize, motion: &Motion) -> Vector {
        let u = &motion.displacement;
        (above[point].value(u) + below[point].value(u)) * 0.5
    }

    /// Normal of a segment of a crack now, from below to above: across the mean of the two faces. None where it has no
    /// length.
    #[cfg(test)]
    pub(super) fn segment_normal(&self, crack: u32, segment: u32, motion: &Motion) -> Option<Vector> {
        let faces = &self.faces[crack as usize];
        let s = segment as usize;
        let (from, to) = (faces[0].get(s)?, faces[0].get(s + 1)?);
        let [before, after] = [s, s + 1].map(|k| Self::mean_at(faces, k, motion));
        normal_across((to.rest - from.rest) + (after - before))
    }
}

/// Unit vector to the left of a way; none where that has no length.
pub(super) fn normal_across(tangent: Vector) -> Option<Vector> {
    let length = tangent.norm();
    (length > 0.0).then(|| Vector::new(-tangent.y, tangent.x) / length)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Total;
    use super::*;
    use crate::particles::Particles;
    use crate::test_scenes;
    use fissure_scene::Formulation;
    use std::sync::Arc;

    /// Truth: the construction. What a crack gets at its end does not move the numbers of its points up.
    #[test]
    fn points_at_the_start_are_counted_whatever_comes_at_the_end() {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        scene.solver.formulation = Formulation::Total;
        test_scenes::add_crack(&mut scene, &[[1.5, 2.03], [2.0, 2.05], [2.5, 2.03]]);
        let first = Cracks::of_scene(&scene);
        let total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &first).unwrap();
        let ids = [End::Start, End::End].map(|end| TipId::new(0, end));
        for grown in [[0, 1], [1, 0], [1, 1], [2, 1], [1, 3]] {
            let mut cracks = first.clone();
            for (id, count) in ids.into_iter().zip(grown) {
                let ahead = cracks.last_direction(id) * 0.05;
                for _ in 0..count {
                    cracks.grow(id, &[cracks.position(id) + ahead]);
                }
            }
            assert_eq!(total.probes.added_at_starts(&cracks, &ids), [grown[0]], "{grown:?}");
        }
    }
}
