//! Colliders on nodes (thesis 3.1.4).

use super::lattice::Lattice;
use super::nodes::Nodes;
use crate::boundary::collider::{Obstacle, PlacedObstacle};
use fissure_scene::Scene;

/// The colliders of a scene.
#[derive(Debug)]
pub(super) struct Colliders {
    obstacles: Vec<Obstacle>,
}

impl Colliders {
    pub(super) fn of(scene: &Scene) -> Self {
        Self { obstacles: scene.colliders.iter().map(Obstacle::new).collect() }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// The colliders where they are at `time` [s].
    pub(super) fn at(&self, time: f64) -> Vec<PlacedObstacle<'_>> {
        self.obstacles.iter().map(|obstacle| obstacle.at(time)).collect()
    }

    /// Keeps nodes out of colliders at the time `middle` [s]; gives the work of that [J/m].
    pub(super) fn collide_nodes(&self, lattice: &Lattice, middle: f64, nodes: &mut Nodes) -> f64 {
        let mut work = 0.0;
        for placed in self.at(middle) {
            for (field, place) in lattice.places_of_fields().enumerate() {
                let mass = nodes.mass[field];
                if mass <= 0.0 {
                    continue;
                }
                let place = lattice.grid.place(place);
                let before = nodes.velocity(field);
                let after = placed.resolve(before, place);
                if after != before {
                    work += mass * (after - before).dot(&placed.velocity(place));
                    nodes.after[0][field] = after.x;
                    nodes.after[1][field] = after.y;
                }
            }
        }
        work
    }
}
