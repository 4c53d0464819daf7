//! A frame as safetensors: what each tensor is called, its shape and type.
//!
//! `n` particles; `k` rings with `m` points in all, `offset[i]..offset[i + 1]` those of ring `i`; likewise cracks; `t`
//! tips; `c` colliders. Numbers are little-endian, matrices row by row.
//!
//! | tensor | shape, type | |
//! |---|---|---|
//! | `frame.number`, `frame.time` | [1] i64, f64 | |
//! | `particles.id`, `.body`, `.piece` | \[n\] u32 | |
//! | `particles.rest`, `.position`, `.velocity` | [n, 2] f64 | m, m, m/s |
//! | `particles.deformation_gradient`, `.cauchy_stress` | [n, 2, 2] f64 | –, Pa |
//! | `outlines.body`, `.ring`; `.offset` | \[k\] u32; [k + 1] i64 | |
//! | `outlines.rest`, `.position`, `.velocity` | [m, 2] f64 | |
//! | `cracks.crack`, `.body`; `.offset` | as for outlines | |
//! | `cracks.ends` | [k, 2] i64 | start and end: -1 tip, -2 mouth, else the crack it ends on |
//! | `cracks.rest`, `.above`, `.below`, `.above_velocity`, `.below_velocity` | [m, 2] f64 | |
//! | `tips.crack`, `.end`, `.state` | \[t\] u32 | end: 0 start, 1 end; state: order of [`TipState`] |
//! | `tips.position`, and the other fields of [`TipRecord`] | [t, 2], \[t\] f64 | |
//! | `tips.radius_shrunk` | \[t\] u8 | 0 or 1 |
//! | `energies.kinetic`, `.strain`, `.external_work`, `.crack` | [1] f64 | J/m |
//! | `colliders.position`, `.angle` | [c, 2], \[c\] f64 | m, rad |

use crate::frame::*;
use fissure_plane::{Matrix, Point, Vector};
use safetensors::tensor::{Dtype, SafeTensors, View, serialize};
use std::borrow::Cow;
use std::collections::HashMap;

/// What the file says it is.
const FORMAT: &str = "fissure-frame 1";

/// Order in which tip states are numbered.
const STATES: [TipState; 6] = [
    TipState::Resting,
    TipState::Growing,
    TipState::Arrested,
    TipState::LeftBody,
    TipState::MetCrack,
    TipState::GuideEnded,
];

/// The fields of a tip that are one number each, in the order in which [`tip_numbers`] gives them.
const TIP_NUMBERS: [&str; 10] = [
    "direction",
    "j_integral",
    "mode_1",
    "mode_2",
    "kink_angle",
    "equivalent",
    "fracture_toughness",
    "speed",
    "length",
    "contour_radius",
];

fn tip_numbers(t: &TipRecord) -> [f64; 10] {
    [
        t.direction,
        t.j_integral,
        t.mode_1,
        t.mode_2,
        t.kink_angle,
        t.equivalent,
        t.fracture_toughness,
        t.speed,
        t.length,
        t.contour_radius,
    ]
}

struct Tensor {
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl View for &Tensor {
    fn dtype(&self) -> Dtype {
        self.dtype
    }
    fn shape(&self) -> &[usize] {
        &self.shape
    }
    fn data(&self) -> Cow<'_, [u8]> {
        Cow::Borrowed(&self.bytes)
    }
    fn data_len(&self) -> usize {
        self.bytes.len()
    }
}

#[derive(Default)]
struct Tensors(Vec<(String, Tensor)>);

impl Tensors {
    fn add(&mut self, name: impl Into<String>, dtype: Dtype, shape: Vec<usize>, bytes: Vec<u8>) {
        self.0.push((name.into(), Tensor { dtype, shape, bytes }));
    }
    fn f64s(&mut self, name: impl Into<String>, shape: Vec<usize>, values: impl Iterator<Item = f64>) {
        self.add(name, Dtype::F64, shape, values.flat_map(f64::to_le_bytes).collect());
    }
    fn numbers(&mut self, name: impl Into<String>, values: impl ExactSizeIterator<Item = f64>) {
        self.f64s(name, vec![values.len()], values);
    }
    fn u32s(&mut self, name: impl Into<String>, values: impl ExactSizeIterator<Item = u32>) {
        self.add(name, Dtype::U32, vec![values.len()], values.flat_map(u32::to_le_bytes).collect());
    }
    fn i64s(&mut self, name: impl Into<String>, shape: Vec<usize>, values: impl Iterator<Item = i64>) {
        self.add(name, Dtype::I64, shape, values.flat_map(i64::to_le_bytes).collect());
    }
    fn points<'a>(&mut self, name: impl Into<String>, points: impl Iterator<Item = &'a Point>) {
        let values: Vec<f64> = points.flat_map(|p| [p.x, p.y]).collect();
        self.f64s(name, vec![values.len() / 2, 2], values.into_iter());
    }
    fn vectors<'a>(&mut self, name: impl Into<String>, vectors: impl Iterator<Item = &'a Vector>) {
        let values: Vec<f64> = vectors.flat_map(|v| [v.x, v.y]).collect();
        self.f64s(name, vec![values.len() / 2, 2], values.into_iter());
    }
    fn matrices(&mut self, name: impl Into<String>, matrices: &[Matrix]) {
        let values = matrices.iter().flat_map(|m| [m.m11, m.m12, m.m21, m.m22]);
        self.f64s(name, vec![matrices.len(), 2, 2], values);
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
}

/// A frame as the bytes of a safetensors file. Equal frames give equal bytes.
///
/// # Errors
/// When the fields of the frame do not have one entry per particle, or it is too large for the format.
pub fn frame_to_bytes(frame: &Frame) -> Result<Vec<u8>, String> {
    let mut t = Tensors::default();
    t.i64s("frame.number", vec![1], std::iter::once(frame.number));
    t.numbers("frame.time", std::iter::once(frame.time));

    let p = &frame.particles;
    let lengths = [
        p.body.len(),
        p.piece.len(),
        p.rest.len(),
        p.position.len(),
        p.velocity.len(),
        p.deformation_gradient.len(),
        p.cauchy_stress.len(),
    ];
    if lengths.iter().any(|&length| length != p.len()) {
        return Err(format!("{} particles have fields of the lengths {lengths:?}", p.len()));
    }
    t.u32s("particles.id", p.id.iter().copied());
    t.u32s("particles.body", p.body.iter().copied());
    t.u32s("particles.piece", p.piece.iter().copied());
    t.points("particles.rest", p.rest.iter());
    t.points("particles.position", p.position.iter());
    t.vectors("particles.velocity", p.velocity.iter());
    t.matrices("particles.deformation_gradient", &p.deformation_gradient);
    t.matrices("particles.cauchy_stress", &p.cauchy_stress);

    let o = &frame.outlines;
    if let Some(ring) = o.iter().find(|r| r.position.len() != r.rest.len() || r.velocity.len() != r.rest.len()) {
        return Err(format!("ring {} of body {} has fields of different lengths", ring.ring, ring.body));
    }
    t.u32s("outlines.body", o.iter().map(|r| r.body));
    t.u32s("outlines.ring", o.iter().map(|r| r.ring));
    t.offsets("outlines.offset", o.iter().map(|r| r.rest.len()));
    t.points("outlines.rest", o.iter().flat_map(|r| &r.rest));
    t.points("outlines.position", o.iter().flat_map(|r| &r.position));
    t.vectors("outlines.velocity", o.iter().flat_map(|r| &r.velocity));

    let c = &frame.cracks;
    let uneven = |k: &&CrackFrame| {
        [k.above.len(), k.below.len(), k.above_velocity.len(), k.below_velocity.len()]
            .iter()
            .any(|&l| l != k.rest.len())
    };
    if let Some(crack) = c.iter().find(uneven) {
        return Err(format!("crack {} has fields of different lengths", crack.crack));
    }
    t.u32s("cracks.crack", c.iter().map(|k| k.crack));
    t.u32s("cracks.body", c.iter().map(|k| k.body));
    t.offsets("cracks.offset", c.iter().map(|k| k.rest.len()));
    t.i64s("cracks.ends", vec![c.len(), 2], c.iter().flat_map(|k| [end_number(k.start), end_number(k.end)]));
    t.points("cracks.rest", c.iter().flat_map(|k| &k.rest));
    t.points("cracks.above", c.iter().flat_map(|k| &k.above));
    t.points("cracks.below", c.iter().flat_map(|k| &k.below));
    t.vectors("cracks.above_velocity", c.iter().flat_map(|k| &k.above_velocity));
    t.vectors("cracks.below_velocity", c.iter().flat_map(|k| &k.below_velocity));

    let tips = &frame.tips;
    t.u32s("tips.crack", tips.iter().map(|tip| tip.crack));
    t.u32s("tips.end", tips.iter().map(|tip| u32::from(tip.end == End::End)));
    t.u32s("tips.state", tips.iter().map(|tip| STATES.iter().position(|s| *s == tip.state).unwrap_or(0) as u32));
    t.points("tips.position", tips.iter().map(|tip| &tip.position));
    for (i, name) in TIP_NUMBERS.into_iter().enumerate() {
        t.numbers(format!("tips.{name}"), tips.iter().map(|tip| tip_numbers(tip)[i]));
    }
    let shrunk = tips.iter().map(|tip| u8::from(tip.radius_shrunk)).collect();
    t.add("tips.radius_shrunk", Dtype::U8, vec![tips.len()], shrunk);

    let e = &frame.energies;
    t.numbers("energies.kinetic", std::iter::once(e.kinetic));
    t.numbers("energies.strain", std::iter::once(e.strain));
    t.numbers("energies.external_work", std::iter::once(e.external_work));
    t.numbers("energies.crack", std::iter::once(e.crack));
    t.points("colliders.position", frame.colliders.iter().map(|pose| &pose.position));
    t.numbers("colliders.angle", frame.colliders.iter().map(|pose| pose.angle));

    // One entry only: the header keeps the order of a hash map.
    let about = HashMap::from([("format".to_owned(), FORMAT.to_owned())]);
    serialize(t.0.iter().map(|(name, tensor)| (name.as_str(), tensor)), Some(about)).map_err(|e| e.to_string())
}

/// Whether the bytes say that they are a frame, whole or not: the first entry of the header of a safetensors file is
/// what the file is.
pub(super) fn is_frame(bytes: &[u8]) -> bool {
    let start = format!("{{\"__metadata__\":{{\"format\":\"{FORMAT}\"");
    bytes.get(8..).is_some_and(|header| header.starts_with(start.as_bytes()))
}

/// A frame from the bytes of a safetensors file, bit for bit as it was.
///
/// # Errors
/// When the file is cut off, lacks a tensor, or one has an unexpected type or length.
pub fn frame_from_bytes(bytes: &[u8]) -> Result<Frame, String> {
    let file =
        Reader(SafeTensors::deserialize(bytes).map_err(|e| format!("it is not a whole safetensors file ({e})"))?);
    let particles = ParticleFrame {
        id: file.u32s("particles.id")?,
        body: file.u32s("particles.body")?,
        piece: file.u32s("particles.piece")?,
        rest: file.points("particles.rest")?,
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
        particles,
    };
    let p = &frame.particles;
    let lengths = [p.body.len(), p.piece.len(), p.rest.len(), p.position.len(), p.velocity.len()];
    if lengths.iter().chain([&p.deformation_gradient.len(), &p.cauchy_stress.len()]).any(|&length| length != p.len()) {
        return Err("its particle tensors differ in length".into());
    }
    check_numbers(&frame)?;
    Ok(frame)
}

/// Checks that what has a place in a frame has a finite one. What was measured at tips may be anything.
fn check_numbers(frame: &Frame) -> Result<(), String> {
    let p = &frame.particles;
    let points = [&p.rest, &p.position].into_iter().flatten();
    let particles = points.flat_map(|x| x.iter()).chain(p.velocity.iter().flatten());
    let tensors = [&p.deformation_gradient, &p.cauchy_stress].into_iter().flatten().flatten();
    let outlines = frame.outlines.iter().flat_map(|o| {
        let points = [&o.rest, &o.position].into_iter().flatten();
        points.flat_map(|x| x.iter()).chain(o.velocity.iter().flatten())
    });
    let cracks = frame.cracks.iter().flat_map(|c| {
        let points = [&c.rest, &c.above, &c.below].into_iter().flatten();
        let velocities = [&c.above_velocity, &c.below_velocity].into_iter().flatten().flatten();
        points.flat_map(|x| x.iter()).chain(velocities)
    });
    let colliders = frame.colliders.iter().flat_map(|pose| pose.position.iter().chain([&pose.angle]));
    let finite = |mut numbers: Box<dyn Iterator<Item = &f64> + '_>| numbers.all(|x| x.is_finite());
    let kinds: [(&str, Box<dyn Iterator<Item = &f64> + '_>); 5] = [
        ("its time", Box::new(std::iter::once(&frame.time))),
        ("a particle", Box::new(particles.chain(tensors))),
        ("an outline", Box::new(outlines)),
        ("a crack", Box::new(cracks)),
        ("a collider", Box::new(colliders)),
    ];
    let what = kinds.into_iter().find_map(|(what, numbers)| (!finite(numbers)).then_some(what));
    what.map_or(Ok(()), |what| Err(format!("{what} has a number that is not finite")))
}

fn end_number(end: CrackEnd) -> i64 {
    match end {
        CrackEnd::Tip => -1,
        CrackEnd::Mouth => -2,
        CrackEnd::Junction { crack } => i64::from(crack),
    }
}

fn end_from_number(number: i64) -> Result<CrackEnd, String> {
    match number {
        -1 => Ok(CrackEnd::Tip),
        -2 => Ok(CrackEnd::Mouth),
        other => u32::try_from(other)
            .map(|crack| CrackEnd::Junction { crack })
            .map_err(|_| format!("a crack has the end {other}")),
    }
}

fn same_length<T>(what: &str, values: Vec<T>, length: usize) -> Result<Vec<T>, String> {
    if values.len() == length { Ok(values) } else { Err(format!("its {what} tensors differ in length")) }
}

struct Reader<'d>(SafeTensors<'d>);

impl Reader<'_> {
    fn values<const N: usize, T>(&self, name: &str, dtype: Dtype, of: fn([u8; N]) -> T) -> Result<Vec<T>, String> {
        let tensor = self.0.tensor(name).map_err(|_| format!("it has no tensor `{name}`"))?;
        if tensor.dtype() != dtype {
            return Err(format!("its tensor `{name}` is of type {:?}, not {dtype:?}", tensor.dtype()));
        }
        Ok(tensor.data().as_chunks::<N>().0.iter().map(|bytes| of(*bytes)).collect())
    }
    /// Numbers in groups of `N`: the components of vectors and matrices.
    fn groups<const N: usize>(&self, name: &str) -> Result<Vec<[f64; N]>, String> {
        let values = self.f64s(name)?;
        let (groups, rest) = values.as_chunks::<N>();
        if rest.is_empty() { Ok(groups.to_vec()) } else { Err(format!("its tensor `{name}` is not in groups of {N}")) }
    }
    fn one<const N: usize, T>(&self, name: &str, dtype: Dtype, of: fn([u8; N]) -> T) -> Result<T, String> {
        let [value] =
            self.values(name, dtype, of)?.try_into().map_err(|_| format!("its tensor `{name}` is no single number"))?;
        Ok(value)
    }
    fn f64s(&self, name: &str) -> Result<Vec<f64>, String> {
        self.values(name, Dtype::F64, f64::from_le_bytes)
    }
    fn number(&self, name: &str) -> Result<f64, String> {
        self.one(name, Dtype::F64, f64::from_le_bytes)
    }
    fn u32s(&self, name: &str) -> Result<Vec<u32>, String> {
        self.values(name, Dtype::U32, u32::from_le_bytes)
    }
    fn points(&self, name: &str) -> Result<Vec<Point>, String> {
        Ok(self.groups(name)?.into_iter().map(|p: [f64; 2]| Point::from(p)).collect())
    }
    fn vectors(&self, name: &str) -> Result<Vec<Vector>, String> {
        Ok(self.groups(name)?.into_iter().map(|v: [f64; 2]| Vector::from(v)).collect())
    }
    fn matrices(&self, name: &str) -> Result<Vec<Matrix>, String> {
        Ok(self.groups(name)?.into_iter().map(|[a, b, c, d]| Matrix::new(a, b, c, d)).collect())
    }

    /// The ranges that `name` gives, checked to be rising and to divide all of `length`.
    fn ranges(&self, name: &str, length: usize) -> Result<Vec<std::ops::Range<usize>>, String> {
        let offsets = self.values(name, Dtype::I64, i64::from_le_bytes)?;
        let is_whole = offsets.first() == Some(&0) && offsets.last() == i64::try_from(length).ok().as_ref();
        let range = |w: &[i64]| Some(usize::try_from(w[0]).ok()?..usize::try_from(w[1]).ok()?);
        let ranges: Option<Vec<_>> =
            offsets.windows(2).map(|w| range(w).filter(|r| r.start <= r.end && r.end <= length)).collect();
        ranges.filter(|_| is_whole).ok_or_else(|| format!("its tensor `{name}` does not divide {length} points"))
    }

    fn outlines(&self) -> Result<Vec<OutlineFrame>, String> {
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

    fn cracks(&self) -> Result<Vec<CrackFrame>, String> {
        let rest = self.points("cracks.rest")?;
        let above = same_length("crack", self.points("cracks.above")?, rest.len())?;
        let below = same_length("crack", self.points("cracks.below")?, rest.len())?;
        let above_velocity = same_length("crack", self.vectors("cracks.above_velocity")?, rest.len())?;
        let below_velocity = same_length("crack", self.vectors("cracks.below_velocity")?, rest.len())?;
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
                below_velocity: below_velocity[r].to_vec(),
                start: end_from_number(ends[i][0])?,
                end: end_from_number(ends[i][1])?,
            })
        };
        ranges.into_iter().enumerate().map(one).collect()
    }

    fn tips(&self) -> Result<Vec<TipRecord>, String> {
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
                state: *STATES.get(state[i] as usize).ok_or_else(|| format!("a tip has the state {}", state[i]))?,
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
