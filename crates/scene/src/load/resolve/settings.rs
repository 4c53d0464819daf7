//! Solver, growth, frames and output.

use super::motion::pairs;
use super::{Resolved, Resolver};
use crate::curve::Curve;
use crate::document::{Ease, ExplodeKeys, OpeningKeys, RoughnessKeys, TimeStep};
use crate::fault::{KeyPath, SceneFault};
use crate::presets::{solver_preset, updated_kernel};
use crate::range::SPEED_FACTOR;
use crate::scene::Material;
use crate::settings::*;
use crate::validate::{Clock, validate_factor, validate_speed};

/// Division of tips, unless the scene says otherwise. Two tips that go on at a third of c_R need three times the energy
/// of one at rest: 2/(1 − v/c_R).
const RELEASE_RATIO: f64 = 3.0;
/// [°], to either side.
const HALF_ANGLE: f64 = 27.0;
/// In cells: branches are apart by the domains that their tips are measured in.
const BRANCH_SPACING: f64 = 12.0;

impl<'d> Resolver<'d> {
    pub(super) fn solver(&self, materials: &[Material]) -> SolverSettings {
        let keys = &self.document.solver;
        let (mut s, _) = solver_preset(keys.preset);
        let flows = materials.iter().any(|m| m.plasticity.is_some());
        s.formulation = keys.formulation.unwrap_or(s.formulation);
        let moves_through_grid = s.formulation == Formulation::Updated || (s.formulation == Formulation::Auto && flows);
        if keys.preset == SolverPreset::Standard && moves_through_grid {
            s.kernel = updated_kernel();
        }
        s.on_distortion = keys.on_distortion.unwrap_or(s.on_distortion);
        s.kernel = keys.kernel.unwrap_or(s.kernel);
        s.transfer = keys.transfer.unwrap_or(s.transfer);
        s.time_step = match keys.time_step {
            TimeStep::Auto => s.time_step,
            TimeStep::Seconds(seconds) => Some(seconds),
        };
        s.courant = keys.courant.unwrap_or(s.courant);
        s.damping = keys.damping.unwrap_or(s.damping);
        s.crack_contact = keys.crack_contact.unwrap_or(s.crack_contact);
        s.crack_friction = keys.crack_friction.unwrap_or(s.crack_friction);
        s.tip_division = keys.tip_division.unwrap_or(s.tip_division);
        s.j_method = keys.j_method.unwrap_or(s.j_method);
        s.j_radius = keys.j_radius.or(s.j_radius);
        s.area_term = keys.area_term.unwrap_or(s.area_term);
        s.mode_split = keys.mode_split.unwrap_or(s.mode_split);
        s
    }

    pub(super) fn growth(&self, frames: &FrameSettings, cell_size: f64) -> Resolved<GrowthSettings> {
        let keys = &self.document.growth;
        let (_, mut g) = solver_preset(self.document.solver.preset);
        g.enabled = keys.enabled.unwrap_or(g.enabled);
        g.increment = keys.increment.unwrap_or(g.increment);
        g.bending = keys.bending.unwrap_or(g.bending);
        g.speed_limit = keys.speed_limit.unwrap_or(g.speed_limit);
        let speed = pairs(&keys.speed_keyframes);
        validate_speed(&KeyPath::setting("growth", "speed_keyframes"), g.speed_limit, Clock::Frames, &speed)?;
        g.speed_curve = in_seconds(&keys.speed_ease.between(&speed), frames);
        if let Some(branching) = keys.branching {
            g.branching = branching.values().map(|values| Branching {
                release_ratio: values.release_ratio.unwrap_or(RELEASE_RATIO),
                half_angle: values.half_angle.unwrap_or(HALF_ANGLE).to_radians(),
                spacing: values.spacing.unwrap_or(BRANCH_SPACING * cell_size),
            });
        }
        Ok(g)
    }

    pub(super) fn frames(&self) -> Resolved<FrameSettings> {
        let keys = &self.document.frames;
        let rate = keys.rate.unwrap_or(24.0);
        let playback = keys.playback.unwrap_or(PLAYBACK);
        let Some(range) = &keys.range else {
            let first = keys.first.unwrap_or(1);
            return Ok(FrameSettings { first, last: keys.last.unwrap_or(first.saturating_add(47)), rate, playback });
        };
        let path = KeyPath::setting("frames", "range");
        if keys.first.is_some() || keys.last.is_some() {
            let message = format!("both `range = \"{range}\"` and `first` or `last` are given");
            return Err(SceneFault::new(path, message, "give the range or its ends"));
        }
        let ends = range.split_once('-').and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
        let (first, last) = ends.ok_or_else(|| {
            SceneFault::new(path, format!("`{range}` is not a range of frames"), "write it as `range = \"1-48\"`")
        })?;
        Ok(FrameSettings { first, last, rate, playback })
    }

    pub(crate) fn output(&self, side: f64, frames: &FrameSettings, cell_size: f64) -> Resolved<OutputSettings> {
        let keys = &self.document.output;
        if keys.formats.is_empty() || keys.parts.is_empty() {
            let key = if keys.formats.is_empty() { "formats" } else { "parts" };
            let message = format!("`{key}` is empty: there is nothing to write");
            return Err(SceneFault::new(
                KeyPath::setting("output", key),
                message,
                "name at least one, or leave it out",
            ));
        }
        let is_shown = |format: &&Format| keys.parts.iter().any(|&part| format.shows(part));
        if let Some(format) = keys.formats.iter().find(|format| !is_shown(format)) {
            let message = format!("`{}` shows none of the `parts`", format.name());
            let remedy = "add the part `cracked`, or leave the format out";
            return Err(SceneFault::new(KeyPath::setting("output", "formats"), message, remedy));
        }
        Ok(OutputSettings {
            thickness: keys.thickness.unwrap_or(0.1 * side),
            formats: keys.formats.clone(),
            parts: keys.parts.clone(),
            up: keys.up,
            smallest_fragment: keys.smallest_fragment,
            walls: keys.walls,
            surfaces: SurfaceSettings {
                cap_size: keys.cap_size,
                cut: keys.cut,
                smoothing: keys.smoothing,
                wall_step: keys.wall_step,
                roughness: keys.roughness.as_ref().map(|keys| roughness(keys, cell_size)),
                bevel: keys.bevel,
                uv_in_metres: keys.uv_in_metres,
            },
            opening: keys.opening.as_ref().map(|keys| opening(keys, frames, cell_size)).transpose()?,
            explode: keys.explode.as_ref().map(|keys| explode(keys, frames)).transpose()?,
            attributes: keys.attributes.clone(),
        })
    }
}

/// Amplitude of a relief, unless the scene says otherwise, in cells.
const RELIEF_HEIGHT: f64 = 0.2;
/// Length of a relief, unless the scene says otherwise, in amplitudes.
const RELIEF_LENGTH: f64 = 10.0;

fn roughness(keys: &RoughnessKeys, cell_size: f64) -> Roughness {
    let RoughnessKeys { amplitude, length, seed } = *keys;
    let amplitude = amplitude.unwrap_or(RELIEF_HEIGHT * cell_size);
    Roughness { amplitude, length: length.unwrap_or(RELIEF_LENGTH * amplitude), seed }
}

/// From a tip to where the least width is reached, unless the scene says otherwise, in cells.
const FALLOFF: f64 = 8.0;

fn opening(keys: &OpeningKeys, frames: &FrameSettings, cell_size: f64) -> Resolved<OpeningSettings> {
    let factor = Schedule { factor: keys.factor, keyframes: &keys.keyframes, ease: keys.ease, table: "opening" };
    Ok(OpeningSettings {
        factor: factor.curve(frames, 1.0)?,
        least: keys.least,
        falloff: keys.falloff.unwrap_or(FALLOFF * cell_size),
    })
}

fn explode(keys: &ExplodeKeys, frames: &FrameSettings) -> Resolved<Curve> {
    let ExplodeKeys { factor, keyframes, ease } = keys;
    Schedule { factor: *factor, keyframes, ease: *ease, table: "explode" }.curve(frames, 0.0)
}

/// A factor of a table of `output`: one number, or keyframes.
struct Schedule<'a> {
    factor: Option<f64>,
    keyframes: &'a [[f64; 2]],
    ease: Ease,
    table: &'a str,
}

impl Schedule<'_> {
    /// As a curve over time; `usual` where nothing is given.
    fn curve(&self, frames: &FrameSettings, usual: f64) -> Resolved<Curve> {
        let path = |key: &str| KeyPath::setting("output", self.table).then(key);
        let points = pairs(self.keyframes);
        if points.is_empty() {
            let factor = self.factor.unwrap_or(usual);
            SPEED_FACTOR.check(path("factor"), "the factor", factor)?;
            return Ok(Curve { points: vec![(0.0, factor)] });
        }
        if self.factor.is_some() {
            let message = "both `factor` and `keyframes` are given";
            return Err(SceneFault::new(path("factor"), message, "give one number, or keyframes"));
        }
        let what = format!("the keyframes of `{}`", self.table);
        validate_factor(&path("keyframes"), &what, Clock::Frames, &points)?;
        Ok(in_seconds(&self.ease.between(&points), frames))
    }
}

/// A curve over frames as one over time.
pub(super) fn in_seconds(points: &[(f64, f64)], frames: &FrameSettings) -> Curve {
    let seconds = |&(frame, value): &(f64, f64)| ((frame - frames.first as f64) / frames.rate, value);
    Curve { points: points.iter().map(seconds).collect() }
}
