//! Which body's own each node is.
//!
//! Two bodies with one velocity at a node would be one there: they could neither leave each other nor slide. Each node
//! is the own of the first body that sees it; the others have further fields there
//! ([`Fields`](crate::grid::fields::Fields)).

/// No body.
const NONE: u32 = u32::MAX;

/// The body that owns each node.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Owners {
    /// Of each node; empty where there is one body only.
    body: Vec<u32>,
}

impl Owners {
    /// Those of so many `nodes`; `seen` calls its visitor with (body, node) for every node that a body sees, as often
    /// as it likes, body by body.
    pub(crate) fn new(nodes: usize, seen: impl FnOnce(&mut dyn FnMut(u32, usize))) -> Self {
        let mut body = vec![NONE; nodes];
        seen(&mut |seeing, node| {
            if body[node] == NONE {
                body[node] = seeing;
            }
        });
        Self { body }
    }

    /// The body, when the node is not its own.
    #[inline]
    pub(crate) fn guest(&self, node: usize, body: u32) -> Option<u32> {
        self.body.get(node).is_some_and(|&owner| owner != body).then_some(body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the construction. Body 0 sees nodes 1 and 2, body 2 nodes 2 and 3, body 5 nodes 2 and 3.
    #[test]
    fn the_first_body_owns_a_node() {
        let owners = Owners::new(5, |see| {
            for (body, node) in [(0, 1), (0, 2), (2, 2), (2, 3), (2, 2), (5, 3), (5, 2)] {
                see(body, node);
            }
        });
        let guests = |body| (0..4).filter(|&node| owners.guest(node, body).is_some()).collect::<Vec<_>>();
        assert_eq!([guests(0), guests(2), guests(5)], [vec![0, 3], vec![0, 1, 2], vec![0, 1, 2, 3]]);
        assert!((0..5).all(|node| Owners::default().guest(node, 0).is_none()));
    }
}
