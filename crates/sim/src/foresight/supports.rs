//! Supports that want different things of the same material.

use crate::boundary;
use crate::particles::Particles;
use fissure_scene::{KeyPath, Scene, SceneFault, Support};

/// Supports that share no more than this part of what the smaller one holds meet in a corner: there the later one
/// holds.
const CORNER: f64 = 0.25;

/// That no two supports give most of the same particles different velocities.
pub(super) fn check_supports(scene: &Scene, particles: &Particles) -> Result<(), SceneFault> {
    let held: Vec<Vec<u32>> = scene.supports.iter().map(|s| particles.select(scene, &s.selection)).collect();
    for (j, second) in scene.supports.iter().enumerate() {
        for (i, first) in scene.supports[..j].iter().enumerate() {
            let Some((axis, time)) = contradiction(first, second) else { continue };
            let shared: Vec<u32> = held[j].iter().filter(|p| held[i].binary_search(p).is_ok()).copied().collect();
            if shared.len() as f64 <= CORNER * held[i].len().min(held[j].len()) as f64 {
                continue;
            }
            let place = particles.rest[shared[shared.len() / 2] as usize];
            let speed = |s: &Support| s.velocity[axis].unwrap_or_default() * s.curve.value(time);
            let message = format!(
                "supports {} and {} hold the same material, {} particles around ({:.4}, {:.4}) m, but at t = {time} s with {} and {} m/s along {}",
                i + 1,
                j + 1,
                shared.len(),
                place.x,
                place.y,
                speed(first),
                speed(second),
                ["x", "y"][axis]
            );
            let remedy = "let each hold material of its own, or leave that direction free in one of them";
            return Err(SceneFault::new(KeyPath::item("support", j), message, remedy).with(KeyPath::item("support", i)));
        }
    }
    Ok(())
}

/// The first axis and a time [s] at which two supports prescribe different velocities.
fn contradiction(a: &Support, b: &Support) -> Option<(usize, f64)> {
    (0..2).find_map(|axis| Some((axis, boundary::supports::contradiction(a, b, axis)?)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::test_scenes::{always, free_body, rectangle};
    use fissure_scene::{BoxSide, Curve, Point, Selection};

    fn fault(supports: Vec<Support>) -> Option<SceneFault> {
        let mut scene = free_body(rectangle([0.0, 0.0], [4.0, 4.0]), 0.25);
        scene.supports = supports;
        let particles = Particles::fill(&scene).unwrap();
        check_supports(&scene, &particles).err()
    }

    fn edge(side: BoxSide, x: Option<f64>, y: Option<f64>) -> Support {
        Support { selection: Selection::Edge { side, bodies: None }, velocity: [x, y], curve: always() }
    }

    /// Truth: by construction the pairs want the same or different velocities of the same particles.
    #[test]
    fn only_different_velocities_of_the_same_material_contradict() {
        let near = |x, radius| Selection::Near { points: vec![Point::new(x, 2.0)], radius };
        let at = |selection: Selection, x: f64| Support { selection, velocity: [Some(x), None], curve: always() };
        let later = |x: f64, time: f64| Support {
            curve: Curve { points: vec![(time, 1.0), (time + 1.0, 2.0)] },
            ..edge(BoxSide::Left, Some(x), None)
        };
        let left = || edge(BoxSide::Left, Some(1.0), None);
        assert!(fault(vec![left(), left()]).is_none());
        assert!(fault(vec![left(), edge(BoxSide::Left, None, Some(2.0))]).is_none());
        assert!(fault(vec![left(), edge(BoxSide::Right, Some(-1.0), None)]).is_none());
        assert!(fault(vec![left(), edge(BoxSide::Top, Some(-1.0), None)]).is_none(), "they meet in a corner");
        assert!(fault(vec![at(near(1.0, 0.5), 1.0), at(near(3.0, 0.5), 2.0)]).is_none());

        let told = fault(vec![left(), edge(BoxSide::Left, Some(-1.0), None)]).unwrap();
        assert_eq!(
            (told.path.to_string(), told.other.unwrap().to_string()),
            ("support[1]".into(), "support[0]".into())
        );
        assert!(told.message.contains("1 and -1 m/s along x"), "{}", told.message);
        assert!(fault(vec![left(), at(Selection::All, 0.0)]).is_some());
        assert!(fault(vec![at(near(1.0, 0.5), 1.0), at(near(1.3, 0.5), 2.0)]).is_some());
        // The same until one of them speeds up.
        assert!(fault(vec![left(), later(1.0, 3.0)]).unwrap().message.contains("t = 4 s"));
    }
}
