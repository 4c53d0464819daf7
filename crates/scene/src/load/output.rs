//! Other output for a scene that has been simulated already.

use super::error::LoadError;
use super::resolve::Resolver;
use super::source::SceneSource;
use crate::curve::Curve;
use crate::document::{Ease, ExplodeKeys, OpeningKeys, OutputKeys, RoughnessKeys};
use crate::fault::SceneFault;
use crate::scene::Scene;
use crate::settings::{FrameSettings, OutputSettings, Roughness, SurfaceSettings};
use std::path::Path;

/// What messages call the place where keys are written that no override sets.
const TAKE: &str = "the take";

/// The scene of a take with `overrides` of its output on top, such as `output.opening.factor=2`. What no override
/// names stays to the bit; all else of the scene, which its frames may depend on, stays as it is. Keyframes of a scene
/// are those of the lines that its easing became, so that new ones go in lines unless they are eased anew.
///
/// # Errors
/// [`LoadError`], which names the override: where a key is none of `output`, or a value is none of its key.
pub fn with_output(scene: &Scene, overrides: &[String]) -> Result<Scene, LoadError> {
    let path = Path::new(TAKE);
    let output = toml::Table::try_from(keys(&scene.output, &scene.frames)).unwrap_or_default();
    let text = toml::Table::from_iter([("output".to_owned(), toml::Value::Table(output))]).to_string();
    let (source, document) = SceneSource::parse(path, text, overrides)?;
    if let Some(other) = source.set_paths().find(|path| path.0.len() < 2 || path.0[0] != "output".into()) {
        let message = format!("`{other}` cannot be set: what a take holds was simulated with another one");
        let remedy = "set keys of `output`, for example `--set output.opening.factor=2`, or simulate again";
        return Err(source.error(SceneFault::new(other.clone(), message, remedy)));
    }
    let resolver = Resolver::new(&document, None, &[], scene.name.clone());
    let fault = |fault| source.error(fault);
    // The take has a thickness, so that no size of bodies is asked for.
    let output = resolver.output(0.0, &scene.frames, scene.cell_size).map_err(fault)?;
    let is_set = |key: &str| source.set_paths().any(|path| path.0[1] == key.into());
    let mut changed = Scene { output, ..scene.clone() };
    // Times of curves would be rounded on their way to frames and back.
    if !is_set("opening") {
        changed.output.opening.clone_from(&scene.output.opening);
    }
    if !is_set("explode") {
        changed.output.explode.clone_from(&scene.output.explode);
    }
    changed.validate().map_err(fault)?;
    Ok(changed)
}

/// The keys that give `output`.
fn keys(output: &OutputSettings, frames: &FrameSettings) -> OutputKeys {
    let OutputSettings { thickness, formats, parts, up, smallest_fragment, walls, .. } = output;
    let OutputSettings { surfaces, opening, explode, attributes, .. } = output;
    let SurfaceSettings { cap_size, cut, smoothing, wall_step, roughness, bevel, uv_in_metres } = *surfaces;
    let opening = opening.as_ref().map(|opening| {
        let (factor, keyframes) = schedule(&opening.factor, frames);
        OpeningKeys { factor, keyframes, ease: Ease::Linear, least: opening.least, falloff: Some(opening.falloff) }
    });
    let explode = explode.as_ref().map(|curve| {
        let (factor, keyframes) = schedule(curve, frames);
        ExplodeKeys { factor, keyframes, ease: Ease::Linear }
    });
    let roughness = roughness.map(|Roughness { amplitude, length, seed }| RoughnessKeys {
        amplitude: Some(amplitude),
        length: Some(length),
        seed,
    });
    OutputKeys {
        thickness: Some(*thickness),
        formats: formats.clone(),
        parts: parts.clone(),
        up: *up,
        smallest_fragment: *smallest_fragment,
        walls: *walls,
        cap_size,
        cut,
        smoothing,
        wall_step,
        roughness,
        bevel,
        uv_in_metres,
        attributes: attributes.clone(),
        opening,
        explode,
    }
}

/// A curve as one factor, or as keyframes.
fn schedule(curve: &Curve, frames: &FrameSettings) -> (Option<f64>, Vec<[f64; 2]>) {
    if let [(_, factor)] = curve.points[..] {
        return (Some(factor), Vec::new());
    }
    let keyframe = |&(time, value): &(f64, f64)| [time * frames.rate + frames.first as f64, value];
    (None, curve.points.iter().map(keyframe).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::load::load_text;
    use proptest::prelude::*;

    const BODY: &str =
        "[[body]]\nname = 'a'\nmaterial = 'glass'\nshape = { rectangle = { min = [0, 0], max = [1, 2] } }\n";

    fn scene(output: &str, overrides: &[String]) -> Scene {
        let text = format!("{BODY}[output]\n{output}");
        load_text(Path::new("scene.toml"), text, overrides, Path::to_owned).unwrap().scene
    }

    proptest! {
        /// Truth: another way there, overrides of the scene file. Output that has keys of its own, with others on top,
        /// is the same for a scene that has been loaded before; the hash stays.
        #[test]
        fn overrides_act_as_on_the_scene_file(
            thickness in 1e-3..1.0_f64, least in 0.0..0.01_f64, factor in 0.0..9.0_f64, seed: u64, walls: bool,
            chosen in proptest::collection::vec(any::<bool>(), 8),
        ) {
            let overrides = [
                format!("output.thickness={thickness:?}"),
                format!("output.opening.least={least:?}"),
                format!("output.opening.factor={factor:?}"),
                format!("output.roughness.seed={seed}", seed = seed >> 1),
                format!("output.walls={}", if walls { "all" } else { "open" }),
                "output.explode.keyframes=[[1, 0], [48, 1.5]]".to_owned(),
                "output.formats=['obj']".to_owned(),
                "output.cut=rest".to_owned(),
            ];
            let overrides: Vec<String> =
                overrides.into_iter().zip(&chosen).filter(|(_, is_chosen)| **is_chosen).map(|(text, _)| text).collect();
            for output in ["", "thickness = 0.3\nopening = { least = 1e-3, falloff = 0.1 }\nroughness = { seed = 4 }",
                           "explode = { keyframes = [[3, 0.1], [7, 0.4], [23, 0.3]] }\nopening = { factor = 3 }"] {
                let before = scene(output, &[]);
                let after = with_output(&before, &overrides).unwrap();
                prop_assert_eq!(&after, &scene(output, &overrides));
                prop_assert_eq!(after.hash, before.hash);
            }
        }
    }

    /// Truth: by hand. What is none of the output, or out of range, is refused with its value and what to do.
    #[test]
    fn what_the_frames_depend_on_cannot_be_set() {
        let scene = scene("", &[]);
        for (argument, words) in [
            ("grid.particle_spacing=0.5", "grid.particle_spacing"),
            ("output={ thickness = 1 }", "`output`"),
            ("output.opening.factors=2", "factors"),
            ("output.thickness=-1", "-1"),
            ("output.roughness.amplitude=7", "7"),
            ("output.cut=sideways", "sideways"),
            ("thickness=1", "thickness"),
        ] {
            let error = with_output(&scene, &[argument.to_owned()]).unwrap_err();
            let place = error.place();
            assert!(error.message.contains(words) && !error.remedy.is_empty(), "{argument}: {error}");
            assert!(place.contains("--set") && place.contains(argument), "{argument}: {place}");
        }
    }

    /// Truth: by hand. One number and keyframes take the place of each other, whichever comes last.
    #[test]
    fn a_factor_and_keyframes_take_the_place_of_each_other() {
        let before = scene("opening = { factor = 2 }\nexplode = { keyframes = [[1, 0], [9, 1]] }", &[]);
        let set = ["output.opening.keyframes=[[1, 0], [5, 3]]", "output.explode.factor=0.5"].map(str::to_owned);
        let output = with_output(&before, &set).unwrap().output;
        assert_eq!(output.opening.unwrap().factor.points.len(), 2);
        assert_eq!(output.explode.unwrap().points, [(0.0, 0.5)]);
    }
}
