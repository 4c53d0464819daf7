//! probe
use fissure_scene::*;
use fissure_sim::Simulation;

pub fn scene(w: f64, h_total: f64, a: f64, cell: f64, dx: f64, dy: f64) -> Scene {
    let p = Point::new;
    let ym = 0.5 * h_total + dy * cell;
    Scene {
        name: "sent".into(), hash: String::new(), plane: PlaneState::Strain,
        materials: vec![Material { name: "m".into(), young_modulus: 1e9, poisson_ratio: 0.3, density: 1000.0, fracture_toughness: 1e30, plasticity: None }],
        bodies: vec![Body { name: "b".into(), region: Region { exterior: vec![p(0.0, 0.0), p(w, 0.0), p(w, h_total), p(0.0, h_total)], holes: vec![] }, material: 0, velocities: vec![] }],
        cracks: vec![Crack { name: "c".into(), body: 0, points: vec![p(0.0, ym), p(a + dx * cell, ym)], start_live: false, end_live: true, start_guide: None, end_guide: None }],
        colliders: vec![], gravity: Vector::zeros(),
        loads: vec![
            Load { selection: Selection::Edge { side: BoxSide::Top, body: None }, kind: LoadKind::Traction(Vector::new(0.0, 1e3)), curve: Curve::default() },
            Load { selection: Selection::Edge { side: BoxSide::Bottom, body: None }, kind: LoadKind::Traction(Vector::new(0.0, -1e3)), curve: Curve::default() },
        ],
        supports: vec![], particle_spacing: cell / 2.0, cell_size: cell,
        solver: SolverSettings { formulation: Formulation::Total, on_distortion: OnDistortion::Stop, kernel: Kernel::Bilinear, transfer: Transfer::Apic, time_step: None, courant: 0.9, damping: 0.0, crack_contact: false, crack_friction: 0.0, tip_division: if std::env::var("LINE").is_ok() { TipDivision::LineCrossing } else { TipDivision::PartlyCut }, j_method: JMethod::Domain, j_radius: std::env::var("R").map_or(4.0, |s| s.parse().unwrap()), area_term: false, mode_split: ModeSplit::Interaction },
        growth: GrowthSettings { enabled: false, increment: 0.25, bending: 1.0, speed_limit: 0.95 },
        frames: FrameSettings { first: 1, last: 2, rate: 1.0 },
        output: OutputSettings { thickness: 1.0, formats: vec![], parts: vec![], up: UpAxis::Y, smallest_fragment: 0.0 },
    }
}

fn main() {
    let n: f64 = std::env::args().nth(1).map_or(8.0, |s| s.parse().unwrap());
    let offs: Vec<(f64, f64)> = (0..16).map(|k| ((k % 4) as f64 / 4.0 - 0.375 , (k / 4) as f64 / 4.0 + 0.01)).collect();
    let (aw, hw, f) = (0.4, 2.0, 2.1127);
    let cell = 1.0 / n;
    let w = (n / aw).round() * cell;
    let mut errs = vec![];
    for (dx, dy) in offs {
        let t = std::time::Instant::now();
        let sc = scene(w, hw * w, 1.0, cell, dx, dy);
        let mut s = Simulation::new(&sc).unwrap();
        let steps = s.relax(1e-5, 20000).unwrap();
        let fr = s.frame();
        let tip = fr.tips[0];
        let a = 1.0 + dx * cell;
        // Tada secant ratio corrects for the changed a/W
        let tada = |x: f64| { let q = std::f64::consts::FRAC_PI_2 * x; (q.tan() / q).sqrt() * (0.752 + 2.02 * x + 0.37 * (1.0 - q.sin()).powi(3)) / q.cos() };
        let k = f * tada(a / w) / tada(0.4) * 1e3 * (std::f64::consts::PI * a).sqrt();
        let e = 1e9 / (1.0 - 0.09);
        let kj = (tip.j_integral * e).sqrt();
        println!("{dx:6.3} {dy:6.3} K_I {:+.3}% sqrt(E'J) {:+.3}% K_II/K_I {:+.3}% steps {steps} particles {} {:.2}s", 100.0 * (tip.mode_1 / k - 1.0), 100.0 * (kj / k - 1.0), 100.0 * tip.mode_2 / tip.mode_1, fr.particles.len(), t.elapsed().as_secs_f64());
        errs.push(100.0 * (tip.mode_1 / k - 1.0));
    }
    let mean = errs.iter().sum::<f64>() / 16.0;
    println!("mean {mean:.3} min {:.3} max {:.3}", errs.iter().cloned().fold(f64::MAX, f64::min), errs.iter().cloned().fold(f64::MIN, f64::max));
}
