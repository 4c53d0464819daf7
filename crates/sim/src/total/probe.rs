//! A place that rides on the material.

use super::field_vectors::{FieldVectors, at};
use super::lattice::Lattice;
use crate::crack::division::CrossedSet;
use crate::faces::outlines::Vertex;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// (field, weight) of a probe: hardly ever more than four.
pub(super) type ProbeEntries = SmallVec<[(u32, f64); 4]>;

/// A place at rest that rides on the material of a body: a vertex of an outline, a point of a crack face, a place of a
/// load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Probe {
    /// Where it is at rest [m].
    pub(super) rest: Point,
    /// A hair beside it, on the side of the crack it belongs to [m].
    pub(super) nudged: Point,
    /// The body.
    pub(super) body: u32,
    /// (field, weight).
    pub(super) entries: ProbeEntries,
    /// Whether these are fields of the nodes around it. They stay what they are while nothing changes there; what is
    /// carried on from a particle may change with what is farther off, as may what has been read.
    #[serde(skip)]
    pub(super) is_local: bool,
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

    /// Whether a field of it has lost all its mass: what is local stays what it is while none has, and nothing around
    /// is divided otherwise.
    pub(super) fn has_lost_material(&self, lattice: &Lattice) -> bool {
        self.entries.iter().any(|&(field, _)| lattice.mass()[field as usize] <= 0.0)
    }

    /// Value of a field vector at the probe.
    #[inline]
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

impl Lattice {
    /// A probe at `rest` that belongs to the material of `body` at `nudged`.
    pub(super) fn probe(&self, body: u32, rest: Point, nudged: Point) -> Probe {
        let (entries, is_local) = match self.local_entries(body, rest, nudged) {
            Some(local) => local,
            None => (self.carried_entries(body, rest, nudged), false),
        };
        Probe { rest, nudged, body, entries, is_local }
    }

    /// (field, weight) of a probe. Where a node has no material on the probe's side, the fields of the nearest
    /// particle's cell are carried on to the probe instead; near a crack linearly: w_ip + ∇w_ip · (X − X_p), exact for
    /// rigid motion.
    pub(super) fn probe_entries(&self, body: u32, rest: Point, nudged: Point) -> ProbeEntries {
        let local = self.local_entries(body, rest, nudged);
        local.map_or_else(|| self.carried_entries(body, rest, nudged), |(entries, _)| entries)
    }

    /// As [`Lattice::probe_entries`], and whether they depend on nothing but what is around: beyond a junction pairs
    /// are parted by what the crack does that was met there, wherever it does it. None where a node has no material on
    /// the probe's side.
    fn local_entries(&self, body: u32, rest: Point, nudged: Point) -> Option<(ProbeEntries, bool)> {
        let stencil = self.stencil(rest);
        let nodes = self.grid.stencil(&stencil);
        let mass = |field: usize| self.layout.mass[field];
        let fields = &self.layout.fields;
        let guest = |node: usize| self.owners.guest(node, body);
        let has_material = |&node: &usize| {
            let all = std::iter::once(node).chain(fields.of(node).iter().map(|&field| field as usize));
            all.into_iter().any(|field| mass(field) > 0.0 && fields.guest(field) == guest(node))
        };
        let mut entries = ProbeEntries::new();
        let last = stencil.width - 1;
        let around = self.division.around(nudged, nodes.place(0, 0), nodes.place(last, last));
        let mut is_local = !around.is_beyond_junction();
        for b in 0..stencil.width {
            for a in 0..stencil.width {
                let w = stencil.weight(a, b);
                if w <= 1e-14 {
                    continue;
                }
                let (node, shares) = match nodes.at(a, b).filter(has_material) {
                    // On the last grid line of a body, up to rounding.
                    None if w <= ROUND_OFF => {
                        let node = nodes.near(a, b).find(has_material)?;
                        is_local = false;
                        (node, self.shares(body, nudged, self.grid.position(node)))
                    }
                    node => (node?, self.shares_of(body, &around, nodes.place(a, b))),
                };
                for share in shares {
                    let field = fields.find(node, guest(node), &share.crossed);
                    entries.push((field.filter(|&field| mass(field) > 0.0)? as u32, w * share.fraction));
                }
            }
        }
        Some((entries, is_local))
    }

    fn carried_entries(&self, body: u32, rest: Point, nudged: Point) -> ProbeEntries {
        let at = (rest - self.particles.anchor) / self.particles.spacing;
        let center = [at.x.floor() as i32, at.y.floor() as i32];
        let mut nearest = None;
        for reach in [2, 6] {
            let (low, high) = (center.map(|c| c.saturating_sub(reach)), center.map(|c| c.saturating_add(reach)));
            let own = |&p: &usize| self.particles.body[p] == body && self.layout.riders.host(p).is_none();
            let with_distance = |p: usize| ((self.particles.rest[p] - rest).norm_squared(), p);
            let mut found: Vec<(f64, usize)> =
                self.particles.within(low, high).filter(own).map(with_distance).collect();
            found.sort_unstable_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
            // Across a crack only where all are.
            let beside = found.iter().find(|(_, p)| !self.is_across(body, self.particles.rest[*p], nudged));
            nearest = beside.or(found.first()).map(|&(_, p)| p);
            if beside.is_some() {
                break;
            }
        }
        let Some(p) = nearest else { return ProbeEntries::new() };
        let offset = rest - self.particles.rest[p];
        let mut entries = ProbeEntries::new();
        if !self.division.is_near(self.particles.rest[p]) {
            // What the fields of its cell are beyond it.
            let stencil = self.stencil(self.particles.rest[p]);
            let (nodes, beyond) = (self.grid.stencil(&stencil), stencil.carried_on(offset));
            for (b, a) in (0..stencil.width).flat_map(|b| (0..stencil.width).map(move |a| (b, a))) {
                let Some(node) = nodes.at(a, b) else { continue };
                let field = self.layout.fields.find(node, self.owners.guest(node, body), &CrossedSet::new());
                entries.extend(field.map(|field| (field as u32, beyond.weight(a, b))));
            }
            return entries;
        }
        self.reader().for_each_entry(p, |field, w, g| entries.push((field as u32, w + g.dot(&offset))));
        entries
    }
}
