//! Materials that no matter is like: a unit has been missed.

use super::samples::two_digits;
use crate::material::elastic::Elastic;
use fissure_scene::{KeyPath, Scene, Warning};

/// Waves faster than this [m/s] are a slip of the pen: in diamond, where they are fastest, they run at 18 km/s
/// (McSkimin & Andreatch 1972).
const FASTEST: f64 = 2e4;
/// A crack that costs less than this [J/m²] is, too: snow of the thesis, the weakest there is, takes 7e-4, the surface
/// of a liquid some 1e-2.
const LEAST_RELEASE: f64 = 1e-6;

/// Materials with waves faster than in diamond, and such that part for nothing.
pub(super) fn unlikely_materials(scene: &Scene, elastic: &[Elastic]) -> Vec<Warning> {
    let mut found = Vec::new();
    for (index, (m, e)) in scene.materials.iter().zip(elastic).enumerate() {
        let path = KeyPath::item("material", index);
        let speed = e.dilatational_wave_speed();
        if speed > FASTEST {
            let message = format!(
                "waves in `{}` run at {speed:.1e} m/s (Young's modulus {:e} Pa, density {} kg/m³), faster than in diamond (1.8e4 m/s)",
                m.name, m.young_modulus, m.density
            );
            let dense = two_digits(m.density * (speed / FASTEST).powi(2), f64::ceil);
            let remedy =
                format!("a density of {dense} kg/m³ or more has slower waves (1 g/cm³ is 1000), or a lower modulus");
            found.push(Warning::new(path.clone().then("density"), message, remedy));
        }
        let release = m.fracture_toughness.powi(2) / e.effective_modulus;
        if release < LEAST_RELEASE && scene.growth.enabled && !scene.cracks.is_empty() {
            let message = format!(
                "a crack in `{}` costs {release:.1e} J/m² (fracture toughness {} Pa·√m, Young's modulus {:e} Pa), less than in anything there is",
                m.name, m.fracture_toughness, m.young_modulus
            );
            let tough = two_digits((LEAST_RELEASE * e.effective_modulus).sqrt(), f64::ceil);
            let remedy = format!("it is {tough} Pa·√m or more (1 MPa·√m is 1e6), or take a lower modulus");
            found.push(Warning::new(path.then("fracture_toughness"), message, remedy));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foresight::warnings;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use fissure_scene::material_presets;

    /// Truth: what people write who take handbook values without their units: 1.2 for MPa·√m, 1.19 for g/cm³.
    #[test]
    fn missed_units_are_told_and_true_materials_are_not() {
        let told = |change: &dyn Fn(&mut fissure_scene::Material), with_crack: bool| {
            let mut all = Vec::new();
            for preset in material_presets() {
                let mut scene = free_body(rectangle([0.0, 0.0], [1.0, 1.0]), 0.02);
                scene.materials[0] = preset;
                change(&mut scene.materials[0]);
                scene.growth.enabled = true;
                if with_crack {
                    add_crack(&mut scene, &[[-0.1, 0.5], [0.5, 0.5]]);
                }
                let is_ours = |w: &Warning| w.message.contains("faster than in") || w.message.contains("costs");
                all.push(warnings(&scene).into_iter().filter(is_ours).count());
            }
            all
        };
        assert_eq!(told(&|_| (), true), [0; 4]);
        // Snow and jelly are so soft that 1e-5 Pa·√m is nothing either, but not a millionth of it.
        assert!(told(&|m| m.fracture_toughness *= 1e-6, true).iter().all(|&count| count == 1));
        assert_eq!(told(&|m| m.fracture_toughness *= 1e-6, false), [0; 4]);
        let stiff = |m: &mut fissure_scene::Material| {
            m.young_modulus = 70e9;
            m.fracture_toughness = 1e6;
            m.density = 2.5;
        };
        assert_eq!(told(&stiff, true), [1; 4]);
    }
}
