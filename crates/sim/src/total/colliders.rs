//! Colliders: obstacles that the surface of the material cannot enter.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use crate::boundary::collider::Obstacle;
use fissure_plane::Point;
use fissure_scene::Scene;
use std::collections::BTreeMap;

/// A field at the surface of a body, which a collider can touch.
#[derive(Debug, Clone, Copy)]
struct SurfaceNode {
    field: u32,
    /// Where its node is at rest [m].
    place: Point,
    /// How far the material goes beyond the node towards an obstacle [m]; negative when it ends before it.
    reach: f64,
}

/// The surface node of a field whose hat is filled with material to the given part; none within the material and far
/// from it.
fn surface_node(field: usize, place: Point, part: f64, h: f64) -> Option<SurfaceNode> {
    if part <= 0.0 || part > 0.999 {
        return None;
    }
    // A half-plane of material whose edge lies d beyond the node fills the part ½ + d/h ∓ ½ (d/h)² of the node's hat;
    // solved for d.
    let beyond = |x: f64| h * (1.0 - (1.0 - x).max(0.0).sqrt());
    let reach = if part >= 0.5 { beyond(2.0 * part - 1.0) } else { -beyond(1.0 - 2.0 * part) };
    Some(SurfaceNode { field: field as u32, place, reach })
}

/// The obstacles of the scene and what they can touch.
#[derive(Debug)]
pub(super) struct Colliders {
    obstacles: Vec<Obstacle>,
    surface: Vec<SurfaceNode>,
}

impl Colliders {
    /// The obstacles of `scene`, and the fields whose node is not surrounded by material of their own.
    pub(super) fn new(scene: &Scene, lattice: &Lattice) -> Self {
        let obstacles: Vec<Obstacle> = scene.colliders.iter().map(Obstacle::new).collect();
        let surface = if obstacles.is_empty() { Vec::new() } else { surface_nodes(lattice) };
        Self { obstacles, surface }
    }

    /// Whether there is none.
    pub(super) fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// The same after a change: fields elsewhere are as before.
    pub(super) fn refresh(&mut self, near: &Near, lattice: &Lattice) {
        if self.is_empty() {
            return;
        }
        let h = lattice.grid.cell_size;
        self.surface.retain(|s| !near.contains(s.place));
        // Every particle that has a weight at a node in the boxes, in the order of their numbers.
        let mut particles: Vec<usize> = Vec::new();
        for (low, high) in near.widened(2.0 * h) {
            particles.extend(lattice.particles.in_box(low, high));
        }
        particles.sort_unstable();
        particles.dedup();
        let mut volume = BTreeMap::<usize, f64>::new();
        let mut reader = lattice.reader();
        for p in particles {
            reader.for_each_entry(p, |field, w, _| {
                if near.contains(lattice.position(field)) {
                    *volume.entry(field).or_default() += lattice.particles.volume[p] * w;
                }
            });
        }
        let of = |(&field, v): (&usize, &f64)| surface_node(field, lattice.position(field), v / (h * h), h);
        self.surface.extend(volume.iter().filter_map(of));
        self.surface.sort_unstable_by_key(|s| s.field);
    }

    /// Keeps the surface out of the obstacles where they are at the time `time` [s]. Adds the work of a step to `work`
    /// [J/m].
    pub(super) fn apply(&self, time: f64, mass: &[f64], motion: &mut Motion, work: &mut f64) {
        for obstacle in &self.obstacles {
            let placed = obstacle.at(time);
            for node in &self.surface {
                let d = node.field as usize;
                let place = node.place + motion.displacement(d);
                let found = placed.surface(place);
                if found.distance > node.reach {
                    continue;
                }
                let before = motion.velocity(d);
                // Where the material itself ends, which is what touches.
                let skin = place - found.normal * node.reach;
                let after = placed.resolve(before, skin);
                let impulse = (after - before) * mass[d];
                *work += impulse.dot(&placed.velocity(place));
                motion.velocity[0][d] = after.x;
                motion.velocity[1][d] = after.y;
            }
        }
    }
}

fn surface_nodes(lattice: &Lattice) -> Vec<SurfaceNode> {
    let h = lattice.grid.cell_size;
    let mut volume = vec![0.0; lattice.field_count()];
    let mut reader = lattice.reader();
    for p in 0..lattice.particles.len() {
        reader.for_each_entry(p, |field, w, _| volume[field] += lattice.particles.volume[p] * w);
    }
    let fields = volume.iter().zip(lattice.places_of_fields()).enumerate();
    fields.filter_map(|(field, (v, place))| surface_node(field, lattice.grid.place(place), v / (h * h), h)).collect()
}
