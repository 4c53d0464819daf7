//! Loads as forces on particles.

use super::beside::Beside;
use super::edge_layer::{EdgeLayer, LayerForce};
use super::faces::Faces;
use super::gather::FromGrid;
use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::pressure::Pressure;
use super::setup::Setup;
use crate::SimulationError;
use crate::boundary::edges::Chain;
use crate::boundary::loads::{ForcePlace, forces_of_load};
use crate::boundary::selector::Selector;
use crate::crack::cracks::Cracks;
use fissure_scene::{Load, LoadKind, Vector};

/// The forces of one load that is no pressure, at a curve factor of 1.
#[derive(Debug, Default)]
struct Forces {
    /// Forces beside particles [N/m].
    beside: Vec<(Beside, Vector)>,
    /// Tractions on edges [Pa].
    layers: Vec<(LayerForce, Vector)>,
}

/// The forces of all loads.
#[derive(Debug)]
pub(super) struct Loads {
    /// Per load; none of pressures.
    forces: Vec<Forces>,
    pressures: Vec<Pressure>,
}

impl Loads {
    /// The forces of the loads of a scene; tractions act on the layers below edges or, where a piece of an edge has no
    /// material below it, beside the nearest of the selected particles.
    ///
    /// # Errors
    /// When a load selects nothing.
    pub(super) fn new(setup: &Setup, cracks: &Cracks, faces: &Faces) -> Result<Self, SimulationError> {
        let Setup { scene, particles, .. } = setup;
        let of_load = |(index, load): (usize, &Load)| {
            let mut forces = Forces::default();
            match load.kind {
                LoadKind::Pressure(_) | LoadKind::FacePressure(..) => return Ok(forces),
                LoadKind::Traction(traction) => {
                    let chains = Chain::of(scene, &Selector::new(scene, &load.selection).pieces(scene));
                    let layers: Vec<EdgeLayer> = chains.iter().map(|chain| EdgeLayer::new(setup, chain)).collect();
                    if layers.iter().all(EdgeLayer::is_whole) {
                        forces.layers = layers.iter().flat_map(EdgeLayer::forces).map(|at| (at, traction)).collect();
                    }
                }
                LoadKind::Force(_) | LoadKind::PerPoint(_) => (),
            }
            if forces.layers.is_empty() {
                let layer = particles.select(scene, &load.selection);
                let beside = |place| match place {
                    ForcePlace::Particle(p) => Some(Beside::at(p)),
                    ForcePlace::Outline { place, .. } => Beside::nearest(setup, &layer, place),
                };
                let of = forces_of_load(scene, particles, index)?.into_iter();
                forces.beside = of.filter_map(|at| Some((beside(at.place)?, at.force))).collect();
            }
            if forces.layers.is_empty() && forces.beside.is_empty() {
                return Err(particles.no_particle("load", index, &load.selection).into());
            }
            Ok(forces)
        };
        let forces = scene.loads.iter().enumerate().map(of_load).collect::<Result<_, SimulationError>>()?;
        Ok(Self { forces, pressures: Pressure::all(setup, cracks, faces)? })
    }

    /// Follows cracks that have changed.
    pub(super) fn follow(&mut self, setup: &Setup, cracks: &Cracks, faces: &Faces) {
        self.pressures.iter_mut().for_each(|pressure| pressure.follow(setup, cracks, faces));
    }

    /// The pressure of the last step on the faces of a crack [Pa].
    pub(super) fn pressure_on_faces(&self, crack: usize) -> f64 {
        self.pressures.iter().map(|pressure| pressure.on_faces(crack)).sum()
    }

    /// Adds the forces at the time `middle` [s] to those on nodes.
    pub(super) fn add_forces(
        &mut self,
        points: &Points,
        faces: &Faces,
        lattice: &Lattice,
        setup: &Setup,
        middle: f64,
        nodes: &mut Nodes,
    ) {
        for pressure in &mut self.pressures {
            pressure.begin_step(setup, middle);
            pressure.for_each_force(faces, |p, f| {
                lattice.for_each_entry(p, points.point[p].position, |field, w| {
                    nodes.after[0][field] += w * f.x;
                    nodes.after[1][field] += w * f.y;
                });
            });
        }
        let force = &mut nodes.after;
        for (load, forces) in setup.scene.loads.iter().zip(&self.forces) {
            let factor = load.curve.value(middle);
            if factor == 0.0 {
                continue;
            }
            for &(beside, f) in &forces.beside {
                let f = f * factor;
                beside.for_each_entry(points, lattice, |field, w| {
                    force[0][field] += w * f.x;
                    force[1][field] += w * f.y;
                });
            }
            for &(layer, traction) in &forces.layers {
                let traction = traction * factor;
                layer.for_each_entry(points, lattice, |field, part| {
                    force[0][field] += part * traction.x;
                    force[1][field] += part * traction.y;
                });
            }
        }
    }

    /// Power of the forces at the time `middle` [s]: material moves by Σ v_i w_ip Δt, so that Σ f·v Δt is their exact
    /// work [W/m].
    pub(super) fn power(&self, points: &Points, faces: &Faces, from: &FromGrid<'_>, middle: f64) -> f64 {
        let (mut power, h) = (0.0, from.setup.scene.cell_size);
        for (load, forces) in from.setup.scene.loads.iter().zip(&self.forces) {
            let factor = load.curve.value(middle);
            let gather = |p: usize| from.gather_one(p, &points.point[p]);
            for (beside, f) in &forces.beside {
                let gathered = gather(beside.particle());
                power += factor * f.dot(&(gathered.velocity + gathered.gradient * beside.way(points, h)));
            }
            for (layer, traction) in &forces.layers {
                let gathered = gather(layer.particle());
                power += factor * traction.dot(&layer.velocity(points, gathered.velocity, gathered.gradient));
            }
        }
        for pressure in &self.pressures {
            pressure.for_each_force(faces, |p, f| power += f.dot(&from.gather_one(p, &points.point[p]).velocity));
        }
        power
    }
}
