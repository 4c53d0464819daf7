//! What a frame must fulfil, whoever made it: the solver, a file, or another program.

use crate::frame::{Frame, ParticleFrame};
use fissure_plane::{Matrix, Point, Vector};
use std::fmt;

/// A part of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FramePart {
    /// Its time.
    Time,
    /// The particles.
    Particles,
    /// One ring.
    Outline {
        /// Index of the body.
        body: u32,
        /// Number of the ring.
        ring: u32,
    },
    /// One crack, by its index.
    Crack(u32),
    /// The colliders.
    Colliders,
}

impl fmt::Display for FramePart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Time => f.write_str("the time"),
            Self::Particles => f.write_str("the list of particles"),
            Self::Outline { body, ring } => write!(f, "ring {ring} of body {body}"),
            Self::Crack(crack) => write!(f, "crack {crack}"),
            Self::Colliders => f.write_str("the list of colliders"),
        }
    }
}

/// What is wrong with a frame.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FrameFault {
    /// Fields that have one entry for each particle or point do not have as many.
    #[error("{part} has fields of the lengths {lengths:?}")]
    UnequalLengths {
        /// Where.
        part: FramePart,
        /// Lengths of all its fields, in the order in which they are declared.
        lengths: Vec<usize>,
    },
    /// A number is infinite or none.
    #[error("{part} has a number that is not finite")]
    NotFinite {
        /// Where.
        part: FramePart,
    },
    /// Something belongs to a body that the scene does not have.
    #[error("{part} names body {body}, the scene has {bodies}")]
    UnknownBody {
        /// Where.
        part: FramePart,
        /// The index named.
        body: u32,
        /// Bodies of the scene.
        bodies: usize,
    },
}

impl Frame {
    /// Checks what everybody relies on who reads a frame: one entry for each particle or point in every field, and
    /// finite numbers. What was measured at tips, and energies, may be anything.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self) -> Result<(), FrameFault> {
        equal_lengths(FramePart::Particles, self.particles.lengths())?;
        for (part, lengths, _) in self.lines() {
            equal_lengths(part, lengths)?;
        }
        finite(FramePart::Time, [self.time].iter())?;
        let p = &self.particles;
        finite(FramePart::Particles, points([&p.rest, &p.position]).chain(vectors([&p.velocity])))?;
        finite(
            FramePart::Particles,
            matrices([&p.deformation_gradient, &p.cauchy_stress]).chain(p.mass.iter().flatten()),
        )?;
        for o in &self.outlines {
            let numbers = points([&o.rest, &o.position]).chain(vectors([&o.velocity]));
            finite(FramePart::Outline { body: o.body, ring: o.ring }, numbers)?;
        }
        for c in &self.cracks {
            let numbers = points([&c.rest, &c.above, &c.below]);
            let formed = c.formed.iter().flatten().flat_map(|formed| [&formed.time, &formed.mode_1]);
            let numbers = numbers.chain(vectors([&c.above_velocity, &c.below_velocity])).chain(formed);
            finite(FramePart::Crack(c.crack), numbers)?;
        }
        let poses = self.colliders.iter().flat_map(|pose| pose.position.iter().chain([&pose.angle]));
        finite(FramePart::Colliders, poses)
    }

    /// Checks the frame as [`Frame::check`] does, and that all of it belongs to one of the `bodies` that its scene has.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check_within(&self, bodies: usize) -> Result<(), FrameFault> {
        self.check()?;
        let particles = self.particles.body.iter().map(|&body| (FramePart::Particles, body));
        let mut all = self.lines().map(|(part, _, body)| (part, body)).chain(particles);
        match all.find(|&(_, body)| body as usize >= bodies) {
            Some((part, body)) => Err(FrameFault::UnknownBody { part, body, bodies }),
            None => Ok(()),
        }
    }

    /// The outlines and the cracks, with the lengths of their fields and their body.
    fn lines(&self) -> impl Iterator<Item = (FramePart, Vec<usize>, u32)> {
        let outlines = self.outlines.iter().map(|o| {
            let lengths = vec![o.rest.len(), o.position.len(), o.velocity.len()];
            (FramePart::Outline { body: o.body, ring: o.ring }, lengths, o.body)
        });
        let cracks = self.cracks.iter().map(|c| {
            let faces = [&c.rest, &c.above, &c.below].map(Vec::len);
            let velocities = [&c.above_velocity, &c.below_velocity].map(Vec::len);
            let formed: Vec<usize> = c.formed.iter().map(Vec::len).collect();
            (FramePart::Crack(c.crack), [&faces[..], &velocities, &formed].concat(), c.body)
        });
        outlines.chain(cracks)
    }
}

impl ParticleFrame {
    /// Lengths of all fields, in the order in which they are declared.
    fn lengths(&self) -> Vec<usize> {
        let numbers = [&self.id, &self.body, &self.piece].map(Vec::len);
        let tensors = [&self.deformation_gradient, &self.cauchy_stress].map(Vec::len);
        let mass: Vec<usize> = self.mass.iter().map(Vec::len).collect();
        let motion = [self.position.len(), self.velocity.len()];
        [&numbers[..], &[self.rest.len()], &mass, &motion, &tensors].concat()
    }
}

fn equal_lengths(part: FramePart, lengths: Vec<usize>) -> Result<(), FrameFault> {
    let equal = lengths.windows(2).all(|pair| pair[0] == pair[1]);
    if equal { Ok(()) } else { Err(FrameFault::UnequalLengths { part, lengths }) }
}

fn finite<'a>(part: FramePart, mut numbers: impl Iterator<Item = &'a f64>) -> Result<(), FrameFault> {
    if numbers.all(|number| number.is_finite()) { Ok(()) } else { Err(FrameFault::NotFinite { part }) }
}

fn points<const N: usize>(lists: [&Vec<Point>; N]) -> impl Iterator<Item = &f64> {
    lists.into_iter().flatten().flat_map(|point| point.iter())
}

fn vectors<const N: usize>(lists: [&Vec<Vector>; N]) -> impl Iterator<Item = &f64> {
    lists.into_iter().flatten().flatten()
}

fn matrices<const N: usize>(lists: [&Vec<Matrix>; N]) -> impl Iterator<Item = &f64> {
    lists.into_iter().flatten().flatten()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::frame::{CrackFrame, Formed, OutlineFrame, Pose};

    fn frame() -> Frame {
        let (point, vector, matrix) = (Point::origin(), Vector::zeros(), Matrix::identity());
        let particles = ParticleFrame {
            id: vec![7],
            body: vec![1],
            piece: vec![0],
            rest: vec![point],
            mass: Some(vec![1.0]),
            position: vec![point],
            velocity: vec![vector],
            deformation_gradient: vec![matrix],
            cauchy_stress: vec![matrix],
        };
        let outline =
            OutlineFrame { body: 0, ring: 2, rest: vec![point], position: vec![point], velocity: vec![vector] };
        let crack = CrackFrame {
            crack: 3,
            body: 1,
            rest: vec![point],
            above: vec![point],
            below: vec![point],
            above_velocity: vec![vector],
            below_velocity: vec![vector],
            formed: Some(vec![Formed::default()]),
            ..CrackFrame::default()
        };
        let colliders = vec![Pose { position: point, angle: 0.0 }];
        Frame { particles, outlines: vec![outline], cracks: vec![crack], colliders, ..Frame::default() }
    }

    /// Truth: the list of fields. Each one that is a number longer is found, in its part.
    #[test]
    fn every_field_has_one_entry_for_each_particle_or_point() {
        type Change = fn(&mut Frame);
        let particles: [Change; 9] = [
            |f| f.particles.id.push(0),
            |f| f.particles.body.push(0),
            |f| f.particles.piece.push(0),
            |f| f.particles.rest.push(Point::origin()),
            |f| f.particles.mass.as_mut().unwrap().push(1.0),
            |f| f.particles.position.push(Point::origin()),
            |f| f.particles.velocity.push(Vector::zeros()),
            |f| f.particles.deformation_gradient.push(Matrix::zeros()),
            |f| f.particles.cauchy_stress.push(Matrix::zeros()),
        ];
        let outline: [Change; 3] = [
            |f| f.outlines[0].rest.push(Point::origin()),
            |f| f.outlines[0].position.push(Point::origin()),
            |f| f.outlines[0].velocity.push(Vector::zeros()),
        ];
        let crack: [Change; 6] = [
            |f| f.cracks[0].rest.push(Point::origin()),
            |f| f.cracks[0].above.push(Point::origin()),
            |f| f.cracks[0].below.push(Point::origin()),
            |f| f.cracks[0].above_velocity.push(Vector::zeros()),
            |f| f.cracks[0].below_velocity.push(Vector::zeros()),
            |f| f.cracks[0].formed.as_mut().unwrap().push(Formed::default()),
        ];
        assert_eq!(frame().check(), Ok(()));
        let outline_part = FramePart::Outline { body: 0, ring: 2 };
        for (expected, changes) in
            [(FramePart::Particles, &particles[..]), (outline_part, &outline), (FramePart::Crack(3), &crack)]
        {
            for (at, change) in changes.iter().enumerate() {
                let mut frame = frame();
                change(&mut frame);
                let lengths = (0..changes.len()).map(|field| if field == at { 2 } else { 1 }).collect();
                assert_eq!(frame.check(), Err(FrameFault::UnequalLengths { part: expected, lengths }));
            }
        }
    }

    /// Truth: the list of fields. A number that is none is found wherever it is.
    #[test]
    fn every_number_is_finite() {
        type Number = fn(&mut Frame) -> &mut f64;
        let numbers: [(FramePart, Number); 19] = [
            (FramePart::Time, |f| &mut f.time),
            (FramePart::Particles, |f| &mut f.particles.rest[0].y),
            (FramePart::Particles, |f| &mut f.particles.mass.as_mut().unwrap()[0]),
            (FramePart::Particles, |f| &mut f.particles.position[0].x),
            (FramePart::Particles, |f| &mut f.particles.velocity[0].y),
            (FramePart::Particles, |f| &mut f.particles.deformation_gradient[0].m21),
            (FramePart::Particles, |f| &mut f.particles.cauchy_stress[0].m22),
            (FramePart::Outline { body: 0, ring: 2 }, |f| &mut f.outlines[0].rest[0].x),
            (FramePart::Outline { body: 0, ring: 2 }, |f| &mut f.outlines[0].position[0].y),
            (FramePart::Outline { body: 0, ring: 2 }, |f| &mut f.outlines[0].velocity[0].x),
            (FramePart::Crack(3), |f| &mut f.cracks[0].rest[0].y),
            (FramePart::Crack(3), |f| &mut f.cracks[0].above[0].x),
            (FramePart::Crack(3), |f| &mut f.cracks[0].below[0].y),
            (FramePart::Crack(3), |f| &mut f.cracks[0].above_velocity[0].x),
            (FramePart::Crack(3), |f| &mut f.cracks[0].below_velocity[0].y),
            (FramePart::Crack(3), |f| &mut f.cracks[0].formed.as_mut().unwrap()[0].time),
            (FramePart::Crack(3), |f| &mut f.cracks[0].formed.as_mut().unwrap()[0].mode_1),
            (FramePart::Colliders, |f| &mut f.colliders[0].position.x),
            (FramePart::Colliders, |f| &mut f.colliders[0].angle),
        ];
        for (part, number) in numbers {
            let mut frame = frame();
            *number(&mut frame) = f64::NAN;
            assert_eq!(frame.check(), Err(FrameFault::NotFinite { part }));
        }
    }

    #[test]
    fn every_body_is_known() {
        assert_eq!(frame().check_within(2), Ok(()));
        let part = FramePart::Crack(3);
        assert_eq!(frame().check_within(1), Err(FrameFault::UnknownBody { part, body: 1, bodies: 1 }));
        let mut stray = frame();
        stray.particles.body[0] = 2;
        let part = FramePart::Particles;
        assert_eq!(stray.check_within(2), Err(FrameFault::UnknownBody { part, body: 2, bodies: 2 }));
    }
}
