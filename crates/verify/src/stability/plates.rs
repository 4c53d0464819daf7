//! K_I of an edge crack at rest under tension, where a plate is not as the method likes it.
//!
//! Reference: Tada's formula for a long plate, within 0.5 % for any length of the crack.

use super::{ERRORS, Parameter, StabilityMap};
use crate::cases::edge_crack::tada;
use crate::placed::Placed;
use crate::placement::Placement;
use crate::problem::{Problem, material, rectangle};
use fissure_scene::{BoxSide, Formulation, PlaneState, updated_kernel};
use fissure_sim::SimulationError;
use std::f64::consts::PI;

/// Kinetic energy at rest, as a part of the strain energy, and steps to rest at most.
const REST: f64 = 1e-8;
const MOST_STEPS: u64 = 20_000;

/// A plate with an edge crack. Lengths in cells.
#[derive(Debug, Clone, Copy)]
struct Plate {
    crack: f64,
    width: f64,
    height: f64,
    /// How far the crack lies above a row of nodes.
    above: f64,
    /// Particles along a cell.
    along: f64,
    /// h [m].
    cell_size: f64,
    poisson_ratio: f64,
    plane: PlaneState,
    formulation: Formulation,
}

impl Default for Plate {
    fn default() -> Self {
        Self {
            crack: 8.0,
            width: 20.0,
            height: 40.0,
            above: 0.0,
            along: 2.0,
            cell_size: 1.0,
            poisson_ratio: 0.3,
            plane: PlaneState::Strain,
            formulation: Formulation::Total,
        }
    }
}

impl Plate {
    /// Error of K_I [–], without its sign.
    fn error(&self, placement: Placement) -> Result<f64, SimulationError> {
        let h = self.cell_size;
        let (stress, young) = (1e3, 1e9);
        let at = (0.5 * self.height + self.above) * h;
        let region = rectangle((0.0, 0.0), (self.width * h, self.height * h));
        let elastic = material(young, self.poisson_ratio, 1000.0, 1e30);
        let mut problem = Problem::new("plate", region, elastic, self.plane, h)
            .at_rest()
            .crack(&[(0.0, at), (self.crack * h, at)], [false, true])
            .traction(BoxSide::Top, 0.0, stress)
            .traction(BoxSide::Bottom, 0.0, -stress);
        problem.scene.particle_spacing = h / self.along;
        problem.scene.solver.formulation = self.formulation;
        if self.formulation == Formulation::Updated {
            problem.scene.solver.kernel = updated_kernel();
        }
        let mut placed = Placed::new(&problem.scene, placement)?;
        placed.relax(REST, MOST_STEPS)?;
        let reference = tada(self.crack / self.width) * stress * (PI * self.crack * h).sqrt();
        Ok((placed.now().tips()[0].mode_1 / reference - 1.0).abs())
    }
}

pub(super) const CRACK_LENGTH: StabilityMap = StabilityMap {
    name: "crack-length",
    title: "Error of K_I of short cracks in a plate of 40 cells",
    across: Parameter::numbers("length of the crack [cells]", &[0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0]),
    up: Parameter::numbers("above a row of nodes [cells]", &[0.0, 0.13, 0.25, 0.4, 0.5]),
    limits: ERRORS,
    run: |crack, above| Plate { crack, above, width: 40.0, height: 80.0, ..Plate::default() }.error(Placement::NATURAL),
};

pub(super) const LIGAMENT: StabilityMap = StabilityMap {
    name: "ligament",
    title: "Error of K_I of a crack that ends near the far edge",
    across: Parameter::numbers("ligament [cells]", &[1.0, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 14.0]),
    up: Parameter::numbers("above a row of nodes [cells]", &[0.0, 0.13, 0.25, 0.4, 0.5]),
    limits: ERRORS,
    run: |ligament, above| {
        let (crack, width) = (8.0, 8.0 + ligament);
        Plate { crack, above, width, height: 2.0 * width, ..Plate::default() }.error(Placement::NATURAL)
    },
};

pub(super) const TURN: StabilityMap = StabilityMap {
    name: "turn",
    title: "Error of K_I of a plate turned on the grid",
    across: Parameter::numbers("turned by [°]", &[0.0, 5.0, 15.0, 22.5, 30.0, 37.0, 45.0, 60.0, 75.0, 90.0]),
    up: Parameter::numbers("length of the crack [cells]", &[3.0, 4.0, 6.0, 8.0, 12.0]),
    limits: ERRORS,
    run: |degrees, crack| {
        let width = 2.5 * crack;
        let plate = Plate { crack, width, height: 2.0 * width, above: 0.2, ..Plate::default() };
        plate.error(Placement::by_angle(degrees.to_radians()))
    },
};

pub(super) const POISSON_RATIO: StabilityMap = StabilityMap {
    name: "poisson-ratio",
    title: "Error of K_I over Poisson's ratio: it should not matter",
    across: Parameter::numbers("ν", &[-0.9, -0.5, 0.0, 0.3, 0.4, 0.45, 0.49, 0.499, 0.4999]),
    up: Parameter::choices("", &["plane stress", "plane strain"]),
    limits: ERRORS,
    run: |poisson_ratio, plane| {
        let plane = if plane < 0.5 { PlaneState::Stress } else { PlaneState::Strain };
        Plate { poisson_ratio, plane, ..Plate::default() }.error(Placement::NATURAL)
    },
};

pub(super) const PARTICLES_PER_CELL: StabilityMap = StabilityMap {
    name: "particles",
    title: "Error of K_I over the particles of a cell",
    across: Parameter::numbers("particles along a cell", &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0]),
    up: Parameter::choices("", &["updated, 4 cells", "total, 4 cells", "total, 8 cells"]),
    limits: ERRORS,
    run: |along, row| {
        let (crack, formulation) = match row as u8 {
            0 => (4.0, Formulation::Updated),
            1 => (4.0, Formulation::Total),
            _ => (8.0, Formulation::Total),
        };
        let width = 2.5 * crack;
        let plate = Plate { crack, width, height: 2.0 * width, along, formulation, ..Plate::default() };
        plate.error(Placement::NATURAL)
    },
};

pub(super) const LENGTHS: StabilityMap = StabilityMap {
    name: "lengths",
    title: "Error of K_I over the size of everything: it should not matter",
    across: Parameter::numbers("length of the crack [m]", &[1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6]),
    up: Parameter::numbers("length of the crack [cells]", &[4.0, 8.0]),
    limits: ERRORS,
    run: |length, crack| {
        let width = 2.5 * crack;
        let plate = Plate { crack, width, height: 2.0 * width, cell_size: length / crack, ..Plate::default() };
        plate.error(Placement::NATURAL)
    },
};
