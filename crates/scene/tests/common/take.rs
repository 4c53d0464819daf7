//! Takes to test with.

use fissure_scene::*;
use std::path::Path;

pub fn scene() -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pull.toml");
    std::fs::write(&path, template()).unwrap();
    load(&path, &["solver.crack_friction=inf".into()]).unwrap()
}

pub fn provenance() -> Provenance {
    Provenance { tool_version: "0.1.0".into(), seed: 7 }
}

/// A frame in which every number differs, some of them hard to write as text.
pub fn frame(number: i64) -> Frame {
    let mut count = 0.0;
    let mut next = || {
        count += 1.0;
        (number as f64 + 0.1) / 3.0 * count
    };
    let n = 5;
    let point = |f: &mut dyn FnMut() -> f64| Point::new(f(), f());
    let mut points = |m: usize| (0..m).map(|_| point(&mut next)).collect::<Vec<_>>();
    let vectors = |p: Vec<Point>| p.into_iter().map(|p| p.coords).collect::<Vec<_>>();
    let matrices = |p: Vec<Point>| p.into_iter().map(|p| Matrix::new(p.x, p.y, -p.x, 2.0 * p.y)).collect::<Vec<_>>();
    Frame {
        number,
        time: number as f64 / 3.0,
        particles: ParticleFrame {
            id: (0..n as u32).collect(),
            body: vec![0; n],
            piece: vec![u32::MAX; n],
            // The same in every frame.
            rest: (0..n).map(|i| Point::new(0.1 * i as f64, -0.0)).collect(),
            mass: Some((0..n).map(|i| 1.0 + 0.1 * i as f64).collect()),
            position: points(n),
            velocity: vectors(points(n)),
            deformation_gradient: matrices(points(n)),
            cauchy_stress: matrices(points(n)),
        },
        outlines: [3, 0, 4]
            .into_iter()
            .enumerate()
            .map(|(ring, m)| OutlineFrame {
                body: 0,
                ring: ring as u32,
                rest: points(m),
                position: points(m),
                velocity: vectors(points(m)),
            })
            .collect(),
        cracks: vec![CrackFrame {
            crack: 0,
            body: 0,
            rest: points(3),
            above: points(3),
            below: points(3),
            above_velocity: vectors(points(3)),
            below_velocity: vectors(points(3)),
            formed: Some((0..3).map(|k| Formed { time: 1e-3 * f64::from(k), mode_1: 0.1 * f64::from(k) }).collect()),
            start: CrackEnd::Mouth,
            end: CrackEnd::Junction { crack: 4 },
        }],
        tips: vec![TipRecord {
            crack: 0,
            end: End::End,
            state: TipState::GuideEnded,
            position: Point::new(-0.0, f64::MIN_POSITIVE),
            direction: 0.1,
            j_integral: 0.2,
            mode_1: 1e6,
            mode_2: -1e-300,
            kink_angle: 0.3,
            equivalent: 0.4,
            fracture_toughness: 0.5,
            speed: 0.6,
            length: 0.7,
            contour_radius: 0.8,
            radius_shrunk: true,
        }],
        energies: Energies { kinetic: 1.0, strain: 2.0, external_work: 3.0, crack: 4.0 },
        colliders: vec![Pose { position: Point::new(1.0, 2.0), angle: 0.25 }],
        supports: vec![SupportRecord { force: Vector::new(5.0, -6.0), work: 7.0 }],
    }
}

pub fn listing(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap())
        .map(|e| (e.file_name().into_string().unwrap(), std::fs::read(e.path()).unwrap()))
        .collect();
    files.sort();
    files
}
