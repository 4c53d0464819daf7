//! The surfaces that can touch: outlines and crack faces joined into chains, and the probe that carries each vertex.

use super::near::Near;
use super::probe::Probe;
use super::probes::Probes;
use crate::contact::surface::Surface;
use crate::crack::cracks::{Cracks, TipId};
use fissure_plane::orientation;
use fissure_scene::{CrackEnd, End, Scene};

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
        for id in cracks.ids() {
            all.join_at_junction(scene, cracks, id);
        }
        all
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
    /// vertex there would belong to one of two corners only.
    fn join_at_junction(&mut self, scene: &Scene, cracks: &Cracks, id: TipId) -> Option<()> {
        let CrackEnd::Junction { crack: trunk } = cracks.end(id) else { return None };
        let branch = &cracks.of(id).points;
        let points = &cracks.get(trunk as usize)?.points;
        let (at, last) = (cracks.position(id), branch.len() - 1);
        let (end, beside) = if id.end == End::Start { (0, 1) } else { (last, last - 1) };
        let k = points.iter().position(|p| (p - at).norm() < SAME * scene.cell_size)?;
        if k == 0 || k + 1 == points.len() {
            return None;
        }
        let side = orientation(points[k - 1], points[k], branch[beside])
            + orientation(points[k], points[k + 1], branch[beside]);
        let face = usize::from(side < 0.0);
        let of_trunk = &self.faces[trunk as usize][face];
        // On the way along the trunk with the material on the left.
        let (before, after) =
            if face == 0 { (of_trunk[k - 1], of_trunk[k + 1]) } else { (of_trunk[k + 1], of_trunk[k - 1]) };
        let corner = of_trunk[k];
        let [above, below] = [0, 1].map(|face: usize| self.faces[id.crack][face][end]);
        let [first, second] = if id.end == End::Start { [above, below] } else { [below, above] };
        self.surface.unlink(corner);
        self.surface.link(before, first);
        self.surface.link(second, after);
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
