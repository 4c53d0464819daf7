//! Pieces: what of the material hangs together, and how each of them moves as if it were rigid.

use super::lattice::Lattice;
use super::motion::Motion;
use super::supports::HeldFields;
use fissure_plane::Vector;
use petgraph::unionfind::UnionFind;

/// The piece of a field that no particle sees.
const NONE: u32 = u32::MAX;

/// Fields that particles tie together, from one to the next.
#[derive(Debug)]
pub(super) struct Piece {
    /// Rising.
    fields: Vec<u32>,
    /// Where the nodes of these are at rest [m].
    places: Vec<Vector>,
    pub(super) body: u32,
    /// Whether its body has other pieces.
    pub(super) is_fragment: bool,
    /// Whether a support holds any of it.
    pub(super) is_held: bool,
}

/// All pieces, in the order of their first fields.
#[derive(Debug, Default)]
pub(super) struct Pieces {
    pieces: Vec<Piece>,
    of_field: Vec<u32>,
}

/// The motion of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RigidMotion {
    /// Mass per unit thickness [kg/m].
    pub(super) mass: f64,
    /// Moment of inertia about the centre, per unit thickness [kg m].
    pub(super) inertia: f64,
    /// Centre of mass [m].
    pub(super) centre: Vector,
    /// Velocity of the centre [m/s].
    pub(super) velocity: Vector,
    /// Angular velocity, counterclockwise [1/s].
    pub(super) turning: f64,
}

impl Pieces {
    /// The pieces of `lattice` as its cracks have cut it.
    pub(super) fn new(lattice: &Lattice, held: &HeldFields) -> Self {
        let count = lattice.field_count();
        let mut sets = UnionFind::<u32>::new(count);
        let mut bodies = vec![NONE; count];
        let mut reader = lattice.reader();
        for (p, &body) in lattice.particles.body.iter().enumerate() {
            // What lies across a crack is no part of this piece, and counts for that of the particles there.
            let mut first = None;
            reader.for_each_entry(p, |field, _, _| {
                bodies[field] = body;
                sets.union(*first.get_or_insert(field as u32), field as u32);
            });
        }
        let sets = sets.into_labeling();
        let mut all = Self { pieces: Vec::new(), of_field: vec![NONE; count] };
        let mut numbers = vec![NONE; count];
        for field in (0..count as u32).filter(|&f| bodies[f as usize] != NONE && lattice.mass()[f as usize] > 0.0) {
            let number = &mut numbers[sets[field as usize] as usize];
            if *number == NONE {
                *number = all.pieces.len() as u32;
                let body = bodies[field as usize];
                let (fields, places) = (Vec::new(), Vec::new());
                all.pieces.push(Piece { fields, places, body, is_fragment: false, is_held: false });
            }
            all.of_field[field as usize] = *number;
            let piece = &mut all.pieces[*number as usize];
            piece.fields.push(field);
            piece.places.push(lattice.position(field as usize).coords);
            piece.is_held |= (0..2).any(|axis| held.holds(field, axis));
        }
        let mut of_body = vec![0_u32; bodies.iter().filter(|&&body| body != NONE).max().map_or(0, |&b| b as usize + 1)];
        all.pieces.iter().for_each(|piece| of_body[piece.body as usize] += 1);
        all.pieces.iter_mut().for_each(|piece| piece.is_fragment = of_body[piece.body as usize] > 1);
        all
    }

    /// Number of pieces.
    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// A piece.
    pub(super) fn get(&self, piece: usize) -> &Piece {
        &self.pieces[piece]
    }

    /// The piece of a field; none of one that no particle saw when pieces were made.
    pub(super) fn of(&self, field: u32) -> Option<usize> {
        self.of_field.get(field as usize).filter(|&&piece| piece != NONE).map(|&piece| piece as usize)
    }
}

impl Piece {
    /// The rigid motion that has its momentum and its angular momentum.
    pub(super) fn rigid_motion(&self, lattice: &Lattice, motion: &Motion) -> RigidMotion {
        let (mut mass, mut moment, mut momentum) = (0.0, Vector::zeros(), Vector::zeros());
        for (field, place) in self.fields(motion) {
            let m = lattice.mass()[field];
            mass += m;
            moment += place * m;
            momentum += motion.velocity(field) * m;
        }
        let (centre, velocity) = (moment / mass, momentum / mass);
        let (mut inertia, mut spin) = (0.0, 0.0);
        for (field, place) in self.fields(motion) {
            let (m, arm) = (lattice.mass()[field], place - centre);
            inertia += m * arm.norm_squared();
            spin += m * arm.perp(&(motion.velocity(field) - velocity));
        }
        // What has only one field has no size to turn by.
        let turning = if inertia > 0.0 { spin / inertia } else { 0.0 };
        RigidMotion { mass, inertia, centre, velocity, turning }
    }

    /// Changes the velocities of all its fields by what two rigid motions about one centre differ by.
    pub(super) fn change(&self, before: &RigidMotion, after: &RigidMotion, motion: &mut Motion) {
        let (change, turn) = (after.velocity - before.velocity, after.turning - before.turning);
        for (&field, &place) in self.fields.iter().zip(&self.places) {
            let field = field as usize;
            let added = change + turned(place + motion.displacement(field) - before.centre) * turn;
            motion.velocity[0][field] += added.x;
            motion.velocity[1][field] += added.y;
        }
    }

    /// Its fields, and where their nodes are now [m].
    fn fields<'a>(&'a self, motion: &'a Motion) -> impl Iterator<Item = (usize, Vector)> + 'a {
        let now = |(&field, &place): (&u32, &Vector)| (field as usize, place + motion.displacement(field as usize));
        self.fields.iter().zip(&self.places).map(now)
    }
}

impl RigidMotion {
    /// Velocity of what is at `point` [m/s].
    pub(super) fn velocity_at(&self, point: Vector) -> Vector {
        self.velocity + turned(point - self.centre) * self.turning
    }

    /// The motion after an impulse per unit thickness [N s/m] at `point`.
    pub(super) fn pushed(self, impulse: Vector, point: Vector) -> Self {
        let added = if self.inertia > 0.0 { (point - self.centre).perp(&impulse) / self.inertia } else { 0.0 };
        let turning = self.turning + added;
        Self { velocity: self.velocity + impulse / self.mass, turning, ..self }
    }
}

/// A quarter turn to the left.
fn turned(v: Vector) -> Vector {
    Vector::new(-v.y, v.x)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Total;
    use super::*;
    use crate::crack::cracks::Cracks;
    use crate::particles::Particles;
    use crate::test_scenes;
    use std::sync::Arc;

    /// Truth: the drawing, and the motion of a rigid body. A crack across a square, beside one that ends within, makes
    /// two pieces of it; another body is one, between them in the order of nodes. A piece that is turned and moved has
    /// that motion.
    #[test]
    fn pieces_are_what_cracks_leave_whole_and_move_as_they_are_moved() {
        let mut scene = test_scenes::free_body(test_scenes::rectangle([0.0, 0.0], [4.0, 4.0]), 0.1);
        scene.solver.formulation = fissure_scene::Formulation::Total;
        test_scenes::add_crack(&mut scene, &[[0.0, 2.03], [4.0, 1.51]]);
        test_scenes::add_crack(&mut scene, &[[0.9, 3.0], [2.9, 3.3]]);
        test_scenes::add_body(&mut scene, [5.0, 0.0]);
        let cracks = Cracks::of_scene(&scene);
        let mut total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
        let pieces = Pieces::new(&total.lattice, total.supports.held());
        let found: Vec<(u32, bool, bool)> =
            (0..pieces.len()).map(|k| pieces.get(k)).map(|p| (p.body, p.is_fragment, p.is_held)).collect();
        assert_eq!(found, [(0, true, false), (1, false, false), (0, true, false)]);
        let area =
            |k: usize| pieces.get(k).rigid_motion(&total.lattice, &total.motion).mass / scene.materials[0].density;
        let below = 0.5 * (2.03 + 1.51) * 4.0;
        assert!((area(0) - below).abs() < 1e-2 && (area(2) - 16.0 + below).abs() < 1e-2, "{} {}", area(0), area(2));
        let at_rest = pieces.get(2).rigid_motion(&total.lattice, &total.motion);
        let moved = RigidMotion { velocity: Vector::new(0.3, -2.0), turning: 0.7, ..at_rest };
        pieces.get(2).change(&at_rest, &moved, &mut total.motion);
        let found = pieces.get(2).rigid_motion(&total.lattice, &total.motion);
        assert!((found.velocity - moved.velocity).norm() < 1e-12 && (found.turning - 0.7).abs() < 1e-12);
        let others = [0, 1].map(|k| pieces.get(k).rigid_motion(&total.lattice, &total.motion));
        assert!(others.iter().all(|other| other.velocity == Vector::zeros() && other.turning == 0.0));
        // A blow off the centre: momentum and angular momentum of the blow.
        let (blow, at) = (Vector::new(2.0, 1.0), Vector::new(3.0, 3.5));
        let after = at_rest.pushed(blow, at);
        assert!((after.velocity * after.mass - blow).norm() < 1e-12);
        assert!((after.turning * after.inertia - (at - at_rest.centre).perp(&blow)).abs() < 1e-12);
    }
}
