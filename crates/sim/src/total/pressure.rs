//! Pressure on edges and on crack faces: forces that follow the normals of the deformed material.
//!
//! On a piece of an edge, from its deformed end a to its end b with the material to the left, a pressure p does
//! p (−(b − a)_y, (b − a)_x): over a closed outline these forces add up to nothing, whatever the deformation. Each
//! piece lies within a cell and hands its force on at the two places of Gauss' rule.

use super::field_vectors::FieldVectors;
use super::lattice::Lattice;
use super::motion::Motion;
use super::near::Near;
use super::probe::Probe;
use crate::SimulationError;
use crate::boundary::pressure::{PressedPiece, pressed_pieces};
use crate::crack::cracks::{Cracks, TipId};
use fissure_plane::{Point, Vector};
use fissure_scene::{LoadKind, Scene};

/// Parts of a piece at which Gauss' rule of two places has them.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// A piece that is pressed on.
#[derive(Debug, Clone)]
pub(super) struct Pressed {
    pub(super) piece: PressedPiece,
    /// Its ends.
    pub(super) ends: [Probe; 2],
    /// Where its force acts, by halves.
    places: [Probe; 2],
}

/// One load of the scene that is a pressure.
#[derive(Debug)]
pub(super) struct Pressure {
    /// Number of the load.
    pub(super) load: usize,
    /// At a curve factor of 1 [Pa].
    pub(super) pressure: f64,
    /// What it presses on.
    pub(super) pieces: Vec<Pressed>,
}

impl Pressed {
    fn new(lattice: &Lattice, piece: PressedPiece) -> Self {
        let probe = |part: f64| lattice.probe(piece.body, piece.at(part), piece.beside(part, lattice.grid.cell_size));
        Self { piece, ends: [0.0, 1.0].map(probe), places: GAUSS.map(probe) }
    }

    /// The force of a pressure of 1 for the displacement `u` [m].
    pub(super) fn normal(&self, u: &FieldVectors) -> Vector {
        let way = self.ends[1].moved(u) - self.ends[0].moved(u);
        Vector::new(-way.y, way.x)
    }
}

impl Pressure {
    /// The pressures of `scene`, on cracks as they are now.
    ///
    /// # Errors
    /// When a load presses on no edge.
    pub(super) fn all(scene: &Scene, lattice: &Lattice, cracks: &Cracks) -> Result<Vec<Self>, SimulationError> {
        let mut found = Vec::new();
        for (load, of) in scene.loads.iter().enumerate() {
            if let LoadKind::Pressure(pressure) | LoadKind::FacePressure(_, pressure) = of.kind {
                let pieces = pressed_pieces(scene, cells(scene, lattice), cracks, load)?;
                let pieces = pieces.into_iter().map(|piece| Pressed::new(lattice, piece)).collect();
                found.push(Self { load, pressure, pieces });
            }
        }
        Ok(found)
    }

    /// Follows the cracks: pieces whose middle `has_changed` are laid anew, and those that are new.
    fn follow(&mut self, scene: &Scene, lattice: &Lattice, cracks: &Cracks, has_changed: impl Fn(Point) -> bool) {
        // That its edges exist was seen at the beginning.
        let Ok(now) = pressed_pieces(scene, cells(scene, lattice), cracks, self.load) else { return };
        // Both lists have the pieces that stay in the same order.
        let before = std::mem::take(&mut self.pieces).into_iter();
        let mut kept = before.filter(|pressed| !has_changed(pressed.piece.middle())).peekable();
        let next = |piece: PressedPiece| {
            let is_same = |pressed: &Pressed| pressed.piece == piece;
            kept.next_if(is_same).unwrap_or_else(|| Pressed::new(lattice, piece))
        };
        self.pieces = now.into_iter().map(next).collect();
    }

    /// After a recut.
    pub(super) fn refresh(&mut self, near: &Near, scene: &Scene, lattice: &Lattice, cracks: &Cracks) {
        self.follow(scene, lattice, cracks, |middle| near.contains(middle));
    }

    /// After a tip has moved on along its segment.
    pub(super) fn slide(&mut self, id: TipId, scene: &Scene, lattice: &Lattice, cracks: &Cracks) {
        let is_of = |pressed: &Pressed| pressed.piece.face.is_some_and(|(crack, _)| crack as usize == id.crack);
        if self.pieces.iter().any(is_of) {
            let (tip, reach) = (cracks.position(id), lattice.grid.cell_size);
            self.follow(scene, lattice, cracks, |middle| (middle - tip).norm() < reach);
        }
    }

    /// Adds the forces at `factor` and the displacement `u` to the forces.
    pub(super) fn add_forces(&self, factor: f64, u: &FieldVectors, force: &mut FieldVectors) {
        for pressed in &self.pieces {
            let f = pressed.normal(u) * (0.5 * factor * self.pressure);
            for &(field, w) in pressed.places.iter().flat_map(|place| &place.entries) {
                force[0][field as usize] += f.x * w;
                force[1][field as usize] += f.y * w;
            }
        }
    }

    /// Work that the forces at `factor` do at the present velocities, per time [W/m].
    pub(super) fn power(&self, factor: f64, motion: &Motion) -> f64 {
        let of = |pressed: &Pressed| {
            let v = pressed.places.iter().map(|place| place.value(&motion.velocity)).sum::<Vector>();
            pressed.normal(&motion.displacement).dot(&v)
        };
        0.5 * factor * self.pressure * self.pieces.iter().map(of).sum::<f64>()
    }
}

/// The lattice that pieces are cut at.
fn cells(scene: &Scene, lattice: &Lattice) -> (Point, f64) {
    (lattice.particles.anchor, scene.cell_size)
}
