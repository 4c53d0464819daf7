//! Edges of the parts of bodies that are of another material, carried with the particles.

use crate::projection::Projection;
use fissure_plane::{Point, Region, orientation};
use fissure_scene::{Frame, Scene, Vector};
use tiny_skia::{Path, PathBuilder};

/// Particles up to so far from an edge move it, in particle spacings: beside cracks the next one may be farther off.
const REACH: f64 = 4.0;
/// Ends that come to lie nearer to each other than this are one, in particle spacings: they were moved by the same
/// material.
const JOINED: f64 = 0.5;
/// The part of an edge by which its ends are drawn in to tell which side of a crack they are on.
const INWARDS: f64 = 0.01;

/// The edges of all inclusions in the plane at height `z`; none where there are none.
pub(crate) fn edges(scene: &Scene, frame: &Frame, z: f64, projection: &Projection) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (index, body) in (0..).zip(&scene.bodies) {
        let material = Material::new(frame, index, scene.particle_spacing);
        for ring in body.inclusions.iter().flat_map(|inclusion| rings(&inclusion.region)) {
            for line in material.moved(ring, |place| body.region.contains(place)) {
                for (i, place) in line.into_iter().enumerate() {
                    let [x, y, _] = projection.pixel([place.x, place.y, z]);
                    let to = if i == 0 { PathBuilder::move_to } else { PathBuilder::line_to };
                    to(&mut path, x as f32, y as f32);
                }
            }
        }
    }
    path.finish()
}

fn rings(region: &Region) -> impl Iterator<Item = &[Point]> {
    std::iter::once(&region.exterior).chain(&region.holes).map(Vec::as_slice)
}

/// The particles of a body and the cracks between them.
struct Material<'a> {
    frame: &'a Frame,
    spacing: f64,
    particles: Vec<usize>,
    /// Crack and number of each segment of a crack.
    segments: Vec<(usize, usize)>,
}

/// Where an edge begins, ends or is cut.
#[derive(Debug, Clone, Copy)]
struct Stop {
    /// Place at rest [m].
    rest: Point,
    /// The crack that it crosses there, the number of its segment and the part of that.
    crossed: Option<(usize, usize, f64)>,
}

impl<'a> Material<'a> {
    fn new(frame: &'a Frame, body: u32, spacing: f64) -> Self {
        let particles = (0..frame.particles.len()).filter(|&p| frame.particles.body[p] == body).collect();
        let cracks = frame.cracks.iter().enumerate().filter(|(_, crack)| crack.body == body);
        let segments = cracks.flat_map(|(c, crack)| (1..crack.rest.len()).map(move |k| (c, k - 1))).collect();
        Self { frame, spacing, particles, segments }
    }

    /// A ring where it is now, as far as `is_inside` says that it is in the body, in lines that end at both faces of
    /// each crack that crosses it.
    fn moved(&self, ring: &[Point], is_inside: impl Fn(Point) -> bool) -> Vec<Vec<Point>> {
        let mut lines: Vec<Vec<Point>> = Vec::new();
        for (&from, &to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let stops = self.stops(from, to);
            for part in stops.windows(2).filter(|part| part.iter().all(|stop| is_inside(stop.rest))) {
                let (Some(start), Some(end)) = (self.place(part[0], part[1]), self.place(part[1], part[0])) else {
                    continue;
                };
                let goes_on = |line: &&mut Vec<Point>| (line[line.len() - 1] - start).norm() < JOINED * self.spacing;
                match lines.last_mut().filter(goes_on).filter(|_| part[0].crossed.is_none()) {
                    Some(line) => line.push(end),
                    None => lines.push(vec![start, end]),
                }
            }
        }
        lines
    }

    /// The ends of an edge, and where cracks cross it, in order.
    fn stops(&self, from: Point, to: Point) -> Vec<Stop> {
        let mut crossings: Vec<(f64, usize, usize, f64)> = self
            .segments
            .iter()
            .filter_map(|&(crack, k)| {
                let (part, of_crack) = crossing([from, to], self.segment(crack, k))?;
                Some((part, crack, k, of_crack))
            })
            .collect();
        crossings.sort_by(|p, q| p.0.total_cmp(&q.0));
        let mut stops = vec![Stop { rest: from, crossed: None }];
        let crossed =
            |(part, crack, k, of_crack)| Stop { rest: from + part * (to - from), crossed: Some((crack, k, of_crack)) };
        stops.extend(crossings.into_iter().map(crossed));
        stops.push(Stop { rest: to, crossed: None });
        stops
    }

    fn segment(&self, crack: usize, k: usize) -> [Point; 2] {
        let rest = &self.frame.cracks[crack].rest;
        [rest[k], rest[k + 1]]
    }

    /// Where `stop` is now, as an end of the edge from `other`: on the face of the crack that it ends on, or as the
    /// nearest particle on its side of all cracks has moved, x_p + F (X − X_p).
    fn place(&self, stop: Stop, other: Stop) -> Option<Point> {
        if let Some((crack, k, part)) = stop.crossed {
            let [a, b] = self.segment(crack, k);
            let crack = &self.frame.cracks[crack];
            let face = if orientation(a, b, other.rest) >= 0.0 { &crack.above } else { &crack.below };
            return Some(face[k] + part * (face[k + 1] - face[k]));
        }
        let particles = &self.frame.particles;
        let from = stop.rest + INWARDS * (other.rest - stop.rest);
        let way = |p: usize| -> Vector { particles.rest[p] - stop.rest };
        let reach = (REACH * self.spacing).powi(2);
        let mut near: Vec<usize> = self.particles.iter().copied().filter(|&p| way(p).norm_squared() < reach).collect();
        near.sort_by(|&p, &q| way(p).norm_squared().total_cmp(&way(q).norm_squared()));
        let is_cut_off = |p: usize| {
            let mut segments = self.segments.iter().map(|&(crack, k)| self.segment(crack, k));
            segments.any(|segment| crossing([from, particles.rest[p]], segment).is_some())
        };
        let p = near.into_iter().find(|&p| !is_cut_off(p))?;
        Some(particles.position[p] - particles.deformation_gradient[p] * way(p))
    }
}

/// Where two segments cross, as parts of both. What lies on a line is to its left, so that a line through a corner of
/// another crosses one of the two edges there.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<(f64, f64)> {
    let [low, high] = [a.inf(&b), a.sup(&b)];
    let [from, to] = [c.inf(&d), c.sup(&d)];
    if from.x > high.x || from.y > high.y || to.x < low.x || to.y < low.y {
        return None;
    }
    let (of_a, of_b) = (orientation(c, d, a), orientation(c, d, b));
    let (of_c, of_d) = (orientation(a, b, c), orientation(a, b, d));
    let cross = (of_a >= 0.0) != (of_b >= 0.0) && (of_c >= 0.0) != (of_d >= 0.0);
    cross.then(|| (of_a / (of_a - of_b), of_c / (of_c - of_d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_plane::Matrix;
    use fissure_scene::CrackFrame;

    const SPACING: f64 = 0.1;
    const HALF: f64 = 0.15;

    /// A plate of 4 m × 4 m, cut along `cut`, its upper half moved up by half of what it is open and its lower down.
    fn parted(cut: f64) -> Frame {
        let mut frame = Frame::default();
        let shift = |is_above: bool| Vector::new(0.0, if is_above { HALF } else { -HALF });
        for (i, j) in (0..40).flat_map(|i| (0..40).map(move |j| (i, j))) {
            let rest = Point::new(-1.95 + SPACING * f64::from(i), -1.95 + SPACING * f64::from(j));
            frame.particles.rest.push(rest);
            frame.particles.position.push(rest + shift(rest.y > cut));
            frame.particles.deformation_gradient.push(Matrix::identity());
            frame.particles.body.push(0);
            frame.particles.id.push(0);
        }
        let rest: Vec<Point> = (0..=20).map(|i| Point::new(-2.0 + 0.2 * f64::from(i), cut)).collect();
        let face = |is_above: bool| rest.iter().map(|p| p + shift(is_above)).collect();
        frame.cracks.push(CrackFrame {
            above: face(true),
            below: face(false),
            rest: rest.clone(),
            ..CrackFrame::default()
        });
        frame
    }

    fn length(lines: &[Vec<Point>]) -> f64 {
        lines.iter().flat_map(|line| line.windows(2)).map(|w| (w[1] - w[0]).norm()).sum()
    }

    /// Truth: halves that move without turning keep all lengths, and nothing is drawn across what is open between
    /// them, where a ring crosses the crack, weaves along it, or has corners on it.
    #[test]
    fn rings_end_at_both_faces_of_a_crack() {
        let circle: Vec<Point> = (0..48)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 48.0)
            .map(|angle| Point::new(angle.cos(), angle.sin()))
            .collect();
        let mut weaving: Vec<Point> =
            (0..20).map(|i| Point::new(-1.0 + 0.1 * f64::from(i), 0.013 + 0.008 * f64::from(i % 3 - 1))).collect();
        weaving.extend([Point::new(1.0, 1.0), Point::new(-1.0, 1.0)]);
        for (ring, cut, count) in [(&circle, 0.013, 3), (&circle, 0.0, 3), (&weaving, 0.013, 15)] {
            let frame = parted(cut);
            let lines = Material::new(&frame, 0, SPACING).moved(ring, |_| true);
            let closed: Vec<Point> = ring.iter().chain(ring.first()).copied().collect();
            let expected = length(&[closed]);
            assert!((length(&lines) - expected).abs() < 1e-9, "{} for {expected} at {cut}", length(&lines));
            assert!(lines.len() >= 2 && lines.len() <= count, "{} lines at {cut}", lines.len());
            let is_open = |p: &Point| (p.y - cut).abs() < HALF - 1e-9;
            assert!(!lines.iter().flatten().any(is_open));
            let sides = |line: &Vec<Point>| line.windows(2).all(|w| (w[0].y > cut) == (w[1].y > cut));
            assert!(lines.iter().all(sides));
        }
    }
}
