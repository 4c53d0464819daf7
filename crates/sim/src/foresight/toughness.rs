//! Whether any crack can reach its toughness.

use super::drawn_tip::DrawnTip;
use super::driving::stress_of_motions;
use super::samples::{PlacedForce, Samples, two_digits};
use super::section::{Section, balanced_forces};
use crate::material::elastic::Elastic;
use fissure_scene::{KeyPath, LoadKind, Scene, Vector, Warning};
use std::f64::consts::PI;

/// A load that comes at once swings to twice what it makes at rest.
const DYNAMIC: f64 = 2.0;
/// Handbook solutions are for strips; bodies are not. With 1.3, of 120 plates with cracks, loads and supports at random
/// three came up to 1.9 times nearer to their toughness than estimated; the median of the estimates is twice what comes
/// out.
const UNSURE: f64 = 1.6;
/// Part of the nominal stress that reaches a crack however it lies: waves, lateral strain, other cracks.
const STRAY: f64 = 0.25;
/// Forces at points are far above nominal around them, and their stray part is that much larger.
const AT_POINTS: f64 = 4.0;
/// A part of its toughness so small is none.
const LEAST: f64 = 1e-12;
/// Most tips that are looked at: with more, the longest cracks speak for the rest.
const MOST_TIPS: usize = 64;

/// That no tip can reach its toughness.
pub(super) fn out_of_reach(scene: &Scene, elastic: &[Elastic]) -> Option<Warning> {
    let tips: Vec<DrawnTip<'_>> = DrawnTip::all(scene).collect();
    if !scene.growth.enabled || tips.is_empty() || tips.iter().any(DrawnTip::is_scheduled) {
        return None;
    }
    let loads = greatest_loads(scene, elastic);
    let (index, &load) = loads.iter().enumerate().filter(|l| !l.1.is_nan()).max_by(|a, b| a.1.total_cmp(b.1))?;
    if load >= 1.0 {
        return None;
    }
    let crack = &scene.cracks[index];
    let message = if tips.len() == 1 {
        format!("crack `{}` will reach about {} of its toughness at most", crack.name, percent(load))
    } else {
        format!(
            "no crack will reach its toughness: `{}` comes nearest with about {} at most",
            crack.name,
            percent(load)
        )
    };
    let (path, what) = if !scene.loads.is_empty() {
        (KeyPath::item("load", 0), "the loads")
    } else if !scene.supports.is_empty() {
        (KeyPath::item("support", 0), "the motion of the supports")
    } else {
        (KeyPath::item("crack", index), "what loads it")
    };
    // Of nothing there is no multiple.
    let more = if load < LEAST {
        "add a load, a support that moves or an initial velocity".to_owned()
    } else {
        format!("multiply {what} by {} or more", two_digits(1.0 / load, f64::ceil))
    };
    let remedy = format!("{more}, make the crack longer, or use a material with less `fracture_toughness`");
    Some(Warning::new(path, message, remedy))
}

fn percent(part: f64) -> String {
    format!("{} %", two_digits(100.0 * part, f64::round))
}

/// For each crack: what its tips may feel within all frames as a part of their toughness, an estimate from above.
/// Negative without a live tip; NaN where nothing can be told.
pub(super) fn greatest_loads(scene: &Scene, elastic: &[Elastic]) -> Vec<f64> {
    let mut found = vec![-1.0; scene.cracks.len()];
    let mut tips: Vec<DrawnTip<'_>> = DrawnTip::all(scene).collect();
    let length = |tip: &DrawnTip<'_>| fissure_plane::polyline_length(&tip.crack.points);
    tips.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let Some(samples) = Samples::of(scene) else { return vec![f64::NAN; found.len()] };
    let end = scene.frames.time(scene.frames.last);
    let times = times_of_loads(scene, end);
    for body in 0..scene.bodies.len() {
        let own: Vec<&DrawnTip<'_>> = tips.iter().filter(|tip| tip.crack.body == body).take(MOST_TIPS).collect();
        if own.is_empty() {
            continue;
        }
        let moved = stress_of_motions(scene, &samples, elastic, body);
        let moments: Vec<(Vec<PlacedForce>, f64)> = times
            .iter()
            .map(|&time| {
                let factors: Vec<f64> = scene.loads.iter().map(|load| load.curve.value(time)).collect();
                let applied = total_of_loads(scene, &samples, body, &factors);
                (balanced_forces(scene, &samples, body, &factors), applied)
            })
            .collect();
        for tip in own {
            let section = Section::of(scene, tip);
            let root = (PI * section.a()).sqrt();
            let at_rest = moments.iter().map(|(forces, applied)| {
                section.stress_intensity(section.resultants(forces)) + STRAY * applied / section.width() * root
            });
            let near = (section.a() / (section.width() - section.length_of_crack()).max(1e-12 * section.width()))
                .sqrt()
                .max(1.0);
            let pressed = DYNAMIC * UNSURE * near * pressure_on(scene, tip.index, &times) * root;
            let felt = DYNAMIC * UNSURE * at_rest.fold(0.0, f64::max) + 1.3 * near * moved * root + pressed;
            let part = felt / least_toughness(scene, tip);
            found[tip.index] = f64::max(found[tip.index], part);
        }
    }
    // What was not looked at is not said to be out of reach.
    for tip in tips.iter().filter(|tip| found[tip.index] < 0.0).map(|tip| tip.index).collect::<Vec<_>>() {
        found[tip] = f64::NAN;
    }
    found
}

/// The greatest pressure on the faces of a crack at some times [Pa].
fn pressure_on(scene: &Scene, crack: usize, times: &[f64]) -> f64 {
    let pressure = |time: f64| {
        let of = scene.loads.iter().filter_map(|load| match &load.kind {
            LoadKind::FacePressure(cracks, p) if cracks.contains(&crack) => Some(p * load.curve.value(time)),
            _ => None,
        });
        of.sum::<f64>().abs()
    };
    times.iter().map(|&time| pressure(time)).fold(0.0, f64::max)
}

/// Times at which loads may be greatest: their curves are linear between them.
fn times_of_loads(scene: &Scene, end: f64) -> Vec<f64> {
    let mut times: Vec<f64> =
        scene.loads.iter().flat_map(|l| &l.curve.points).map(|p| p.0.clamp(0.0, end)).chain([0.0, end]).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    const MOST: usize = 24;
    let every = times.len().div_ceil(MOST);
    times.into_iter().step_by(every).collect()
}

/// Sum of all forces on a body, whatever their directions, halved: what they may hand on through any section [N/m].
fn total_of_loads(scene: &Scene, samples: &Samples, body: usize, factors: &[f64]) -> f64 {
    let each = scene.loads.iter().zip(&samples.loads).zip(factors).map(|((load, forces), factor)| {
        let own: Vec<Vector> = forces.iter().filter(|f| f.body == body).map(|f| f.force).collect();
        match load.kind {
            LoadKind::Pressure(_) => own.iter().map(Vector::norm).sum::<f64>() * factor.abs(),
            LoadKind::PerPoint(_) => AT_POINTS * own.iter().map(Vector::norm).sum::<f64>() * factor.abs(),
            _ => own.iter().sum::<Vector>().norm() * factor.abs(),
        }
    });
    0.5 * each.sum::<f64>()
}

/// The least toughness around a tip, up to four cells away [Pa·√m].
fn least_toughness(scene: &Scene, tip: &DrawnTip<'_>) -> f64 {
    let body = &scene.bodies[tip.crack.body];
    let here = tip.place();
    let around = (0..8).map(|k| f64::from(k) * 0.25 * PI).flat_map(|angle| {
        [1.0, 2.0, 4.0].map(|cells| here + Vector::new(angle.cos(), angle.sin()) * (cells * scene.cell_size))
    });
    std::iter::once(here)
        .chain(around)
        .map(|p| scene.materials[body.material_at(p)].fracture_toughness * scene.toughness_factor(tip.crack.body, p))
        .fold(f64::INFINITY, f64::min)
}
