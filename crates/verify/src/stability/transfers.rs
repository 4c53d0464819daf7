//! What particles do that the grid does not see, and what they do when they are pulled apart: the updated formulation.

use super::{Parameter, StabilityMap};
use crate::problem::{Problem, material, rectangle};
use fissure_scene::{
    BoxSide, Formulation, Frame, InitialVelocity, Kernel, OnDistortion, PlaneState, Point, Selection, Transfer, Vector,
    updated_kernel,
};
use fissure_sim::{Elastic, Simulation, SimulationError};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

pub(super) const RINGING: StabilityMap = StabilityMap {
    name: "ringing",
    title: "What particles of a ringing bar move by that their cell as a whole does not, by its velocity",
    across: Parameter::choices("", &["PIC", "APIC", "AFLIP", "FLIP", "XPIC"]),
    up: Parameter::choices("", &["bilinear", "GIMP", "quadratic", "cubic"]),
    limits: [0.03, 0.06, 0.1, 0.2, 0.4, 0.8],
    run: |transfer, kernel| {
        let transfers = [Transfer::Pic, Transfer::Apic, Transfer::Aflip, Transfer::Flip(1.0), Transfer::Xpic];
        let kernels = [Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic];
        noise(transfers[transfer as usize], kernels[kernel as usize])
    },
};

pub(super) const STRETCHED: StabilityMap = StabilityMap {
    name: "stretched",
    title: "By how much stretches in a bar that is drawn out are off: it should be stretched alike everywhere",
    across: Parameter::numbers("drawn out to times its length", &[1.1, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0]),
    up: Parameter::choices("", &["updated GIMP", "updated quadratic", "updated cubic", "total, switches"]),
    limits: [0.02, 0.05, 0.1, 0.2, 0.4, 0.8],
    run: |stretch, way| {
        let kernel = [Kernel::Gimp, updated_kernel(), Kernel::Cubic, Kernel::Bilinear][way as usize];
        off_by(stretch, (way as u8 == 3).then_some(OnDistortion::Switch), kernel)
    },
};

/// A bar of 24 by 4 cells that rings in its first mode for some periods, at strains of 1e-3 while it flies on a cell.
fn noise(transfer: Transfer, kernel: Kernel) -> Result<f64, SimulationError> {
    let (length, height) = (24.0, 4.0);
    let elastic = material(1e6, 0.0, 1000.0, 1e30);
    let wave = Elastic::new(&elastic, PlaneState::Strain).dilatational_wave_speed();
    let bar = rectangle((0.0, 0.0), (length, height));
    let period = 2.0 * length / wave;
    let mut scene = Problem::new("bar", bar, elastic, PlaneState::Strain, 1.0).until(5.0 * period, 10).scene;
    for (low, high, sign) in [(-1.0, 0.5 * length, -1.0), (0.5 * length, length + 1.0, 1.0)] {
        scene.bodies[0].velocities.push(InitialVelocity {
            selection: Selection::Region(rectangle((low, -1.0), (high, height + 1.0))),
            velocity: Vector::new(sign * 1e-3 * wave, 0.0),
            angular_velocity: 0.0,
            center: Point::origin(),
        });
    }
    // A cell in all: particles cross from one to the next.
    scene.bodies[0].velocities.push(InitialVelocity {
        selection: Selection::All,
        velocity: Vector::new(1.0, 0.7) / (5.0 * period),
        angular_velocity: 0.0,
        center: Point::origin(),
    });
    let solver = &mut scene.solver;
    (solver.formulation, solver.transfer, solver.kernel) = (Formulation::Updated, transfer, kernel);
    let frame = last_frame(scene)?;
    let mean = frame.particles.velocity.iter().sum::<Vector>() / frame.particles.velocity.len() as f64;
    let mut cells: BTreeMap<[i64; 2], Vec<Vector>> = BTreeMap::new();
    for (place, velocity) in frame.particles.position.iter().zip(&frame.particles.velocity) {
        cells.entry([place.x.floor() as i64, place.y.floor() as i64]).or_default().push(velocity - mean);
    }
    let (mut beside, mut all) = (0.0, 0.0);
    for velocities in cells.values() {
        let of_cell = velocities.iter().sum::<Vector>() / velocities.len() as f64;
        beside += velocities.iter().map(|v| (v - of_cell).norm_squared()).sum::<f64>();
        all += velocities.iter().map(Vector::norm_squared).sum::<f64>();
    }
    // By what the wave has as it is at its fastest: at the end it may be anywhere between.
    Ok((beside / all.max(frame.particles.velocity.len() as f64 * 0.25e-6 * wave * wave)).sqrt())
}

/// Root mean square of what stretches in the inner half of a bar of 12 by 4 cells are off when it is drawn out slowly
/// to `stretch` times its length, by that. Where it comes apart, the middle goes back to its length.
fn off_by(stretch: f64, on_distortion: Option<OnDistortion>, kernel: Kernel) -> Result<f64, SimulationError> {
    let length = 12.0;
    let elastic = material(1e6, 0.3, 1000.0, 1e30);
    let wave = Elastic::new(&elastic, PlaneState::Stress).dilatational_wave_speed();
    let speed = 0.02 * wave;
    let edge = |side| Selection::Edge { side, bodies: None };
    let mut scene = Problem::new("bar", rectangle((0.0, 0.0), (length, 4.0)), elastic, PlaneState::Stress, 1.0)
        .support(edge(BoxSide::Left), [Some(0.0), None])
        .support(edge(BoxSide::Right), [Some(speed), None])
        .until((stretch - 1.0) * length / speed, 10)
        .scene;
    scene.solver.damping = wave / length;
    scene.solver.kernel = kernel;
    scene.solver.formulation = Formulation::Updated;
    if let Some(on_distortion) = on_distortion {
        (scene.solver.formulation, scene.solver.on_distortion) = (Formulation::Total, on_distortion);
    }
    let frame = last_frame(scene)?;
    let inner = frame.particles.rest.iter().zip(&frame.particles.deformation_gradient);
    let stretches: Vec<f64> = inner.filter(|(p, _)| p.x > 3.0 && p.x < 9.0).map(|(_, f)| f[(0, 0)]).collect();
    let count = stretches.len() as f64;
    let square = stretches.iter().map(|s| (s - stretch) * (s - stretch)).sum::<f64>() / count;
    Ok(square.sqrt() / stretch)
}

fn last_frame(scene: fissure_scene::Scene) -> Result<Frame, SimulationError> {
    let mut simulation = Simulation::new(&scene)?;
    while !simulation.is_finished() {
        simulation.advance(&mut |_| ControlFlow::Continue(()))?;
    }
    Ok(simulation.frame())
}
