//! What a feature costs in a scene that has no need of it: a plate with it beside the same plate without.
//!
//! The plate is pulled at both ends and rings; its crack is tougher than all that happens. Time is that of a computing
//! processor; plates take turns, so that a busy machine slows all of them alike.

use crate::cpu_time::cpu_time;
use crate::problem::{LINEAR_YOUNG, Problem, material, rectangle};
use fissure_scene::{
    BoxSide, Collider, ColliderShape, Contact, Formulation, Inclusion, PlaneState, Plasticity, Point, Pose, Scene,
    Selection, Support, ToughnessKind, ToughnessPatch, Vector, updated_kernel,
};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;
use std::time::Duration;

/// A feature that may be switched on.
#[derive(Debug, Clone, Copy)]
pub struct Feature {
    /// Short name, as in tables.
    pub name: &'static str,
    /// Whether the plate is solved in the updated formulation.
    pub is_updated: bool,
    /// What of the cost there is that is not for nothing; empty: nothing should be.
    pub because: &'static str,
    switch: Switch,
}

/// How a feature is switched on.
#[derive(Debug, Clone, Copy)]
enum Switch {
    /// In the scene.
    Scene(fn(&mut Scene)),
    /// J and K over five radii at every look.
    Contours,
    /// The energies of one moment at so many steps of all.
    Energies(u64),
}

const fn total(name: &'static str, because: &'static str, change: fn(&mut Scene)) -> Feature {
    Feature { name, is_updated: false, because, switch: Switch::Scene(change) }
}

const fn updated(name: &'static str, because: &'static str, change: fn(&mut Scene)) -> Feature {
    Feature { name, is_updated: true, because, switch: Switch::Scene(change) }
}

/// All features; those without a change are the plates that the others of their formulation are held against.
pub const FEATURES: [Feature; 22] = [
    total("nothing", "", |_| ()),
    total("no crack at all", "what a crack costs, the other way round", |scene| scene.cracks.clear()),
    total("tips that are not looked at", "what looks cost, the other way round", |scene| {
        scene.cracks[0].end_live = false;
    }),
    total(
        "growth off",
        "a tip that may not grow is looked at in every step, not in every fourth; steps are longer",
        |scene| {
            scene.growth.enabled = false;
        },
    ),
    total("faces that pass through each other", "what contact of faces costs, the other way round", |scene| {
        scene.solver.crack_contact = false;
    }),
    total("friction of faces", "", |scene| scene.solver.crack_friction = 0.4),
    total("friction of bodies", "", |scene| scene.contact.friction = 0.4),
    total("a collider far away", "its distance from every node at the surface, in every step", |scene| {
        scene.colliders.push(far_collider());
    }),
    total("a body far away", "its particles: a quarter more of them", |scene| {
        let mut body = scene.bodies[0].clone();
        body.name = "other".into();
        body.region = rectangle((5.0, 0.0), (5.5, 0.5));
        scene.bodies.push(body);
    }),
    total("a part of the same material", "", |scene| {
        scene.bodies[0].inclusions.push(Inclusion { region: rectangle((0.6, 0.6), (0.9, 0.9)), material: 0 });
    }),
    total("tougher places", "", |scene| {
        let kind = ToughnessKind::Region { region: rectangle((0.6, 0.6), (0.9, 0.9)), factor: 2.0 };
        scene.toughness.push(ToughnessPatch { body: None, kind });
    }),
    total("damping", "", |scene| scene.solver.damping = 1.0),
    total("gravity", "its work, a sum over all nodes in every step", |scene| scene.gravity = Vector::new(0.0, -1e-6)),
    total("a support", "what holds its nodes, and its work, in every step", |scene| {
        let selection = Selection::Edge { side: BoxSide::Left, bodies: None };
        scene.supports.push(Support { selection, velocity: [None, Some(0.0)], curve: Default::default() });
    }),
    total(
        "ten times as many frames",
        "the energies of ten times as many frames, and the steps that end with them",
        |scene| {
            scene.frames.last *= 10;
            scene.frames.rate *= 10.0;
        },
    ),
    Feature {
        name: "table of contours",
        is_updated: false,
        because: "J and K over five more radii at every look",
        switch: Switch::Contours,
    },
    Feature {
        name: "table of energies",
        is_updated: false,
        because: "all forces and strains once more at every tenth step",
        switch: Switch::Energies(10),
    },
    updated("nothing", "", |_| ()),
    updated("no crack at all", "what a crack costs, the other way round", |scene| scene.cracks.clear()),
    updated("plasticity that never yields", "singular values of every particle in every step", |scene| {
        scene.materials[0].plasticity =
            Some(Plasticity { critical_compression: 0.3, critical_stretch: 0.3, hardening: 0.0 });
    }),
    updated("friction of faces", "", |scene| scene.solver.crack_friction = 0.4),
    updated("a collider far away", "its distance from nodes and particles, in every step", |scene| {
        scene.colliders.push(far_collider());
    }),
];

/// Cells along a side of the plate in the total formulation, and in the updated one.
const CELLS: [f64; 2] = [64.0, 32.0];
/// Waves cross the plate so many times.
const CROSSINGS: f64 = 4.0;
const FRAMES: u32 = 4;

fn far_collider() -> Collider {
    Collider {
        name: "ground".into(),
        shape: ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) },
        keyframes: vec![(0.0, Pose { position: Point::new(0.0, -9.0), angle: 0.0 })],
        contact: Contact::Separate,
        friction: 0.0,
    }
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureCost {
    /// Time of all threads.
    pub cpu: Duration,
    /// Steps.
    pub steps: u64,
}

impl Feature {
    /// The plate with the feature.
    fn scene(&self) -> Scene {
        let h = 1.0 / CELLS[usize::from(self.is_updated)];
        let density = 1000.0;
        let elastic = material(LINEAR_YOUNG, 0.3, density, 1e30);
        let end = CROSSINGS / (LINEAR_YOUNG / density).sqrt();
        let mut scene = Problem::new("plate", rectangle((0.0, 0.0), (1.0, 1.0)), elastic, PlaneState::Strain, h)
            .crack(&[(0.0, 0.503), (0.3, 0.503)], [false, true])
            .traction(BoxSide::Top, 0.0, 1e3)
            .traction(BoxSide::Bottom, 0.0, -1e3)
            .growing()
            .until(end, FRAMES)
            .scene;
        scene.solver.formulation = Formulation::Total;
        if self.is_updated {
            (scene.solver.formulation, scene.solver.kernel) = (Formulation::Updated, updated_kernel());
        }
        if let Switch::Scene(change) = self.switch {
            change(&mut scene);
        }
        scene
    }

    /// Runs the plate once.
    ///
    /// # Errors
    /// When the solver fails.
    pub fn cost(&self) -> Result<FeatureCost, SimulationError> {
        let scene = self.scene();
        let start = cpu_time();
        let mut simulation = Simulation::new(&scene)?;
        if matches!(self.switch, Switch::Contours) {
            simulation.watch_contours();
        }
        let every = if let Switch::Energies(every) = self.switch { every } else { u64::MAX };
        while !simulation.is_finished() {
            simulation.advance_observed(&mut |simulation, now| {
                if now.steps.is_multiple_of(every) {
                    std::hint::black_box(simulation.energies_of_one_moment());
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(FeatureCost { cpu: cpu_time() - start, steps: simulation.steps() })
    }
}
