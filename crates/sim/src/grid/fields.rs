//! Velocity fields at nodes: which degree of freedom serves a node for particles that see it across given cracks.
//!
//! Every node has its own field; its degree of freedom has the number of the node. Nodes near cracks have further
//! fields, one for each set of (crack, side) that particles cross on the way to the node; their number is not limited,
//! and a scene without a crack has none. A node that several bodies see is one body's own
//! ([`Owners`](crate::grid::owners::Owners)); the others have fields of their own there.

use crate::crack::crossing::Side;
use crate::crack::division::{CrossedSet, facing};
use crate::saved::{self, Fits};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// A field besides a node's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct FurtherField {
    node: u32,
    /// The body it serves, when the node is another body's own.
    guest: Option<u32>,
    /// What particles cross on their way to the node.
    crossed: CrossedSet,
}

/// The fields of all nodes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "SavedFields", into = "SavedFields")]
pub(crate) struct Fields {
    nodes: usize,
    /// In the order of their numbers, the first of which is `nodes`.
    further: Vec<FurtherField>,
    /// Numbers of the further fields of each node that has some, rising.
    of_node: FxHashMap<u32, Vec<u32>>,
}

/// What tells all of [`Fields`].
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename = "Fields")]
struct SavedFields {
    nodes: usize,
    further: Vec<FurtherField>,
}

impl From<SavedFields> for Fields {
    fn from(saved: SavedFields) -> Self {
        let mut of_node: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for (number, field) in (saved.nodes as u32..).zip(&saved.further) {
            of_node.entry(field.node).or_default().push(number);
        }
        Self { nodes: saved.nodes, further: saved.further, of_node }
    }
}

impl From<Fields> for SavedFields {
    fn from(fields: Fields) -> Self {
        Self { nodes: fields.nodes, further: fields.further }
    }
}

/// Two fields of one node on the two sides of one crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FacingFields {
    pub(crate) first: u32,
    pub(crate) second: u32,
    pub(crate) crack: u32,
    /// Side of the crack that the first is on.
    side: Side,
}

impl FacingFields {
    /// The field above the crack and the one below.
    pub(crate) fn above_and_below(&self) -> [u32; 2] {
        if self.side == Side::Above { [self.first, self.second] } else { [self.second, self.first] }
    }
}

impl Fields {
    /// No further fields on `nodes` nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { nodes, ..Self::default() }
    }

    /// Forgets all further fields; from now on there are so many `nodes`.
    pub(crate) fn clear(&mut self, nodes: usize) {
        self.nodes = nodes;
        self.further.clear();
        self.of_node.clear();
    }

    /// Checks fields that were read against so many `nodes`, `bodies` and `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self, nodes: usize, bodies: usize, cracks: usize) -> Fits {
        saved::ensure(self.nodes == nodes, "its number of nodes")?;
        saved::below("a field", self.further.iter().map(|field| field.node), nodes)?;
        saved::below("a field", self.further.iter().filter_map(|field| field.guest), bodies)?;
        let crossed = self.further.iter().flat_map(|field| &field.crossed);
        saved::below("a field", crossed.map(|(crack, _)| *crack), cracks)
    }

    /// Number of fields of all nodes together.
    pub(crate) fn len(&self) -> usize {
        self.nodes + self.further.len()
    }

    /// Number of further fields.
    pub(crate) fn further_count(&self) -> usize {
        self.further.len()
    }

    /// The nodes of the further fields, in the order of the fields.
    pub(crate) fn nodes_of_further(&self) -> impl Iterator<Item = usize> {
        self.further.iter().map(|field| field.node as usize)
    }

    /// The node a field belongs to.
    pub(crate) fn node(&self, field: usize) -> usize {
        if field < self.nodes { field } else { self.further[field - self.nodes].node as usize }
    }

    /// What particles of a field cross on their way to its node.
    pub(crate) fn crossed(&self, field: usize) -> &[(u32, Side)] {
        field.checked_sub(self.nodes).map_or(&[], |further| &self.further[further].crossed)
    }

    /// The body a field serves, when its node is another body's own.
    pub(crate) fn guest(&self, field: usize) -> Option<u32> {
        field.checked_sub(self.nodes).and_then(|further| self.further[further].guest)
    }

    /// The field at `node` for particles across `crossed`, if it exists; of the body `guest` when the node is another
    /// body's own.
    pub(crate) fn find(&self, node: usize, guest: Option<u32>, crossed: &CrossedSet) -> Option<usize> {
        if guest.is_none() && crossed.is_empty() {
            return Some(node);
        }
        let mut fields = self.of(node).iter().map(|&field| field as usize);
        fields.find(|&field| self.guest(field) == guest && self.crossed(field) == crossed.as_slice())
    }

    /// The further fields of a node, rising.
    pub(crate) fn of(&self, node: usize) -> &[u32] {
        self.of_node.get(&(node as u32)).map_or(&[], Vec::as_slice)
    }

    /// As [`Fields::find`]; the field is made when it does not exist.
    pub(crate) fn find_or_add(&mut self, node: usize, guest: Option<u32>, crossed: &CrossedSet) -> usize {
        if let Some(field) = self.find(node, guest, crossed) {
            return field;
        }
        let field = self.len();
        self.further.push(FurtherField { node: node as u32, guest, crossed: crossed.clone() });
        self.of_node.entry(node as u32).or_default().push(field as u32);
        field
    }

    /// Nodes that have further fields, rising.
    pub(crate) fn divided_nodes(&self) -> Vec<usize> {
        let mut nodes: Vec<usize> = self.of_node.keys().map(|&node| node as usize).collect();
        nodes.sort_unstable();
        nodes
    }

    /// All pairs of `fields`, which are of one node, that face each other across one crack of their body.
    pub(crate) fn facing_pairs(&self, fields: &[u32]) -> impl Iterator<Item = FacingFields> {
        let pairs = fields
            .iter()
            .enumerate()
            .flat_map(|(k, &first)| fields[k + 1..].iter().map(move |&second| (first, second)));
        let of_one_body = |&(first, second): &(u32, u32)| self.guest(first as usize) == self.guest(second as usize);
        pairs.filter(of_one_body).filter_map(|(first, second)| {
            let (crack, side) = facing(self.crossed(first as usize), self.crossed(second as usize))?;
            Some(FacingFields { first, second, crack, side })
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use smallvec::smallvec;

    /// Truth: the drawing. Node 7 lies between crack 0 above it and crack 1 below it: three fields, of which the outer
    /// two see each other across both cracks and do not face.
    #[test]
    fn fields_face_across_one_crack() {
        let mut fields = Fields::new(10);
        let above = fields.find_or_add(7, None, &smallvec![(0, Side::Above)]) as u32;
        let below = fields.find_or_add(7, None, &smallvec![(1, Side::Below)]) as u32;
        assert_eq!(fields.find_or_add(7, None, &smallvec![(0, Side::Above)]) as u32, above);
        // Another body there is whole: it faces nothing.
        let guest = fields.find_or_add(7, Some(1), &CrossedSet::new()) as u32;
        assert_eq!(fields.find_or_add(7, Some(1), &CrossedSet::new()) as u32, guest);
        let all = [7, above, below, guest];
        let found: Vec<_> = fields.facing_pairs(&all).map(|p| (p.crack, p.above_and_below())).collect();
        assert_eq!(found, [(0, [above, 7]), (1, [7, below])]);
        let bytes = saved::to_bytes(&fields).unwrap();
        assert_eq!(saved::from_bytes::<Fields>(&bytes).unwrap(), fields);
    }
}
