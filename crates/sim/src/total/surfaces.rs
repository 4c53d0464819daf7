//! The surfaces that can touch: outlines and crack faces joined into chains, and the probe that carries each vertex.

use super::near::Near;
use super::probe::Probe;
use super::probes::Probes;
use crate::contact::neighbours::{MOST_MOVED, MOST_MOVED_OF_PIECES};
use crate::contact::surface::Surface;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::fragments;
use fissure_plane::{distance_to_segment, orientation};
use fissure_scene::{BoundaryEdge, CrackEnd, End, Line, Scene};

/// Two places nearer to each other than this, in cells, are one.
const SAME: f64 = 1e-9;
/// Two places so near to each other, in cells, are on the same side of a crack: faces are decided on a little farther
/// beside it.
const SAME_SIDE: f64 = 0.5e-6;

/// What tells a vertex from all others: the bits of its place at rest, and the ring or the face that it is of.
pub(super) type VertexKey = [u64; 3];

/// Which probe carries a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Carrier {
    /// A vertex of a ring.
    Ring { ring: u32, vertex: u32 },
    /// A point of a face of a crack: above (0) or below (1).
    Face { crack: u32, face: u8, point: u32 },
}

/// The surface with the carriers of its vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct Surfaces {
    pub(super) surface: Surface,
    carriers: Vec<Carrier>,
    /// Numbers of the vertices of each face of each crack, point by point.
    faces: Vec<[Vec<u32>; 2]>,
    /// A vertex of each ring that no crack ends on.
    whole_rings: Vec<Option<u32>>,
    /// Whether a body has come to pieces.
    are_pieces: bool,
}

impl Carrier {
    pub(super) fn probe(self, probes: &Probes) -> &Probe {
        match self {
            Self::Ring { ring, vertex } => probes.outlines.vertex(ring as usize, vertex as usize),
            Self::Face { crack, face, point } => &probes.faces[crack as usize][face as usize][point as usize],
        }
    }
}

impl Surfaces {
    /// The outlines and faces of `probes`.
    pub(super) fn new(scene: &Scene, probes: &Probes, cracks: &Cracks) -> Self {
        let mut all = Self::default();
        all.add_rings(scene, probes);
        all.add_faces(scene, probes, cracks);
        let mut joined = Vec::new();
        for id in cracks.ids() {
            all.join_at_junction(scene, cracks, id, &mut joined);
        }
        all.number_pieces(scene, cracks);
        all
    }

    /// Tells each vertex which piece it belongs to: those that bound the same fragment are of one.
    fn number_pieces(&mut self, scene: &Scene, cracks: &Cracks) {
        let fragments = fragments::at_rest(scene, cracks);
        // Where a crack ends on a point of another one, what was the vertex there belongs to two fragments.
        let has_edge = |&v: &u32| self.surface.has_edge(v);
        let mut joined = Vec::new();
        for fragment in fragments.list() {
            let mut own = fragment.boundaries.iter().flatten().flat_map(|edge| self.vertices_of(edge)).filter(has_edge);
            if let Some(first) = own.next() {
                joined.extend(own.map(|other| [first, other]));
            }
        }
        self.surface.number_pieces(&joined);
        self.are_pieces = fragments.list().len() > scene.bodies.len();
    }

    /// Vertices that belong to the fragment of an edge, whatever else ends on that edge: its ends where it is of a
    /// face; of a ring, those that are not joined to faces.
    fn vertices_of(&self, edge: &BoundaryEdge) -> impl Iterator<Item = u32> {
        let (of_ring, of_face) = match edge.line {
            Line::Ring(ring) => (self.whole_rings.get(ring).copied().flatten(), None),
            Line::Above(crack) => (None, self.faces.get(crack).map(|faces| &faces[0])),
            Line::Below(crack) => (None, self.faces.get(crack).map(|faces| &faces[1])),
        };
        let is_end = [edge.span[0] == 0.0, edge.span[1] == 1.0];
        let points = edge.points.into_iter().zip(is_end).filter(|(_, is_end)| *is_end).map(|(point, _)| point);
        of_ring.into_iter().chain(points.filter_map(move |point| of_face?.get(point).copied()))
    }

    /// Whether the two sides of a segment of a crack belong to different pieces.
    pub(super) fn are_apart(&self, crack: usize, segment: usize) -> bool {
        let Some(faces) = self.faces.get(crack) else { return false };
        let of_face = |face: usize| {
            let ends = [segment, segment + 1].map(|point| faces[face].get(point).copied());
            ends.into_iter().flatten().filter(|&v| self.surface.has_edge(v))
        };
        let piece = |v: u32| self.surface.vertex(v).piece;
        self.are_pieces && of_face(0).all(|above| of_face(1).all(|below| piece(above) != piece(below)))
    }

    /// Gives the points of faces the numbers that they have now.
    pub(super) fn renumber(&mut self, near: &Near) {
        for (crack, faces) in self.faces.iter().enumerate().filter(|&(crack, _)| near.shift(crack) > 0) {
            for &vertex in faces.iter().flatten() {
                if let Carrier::Face { point, .. } = &mut self.carriers[vertex as usize] {
                    *point += near.shift(crack);
                }
            }
        }
    }

    /// By how much surfaces may come nearer to each other before neighbours are looked for anew, in cells.
    pub(super) fn most_moved(&self) -> f64 {
        if self.are_pieces { MOST_MOVED_OF_PIECES } else { MOST_MOVED }
    }

    /// The probe that carries a vertex.
    pub(super) fn probe<'p>(&self, vertex: u32, probes: &'p Probes) -> &'p Probe {
        self.carriers[vertex as usize].probe(probes)
    }

    /// What tells a vertex from all others, whatever their numbers are: its place at rest, to the bit, and its side.
    pub(super) fn key(&self, vertex: u32) -> VertexKey {
        let rest = self.surface.vertex(vertex).rest;
        let side = match self.carriers[vertex as usize] {
            Carrier::Ring { ring, .. } => 3 * u64::from(ring),
            Carrier::Face { crack, face, .. } => 3 * u64::from(crack) + 1 + u64::from(face),
        };
        [rest.x.to_bits(), rest.y.to_bits(), side]
    }

    fn push(&mut self, scene: &Scene, probe: &Probe, carrier: Carrier, is_on_crack: bool) -> u32 {
        let material = scene.bodies[probe.body as usize].material_at(probe.rest) as u32;
        self.carriers.push(carrier);
        self.surface.push(probe.rest, probe.body, material, is_on_crack)
    }

    fn add_rings(&mut self, scene: &Scene, probes: &Probes) {
        for (ring, vertices) in probes.outlines.rings().enumerate() {
            let numbers: Vec<u32> = vertices
                .iter()
                .enumerate()
                .map(|(vertex, probe)| {
                    let carrier = Carrier::Ring { ring: ring as u32, vertex: vertex as u32 };
                    self.push(scene, probe, carrier, probe.nudged != probe.rest)
                })
                .collect();
            let is_whole = vertices.iter().all(|probe| probe.nudged == probe.rest);
            self.whole_rings.push(numbers.first().copied().filter(|_| is_whole));
            for k in 0..numbers.len() {
                let next = (k + 1) % numbers.len();
                // Between the two vertices of a mouth there is none: the faces go on from there.
                let is_mouth = vertices[k].nudged != vertices[k].rest
                    && vertices[next].nudged != vertices[next].rest
                    && (vertices[k].rest - vertices[next].rest).norm() < SAME * scene.cell_size;
                if !is_mouth {
                    self.surface.link(numbers[k], numbers[next]);
                }
            }
        }
    }

    fn add_faces(&mut self, scene: &Scene, probes: &Probes, cracks: &Cracks) {
        let on_rings = self.carriers.len() as u32;
        let mouths: Vec<u32> = (0..on_rings).filter(|&v| self.surface.vertex(v).is_on_crack).collect();
        for (crack, faces) in probes.faces.iter().enumerate() {
            let last = faces[0].len() - 1;
            let mut numbers = [Vec::new(), Vec::new()];
            for (face, points) in faces.iter().enumerate() {
                for (point, probe) in points.iter().enumerate() {
                    let end = if point == 0 { End::Start } else { End::End };
                    let is_mouth =
                        (point == 0 || point == last) && cracks.end(TipId::new(crack, end)) == CrackEnd::Mouth;
                    let there = |&&v: &&u32| {
                        let vertex = self.carriers[v as usize].probe(probes);
                        (vertex.rest - probe.rest).norm() < SAME * scene.cell_size
                            && (vertex.nudged - probe.nudged).norm() < SAME_SIDE * scene.cell_size
                    };
                    let found = if is_mouth { mouths.iter().find(there).copied() } else { None };
                    let carrier = Carrier::Face { crack: crack as u32, face: face as u8, point: point as u32 };
                    numbers[face].push(found.unwrap_or_else(|| self.push(scene, probe, carrier, true)));
                }
                // The material lies to the left of the face above from the start of the crack to its end, and of the
                // face below from the end to the start.
                for pair in numbers[face].windows(2) {
                    if face == 0 { self.surface.link(pair[0], pair[1]) } else { self.surface.link(pair[1], pair[0]) }
                }
            }
            self.faces.push(numbers);
        }
    }

    /// Joins the faces of a crack that begins or ends on another one to the face of that one on its side, whose own
    /// vertex there, if it has one, would belong to one of two corners only. `joined`: the two corners of those before.
    fn join_at_junction(
        &mut self,
        scene: &Scene,
        cracks: &Cracks,
        id: TipId,
        joined: &mut Vec<[u32; 2]>,
    ) -> Option<()> {
        let CrackEnd::Junction { crack: trunk } = cracks.end(id) else { return None };
        let branch = &cracks.of(id).points;
        let points = &cracks.get(trunk as usize)?.points;
        let (at, last) = (cracks.position(id), branch.len() - 1);
        let (end, beside) = if id.end == End::Start { (0, branch[1]) } else { (last, branch[last - 1]) };
        let [above, below] = [0, 1].map(|face: usize| self.faces[id.crack][face][end]);
        let [first, second] = if id.end == End::Start { [above, below] } else { [below, above] };
        let same = SAME * scene.cell_size;
        let (before, after) = if let Some(k) = points.iter().position(|p| (p - at).norm() < same) {
            if k == 0 || k + 1 == points.len() {
                return None;
            }
            let side = orientation(points[k - 1], points[k], beside) + orientation(points[k], points[k + 1], beside);
            let face = usize::from(side < 0.0);
            let of_trunk = &self.faces[trunk as usize][face];
            self.surface.unlink(of_trunk[k]);
            // On the way along the trunk with the material on the left.
            if face == 0 { (of_trunk[k - 1], of_trunk[k + 1]) } else { (of_trunk[k + 1], of_trunk[k - 1]) }
        } else {
            let distance = |k: &usize| distance_to_segment(at, points[*k], points[k + 1]);
            let k = (0..points.len() - 1).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            let face = usize::from(orientation(points[k], points[k + 1], beside) < 0.0);
            let mut before = self.faces[trunk as usize][face][k + face];
            // Others that end on this segment, before this one.
            let from = self.surface.vertex(before).rest;
            let is_before = |v: u32| (self.surface.vertex(v).rest - from).norm() < (at - from).norm();
            while let Some([_, corner]) =
                joined.iter().find(|[corner, _]| self.surface.next(before) == Some(*corner) && is_before(*corner))
            {
                before = *corner;
            }
            (before, self.surface.next(before)?)
        };
        self.surface.link(before, first);
        self.surface.link(second, after);
        joined.push([first, second]);
        Some(())
    }
}

/// Whether there is anything that can meet something else: several bodies, cracks that may cut some off, or a body that
/// is not convex.
pub(super) fn can_meet(scene: &Scene) -> bool {
    let is_convex = |ring: &[fissure_plane::Point]| {
        (0..ring.len()).all(|k| {
            let [a, b, c] = [0, 1, 2].map(|i| ring[(k + i) % ring.len()]);
            orientation(a, b, c) >= 0.0
        })
    };
    let is_convex_body = |body: &fissure_scene::Body| body.region.holes.is_empty() && is_convex(&body.region.exterior);
    scene.bodies.len() > 1 || !scene.cracks.is_empty() || !scene.bodies.iter().all(is_convex_body)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Total;
    use super::*;
    use crate::particles::Particles;
    use crate::test_scenes;
    use fissure_plane::signed_area;
    use std::sync::Arc;

    /// A square of four metres in cells of 0.1 m, cut by cracks that end on the first one.
    fn cut_square(cracks: &[&[[f64; 2]]]) -> (Scene, Total, Cracks) {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        cracks.iter().for_each(|points| test_scenes::add_crack(&mut scene, points));
        let branches: Vec<usize> = (1..cracks.len()).collect();
        cut(scene, &branches)
    }

    /// The body of a scene cut by its cracks, of which some begin on the first one.
    fn cut(mut scene: Scene, branches: &[usize]) -> (Scene, Total, Cracks) {
        scene.solver.formulation = fissure_scene::Formulation::Total;
        let mut cracks = Cracks::of_scene(&scene);
        for &branch in branches {
            cracks.set_end(TipId::new(branch, End::Start), CrackEnd::Junction { crack: 0 });
        }
        let total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
        (scene, total, cracks)
    }

    /// Truth: the drawing. Two cracks end beside each other on one segment of a third one, and another one on its other
    /// side: the surfaces are the outlines of the five parts.
    #[test]
    fn faces_join_into_the_outlines_of_the_parts() {
        let (scene, total, cracks) = cut_square(&[
            &[[0.0, 2.03], [4.0, 2.03]],
            &[[1.34, 2.03], [1.9, 4.0]],
            &[[1.31, 2.03], [0.9, 4.0]],
            &[[1.33, 2.03], [2.2, 0.0]],
        ]);
        let surface = Surfaces::new(&scene, &total.probes, &cracks).surface;
        let mut areas = Vec::new();
        let mut seen = vec![false; surface.len()];
        for start in 0..surface.len() as u32 {
            let mut ring = Vec::new();
            let mut at = Some(start);
            while let Some(vertex) = at.filter(|&v| !std::mem::replace(&mut seen[v as usize], true)) {
                ring.push(surface.vertex(vertex).rest);
                at = surface.next(vertex);
            }
            if at == Some(start) && ring.len() > 1 {
                areas.push(signed_area(&ring));
            }
        }
        areas.sort_by(f64::total_cmp);
        let (below, above) = (0.5 * 2.03, 0.5 * 1.97);
        let expected =
            [above * 1.03, above * (1.31 + 0.9), below * (1.33 + 2.2), below * (2.67 + 1.8), above * (2.66 + 2.1)];
        assert_eq!(areas.len(), expected.len(), "{areas:?}");
        assert!(areas.iter().zip(expected).all(|(area, expected)| (area - expected).abs() < 1e-9), "{areas:?}");
    }

    /// Truth: the drawing. A crack across a square, one from that to its upper edge, one within and one from the edge;
    /// a hole below. There are three pieces: the hole and what ends within them are of the piece around them, and faces
    /// are apart where the square is in two.
    #[test]
    fn pieces_are_what_cracks_cut_off() {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        let hole = [[1.0, 0.5], [1.0, 1.0], [1.5, 1.0], [1.5, 0.5]];
        scene.bodies[0].region.holes.push(hole.map(fissure_plane::Point::from).to_vec());
        let lines: [&[[f64; 2]]; 4] = [
            &[[0.0, 2.03], [2.01, 2.03], [4.0, 2.03]],
            &[[2.01, 2.03], [2.2, 4.0]],
            &[[2.5, 0.6], [2.9, 0.9], [3.3, 1.3]],
            &[[1.03, 4.0], [1.2, 3.0]],
        ];
        lines.iter().for_each(|points| test_scenes::add_crack(&mut scene, points));
        let (scene, total, cracks) = cut(scene, &[1]);
        let surfaces = Surfaces::new(&scene, &total.probes, &cracks);
        let surface = &surfaces.surface;
        let vertices: Vec<u32> = (0..surface.len() as u32).filter(|&v| surface.has_edge(v)).collect();
        // Beside lines, the side tells; of vertices on them the other vertices of their edge.
        let part = |v: u32| {
            let rest = surface.vertex(v).rest;
            if rest.y < 2.02 {
                Some(0)
            } else if rest.y < 2.04 {
                None
            } else {
                Some(if rest.x < 2.0 { 1 } else { 2 })
            }
        };
        let mut pieces = [Vec::new(), Vec::new(), Vec::new()];
        for &v in &vertices {
            // The crack between the two upper parts has vertices of both.
            let is_between = (surface.vertex(v).rest.x - 2.1).abs() < 0.11;
            if let Some(part) = part(v).filter(|&part| part == 0 || !is_between) {
                pieces[part].push(surface.vertex(v).piece);
            }
        }
        pieces.iter_mut().for_each(Vec::dedup);
        assert!(pieces.iter().all(|of_part| of_part.len() == 1), "{pieces:?}");
        assert!(pieces[0] != pieces[1] && pieces[1] != pieces[2] && pieces[0] != pieces[2], "{pieces:?}");
        let apart =
            |crack: usize| (0..lines[crack].len() - 1).map(|k| surfaces.are_apart(crack, k)).collect::<Vec<_>>();
        assert_eq!([apart(0), apart(1)], [vec![true, true], vec![true]]);
        assert_eq!([apart(2), apart(3)], [vec![false, false], vec![false]]);
    }

    /// Truth: the drawing. At whatever angle a crack ends on another one, both its faces end on its own side of that.
    #[test]
    fn faces_end_on_their_side_of_the_other_crack() {
        for x in [0.5, 1.2, 1.9, 2.2, 3.1, 3.7] {
            let (_, total, _) = cut_square(&[&[[0.0, 2.03], [2.01, 2.03], [4.0, 2.03]], &[[2.01, 2.03], [x, 3.5]]]);
            for face in &total.probes.faces[1] {
                for &(field, _) in &face[0].entries {
                    let crosses = total.lattice.fields().crossed(field as usize).iter().any(|c| c.0 == 0);
                    let is_below = total.lattice.position(field as usize).y < 2.03;
                    assert_eq!(crosses, is_below, "{x}");
                }
            }
        }
    }
}
