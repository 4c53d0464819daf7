//! Bodies that begin inside of a collider.

use crate::boundary::collider::Obstacle;
use crate::particles::Particles;
use fissure_scene::{Contact, KeyPath, Scene, SceneFault};

/// A body may reach this far into a collider, in particle spacings: outlines are flattened, and drawn things touch.
const TOUCH: f64 = 1.0;

/// That no body begins inside of a collider, except of one that holds what it touches.
pub(super) fn check_colliders(scene: &Scene, particles: &Particles) -> Result<(), SceneFault> {
    for (index, collider) in scene.colliders.iter().enumerate().filter(|(_, c)| c.contact != Contact::Stick) {
        let obstacle = Obstacle::new(collider);
        let placed = obstacle.at(0.0);
        // A particle stands for the material half a spacing around it.
        let depth = |p: usize| placed.contact(particles.rest[p]).map(|s| 0.5 * scene.particle_spacing - s.distance);
        let deepest = (0..particles.len()).filter_map(|p| Some((p, depth(p)?))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((particle, depth)) = deepest.filter(|d| d.1 > TOUCH * scene.particle_spacing) else { continue };
        let (body, place) = (particles.body[particle] as usize, particles.rest[particle]);
        let message = format!(
            "body `{}` is inside collider `{}` at the start, {depth:.3} m deep at ({:.4}, {:.4}) m",
            scene.bodies[body].name, collider.name, place.x, place.y
        );
        let remedy = "move them apart, or let the collider hold what is inside of it with `contact = \"stick\"`";
        let shape = |array: &str, index: usize| KeyPath::item(array, index).then("shape");
        return Err(SceneFault::new(shape("body", body), message, remedy).with(shape("collider", index)));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{free_body, rectangle};
    use fissure_scene::{Collider, ColliderShape, Point, Pose, Vector};

    /// Truth: the construction. A floor under a block, at different heights.
    #[test]
    fn a_block_may_stand_on_a_floor_and_not_in_it() {
        let told = |height: f64, contact: Contact| {
            let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.25);
            scene.colliders.push(Collider {
                name: "floor".into(),
                shape: ColliderShape::HalfPlane { normal: Vector::y() },
                keyframes: vec![(0.0, Pose { position: Point::new(0.0, height), angle: 0.0 })],
                contact,
                friction: 0.0,
            });
            let particles = Particles::fill(&scene).unwrap();
            check_colliders(&scene, &particles).err()
        };
        for height in [-1.0, 0.0, 0.2] {
            assert!(told(height, Contact::Separate).is_none(), "{height}");
        }
        let fault = told(1.5, Contact::Slip).unwrap();
        assert!(fault.message.contains("1.500 m deep"), "{}", fault.message);
        assert_eq!(fault.other.unwrap().to_string(), "collider[0].shape");
        assert!(told(1.5, Contact::Stick).is_none());
    }
}
