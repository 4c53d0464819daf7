//! A place that rides on the material.

use super::field_vectors::{FieldVectors, at};
use super::lattice::Lattice;
use crate::crack::division::CrossedSet;
use crate::faces::outlines::Vertex;
use crate::saved::{self, Fits};
use fissure_plane::{Point, Vector};
use serde::{Deserialize, Serialize};

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

impl Lattice {
    /// A probe at `rest` that belongs to the material of `body` at `nudged`.
    pub(super) fn probe(&self, body: u32, rest: Point, nudged: Point) -> Probe {
        Probe { rest, nudged, body, entries: self.probe_entries(body, rest, nudged) }
    }

    /// (field, weight) of a probe. Where a node has no material on the probe's side, the fields of the nearest
    /// particle's cell are carried on to the probe instead; near a crack linearly: w_ip + ∇w_ip · (X − X_p), exact for
    /// rigid motion.
    pub(super) fn probe_entries(&self, body: u32, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let stencil = self.stencil(rest);
        let nodes = self.grid.stencil(&stencil);
        let mass = |field: usize| self.layout.mass[field];
        let fields = &self.layout.fields;
        let guest = |node: usize| self.owners.guest(node, body);
        let has_material = |&node: &usize| {
            let all = std::iter::once(node).chain(fields.of(node).iter().map(|&field| field as usize));
            all.into_iter().any(|field| mass(field) > 0.0 && fields.guest(field) == guest(node))
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
                let Some((node, place)) = found else { return self.carried_entries(body, rest, nudged) };
                for share in self.shares(body, nudged, place) {
                    match fields.find(node, guest(node), &share.crossed) {
                        Some(field) if mass(field) > 0.0 => entries.push((field as u32, w * share.fraction)),
                        _ => return self.carried_entries(body, rest, nudged),
                    }
                }
            }
        }
        entries
    }

    fn carried_entries(&self, body: u32, rest: Point, nudged: Point) -> Vec<(u32, f64)> {
        let at = (rest - self.particles.anchor) / self.particles.spacing;
        let center = [at.x.floor() as i32, at.y.floor() as i32];
        let mut nearest: Option<(bool, f64, usize)> = None;
        for reach in [2, 6] {
            let (low, high) = (center.map(|c| c.saturating_sub(reach)), center.map(|c| c.saturating_add(reach)));
            let own = |&p: &usize| self.particles.body[p] == body && self.layout.riders.host(p).is_none();
            for p in self.particles.within(low, high).filter(own) {
                let place = self.particles.rest[p];
                let across = self.is_across(body, place, nudged);
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
