//! Pressure on edges and on crack faces: forces that follow the normals of the deformed material.
//!
//! On a piece of an edge, from its end a to its end b with the material to the left, a pressure p does
//! p (−(b − a)_y, (b − a)_x), where the carried outlines and faces have a and b: over a closed outline these forces add
//! up to nothing, whatever the deformation. Each acts on the particle that was nearest to the piece at rest, on its
//! side.

use super::faces::Faces;
use super::setup::Setup;
use super::tracer::Tracer;
use crate::SimulationError;
use crate::boundary::pressure::{PressedPiece, pressed_pieces};
use crate::crack::cracks::Cracks;
use crate::crack::crossing::Side;
use crate::particles::Particles;
use fissure_plane::{Point, Vector, distance_to_segment, nearest_on_segment};
use fissure_scene::LoadKind;

/// How far around a piece its particle is sought first, in spacings.
const NEAR: i32 = 3;

/// A place between two neighbours of what is carried along.
#[derive(Debug, Clone, Copy)]
struct Carried {
    line: Line,
    /// Number of the first of the two.
    from: usize,
    /// Part of the way to the second one.
    part: f64,
}

/// What is carried along.
#[derive(Debug, Clone, Copy)]
enum Line {
    /// A ring of the outlines, by its number among all.
    Ring(usize),
    /// A crack, and its face: 0 above, 1 below.
    Face(usize, usize),
}

/// A piece that is pressed on.
#[derive(Debug, Clone, Copy)]
struct Pressed {
    particle: u32,
    ends: [Carried; 2],
}

/// One load of the scene that is a pressure.
#[derive(Debug)]
pub(super) struct Pressure {
    load: usize,
    /// At a curve factor of 1 [Pa].
    pressure: f64,
    /// Its factor in the last step, at the beginning that of the start.
    factor: f64,
    pieces: Vec<Pressed>,
    /// Vertices of the outlines when pieces were laid.
    vertices: usize,
}

impl Pressure {
    /// The pressures of the scene, on cracks and outlines as they are now.
    ///
    /// # Errors
    /// When a load presses on no edge.
    pub(super) fn all(setup: &Setup, cracks: &Cracks, faces: &Faces) -> Result<Vec<Self>, SimulationError> {
        let mut found = Vec::new();
        for (load, of) in setup.scene.loads.iter().enumerate() {
            if let LoadKind::Pressure(pressure) | LoadKind::FacePressure(_, pressure) = of.kind {
                let factor = of.curve.value(0.0);
                let mut pressure = Self { load, pressure, factor, pieces: Vec::new(), vertices: 0 };
                pressure.lay(setup, cracks, faces)?;
                found.push(pressure);
            }
        }
        Ok(found)
    }

    fn lay(&mut self, setup: &Setup, cracks: &Cracks, faces: &Faces) -> Result<(), SimulationError> {
        // Along the edges of the particles' domains: what a particle feels then lies beside it, and turns nothing.
        let domains = (setup.particles.anchor, setup.particles.spacing);
        let pieces = pressed_pieces(&setup.scene, domains, cracks, self.load)?;
        let pressed = |piece: &PressedPiece| {
            let particle = particle_of(&setup.particles, piece)?;
            let [a, b] = [0.0, 1.0].map(|part| faces.carried(setup, piece, part));
            Some(Pressed { particle, ends: [a?, b?] })
        };
        self.pieces = pieces.iter().filter_map(pressed).collect();
        self.vertices = faces.outlines.vertices().count();
        Ok(())
    }

    /// Follows cracks that have changed, and outlines that they have opened.
    pub(super) fn follow(&mut self, setup: &Setup, cracks: &Cracks, faces: &Faces) {
        let is_of_faces = matches!(setup.scene.loads[self.load].kind, LoadKind::FacePressure(..));
        if is_of_faces || self.vertices != faces.outlines.vertices().count() {
            // That its edges exist was seen at the beginning.
            let _ = self.lay(setup, cracks, faces);
        }
    }

    /// Takes the factor of its curve at `time` [s].
    pub(super) fn begin_step(&mut self, setup: &Setup, time: f64) {
        self.factor = setup.scene.loads[self.load].curve.value(time);
    }

    /// Calls `act` with each particle that is pushed and its force [N/m].
    pub(super) fn for_each_force(&self, faces: &Faces, mut act: impl FnMut(usize, Vector)) {
        let now = self.factor * self.pressure;
        if now == 0.0 {
            return;
        }
        for pressed in &self.pieces {
            let way = faces.place(pressed.ends[1]) - faces.place(pressed.ends[0]);
            act(pressed.particle as usize, Vector::new(-way.y, way.x) * now);
        }
    }

    /// The pressure now on the faces of a crack [Pa].
    pub(super) fn on_faces(&self, crack: usize) -> f64 {
        let is_of = |pressed: &Pressed| matches!(pressed.ends[0].line, Line::Face(of, _) if of == crack);
        if self.pieces.iter().any(is_of) { self.factor * self.pressure } else { 0.0 }
    }
}

impl Faces {
    /// Where the place at a part of a piece at rest rides along; none where nothing is carried.
    fn carried(&self, setup: &Setup, piece: &PressedPiece, part: f64) -> Option<Carried> {
        // A hair inside, for at a mouth two vertices lie in one place.
        let (place, beside) = (piece.at(part), piece.beside(part, setup.scene.cell_size));
        if let Some((crack, side)) = piece.face {
            let rest = &self.cracks.get(crack as usize)?.rest;
            let face = if side == Side::Above { 0 } else { 1 };
            let line = Line::Face(crack as usize, face);
            return nearest_stretch(rest.len() - 1, |k| [rest[k], rest[k + 1]], place, beside)
                .map(|(from, part, _)| Carried { line, from, part });
        }
        let bodies = setup.scene.bodies.iter().enumerate();
        let body_of_rings = bodies.flat_map(|(body, of)| std::iter::repeat_n(body as u32, 1 + of.region.holes.len()));
        let of_ring = |(number, (ring, body)): (usize, (&[Tracer], u32))| {
            let stretch = |k: usize| [ring[k].rest, ring[(k + 1) % ring.len()].rest];
            let found = (body == piece.body).then(|| nearest_stretch(ring.len(), stretch, place, beside))??;
            Some((Carried { line: Line::Ring(number), from: found.0, part: found.1 }, found.2))
        };
        let found = self.outlines.rings().zip(body_of_rings).enumerate().filter_map(of_ring);
        found.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(carried, _)| carried)
    }

    /// Where a carried place is now [m].
    fn place(&self, carried: Carried) -> Point {
        let Carried { line, from, part } = carried;
        let [a, b] = match line {
            Line::Face(crack, face) => [from, from + 1].map(|k| self.cracks[crack].faces[face][k]),
            Line::Ring(ring) => {
                let count = self.outlines.rings().nth(ring).map_or(1, <[_]>::len);
                [from, (from + 1) % count].map(|k| self.place_of(self.outlines.vertex(ring, k)))
            }
        };
        a + (b - a) * part
    }
}

/// Which of `count` stretches comes nearest to `beside`, at which part of it `place` is, and how near it comes [m].
/// Stretches without length do not count.
fn nearest_stretch(
    count: usize,
    stretch: impl Fn(usize) -> [Point; 2],
    place: Point,
    beside: Point,
) -> Option<(usize, f64, f64)> {
    let distance = |k: usize| {
        let [a, b] = stretch(k);
        (a != b).then(|| (k, distance_to_segment(beside, a, b)))
    };
    let (k, off) = (0..count).filter_map(distance).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let [a, b] = stretch(k);
    Some((k, (nearest_on_segment(place, a, b) - a).norm() / (b - a).norm(), off))
}

/// The particle nearest to a piece, of a face on its side of it; none where there is none.
fn particle_of(particles: &Particles, piece: &PressedPiece) -> Option<u32> {
    let (middle, way) = (piece.middle(), piece.ends[1] - piece.ends[0]);
    let left = Vector::new(-way.y, way.x);
    let fits = |p: &usize| {
        let arm = particles.rest[*p] - middle;
        particles.body[*p] == piece.body && (piece.face.is_none() || left.dot(&arm) > 0.0)
    };
    let distance = |p: &usize| (particles.rest[*p] - middle).norm_squared();
    let nearer = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
    let at = ((middle - particles.anchor) / particles.spacing).map(f64::floor);
    let (low, high) = ([at.x as i32 - NEAR, at.y as i32 - NEAR], [at.x as i32 + NEAR, at.y as i32 + NEAR]);
    let nearest = particles.within(low, high).filter(fits).min_by(nearer);
    nearest.or_else(|| (0..particles.len()).filter(fits).min_by(nearer)).map(|p| p as u32)
}
