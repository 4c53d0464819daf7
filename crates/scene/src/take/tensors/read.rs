//! From tensors to a frame.

use super::{FrameFileError, ParticlesAtRest, STATES, TIP_NUMBERS};
use crate::frame::*;
use fissure_plane::{Matrix, Point, Vector};
use safetensors::tensor::{Dtype, SafeTensors};

/// A frame from the bytes of a safetensors file, bit for bit as it was. `at_rest`: what its particles are at rest, if
/// the file does not say so itself.
///
/// # Errors
/// When the file is cut off, lacks a tensor, one has an unexpected type or length, or the frame does not pass
/// [`Frame::check`].
pub fn frame_from_bytes(bytes: &[u8], at_rest: Option<&ParticlesAtRest>) -> Result<Frame, FrameFileError> {
    let file = Reader::new(bytes)?;
    let ParticlesAtRest { id, body, rest, mass } = match at_rest {
        Some(known) if !file.has(ParticlesAtRest::ID) => known.clone(),
        _ => ParticlesAtRest::read(&file)?,
    };
    let particles = ParticleFrame {
        id,
        body,
        piece: file.u32s("particles.piece")?,
        rest,
        mass,
        position: file.points("particles.position")?,
        velocity: file.vectors("particles.velocity")?,
        deformation_gradient: file.matrices("particles.deformation_gradient")?,
        cauchy_stress: file.matrices("particles.cauchy_stress")?,
    };
    let frame = Frame {
        number: file.one("frame.number", Dtype::I64, i64::from_le_bytes)?,
        time: file.number("frame.time")?,
        outlines: file.outlines()?,
        cracks: file.cracks()?,
        tips: file.tips()?,
        energies: Energies {
            kinetic: file.number("energies.kinetic")?,
            strain: file.number("energies.strain")?,
            external_work: file.number("energies.external_work")?,
            crack: file.number("energies.crack")?,
        },
        colliders: {
            let positions = file.points("colliders.position")?;
            let angles = same_length("colliders", file.f64s("colliders.angle")?, positions.len())?;
            positions.into_iter().zip(angles).map(|(position, angle)| Pose { position, angle }).collect()
        },
        supports: {
            let forces = file.vectors("supports.force")?;
            let works = same_length("supports", file.f64s("supports.work")?, forces.len())?;
            forces.into_iter().zip(works).map(|(force, work)| SupportRecord { force, work }).collect()
        },
        particles,
    };
    frame.check()?;
    Ok(frame)
}

fn end_from_number(number: i64) -> Result<CrackEnd, FrameFileError> {
    match number {
        -1 => Ok(CrackEnd::Tip),
        -2 => Ok(CrackEnd::Mouth),
        other => {
            u32::try_from(other).map(|crack| CrackEnd::Junction { crack }).map_err(|_| FrameFileError::CrackEnd(other))
        }
    }
}

fn same_length<T>(what: &'static str, values: Vec<T>, length: usize) -> Result<Vec<T>, FrameFileError> {
    if values.len() == length { Ok(values) } else { Err(FrameFileError::Lengths(what)) }
}

/// The tensors of a file.
pub(super) struct Reader<'d>(SafeTensors<'d>);

impl<'d> Reader<'d> {
    pub(super) fn new(bytes: &'d [u8]) -> Result<Self, FrameFileError> {
        let file = SafeTensors::deserialize(bytes).map_err(|error| FrameFileError::NotWhole(error.to_string()))?;
        Ok(Self(file))
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.0.tensor(name).is_ok()
    }

    fn values<const N: usize, T>(
        &self,
        name: &str,
        dtype: Dtype,
        of: fn([u8; N]) -> T,
    ) -> Result<Vec<T>, FrameFileError> {
        let tensor = self.0.tensor(name).map_err(|_| FrameFileError::Missing(name.into()))?;
        if tensor.dtype() != dtype {
            return Err(FrameFileError::Type { tensor: name.into(), found: tensor.dtype(), expected: dtype });
        }
        Ok(tensor.data().as_chunks::<N>().0.iter().map(|bytes| of(*bytes)).collect())
    }
    /// Numbers in groups of `N`: the components of vectors and matrices.
    fn groups<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, FrameFileError> {
        let values = self.reals(name)?;
        let (groups, rest) = values.as_chunks::<N>();
        if rest.is_empty() { Ok(groups.to_vec()) } else { Err(FrameFileError::Groups { tensor: name.into(), of: N }) }
    }
    fn one<const N: usize, T>(&self, name: &str, dtype: Dtype, of: fn([u8; N]) -> T) -> Result<T, FrameFileError> {
        let [value] = self.values(name, dtype, of)?.try_into().map_err(|_| FrameFileError::NotOne(name.into()))?;
        Ok(value)
    }
    pub(super) fn f64s(&self, name: &str) -> Result<Vec<f64>, FrameFileError> {
        self.values(name, Dtype::F64, f64::from_le_bytes)
    }
    /// Numbers of double or single precision.
    fn reals(&self, name: &str) -> Result<Vec<f64>, FrameFileError> {
        match self.0.tensor(name) {
            Ok(tensor) if tensor.dtype() == Dtype::F32 => {
                self.values(name, Dtype::F32, |bytes| f64::from(f32::from_le_bytes(bytes)))
            }
            _ => self.f64s(name),
        }
    }
    fn number(&self, name: &str) -> Result<f64, FrameFileError> {
        self.one(name, Dtype::F64, f64::from_le_bytes)
    }
    pub(super) fn u32s(&self, name: &str) -> Result<Vec<u32>, FrameFileError> {
        self.values(name, Dtype::U32, u32::from_le_bytes)
    }
    pub(super) fn points(&self, name: &str) -> Result<Vec<Point>, FrameFileError> {
        Ok(self.groups(name)?.into_iter().map(|p: [f64; 2]| Point::from(p)).collect())
    }
    fn vectors(&self, name: &str) -> Result<Vec<Vector>, FrameFileError> {
        Ok(self.groups(name)?.into_iter().map(|v: [f64; 2]| Vector::from(v)).collect())
    }
    fn matrices(&self, name: &str) -> Result<Vec<Matrix>, FrameFileError> {
        Ok(self.groups(name)?.into_iter().map(|[a, b, c, d]| Matrix::new(a, b, c, d)).collect())
    }

    /// The ranges that `name` gives, checked to be rising and to divide all of `length`.
    fn ranges(&self, name: &str, length: usize) -> Result<Vec<std::ops::Range<usize>>, FrameFileError> {
        let offsets = self.values(name, Dtype::I64, i64::from_le_bytes)?;
        let is_whole = offsets.first() == Some(&0) && offsets.last() == i64::try_from(length).ok().as_ref();
        let range = |w: &[i64]| Some(usize::try_from(w[0]).ok()?..usize::try_from(w[1]).ok()?);
        let ranges: Option<Vec<_>> =
            offsets.windows(2).map(|w| range(w).filter(|r| r.start <= r.end && r.end <= length)).collect();
        ranges.filter(|_| is_whole).ok_or_else(|| FrameFileError::Division { tensor: name.into(), length })
    }

    fn outlines(&self) -> Result<Vec<OutlineFrame>, FrameFileError> {
        let rest = self.points("outlines.rest")?;
        let position = same_length("outline", self.points("outlines.position")?, rest.len())?;
        let velocity = same_length("outline", self.vectors("outlines.velocity")?, rest.len())?;
        let ranges = self.ranges("outlines.offset", rest.len())?;
        let body = same_length("outline", self.u32s("outlines.body")?, ranges.len())?;
        let ring = same_length("outline", self.u32s("outlines.ring")?, ranges.len())?;
        let one = |(i, r): (usize, std::ops::Range<usize>)| OutlineFrame {
            body: body[i],
            ring: ring[i],
            rest: rest[r.clone()].to_vec(),
            position: position[r.clone()].to_vec(),
            velocity: velocity[r].to_vec(),
        };
        Ok(ranges.into_iter().enumerate().map(one).collect())
    }

    fn cracks(&self) -> Result<Vec<CrackFrame>, FrameFileError> {
        let rest = self.points("cracks.rest")?;
        let above = same_length("crack", self.points("cracks.above")?, rest.len())?;
        let below = same_length("crack", self.points("cracks.below")?, rest.len())?;
        let above_velocity = same_length("crack", self.vectors("cracks.above_velocity")?, rest.len())?;
        let below_velocity = same_length("crack", self.vectors("cracks.below_velocity")?, rest.len())?;
        let formed = self.formed(rest.len())?;
        let ranges = self.ranges("cracks.offset", rest.len())?;
        let crack = same_length("crack", self.u32s("cracks.crack")?, ranges.len())?;
        let body = same_length("crack", self.u32s("cracks.body")?, ranges.len())?;
        let ends = self.values("cracks.ends", Dtype::I64, i64::from_le_bytes)?;
        let ends = same_length("crack", ends.as_chunks::<2>().0.to_vec(), ranges.len())?;
        let one = |(i, r): (usize, std::ops::Range<usize>)| {
            Ok(CrackFrame {
                crack: crack[i],
                body: body[i],
                rest: rest[r.clone()].to_vec(),
                above: above[r.clone()].to_vec(),
                below: below[r.clone()].to_vec(),
                above_velocity: above_velocity[r.clone()].to_vec(),
                below_velocity: below_velocity[r.clone()].to_vec(),
                formed: formed.as_ref().map(|formed| formed[r].to_vec()),
                start: end_from_number(ends[i][0])?,
                end: end_from_number(ends[i][1])?,
            })
        };
        ranges.into_iter().enumerate().map(one).collect()
    }

    /// How the points of all cracks, so many, came about; none where the frame does not say.
    fn formed(&self, points: usize) -> Result<Option<Vec<Formed>>, FrameFileError> {
        if !self.has("cracks.formed_time") {
            return Ok(None);
        }
        let times = same_length("crack", self.f64s("cracks.formed_time")?, points)?;
        let modes = same_length("crack", self.f64s("cracks.formed_mode_1")?, points)?;
        Ok(Some(times.into_iter().zip(modes).map(|(time, mode_1)| Formed { time, mode_1 }).collect()))
    }

    fn tips(&self) -> Result<Vec<TipRecord>, FrameFileError> {
        let crack = self.u32s("tips.crack")?;
        let n = crack.len();
        let end = same_length("tip", self.u32s("tips.end")?, n)?;
        let state = same_length("tip", self.u32s("tips.state")?, n)?;
        let position = same_length("tip", self.points("tips.position")?, n)?;
        let shrunk = same_length("tip", self.values("tips.radius_shrunk", Dtype::U8, |[b]: [u8; 1]| b != 0)?, n)?;
        let mut numbers = Vec::new();
        for name in TIP_NUMBERS {
            numbers.push(same_length("tip", self.f64s(&format!("tips.{name}"))?, n)?);
        }
        let one = |i: usize| {
            let [
                direction,
                j_integral,
                mode_1,
                mode_2,
                kink_angle,
                equivalent,
                fracture_toughness,
                speed,
                length,
                contour_radius,
            ] = std::array::from_fn(|k| numbers[k][i]);
            Ok(TipRecord {
                crack: crack[i],
                end: if end[i] == 0 { End::Start } else { End::End },
                state: *STATES.get(state[i] as usize).ok_or(FrameFileError::TipState(state[i]))?,
                position: position[i],
                direction,
                j_integral,
                mode_1,
                mode_2,
                kink_angle,
                equivalent,
                fracture_toughness,
                speed,
                length,
                contour_radius,
                radius_shrunk: shrunk[i],
            })
        };
        (0..n).map(one).collect()
    }
}
