//! What a scene could be without, and would run faster: told only where an estimate from above shows it.

use super::accuracy::{accuracy, rise_time};
use super::course::first_contact;
use super::toughness::greatest_loads;
use crate::formulation::{self, expected_strain};
use crate::material::elastic::Elastic;
use crate::simulation::Estimate;
use fissure_scene::{Formulation, Scene};
use std::f64::consts::PI;

/// Loads that rise over so many crossings of waves are as good as at rest: of a body that swings, ramps of so many of
/// its periods leave less than 1/(5 π) of what they make.
const AT_REST: f64 = 5.0;
/// ... and of those that rise over so many, half and more is waiting.
const SLOW: f64 = 10.0;
/// Strain at holes and corners over the nominal one, at most.
const CONCENTRATION: f64 = 10.0;
/// A tip that feels less than this part of its toughness at most is looked at for nothing.
const FAR_FROM_GROWTH: f64 = 0.5;
/// An error of K that nobody sees [–].
const GOOD_ENOUGH: f64 = 0.015;
/// Steps shorter than this part of what is stable are so for nothing.
const SHORT_STEP: f64 = 0.4;

/// What `scene`, which `estimate` is of, could be without: a sentence each, with what that would save.
pub fn dispensable(scene: &Scene, estimate: &Estimate) -> Vec<String> {
    let elastic: Vec<Elastic> = scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect();
    let loads = greatest_loads(scene, &elastic);
    let mut found = Vec::new();
    found.extend(slow_loads(scene, &elastic));
    found.extend(fine_cells(scene, &elastic));
    found.extend(plasticity(scene, &elastic, &loads));
    found.extend(looks(scene, &loads));
    found.extend(colliders(scene));
    found.extend(asked_formulation(scene, &elastic));
    found.extend(short_steps(scene, estimate));
    found
}

/// Loads that rise far more slowly than waves go.
fn slow_loads(scene: &Scene, elastic: &[Elastic]) -> Option<String> {
    let crossing = |body: &fissure_scene::Body| {
        let (low, high) = body.region.bounds();
        (high - low).norm() / elastic[body.material].dilatational_wave_speed()
    };
    let crossing = scene.bodies.iter().map(crossing).fold(0.0, f64::max);
    let rise = rise_time(scene);
    let loads_rise = !scene.loads.is_empty() && rise < scene.frames.time(scene.frames.last);
    (loads_rise && rise > SLOW * crossing).then(|| {
        format!(
            "time: loads rise over {:.0} crossings of waves, which is as good as at rest; a rise over {AT_REST} ({:.2e} s) shows \
             the same in {:.0} times fewer steps",
            rise / crossing,
            AT_REST * crossing,
            rise / (AT_REST * crossing)
        )
    })
}

/// Cells much smaller than K needs.
fn fine_cells(scene: &Scene, elastic: &[Elastic]) -> Option<String> {
    let formulation = formulation::choose(scene, elastic).formulation;
    let error = |by: f64| {
        let (particle_spacing, cell_size) = (by * scene.particle_spacing, by * scene.cell_size);
        let coarser = Scene { particle_spacing, cell_size, ..scene.clone() };
        accuracy(&coarser, elastic, formulation).map(|accuracy| accuracy.error)
    };
    let coarser = error(2.0).filter(|&error| error <= GOOD_ENOUGH)?;
    Some(format!(
        "cells: with particles twice as far apart the highest K would still be within {:.1} %, in an eighth of the time of \
         steps and a quarter of the memory",
        100.0 * coarser
    ))
}

/// Plastic flow that nothing comes near to.
fn plasticity(scene: &Scene, elastic: &[Elastic], loads: &[f64]) -> Option<String> {
    let critical = |m: &fissure_scene::Material| m.plasticity.map(|p| p.critical_compression.min(p.critical_stretch));
    let least = scene.materials.iter().filter_map(critical).fold(f64::INFINITY, f64::min);
    let mut strain = CONCENTRATION * expected_strain(scene, elastic);
    // At a tip, half a particle ahead of it; one that grows feels its toughness.
    for (crack, &load) in scene.cracks.iter().zip(loads) {
        if !crack.start_live && !crack.end_live {
            continue;
        }
        let material = scene.bodies[crack.body].material;
        // NaN where nothing is known stays one.
        let intensity = load.clamp(0.0, 1.0) * scene.materials[material].fracture_toughness;
        let at_tip = intensity / (elastic[material].effective_modulus * (PI * scene.particle_spacing).sqrt());
        strain = if at_tip > strain || at_tip.is_nan() { at_tip } else { strain };
    }
    (strain < least && least.is_finite()).then(|| {
        format!(
            "`plasticity`: material flows from strains of {least:.1e} on, and {strain:.1e} is the most to be expected; without it \
             the scene would be computed in the total formulation, several times as fast"
        )
    })
}

/// Tips that are looked at and cannot grow.
fn looks(scene: &Scene, loads: &[f64]) -> Option<String> {
    let live = |k: &usize| scene.cracks[*k].start_live || scene.cracks[*k].end_live;
    if !scene.growth.enabled {
        return (0..scene.cracks.len()).any(|k| live(&k)).then(|| {
            "looks: nothing grows, and yet tips are looked at in every step; `tips = \"none\"` of a crack leaves that out \
             where its K is not wanted"
                .to_owned()
        });
    }
    let is_idle = |k: &usize| {
        let scheduled = [&scene.cracks[*k].start_guide, &scene.cracks[*k].end_guide];
        live(k) && loads[*k] < FAR_FROM_GROWTH && scheduled.into_iter().flatten().all(|g| g.schedule.points.is_empty())
    };
    let idle: Vec<&str> = (0..scene.cracks.len()).filter(is_idle).map(|k| scene.cracks[k].name.as_str()).collect();
    let (first, count) = (idle.first()?, idle.len());
    let others = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
    Some(format!(
        "tips: crack `{first}`{others} will feel less than half of its toughness; with `tips = \"none\"` its tips are not looked at"
    ))
}

/// Colliders that nothing comes to.
fn colliders(scene: &Scene) -> Option<String> {
    let spins = scene.bodies.iter().flat_map(|b| &b.velocities).any(|v| v.angular_velocity != 0.0);
    let moves = scene.colliders.iter().any(|c| c.keyframes.len() > 1);
    if scene.colliders.is_empty() || !scene.loads.is_empty() || !scene.supports.is_empty() || spins || moves {
        return None;
    }
    let end = scene.frames.time(scene.frames.last);
    (first_contact(scene, end) >= end).then(|| {
        let name = &scene.colliders[0].name;
        format!("colliders: nothing comes to `{name}` or any other until {end:.2e} s; steps are shorter for them")
    })
}

/// The updated formulation where nothing asks for it.
fn asked_formulation(scene: &Scene, elastic: &[Elastic]) -> Option<String> {
    let mut free = scene.clone();
    free.solver.formulation = Formulation::Auto;
    let choice = formulation::choose(&free, elastic);
    let is_asked = scene.solver.formulation == Formulation::Updated && choice.formulation == Formulation::Total;
    is_asked.then(|| {
        format!("`formulation = \"updated\"`: {}; the total formulation is some ten times as fast", choice.reason)
    })
}

/// Steps that are shorter than they have to be.
fn short_steps(scene: &Scene, estimate: &Estimate) -> Option<String> {
    let asked = scene.solver.time_step.filter(|&step| step < SHORT_STEP * estimate.stable_time_step)?;
    Some(format!(
        "`time_step`: {asked:.2e} s is {:.0} times shorter than what is stable; left out, the solver chooses half of that or more",
        estimate.stable_time_step / asked
    ))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::Simulation;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use fissure_scene::{BoxSide, Curve, Kernel, Load, LoadKind, Plasticity, Selection, Vector};

    /// A plate of 64 cells with an edge crack of 16, under a traction of 1e-6 times its modulus that rises over so many
    /// crossings of waves.
    fn plate(crossings: f64) -> Scene {
        let mut scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 1.0 / 128.0);
        (scene.solver.formulation, scene.solver.kernel) = (Formulation::Auto, Kernel::Bilinear);
        scene.growth.enabled = true;
        add_crack(&mut scene, &[[0.0, 0.5], [0.25, 0.5]]);
        scene.cracks[0].end_live = true;
        let wave = Elastic::new(&scene.materials[0], scene.plane).dilatational_wave_speed();
        let rise = crossings * 2.0_f64.sqrt() / wave;
        for (side, stress) in [(BoxSide::Top, 1e-3), (BoxSide::Bottom, -1e-3)] {
            scene.loads.push(Load {
                selection: Selection::Edge { side, bodies: None },
                kind: LoadKind::Traction(Vector::new(0.0, stress)),
                curve: Curve { points: vec![(0.0, 0.0), (rise, 1.0)] },
            });
        }
        (scene.frames.last, scene.frames.rate) = (20, 10.0 / rise);
        // Felt: about 1e-3 √π/4 × 1.5 = 1.3e-3.
        scene.materials[0].fracture_toughness = 1.5e-3;
        scene
    }

    fn told(scene: &Scene) -> String {
        dispensable(scene, &Simulation::estimate(scene).unwrap()).join("\n")
    }

    /// Truth: the constructions. What a scene needs is never said to be superfluous, what it does not is.
    #[test]
    fn what_nothing_needs_is_told() {
        let needed = plate(3.0);
        assert_eq!(told(&needed), "");
        assert!(told(&plate(20.0)).contains("4 times fewer steps"), "{}", told(&plate(20.0)));

        let mut tough = plate(3.0);
        tough.materials[0].fracture_toughness = 1.0;
        assert!(told(&tough).contains("tips: crack `crack 0` will"), "{}", told(&tough));

        let mut plastic = tough.clone();
        let hard = Plasticity { critical_compression: 0.3, critical_stretch: 0.2, hardening: 1.0 };
        plastic.materials[0].plasticity = Some(hard);
        assert!(told(&plastic).contains("`plasticity`"), "{}", told(&plastic));
        plastic.materials[0].plasticity = Some(Plasticity { critical_stretch: 1e-5, ..hard });
        assert!(!told(&plastic).contains("`plasticity`"));

        let mut asked = plate(3.0);
        (asked.solver.formulation, asked.solver.kernel) = (Formulation::Updated, Kernel::Quadratic);
        assert!(told(&asked).contains("`formulation"), "{}", told(&asked));

        let mut hasty = plate(3.0);
        hasty.solver.time_step = Some(0.1 * Simulation::estimate(&hasty).unwrap().stable_time_step);
        assert!(told(&hasty).contains("10 times shorter"), "{}", told(&hasty));
    }
}
