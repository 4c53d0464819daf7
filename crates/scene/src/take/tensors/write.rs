//! From a frame to tensors.

use super::{FRAME_FORMAT, FrameFileError, ParticlesAtRest, STATES, TIP_NUMBERS, tip_numbers};
use crate::frame::{CrackEnd, End, Frame};
use crate::take_settings::Precision;
use fissure_plane::{Matrix, Point, Vector};
use safetensors::tensor::{Dtype, View, serialize};
use std::borrow::Cow;
use std::collections::HashMap;

/// Adds the bytes of a tensor.
type Write<'a> = dyn Fn(&mut Vec<u8>) + 'a;

/// What is written as a tensor, made into bytes only when it is its turn.
struct Tensor<'a> {
    dtype: Dtype,
    shape: Vec<usize>,
    write: Box<Write<'a>>,
}

impl View for &Tensor<'_> {
    fn dtype(&self) -> Dtype {
        self.dtype
    }
    fn shape(&self) -> &[usize] {
        &self.shape
    }
    fn data(&self) -> Cow<'_, [u8]> {
        let mut bytes = Vec::with_capacity(self.data_len());
        (self.write)(&mut bytes);
        Cow::Owned(bytes)
    }
    fn data_len(&self) -> usize {
        self.shape.iter().product::<usize>() * self.dtype.bitsize() / 8
    }
}

/// The tensors of a file, in the order in which they are added.
#[derive(Default)]
pub(super) struct Tensors<'a>(Vec<(String, Tensor<'a>)>);

impl<'a> Tensors<'a> {
    fn add<T: 'a, const N: usize>(
        &mut self,
        name: impl Into<String>,
        dtype: Dtype,
        shape: Vec<usize>,
        values: impl Iterator<Item = T> + Clone + 'a,
        bytes_of: impl Fn(T) -> [u8; N] + 'a,
    ) {
        let write =
            move |bytes: &mut Vec<u8>| values.clone().for_each(|value| bytes.extend_from_slice(&bytes_of(value)));
        self.0.push((name.into(), Tensor { dtype, shape, write: Box::new(write) }));
    }
    fn f64s(&mut self, name: impl Into<String>, shape: Vec<usize>, values: impl Iterator<Item = f64> + Clone + 'a) {
        self.add(name, Dtype::F64, shape, values, f64::to_le_bytes);
    }
    fn reals(
        &mut self,
        name: impl Into<String>,
        precision: Precision,
        shape: Vec<usize>,
        values: impl Iterator<Item = f64> + Clone + 'a,
    ) {
        match precision {
            Precision::Double => self.f64s(name, shape, values),
            Precision::Single => self.add(name, Dtype::F32, shape, values, |value| (value as f32).to_le_bytes()),
        }
    }
    pub(super) fn numbers(&mut self, name: impl Into<String>, values: impl ExactSizeIterator<Item = f64> + Clone + 'a) {
        self.f64s(name, vec![values.len()], values);
    }
    pub(super) fn u32s(&mut self, name: impl Into<String>, values: impl ExactSizeIterator<Item = u32> + Clone + 'a) {
        self.add(name, Dtype::U32, vec![values.len()], values, u32::to_le_bytes);
    }
    fn i64s(&mut self, name: impl Into<String>, shape: Vec<usize>, values: impl Iterator<Item = i64> + Clone + 'a) {
        self.add(name, Dtype::I64, shape, values, i64::to_le_bytes);
    }
    pub(super) fn points(&mut self, name: impl Into<String>, points: impl Iterator<Item = &'a Point> + Clone + 'a) {
        let count = points.clone().count();
        self.f64s(name, vec![count, 2], points.flat_map(|p| [p.x, p.y]));
    }
    fn vectors(&mut self, name: impl Into<String>, vectors: impl Iterator<Item = &'a Vector> + Clone + 'a) {
        let count = vectors.clone().count();
        self.f64s(name, vec![count, 2], vectors.flat_map(|v| [v.x, v.y]));
    }
    fn offsets(&mut self, name: impl Into<String>, lengths: impl Iterator<Item = usize>) {
        let mut offsets = vec![0_i64];
        let mut sum = 0;
        offsets.extend(lengths.map(|length| {
            sum += length as i64;
            sum
        }));
        self.i64s(name, vec![offsets.len()], offsets.into_iter());
    }

    /// The file that says it is of `format`.
    pub(super) fn into_bytes(self, format: &str) -> Result<Vec<u8>, FrameFileError> {
        // One entry only: the header keeps the order of a hash map.
        let about = HashMap::from([("format".to_owned(), format.to_owned())]);
        serialize(self.0.iter().map(|(name, tensor)| (name.as_str(), tensor)), Some(about))
            .map_err(|error| FrameFileError::NotWritten(error.to_string()))
    }
}

/// A frame as the bytes of a safetensors file, its particles as exact as `precision` says, without what these are at
/// rest where that is what `at_rest` says. Equal frames give equal bytes.
///
/// # Errors
/// When the frame does not pass [`Frame::check`], or is too large for the format.
pub fn frame_to_bytes(
    frame: &Frame,
    precision: Precision,
    at_rest: Option<&ParticlesAtRest>,
) -> Result<Vec<u8>, FrameFileError> {
    frame.check()?;
    let p = &frame.particles;
    let own = (!at_rest.is_some_and(|known| known.is_of(p))).then(|| ParticlesAtRest::of(p));
    let formed = frame.cracks.iter().map(|k| k.formed.as_deref()).collect::<Option<Vec<_>>>();
    let formed = formed.map(|formed| formed.concat());
    let mut t = Tensors::default();
    t.i64s("frame.number", vec![1], std::iter::once(frame.number));
    t.numbers("frame.time", std::iter::once(frame.time));

    if let Some(own) = &own {
        own.add_to(&mut t);
    }
    t.u32s("particles.piece", p.piece.iter().copied());
    let n = p.len();
    t.reals("particles.position", precision, vec![n, 2], p.position.iter().flat_map(|x| [x.x, x.y]));
    t.reals("particles.velocity", precision, vec![n, 2], p.velocity.iter().flat_map(|v| [v.x, v.y]));
    let components = |m: &Matrix| [m.m11, m.m12, m.m21, m.m22];
    let shape = || vec![n, 2, 2];
    let gradients = p.deformation_gradient.iter().flat_map(components);
    t.reals("particles.deformation_gradient", precision, shape(), gradients);
    t.reals("particles.cauchy_stress", precision, shape(), p.cauchy_stress.iter().flat_map(components));

    let o = &frame.outlines;
    t.u32s("outlines.body", o.iter().map(|r| r.body));
    t.u32s("outlines.ring", o.iter().map(|r| r.ring));
    t.offsets("outlines.offset", o.iter().map(|r| r.rest.len()));
    t.points("outlines.rest", o.iter().flat_map(|r| &r.rest));
    t.points("outlines.position", o.iter().flat_map(|r| &r.position));
    t.vectors("outlines.velocity", o.iter().flat_map(|r| &r.velocity));

    let c = &frame.cracks;
    t.u32s("cracks.crack", c.iter().map(|k| k.crack));
    t.u32s("cracks.body", c.iter().map(|k| k.body));
    t.offsets("cracks.offset", c.iter().map(|k| k.rest.len()));
    t.i64s("cracks.ends", vec![c.len(), 2], c.iter().flat_map(|k| [end_number(k.start), end_number(k.end)]));
    t.points("cracks.rest", c.iter().flat_map(|k| &k.rest));
    t.points("cracks.above", c.iter().flat_map(|k| &k.above));
    t.points("cracks.below", c.iter().flat_map(|k| &k.below));
    t.vectors("cracks.above_velocity", c.iter().flat_map(|k| &k.above_velocity));
    t.vectors("cracks.below_velocity", c.iter().flat_map(|k| &k.below_velocity));
    // Those of all cracks or of none: a frame is of one version.
    if let Some(formed) = &formed {
        t.numbers("cracks.formed_time", formed.iter().map(|formed| formed.time));
        t.numbers("cracks.formed_mode_1", formed.iter().map(|formed| formed.mode_1));
    }

    let tips = &frame.tips;
    t.u32s("tips.crack", tips.iter().map(|tip| tip.crack));
    t.u32s("tips.end", tips.iter().map(|tip| u32::from(tip.end == End::End)));
    t.u32s("tips.state", tips.iter().map(|tip| STATES.iter().position(|s| *s == tip.state).unwrap_or(0) as u32));
    t.points("tips.position", tips.iter().map(|tip| &tip.position));
    for (i, name) in TIP_NUMBERS.into_iter().enumerate() {
        t.numbers(format!("tips.{name}"), tips.iter().map(move |tip| tip_numbers(tip)[i]));
    }
    let shrunk = tips.iter().map(|tip| u8::from(tip.radius_shrunk));
    t.add("tips.radius_shrunk", Dtype::U8, vec![tips.len()], shrunk, u8::to_le_bytes);

    let e = &frame.energies;
    t.numbers("energies.kinetic", std::iter::once(e.kinetic));
    t.numbers("energies.strain", std::iter::once(e.strain));
    t.numbers("energies.external_work", std::iter::once(e.external_work));
    t.numbers("energies.crack", std::iter::once(e.crack));
    t.points("colliders.position", frame.colliders.iter().map(|pose| &pose.position));
    t.numbers("colliders.angle", frame.colliders.iter().map(|pose| pose.angle));
    t.vectors("supports.force", frame.supports.iter().map(|support| &support.force));
    t.numbers("supports.work", frame.supports.iter().map(|support| support.work));
    t.into_bytes(FRAME_FORMAT)
}

fn end_number(end: CrackEnd) -> i64 {
    match end {
        CrackEnd::Tip => -1,
        CrackEnd::Mouth => -2,
        CrackEnd::Junction { crack } => i64::from(crack),
    }
}
