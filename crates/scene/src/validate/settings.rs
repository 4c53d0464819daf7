//! Resolution, solver, growth, frames and output.

use super::curve::{Clock, validate_speed};
use super::{ABOVE_ONE, ACUTE, Check, FRACTION, FRICTION, NOT_NEGATIVE, POSITIVE, UNIT};
use crate::fault::{KeyPath, SceneFault, short};
use crate::scene::Scene;
use crate::settings::Branching;

/// Most particles along the larger side of a body: beyond it a spacing is a slip of the pen.
const MOST_ALONG_A_SIDE: f64 = 1e5;

impl Scene {
    pub(super) fn validate_resolution(&self) -> Check {
        let path = KeyPath::setting("grid", "particle_spacing");
        POSITIVE.check(path.clone(), "the particle spacing", self.particle_spacing)?;
        POSITIVE.check(KeyPath::setting("grid", "cell_size"), "the cell size", self.cell_size)?;
        for body in &self.bodies {
            let (low, high) = body.region.bounds();
            let (width, height) = (high.x - low.x, high.y - low.y);
            let (spacing, name) = (self.particle_spacing, &body.name);
            let size = format!("body `{name}` ({} m x {} m)", short(width), short(height));
            if spacing > width.min(height) {
                return Err(SceneFault::new(
                    path,
                    format!("the particle spacing {} m is larger than {size}", short(spacing)),
                    format!("make it at most {} m", short(width.min(height) / 4.0)),
                ));
            }
            if width.max(height) / spacing > MOST_ALONG_A_SIDE {
                return Err(SceneFault::new(
                    path,
                    format!(
                        "the particle spacing {} m puts more than {MOST_ALONG_A_SIDE} particles along {size}",
                        short(spacing)
                    ),
                    format!("something like {} m is usual", short(width.max(height) / 128.0)),
                ));
            }
        }
        if self.cell_size < self.particle_spacing {
            return Err(SceneFault::new(
                KeyPath::setting("grid", "cell_size"),
                format!(
                    "the cell size {} m is below the particle spacing {} m",
                    short(self.cell_size),
                    short(self.particle_spacing)
                ),
                "leave `grid.cell_size` out: it is then twice the particle spacing",
            ));
        }
        Ok(())
    }

    pub(super) fn validate_settings(&self) -> Check {
        let (s, g, f, o) = (&self.solver, &self.growth, &self.frames, &self.output);
        let solver = |key: &str| KeyPath::setting("solver", key);
        if let Some(step) = s.time_step {
            POSITIVE.check(solver("time_step"), "the time step", step)?;
        }
        FRACTION.check(solver("courant"), "`courant`", s.courant)?;
        NOT_NEGATIVE.check(solver("damping"), "`damping`", s.damping)?;
        FRICTION.check(solver("crack_friction"), "`crack_friction`", s.crack_friction)?;
        if let Some(radius) = s.j_radius {
            POSITIVE.check(solver("j_radius"), "`j_radius`", radius)?;
        }
        if let crate::settings::Transfer::Flip(flip) = s.transfer {
            UNIT.check(solver("transfer"), "the FLIP share", flip)?;
        }
        let frames = |key: &str| KeyPath::setting("frames", key);
        POSITIVE.check(frames("rate"), "the frame rate", f.rate)?;
        if f.first < 0 {
            let message = format!("the first frame is {}", f.first);
            return Err(SceneFault::new(frames("first"), message, "frame numbers start at 0 or above"));
        }
        if f.last < f.first {
            let message = format!("the last frame {} comes before the first frame {}", f.last, f.first);
            return Err(SceneFault::new(frames("last"), message, "make `last` at least `first`"));
        }
        let growth = |key: &str| KeyPath::setting("growth", key);
        POSITIVE.check(growth("increment"), "`increment`", g.increment)?;
        NOT_NEGATIVE.check(growth("bending"), "`bending`", g.bending)?;
        FRACTION.check(growth("speed_limit"), "`speed_limit`", g.speed_limit)?;
        validate_speed(&growth("speed_keyframes"), g.speed_limit, Clock::Seconds, &g.speed_curve.points)?;
        if let Some(branching) = &g.branching {
            validate_branching(&growth("branching"), branching)?;
        }
        POSITIVE.check(KeyPath::setting("output", "thickness"), "the thickness", o.thickness)?;
        NOT_NEGATIVE.check(
            KeyPath::setting("output", "smallest_fragment"),
            "the smallest fragment",
            o.smallest_fragment,
        )
    }
}

/// Division of tips.
fn validate_branching(path: &KeyPath, branching: &Branching) -> Check {
    ABOVE_ONE.check(path.then("release_ratio"), "`release_ratio`", branching.release_ratio)?;
    ACUTE.check(path.then("half_angle"), "`half_angle`", short(branching.half_angle.to_degrees()))?;
    POSITIVE.check(path.then("spacing"), "`spacing`", branching.spacing)
}
