//! A running crack that meets tougher material: whether it goes on straight ahead or along the interface.
//!
//! Under pure mode I the hoop stress in the direction of an interface that is turned by φ is cos³(φ/2) of that ahead
//! (Erdogan & Sih 1963). Along it, in the weaker material, a crack needs K_1, through it K_2: it goes through while
//! K_2/K_1 < 1/cos³(φ/2).

use super::{Parameter, StabilityMap};
use crate::problem::{Problem, material, rectangle};
use fissure_scene::{BoxSide, PlaneState, Point, Region, ToughnessKind, ToughnessPatch, Vector};
use fissure_sim::{Simulation, SimulationError};
use std::ops::ControlFlow;

pub(super) const TOUGHNESS_JUMPS: StabilityMap = StabilityMap {
    name: "toughness-jump",
    title: "Direction of a crack behind an interface, against through or along it, by the angle between both",
    across: Parameter::numbers("K_2/K_1", &[1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.6, 2.0, 3.0]),
    up: Parameter::numbers("angle between crack and interface [°]", &[20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0]),
    limits: [0.05, 0.1, 0.2, 0.4, 0.6, 0.8],
    run: |jump, degrees| {
        let phi = degrees.to_radians();
        let turns = jump * (0.5 * phi).cos().powi(3) > 1.0;
        Ok((turned_by(jump, phi)? - f64::from(u8::from(turns))).abs())
    },
};

/// The plate [cells of 1 m], its crack, where that meets the interface, and how far beyond that its direction is taken.
const PLATE: (f64, f64) = (16.0, 24.0);
const CRACK: f64 = 6.2;
const MEETING: Point = Point::new(8.7, 0.5 * PLATE.1);
const BEYOND: (f64, f64) = (1.0, 3.0);
/// K_1 [Pa·√m]: less than half of what the load gives.
const TOUGHNESS: f64 = 4e3;

/// By what part of the angle `phi` [rad] of the interface a crack has turned behind it [–]: 0 through, 1 along.
fn turned_by(jump: f64, phi: f64) -> Result<f64, SimulationError> {
    let (width, height) = PLATE;
    let plate = rectangle((0.0, 0.0), PLATE);
    let mut problem = Problem::new("plate", plate, material(1e9, 0.3, 1000.0, TOUGHNESS), PlaneState::Strain, 1.0)
        .crack(&[(0.0, MEETING.y), (CRACK, MEETING.y)], [false, true])
        .traction(BoxSide::Top, 0.0, 1e3)
        .traction(BoxSide::Bottom, 0.0, -1e3)
        .growing()
        .until(0.15, 150);
    let along = Vector::new(phi.cos(), phi.sin()) * (width + height);
    let ahead = Vector::new(along.y, -along.x);
    let exterior = vec![MEETING - along, MEETING - along + ahead, MEETING + along + ahead, MEETING + along];
    problem.scene.toughness.push(ToughnessPatch {
        body: None,
        kind: ToughnessKind::Region { region: Region { exterior, holes: Vec::new() }, factor: jump },
    });
    let mut simulation = Simulation::new(&problem.scene)?;
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
        let frame = simulation.frame();
        let path = &frame.cracks[0].rest;
        // From where it is about as far as the interface; it may run along that without touching it.
        let met = path.iter().position(|&at| (at - MEETING).norm() < BEYOND.0).unwrap_or(path.len());
        let farther = |way: f64| path[met..].iter().find(|&&at| (at - MEETING).norm() > way).copied();
        if let (Some(from), Some(to)) = (farther(BEYOND.0), farther(BEYOND.1)) {
            let way = to - from;
            let turned = way.y.atan2(way.x) / phi;
            // Across an interface at a right angle both ways along it are alike.
            return Ok(if phi < 1.5 { turned } else { turned.abs() });
        }
    }
    Ok(f64::NAN)
}
