//! What particles are at rest: it never changes, so that a take holds it once.

use super::read::Reader;
use super::write::Tensors;
use super::{AT_REST_FORMAT, FrameFileError};
use crate::frame::ParticleFrame;
use fissure_plane::Point;

/// What the particles of a frame are at rest, one entry per particle in every field, in the order of the frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParticlesAtRest {
    /// Identity, stable over frames.
    pub id: Vec<u32>,
    /// Index of the body in the scene.
    pub body: Vec<u32>,
    /// Position at rest X_p [m].
    pub rest: Vec<Point>,
    /// Mass per unit thickness m_p [kg/m]; none in takes of older versions.
    pub mass: Option<Vec<f64>>,
}

impl ParticlesAtRest {
    /// The tensor that says whether a file holds them.
    pub(super) const ID: &str = "particles.id";

    /// What `particles` are at rest.
    pub fn of(particles: &ParticleFrame) -> Self {
        let ParticleFrame { id, body, rest, mass, .. } = particles;
        Self { id: id.clone(), body: body.clone(), rest: rest.clone(), mass: mass.clone() }
    }

    /// Whether `particles` are these, to the bit.
    pub(super) fn is_of(&self, particles: &ParticleFrame) -> bool {
        let bits = |point: &Point| [point.x.to_bits(), point.y.to_bits()];
        self.id == particles.id
            && self.body == particles.body
            && self.rest.len() == particles.rest.len()
            && self.rest.iter().map(bits).eq(particles.rest.iter().map(bits))
            && self.mass == particles.mass
    }

    /// The bytes of a safetensors file that holds nothing else.
    ///
    /// # Errors
    /// When they are too many for the format.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FrameFileError> {
        let mut tensors = Tensors::default();
        self.add_to(&mut tensors);
        tensors.into_bytes(AT_REST_FORMAT)
    }

    /// What such a file holds, bit for bit. Fields of different lengths are found when a frame of it is read.
    ///
    /// # Errors
    /// When the file is cut off, lacks a tensor, or one has an unexpected type or length.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FrameFileError> {
        Self::read(&Reader::new(bytes)?)
    }

    pub(super) fn add_to<'a>(&'a self, tensors: &mut Tensors<'a>) {
        tensors.u32s(Self::ID, self.id.iter().copied());
        tensors.u32s("particles.body", self.body.iter().copied());
        tensors.points("particles.rest", self.rest.iter());
        if let Some(mass) = &self.mass {
            tensors.numbers("particles.mass", mass.iter().copied());
        }
    }

    pub(super) fn read(file: &Reader<'_>) -> Result<Self, FrameFileError> {
        let (id, body) = (file.u32s(Self::ID)?, file.u32s("particles.body")?);
        let mass = file.has("particles.mass").then(|| file.f64s("particles.mass")).transpose()?;
        Ok(Self { id, body, rest: file.points("particles.rest")?, mass })
    }
}
