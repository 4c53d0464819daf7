//! Velocity fields at nodes: which degree of freedom serves a node for particles that see it across given cracks.
//!
//! Every node has its own field; its degree of freedom has the number of the node. Nodes near cracks have further
//! fields, one for each set of (crack, side) that particles cross on the way to the node; their number is not limited,
//! and a scene without a crack has none.

use crate::crack::division::CrossedSet;
use crate::saved::{self, Fits};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The further fields of all nodes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Fields {
    nodes: usize,
    of_node: BTreeMap<u32, Vec<(CrossedSet, u32)>>,
    /// Node of each further field, in the order of their numbers.
    node_of: Vec<u32>,
}

impl Fields {
    /// No further fields on `nodes` nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { nodes, of_node: BTreeMap::new(), node_of: Vec::new() }
    }

    /// Checks fields that were read against so many `nodes` and `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`](crate::SimulationError::BadState)
    pub(crate) fn check(&self, nodes: usize, cracks: usize) -> Fits {
        saved::ensure(self.nodes == nodes, "its number of nodes")?;
        saved::below("a field", self.node_of.iter().copied(), nodes)?;
        for (&node, fields) in &self.of_node {
            for (crossed, field) in fields {
                saved::below("a field", crossed.iter().map(|(crack, _)| *crack), cracks)?;
                let further = (*field as usize).checked_sub(nodes).and_then(|further| self.node_of.get(further));
                saved::ensure(further == Some(&node), "a field of a node")?;
            }
        }
        Ok(())
    }

    /// Number of fields of all nodes together.
    pub(crate) fn len(&self) -> usize {
        self.nodes + self.node_of.len()
    }

    /// The node a field belongs to.
    pub(crate) fn node(&self, field: usize) -> usize {
        if field < self.nodes { field } else { self.node_of[field - self.nodes] as usize }
    }

    /// The field at `node` for particles across `crossed`, if it exists.
    pub(crate) fn find(&self, node: usize, crossed: &CrossedSet) -> Option<usize> {
        if crossed.is_empty() {
            return Some(node);
        }
        let fields = self.of_node.get(&(node as u32))?;
        fields.iter().find(|(set, _)| set == crossed).map(|&(_, field)| field as usize)
    }

    /// The further fields of a node, each with its crossed set.
    pub(crate) fn of(&self, node: usize) -> &[(CrossedSet, u32)] {
        self.of_node.get(&(node as u32)).map_or(&[], Vec::as_slice)
    }

    /// The field at `node` for particles across `crossed`, made when it does not exist.
    pub(crate) fn find_or_add(&mut self, node: usize, crossed: &CrossedSet) -> usize {
        if let Some(field) = self.find(node, crossed) {
            return field;
        }
        let field = self.len();
        self.node_of.push(node as u32);
        self.of_node.entry(node as u32).or_default().push((crossed.clone(), field as u32));
        field
    }

    /// Nodes that have further fields, rising, each with (crossed set, field).
    pub(crate) fn divided_nodes(&self) -> impl Iterator<Item = (usize, &[(CrossedSet, u32)])> {
        self.of_node.iter().map(|(&node, fields)| (node as usize, fields.as_slice()))
    }
}
