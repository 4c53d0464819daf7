//! Resolution, solver, growth, frames and output.

use super::curve::{Clock, validate_factor, validate_speed};
use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault, short};
use crate::range::{
    ACUTE, AREA, BENDING, CELLS, DAMPING, FRACTION, FRAME_RATE, FRAMES, FRICTION, ITEMS, LENGTH, PARTICLE_FRAMES,
    PARTICLES, RELEASE_RATIO, SMOOTHING_CELLS, TIME, TIME_STEP, UNIT, WALL_CELLS, WIDTH,
};
use crate::scene::{Body, Scene};
use crate::settings::{Branching, Roughness};

/// Most particles along the larger side of a body: beyond it a spacing is a slip of the pen.
const MOST_ALONG_A_SIDE: f64 = 1e5;
/// Most particle spacings along the larger side of the box around all bodies: places on the particle lattice are
/// counted by integers of 32 bits.
const MOST_ALONG_THE_SCENE: f64 = 1e9;
/// Steps of single precision that a particle spacing must have: with fewer, the rounding of a mesh would be seen.
const LEAST_STEPS_PER_SPACING: f64 = 16.0;

/// Most triangles of a cap of given size.
const MOST_CAP_TRIANGLES: f64 = 4e6;
/// Least length of a relief, in amplitudes.
const ROUGHNESS_LENGTH: f64 = 4.0;
/// Most lengths of a relief along the longest side of a body, and in the thickness.
const MOST_RELIEFS: f64 = 1000.0;
/// Widest bevel, as a part of a cell and of the thickness.
const BEVEL_SHARE: f64 = 0.25;
/// Area of an equilateral triangle, over the square of its side.
const EQUILATERAL: f64 = 0.433;

impl Scene {
    pub(super) fn validate_resolution(&self) -> Check {
        let path = KeyPath::setting("grid", "particle_spacing");
        LENGTH.check(path.clone(), "the particle spacing", self.particle_spacing)?;
        LENGTH.check(KeyPath::setting("grid", "cell_size"), "the cell size", self.cell_size)?;
        for (i, body) in self.bodies.iter().enumerate() {
            self.validate_body_resolution(&path, body)?;
            self.validate_precision(&KeyPath::item("body", i).then("shape"), body)?;
        }
        self.validate_particle_count(&path)?;
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

    /// A body has particles, and not too many along a side.
    fn validate_body_resolution(&self, path: &KeyPath, body: &Body) -> Check {
        let (low, high) = body.region.bounds();
        let (width, height) = (high.x - low.x, high.y - low.y);
        let (spacing, name) = (self.particle_spacing, &body.name);
        let size = format!("body `{name}` ({} m x {} m)", short(width), short(height));
        if spacing > width.min(height) {
            return Err(SceneFault::new(
                path.clone(),
                format!("the particle spacing {} m is larger than {size}", short(spacing)),
                format!("make it at most {} m", short(width.min(height) / 4.0)),
            ));
        }
        if width.max(height) / spacing > MOST_ALONG_A_SIDE {
            return Err(SceneFault::new(
                path.clone(),
                format!(
                    "the particle spacing {} m puts more than {MOST_ALONG_A_SIDE} particles along {size}",
                    short(spacing)
                ),
                format!("something like {} m is usual", short(width.max(height) / 128.0)),
            ));
        }
        Ok(())
    }

    /// Meshes are written in single precision: where a body lies, its steps must be fine against the particle spacing.
    fn validate_precision(&self, path: &KeyPath, body: &Body) -> Check {
        let (low, high) = body.region.bounds();
        let reach = low.coords.amax().max(high.coords.amax());
        let step = reach * f64::from(f32::EPSILON);
        if step * LEAST_STEPS_PER_SPACING <= self.particle_spacing {
            return Ok(());
        }
        let (name, spacing) = (&body.name, short(self.particle_spacing));
        Err(SceneFault::new(
            path.clone(),
            format!(
                "body `{name}` reaches {} m away from the origin, where single precision, in which meshes are written, has steps of \
                 {} m; its particle spacing is {spacing} m",
                short(reach),
                short(step)
            ),
            format!(
                "move the scene to the origin (take the offset from all coordinates, or choose another `drawing.origin`), or make \
                 `grid.particle_spacing` at least {} m",
                short(step * LEAST_STEPS_PER_SPACING)
            ),
        ))
    }

    /// Particles of all bodies, by area.
    fn expected_particles(&self) -> f64 {
        self.bodies.iter().map(|b| b.region.area()).sum::<f64>() / (self.particle_spacing * self.particle_spacing)
    }

    /// The particles of all bodies can be counted, and their places too.
    fn validate_particle_count(&self, path: &KeyPath) -> Check {
        let spacing = self.particle_spacing;
        PARTICLES.check_real(path, "the scene", self.expected_particles())?;
        let boxes = self.bodies.iter().map(|b| b.region.bounds());
        let Some((low, high)) = boxes.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d))) else { return Ok(()) };
        let side = (high - low).amax();
        if side / spacing <= MOST_ALONG_THE_SCENE {
            return Ok(());
        }
        Err(SceneFault::new(
            path.clone(),
            format!(
                "the bodies lie within {} m, which is more than {MOST_ALONG_THE_SCENE} times the particle spacing {} m",
                short(side),
                short(spacing)
            ),
            "move the bodies nearer to each other, or make the spacing larger",
        ))
    }

    pub(super) fn validate_settings(&self) -> Check {
        let (s, g, f, o) = (&self.solver, &self.growth, &self.frames, &self.output);
        let solver = |key: &str| KeyPath::setting("solver", key);
        if let Some(step) = s.time_step {
            TIME_STEP.check(solver("time_step"), "the time step", step)?;
        }
        FRACTION.check(solver("courant"), "`courant`", s.courant)?;
        DAMPING.check(solver("damping"), "`damping`", s.damping)?;
        FRICTION.check(solver("crack_friction"), "`crack_friction`", s.crack_friction)?;
        self.validate_contact()?;
        if let Some(radius) = s.j_radius {
            CELLS.check(solver("j_radius"), "`j_radius`", radius)?;
        }
        if let crate::settings::Transfer::Flip(flip) = s.transfer {
            UNIT.check(solver("transfer"), "the FLIP share", flip)?;
        }
        let frames = |key: &str| KeyPath::setting("frames", key);
        FRAME_RATE.check(frames("rate"), "the frame rate", f.rate)?;
        FRAME_RATE.check(frames("playback"), "the frame rate of playback", f.playback)?;
        if f.first < 0 {
            let message = format!("the first frame is {}", f.first);
            return Err(SceneFault::new(frames("first"), message, "frame numbers start at 0 or above"));
        }
        if f.last < f.first {
            let message = format!("the last frame {} comes before the first frame {}", f.last, f.first);
            return Err(SceneFault::new(frames("last"), message, "make `last` at least `first`"));
        }
        let count = f.last as f64 - f.first as f64 + 1.0;
        FRAMES.check_real(&frames("last"), "the scene", count)?;
        PARTICLE_FRAMES.check_real(&frames("last"), "the scene", self.expected_particles() * count)?;
        TIME.check(frames("last"), "the time of the last frame", f.time(f.last))?;
        let growth = |key: &str| KeyPath::setting("growth", key);
        CELLS.check(growth("increment"), "`increment`", g.increment)?;
        BENDING.check(growth("bending"), "`bending`", g.bending)?;
        FRACTION.check(growth("speed_limit"), "`speed_limit`", g.speed_limit)?;
        validate_speed(&growth("speed_keyframes"), g.speed_limit, Clock::Seconds, &g.speed_curve.points)?;
        if let Some(branching) = &g.branching {
            validate_branching(&growth("branching"), branching)?;
        }
        self.take.particles.must_do_for(o)?;
        LENGTH.check(KeyPath::setting("output", "thickness"), "the thickness", o.thickness)?;
        AREA.check(KeyPath::setting("output", "smallest_fragment"), "the smallest fragment", o.smallest_fragment)?;
        SMOOTHING_CELLS.check(KeyPath::setting("output", "smoothing"), "`smoothing`", o.surfaces.smoothing)?;
        WALL_CELLS.check(KeyPath::setting("output", "wall_step"), "`wall_step`", o.surfaces.wall_step)?;
        o.surfaces.cap_size.map_or(Ok(()), |size| self.validate_cap_size(size))?;
        o.surfaces.roughness.as_ref().map_or(Ok(()), |roughness| self.validate_roughness(roughness))?;
        self.validate_bevel()?;
        if let Some(opening) = &o.opening {
            let path = KeyPath::setting("output", "opening");
            let points = &opening.factor.points;
            validate_factor(&path.then("keyframes"), "the keyframes of the opening", Clock::Seconds, points)?;
            WIDTH.check(path.then("least"), "the least width", opening.least)?;
            LENGTH.check(path.then("falloff"), "the falloff", opening.falloff)?;
        }
        o.explode.as_ref().map_or(Ok(()), |curve| {
            let path = KeyPath::setting("output", "explode").then("keyframes");
            validate_factor(&path, "the keyframes of `explode`", Clock::Seconds, &curve.points)
        })
    }

    /// Walls that are moved by more than half a cell, or whose relief is too steep, could come to cross each other;
    /// those with more triangles than anybody opens are a slip of the pen.
    fn validate_roughness(&self, roughness: &Roughness) -> Check {
        let path = |key| KeyPath::setting("output", "roughness").then(key);
        let Roughness { amplitude, length, .. } = *roughness;
        LENGTH.check(path("amplitude"), "`amplitude`", amplitude)?;
        LENGTH.check(path("length"), "`length`", length)?;
        let half_cell = 0.5 * self.cell_size;
        if amplitude > half_cell {
            let message = format!("walls would be moved by {amplitude} m, more than half a cell, {half_cell} m");
            return Err(SceneFault::new(path("amplitude"), message, format!("make it at most {half_cell}")));
        }
        if length < ROUGHNESS_LENGTH * amplitude {
            let message = format!("a relief {length} m long is too steep with an amplitude of {amplitude} m");
            let remedy = format!("make `length` at least {}, or leave it out", short(ROUGHNESS_LENGTH * amplitude));
            return Err(SceneFault::new(path("length"), message, remedy));
        }
        let side = |body: &Body| (body.region.bounds().1 - body.region.bounds().0).amax();
        let longest = self.bodies.iter().map(side).fold(self.output.thickness, f64::max);
        if length * MOST_RELIEFS < longest {
            let message =
                format!("walls of {} m with a relief {length} m long have too many triangles", short(longest));
            let remedy = format!("make `length` at least {:.2e}", longest / MOST_RELIEFS);
            return Err(SceneFault::new(path("length"), message, remedy));
        }
        Ok(())
    }

    /// A bevel has to leave something of walls and of caps; walls with a relief have none.
    fn validate_bevel(&self) -> Check {
        let path = || KeyPath::setting("output", "bevel");
        let (bevel, thickness) = (self.output.surfaces.bevel, self.output.thickness);
        WIDTH.check(path(), "`bevel`", bevel)?;
        let widest = BEVEL_SHARE * self.cell_size.min(thickness);
        if bevel > widest {
            let message = format!("a bevel {bevel} m wide is more than a quarter of a cell or of the thickness");
            return Err(SceneFault::new(path(), message, format!("make it at most {widest}")));
        }
        if bevel > 0.0 && self.output.surfaces.roughness.is_some() {
            let message = format!("walls with `roughness` have no bevel, but `bevel` is {bevel}");
            return Err(SceneFault::new(path(), message, "leave out one of the two"));
        }
        Ok(())
    }

    /// Caps of more triangles than anybody opens are a slip of the pen.
    fn validate_cap_size(&self, size: f64) -> Check {
        let path = || KeyPath::setting("output", "cap_size");
        LENGTH.check(path(), "`cap_size`", size)?;
        let area: f64 = self.bodies.iter().map(|body| body.region.area()).sum();
        if area <= MOST_CAP_TRIANGLES * EQUILATERAL * size * size {
            return Ok(());
        }
        let message =
            format!("caps with edges of {size} m would have {:.1e} triangles", area / (EQUILATERAL * size * size));
        let least = (area / (MOST_CAP_TRIANGLES * EQUILATERAL)).sqrt();
        Err(SceneFault::new(path(), message, format!("make `cap_size` at least {least:.2e}")))
    }
}

impl Scene {
    fn validate_contact(&self) -> Check {
        let contact = |key: &str| KeyPath::setting("contact", key);
        FRICTION.check(contact("friction"), "the friction of contact", self.contact.friction)?;
        UNIT.check(contact("restitution"), "the restitution of bodies", self.contact.restitution)?;
        UNIT.check(contact("fragment_restitution"), "the restitution of fragments", self.contact.fragment_restitution)?;
        ITEMS.check(&contact("pairs"), "`pairs`", self.contact.pairs.len())?;
        for (i, pair) in self.contact.pairs.iter().enumerate() {
            let path = contact("pairs").then(i);
            if let Some(material) = pair.materials.iter().find(|&&m| m >= self.materials.len()) {
                let message = format!("a pair names material number {material}");
                let remedy = format!("there are {}, numbered from 0", self.materials.len());
                return Err(SceneFault::new(path.then("materials"), message, remedy));
            }
            FRICTION.check(path.then("friction"), "the friction of a pair", pair.friction)?;
        }
        Ok(())
    }
}

/// Division of tips.
fn validate_branching(path: &KeyPath, branching: &Branching) -> Check {
    RELEASE_RATIO.check(path.then("release_ratio"), "`release_ratio`", branching.release_ratio)?;
    ACUTE.check(path.then("half_angle"), "`half_angle`", short(branching.half_angle.to_degrees()))?;
    LENGTH.check(path.then("spacing"), "`spacing`", branching.spacing)
}
