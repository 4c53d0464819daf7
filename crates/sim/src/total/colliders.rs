//! Colliders: obstacles that the surface of the material cannot enter.

use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::rebound::{Ground, Push};
use super::ties::Ties;
use crate::boundary::collider::Obstacle;
use crate::boundary::constraints::Inertia;
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::Scene;

/// A field at the surface of a body, which a collider can touch.
#[derive(Debug, Clone, Copy)]
struct SurfaceNode {
    field: u32,
    /// Where its node is at rest [m].
    place: Point,
    /// How far the material goes beyond the node towards an obstacle [m]; negative when it ends before it.
    reach: f64,
    /// Beside a crack: which way is out of the material.
    face: Option<Face>,
}

/// A face of a crack at a node.
#[derive(Debug, Clone, Copy)]
struct Face {
    /// Out of the material at rest, of any length.
    outward: Vector,
    /// The particle that has the largest part of itself at the node, which says how the material has turned.
    particle: u32,
}

/// What particles have at a field.
#[derive(Debug, Clone, Copy, Default)]
struct Filling {
    /// Volume per unit thickness [m²].
    volume: f64,
    /// ∫ ∇w dV over the material, by Gauss' theorem that of the outward normal times w over its border [m].
    outward: Vector,
    particle: u32,
    largest: f64,
}

impl Filling {
    fn add(&mut self, particle: usize, volume: f64, weight: f64, gradient: Vector) {
        self.volume += volume * weight;
        self.outward += gradient * volume;
        if weight > self.largest {
            (self.largest, self.particle) = (weight, particle as u32);
        }
    }

    /// The surface node of a field with this.
    fn surface_node(&self, lattice: &Lattice, field: usize, place: Point) -> Option<SurfaceNode> {
        let h = lattice.grid.cell_size;
        let found = surface_node(field, place, self.volume / (h * h), h)?;
        let node = lattice.fields().node(field);
        let guest = lattice.fields().guest(field);
        let is_divided = lattice.fields().of(node).iter().any(|&other| {
            lattice.fields().guest(other as usize) == guest && !lattice.fields().crossed(other as usize).is_empty()
        });
        let face = is_divided.then_some(Face { outward: self.outward, particle: self.particle });
        Some(SurfaceNode { face, ..found })
    }
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
    Some(SurfaceNode { field: field as u32, place, reach, face: None })
}

/// The obstacles of the scene and what they can touch.
#[derive(Debug)]
pub(super) struct Colliders {
    obstacles: Vec<Obstacle>,
    surface: Vec<SurfaceNode>,
    /// Of each field, its number from 1 on among those whose surface is found anew; zero between changes and elsewhere.
    numbers: Vec<u32>,
}

/// What obstacles do in a step [J/m].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CollisionWork {
    /// By how they move.
    pub(super) of_motion: f64,
    /// What their impulses do to what the leapfrog keeps beyond that: they work on the mean of the velocities before
    /// and after a kick. Below zero where material runs into an obstacle and is stopped; above where it was about to
    /// leave and waves of the lattice throw it back within a step.
    pub(super) beyond: f64,
}

impl Colliders {
    /// The obstacles of `scene`, and the fields whose node is not surrounded by material of their own.
    pub(super) fn new(scene: &Scene, lattice: &Lattice) -> Self {
        let obstacles: Vec<Obstacle> = scene.colliders.iter().map(Obstacle::new).collect();
        let surface = if obstacles.is_empty() { Vec::new() } else { surface_nodes(lattice) };
        Self { obstacles, surface, numbers: Vec::new() }
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
        self.surface.retain(|s| !near.contains(s.place));
        // Every particle that has a weight at a node in the boxes, in the order of their numbers.
        let mut particles: Vec<usize> = Vec::new();
        for (low, high) in near.widened(2.0 * lattice.grid.cell_size) {
            particles.extend(lattice.particles.in_box(low, high));
        }
        particles.sort_unstable();
        particles.dedup();
        let fields = near.fields(lattice);
        self.numbers.resize(lattice.field_count(), 0);
        (1..).zip(&fields).for_each(|(number, &(field, _))| self.numbers[field] = number);
        let mut fillings = vec![Filling::default(); fields.len()];
        let mut reader = lattice.reader();
        for p in particles {
            reader.for_each_part(p, |field, share, w, g| {
                if let Some(at) = self.numbers[field].checked_sub(1) {
                    fillings[at as usize].add(p, share * lattice.particles.volume[p], w, g);
                }
            });
        }
        fields.iter().for_each(|&(field, _)| self.numbers[field] = 0);
        let of = |(&(field, place), filling): (&(usize, Point), &Filling)| filling.surface_node(lattice, field, place);
        self.surface.extend(fields.iter().zip(&fillings).filter_map(of));
        self.surface.sort_unstable_by_key(|s| s.field);
    }

    /// Keeps the surface out of the obstacles where they are at the time `time` [s]. `gain`:
    /// [`super::motion::force_of_impulse`]. Tells `pushed` of each push.
    pub(super) fn apply(
        &self,
        time: f64,
        gain: f64,
        (lattice, ties): (&Lattice, &Ties),
        motion: &mut Motion,
        pushed: &mut dyn FnMut(Push),
    ) -> CollisionWork {
        let mut work = CollisionWork::default();
        for obstacle in &self.obstacles {
            let placed = obstacle.at(time);
            for node in &self.surface {
                let d = node.field as usize;
                let place = node.place + motion.displacement(d);
                let mut found = placed.surface(place);
                if found.distance > node.reach {
                    continue;
                }
                if let Some(face) = node.face {
                    let turn = deformation_gradient(lattice, face.particle as usize, motion);
                    // Normals go with the cofactors of F.
                    let outward = Vector::new(
                        turn.m22 * face.outward.x - turn.m21 * face.outward.y,
                        turn.m11 * face.outward.y - turn.m12 * face.outward.x,
                    );
                    match placed.surface_facing(place, outward) {
                        Some(facing) if facing.distance <= node.reach => found = facing,
                        _ => continue,
                    }
                }
                let before = motion.velocity(d);
                // Where the material itself ends, which is what touches.
                let skin = place - found.normal * node.reach;
                let after = if node.face.is_some() {
                    placed.resolve_at(before, skin, found.normal)
                } else {
                    placed.resolve(before, skin)
                };
                if after == before {
                    continue;
                }
                // A field that is tied to others takes them along.
                let inertia = ties.inertia_at(lattice.fields().node(d), &lattice.inverse_mass);
                let mut own = 0.0;
                inertia.response(node.field, &mut |moved, response| {
                    own += if moved == node.field { response } else { 0.0 }
                });
                let impulse = (after - before) / own;
                let before_kick = Vector::new(motion.before_kick()[0][d], motion.before_kick()[1][d]);
                let of_obstacle = placed.velocity(place);
                let of_motion = impulse.dot(&of_obstacle);
                let along = found.normal.dot(&impulse);
                // What sticks is pulled, too.
                if along > 0.0 {
                    let on = Ground::Collider(of_obstacle);
                    pushed(Push { point: skin, field: node.field, on, impulse: found.normal * along });
                }
                work.of_motion += of_motion;
                work.beyond += 0.5 * gain * impulse.dot(&(before_kick + after)) - of_motion;
                inertia.response(node.field, &mut |moved, response| {
                    for axis in 0..2 {
                        motion.velocity[axis][moved as usize] += response * impulse[axis];
                    }
                });
                motion.velocity[0][d] = after.x;
                motion.velocity[1][d] = after.y;
            }
        }
        work
    }
}

fn surface_nodes(lattice: &Lattice) -> Vec<SurfaceNode> {
    let mut fillings = vec![Filling::default(); lattice.field_count()];
    let mut reader = lattice.reader();
    for p in 0..lattice.particles.len() {
        reader.for_each_part(p, |field, share, w, g| {
            fillings[field].add(p, share * lattice.particles.volume[p], w, g);
        });
    }
    let fields = fillings.iter().zip(lattice.places_of_fields()).enumerate();
    let of = |(field, (filling, place)): (usize, (&Filling, [i32; 2]))| {
        filling.surface_node(lattice, field, lattice.grid.place(place))
    };
    fields.filter_map(of).collect()
}

fn deformation_gradient(lattice: &Lattice, particle: usize, motion: &Motion) -> Matrix {
    Matrix::identity() + lattice.reader().gradient(particle, &motion.displacement)
}
