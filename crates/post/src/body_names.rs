//! What bodies are called in the names of objects.

use crate::mesh::plain;
use fissure_scene::Scene;
use std::collections::BTreeSet;

/// The names of the bodies of `scene` in letters, digits, `_` and `-`; of those that become equal all but the first get
/// a number.
pub(crate) fn body_names(scene: &Scene) -> Vec<String> {
    unique(scene.bodies.iter().map(|body| body.name.as_str()))
}

fn unique<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    let free = |name: &str| {
        let name = plain(name);
        let mut free = name.clone();
        let mut number = 1;
        while !taken.insert(free.clone()) {
            number += 1;
            free = format!("{name}_{number}");
        }
        free
    };
    names.map(free).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand.
    #[test]
    fn no_two_bodies_have_one_name() {
        let names = unique(["a b", "a_b", "pane", "a_b_2", "a.b"].into_iter());
        assert_eq!(names, ["a_b", "a_b_2", "pane", "a_b_2_2", "a_b_3"]);
    }
}
