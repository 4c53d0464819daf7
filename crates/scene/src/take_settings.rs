//! What a take holds of particles, and what has need of them.

use crate::fault::{KeyPath, SceneFault};
use crate::settings::{Cut, Format, OutputSettings, Part};
use serde::{Deserialize, Serialize};

/// Which particles a take holds of each frame; each of these holds those of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HeldParticles {
    /// Two in each fragment, which tell its number.
    None,
    /// Those within a cell of an outline or a crack at rest.
    Surface,
    /// All.
    #[default]
    Full,
}

/// How many bytes a number of a particle takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "load", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// Four bytes: seven digits.
    Single,
    /// Eight bytes: as the solver has it.
    #[default]
    Double,
}

/// What a take holds of particles. The saved state of the solver holds all of them, whatever is said here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct TakeSettings {
    /// Which of them.
    pub particles: HeldParticles,
    /// How exact; places at rest are always double.
    pub precision: Precision,
}

impl HeldParticles {
    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Surface => "surface",
            Self::Full => "full",
        }
    }

    /// That these are all the particles that `output` has need of.
    ///
    /// # Errors
    /// Names the key of `output` that has need of more.
    pub fn must_do_for(self, output: &OutputSettings) -> Result<(), SceneFault> {
        let OutputSettings { formats, parts, surfaces, explode, .. } = output;
        let needs = [
            (parts.contains(&Part::Particles), "parts", "the part `particles`", Self::Surface),
            (formats.contains(&Format::GlbRigid), "formats", "the format `glb_rigid`", Self::Surface),
            (explode.is_some(), "explode", "`explode`", Self::Surface),
            (surfaces.cap_size.is_some(), "cap_size", "`cap_size`", Self::Full),
            (surfaces.cut == Cut::Rest, "cut", "`cut = \"rest\"`", Self::Full),
        ];
        let lacking = needs.into_iter().find(|&(is_wanted, _, _, least)| is_wanted && self < least);
        let Some((_, key, what, least)) = lacking else { return Ok(()) };
        let message = format!("{what} is made of particles that a take with `particles = \"{}\"` lacks", self.word());
        let remedy = format!("set `take.particles` to \"{}\", or leave it out", least.word());
        let fault = SceneFault::new(KeyPath::setting("output", key), message, remedy);
        Err(SceneFault { other: Some(KeyPath::setting("take", "particles")), ..fault })
    }
}
