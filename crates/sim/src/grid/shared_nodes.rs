//! Nodes that particles of several bodies see: which body's own they are.
//!
//! Two bodies with one velocity at a node would be one there: they could neither leave each other nor slide. Each node
//! is the own of the first body that sees it; the others have further fields there
//! ([`Fields`](crate::grid::fields::Fields)).

/// The nodes that several bodies see.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SharedNodes {
    /// (node, the body whose own it is), nodes rising.
    owners: Vec<(u32, u32)>,
}

impl SharedNodes {
    /// Those of so many `nodes`; `seen` calls its visitor with (body, node) for every node that a body sees, as often
    /// as it likes, body by body.
    pub(crate) fn new(nodes: usize, seen: impl FnOnce(&mut dyn FnMut(u32, usize))) -> Self {
        let mut first: Vec<Option<u32>> = vec![None; nodes];
        let mut owners = Vec::new();
        seen(&mut |body, node| {
            let owner = *first[node].get_or_insert(body);
            if owner != body {
                owners.push((node as u32, owner));
            }
        });
        owners.sort_unstable();
        owners.dedup();
        Self { owners }
    }

    /// The body, when the node is another body's own.
    pub(crate) fn guest(&self, node: usize, body: u32) -> Option<u32> {
        if self.owners.is_empty() {
            return None;
        }
        let found = self.owners.binary_search_by_key(&(node as u32), |&(node, _)| node).ok()?;
        (self.owners[found].1 != body).then_some(body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the construction. Body 0 sees nodes 1 and 2, body 2 nodes 2 and 3, body 5 nodes 2 and 3.
    #[test]
    fn the_first_body_owns_a_node() {
        let shared = SharedNodes::new(5, |see| {
            for (body, node) in [(0, 1), (0, 2), (2, 2), (2, 3), (2, 2), (5, 3), (5, 2)] {
                see(body, node);
            }
        });
        let guest = |node, body| shared.guest(node, body).is_some();
        assert_eq!(
            [(1, 0), (2, 0), (2, 2), (3, 2), (2, 5), (3, 5)].map(|(node, body)| guest(node, body)),
            [false, false, true, false, true, true]
        );
    }
}
