//! What the material within a fragment carries.

use crate::extrude::Extrusion;
use crate::sight::Sight;
use crate::smooth::SmoothCracks;
use crate::snap::GridPoint;
use crate::source::Carried;
use crate::triangulate::Cap;
use fissure_scene::{Cut, Frame, Point, Vector};
use rustc_hash::{FxHashMap, FxHashSet};
use std::ops::Range;

/// Width of a bin, in particle spacings: the nearest particle of most places lies in their bin or in one beside it,
/// unless the material has stretched to twice its length.
const BIN: f64 = 2.0;

/// The particles of a body, to be found by where they are.
#[derive(Debug)]
pub(crate) struct Interior<'a> {
    frame: &'a Frame,
    /// By where they are now.
    now: Bins,
    /// By where they are at rest, if that is needed, without strays.
    rest: Bins,
    /// What lies between places at rest, if that is known.
    sight: Option<Sight>,
}

/// Particles by place.
#[derive(Debug, Default)]
struct Bins {
    /// Width of a bin [m].
    width: f64,
    /// Bin after bin; what a search looks at lies side by side.
    particles: Vec<Binned>,
    /// The particles of each bin that holds some, by its column and row.
    ranges: FxHashMap<[i32; 2], Range<usize>>,
}

/// A particle in its bin.
#[derive(Debug, Clone, Copy)]
struct Binned {
    particle: u32,
    piece: u32,
    place: Point,
}

impl<'a> Interior<'a> {
    /// Those of body `body`, to be found as `cut` needs them; `spacing` [m] is their distance at rest.
    pub(crate) fn new(frame: &'a Frame, body: u32, spacing: f64, cut: Cut) -> Self {
        let bins = |places| Bins::new(frame, body, places, BIN * spacing);
        let rest = if cut == Cut::Rest { bins(&frame.particles.rest).without_strays() } else { Bins::default() };
        Self { frame, now: bins(&frame.particles.position), rest, sight: None }
    }

    /// Lets what is at rest follow particles on its own side of `cracks` of this body, `body`, only.
    pub(crate) fn part(&mut self, body: u32, cracks: &SmoothCracks<'_>) {
        self.sight = Some(Sight::new(self.frame, body, cracks, self.now.width));
    }

    /// What the corners within a polygon of fragment `piece` carry; where no particle is near, one has moved as the
    /// nearest corner of the outline.
    pub(crate) fn of_cap(&self, cap: &Cap, extrusion: &Extrusion<'_>, piece: u32) -> Vec<Carried> {
        let mut corners = None;
        let of_corner = |&point: &GridPoint| {
            let place = extrusion.grid.place(point);
            if let Some((rest, velocity)) = self.at(place, piece) {
                return Carried::within(rest, velocity);
            }
            // Rarely: the corners are not looked up before.
            let outer: &Vec<(GridPoint, Carried)> = corners.get_or_insert_with(|| extrusion.outer(cap));
            let distance = |p: GridPoint| ((p.x - point.x) as f64).hypot((p.y - point.y) as f64);
            let nearest = outer.iter().min_by(|p, q| distance(p.0).total_cmp(&distance(q.0)));
            let beside = |(corner, carried): &(GridPoint, Carried)| Carried {
                rest: carried.rest + (place - extrusion.grid.place(*corner)),
                ..*carried
            };
            nearest.map_or(Carried::within(place, Vector::zeros()), beside)
        };
        cap.within.iter().map(of_corner).collect()
    }

    /// Position at rest [m] and velocity [m/s] of the material of fragment `piece` at `place` [m], as the nearest of
    /// its particles sees it: X = X_p + F_p⁻¹ (x − x_p). None where none of them is near.
    pub(crate) fn at(&self, place: Point, piece: u32) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let p = self.now.nearest(place, piece)?;
        let back = particles.deformation_gradient[p].try_inverse()?;
        Some((particles.rest[p] + back * (place - particles.position[p]), particles.velocity[p]))
    }

    /// Whether a particle of fragment `piece` is in a region between `contours` [m].
    pub(crate) fn is_in(&self, contours: &[Vec<Point>], piece: u32) -> bool {
        let of_piece = self.now.particles.iter().filter(|binned| binned.piece == piece);
        of_piece.into_iter().any(|binned| encloses(contours, binned.place))
    }

    /// Position [m] and velocity [m/s] of the material of fragment `piece` that is at `rest` [m] at rest: the mean of
    /// what the particles around it see there, x = x_p + F_p (X − X_p), the nearer the more. Only those count that are
    /// seen `from` a place beside it, on its side of cracks. None where there are none.
    pub(crate) fn moved(&self, rest: Point, from: Point, piece: u32) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let on_this_side = |p: usize| self.sight.as_ref().is_none_or(|sight| sight.reaches(from, particles.rest[p]));
        let (mut total, mut place, mut velocity) = (0.0, Vector::zeros(), Vector::zeros());
        for binned in self.rest.around(rest, piece) {
            let part = 1.0 - (binned.place - rest).norm_squared() / self.rest.width.powi(2);
            if part > 0.0 && on_this_side(binned.particle as usize) {
                let (p, weight) = (binned.particle as usize, part * part);
                let way = particles.deformation_gradient[p] * (rest - particles.rest[p]);
                total += weight;
                place += weight * (particles.position[p].coords + way);
                velocity += weight * particles.velocity[p];
            }
        }
        (total > 0.0).then(|| ((place / total).into(), velocity / total))
    }

    /// Position [m] of the material of fragment `piece` that is at `rest` [m] at rest, as the nearest of all its
    /// particles sees it; none where there are none.
    pub(crate) fn carried(&self, rest: Point, piece: u32) -> Option<Point> {
        let particles = &self.frame.particles;
        let squared = |binned: &Binned| (binned.place - rest).norm_squared();
        let of_piece = self.rest.particles.iter().filter(|binned| binned.piece == piece);
        let nearest = of_piece.min_by(|p, q| squared(p).total_cmp(&squared(q)).then(p.particle.cmp(&q.particle)))?;
        let p = nearest.particle as usize;
        Some(particles.position[p] + particles.deformation_gradient[p] * (rest - particles.rest[p]))
    }
}

impl Bins {
    /// The particles of a body in bins of some `width` [m], each by its place among `places`.
    fn new(frame: &Frame, body: u32, places: &[Point], width: f64) -> Self {
        let particles = &frame.particles;
        let of_body = (0..places.len()).filter(|&p| particles.body[p] == body);
        let binned = |p: usize| Binned { particle: p as u32, piece: particles.piece[p], place: places[p] };
        Self::of(of_body.map(binned).collect(), width)
    }

    /// Some particles, in their order in each bin.
    fn of(particles: Vec<Binned>, width: f64) -> Self {
        let mut ranges = FxHashMap::<[i32; 2], Range<usize>>::default();
        for one in &particles {
            ranges.entry(bin_of(one.place, width)).or_default().end += 1;
        }
        let mut begin = 0;
        for range in ranges.values_mut() {
            let count = range.end;
            *range = begin..begin;
            begin += count;
        }
        let mut sorted = particles.clone();
        for one in particles {
            if let Some(range) = ranges.get_mut(&bin_of(one.place, width)) {
                sorted[range.end] = one;
                range.end += 1;
            }
        }
        Self { width, particles: sorted, ranges }
    }

    /// Those that have another one of their fragment within a bin's width, of fragments with any; of others all. One in
    /// a needle far from the rest of its fragment goes as what lies beside the needle does.
    fn without_strays(self) -> Self {
        let has_company = |one: &Binned| {
            let mut others = self.around(one.place, one.piece).filter(|other| other.particle != one.particle);
            others.any(|other| (other.place - one.place).norm_squared() < self.width.powi(2))
        };
        let (kept, strays): (Vec<Binned>, Vec<Binned>) = self.particles.iter().partition(|one| has_company(one));
        if strays.is_empty() {
            return self;
        }
        let with_company: FxHashSet<u32> = kept.iter().map(|one| one.piece).collect();
        let left = strays.into_iter().filter(|one| !with_company.contains(&one.piece));
        Self::of(kept.into_iter().chain(left).collect(), self.width)
    }

    /// The particle of fragment `piece` nearest to `place`, of those in its bin and in those around it; of several the
    /// one in the first column, the first row and with the lowest number.
    fn nearest(&self, place: Point, piece: u32) -> Option<usize> {
        let mut nearest: Option<(f64, u32)> = None;
        for binned in self.around(place, piece) {
            let distance = (binned.place - place).norm_squared();
            if nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, binned.particle));
            }
        }
        nearest.map(|(_, particle)| particle as usize)
    }

    /// The particles of fragment `piece` in the bin of `place` and in those around it.
    fn around(&self, place: Point, piece: u32) -> impl Iterator<Item = &Binned> {
        let [column, row] = bin_of(place, self.width);
        let around = |x: i32| x.saturating_sub(1)..=x.saturating_add(1);
        let bins = around(column).flat_map(move |column| around(row).map(move |row| [column, row]));
        let of_bin = |bin: [i32; 2]| self.ranges.get(&bin).map_or(&[][..], |range| &self.particles[range.clone()]);
        bins.flat_map(of_bin).filter(move |binned| binned.piece == piece)
    }
}

/// Column and row of the bin that holds `place`; far away ones are all in the last.
fn bin_of(place: Point, width: f64) -> [i32; 2] {
    [place.x, place.y].map(|x| (x / width).floor() as i32)
}

/// Whether a place [m] is between closed contours [m]: an odd number of their edges is to the right of it.
pub(crate) fn encloses(contours: &[Vec<Point>], place: Point) -> bool {
    let edges = contours.iter().flat_map(|contour| contour.iter().zip(contour.iter().cycle().skip(1)));
    let is_right = |(a, b): &(&Point, &Point)| {
        let crosses = (a.y > place.y) != (b.y > place.y);
        crosses && a.x + (b.x - a.x) * ((place.y - a.y) / (b.y - a.y)) > place.x
    };
    edges.filter(is_right).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use fissure_scene::{Matrix, ParticleFrame};

    /// Truth: by hand. A block that has turned, and far out in a needle of it one particle, which what lies beside the
    /// needle has carried off: the needle goes on as a straight part of the block. What is nothing but such particles
    /// goes as they do.
    #[test]
    fn needles_go_with_their_fragment_not_with_a_stray_particle() {
        let block = (0..16).map(|k| Point::new(f64::from(k % 4), f64::from(k / 4)));
        let rest: Vec<Point> = block.chain([Point::new(-3.5, 0.0), Point::new(50.0, 0.0)]).collect();
        let (sin, cos) = 0.5_f64.sin_cos();
        let turned = Matrix::new(cos, -sin, sin, cos);
        let mut particles = ParticleFrame {
            body: vec![0; 18],
            piece: vec![0; 18],
            position: rest.iter().map(|at| turned * at).collect(),
            velocity: vec![Vector::zeros(); 18],
            deformation_gradient: vec![turned; 18],
            rest,
            ..ParticleFrame::default()
        };
        particles.position[16] = Point::new(-3.5, 7.0);
        particles.piece[17] = 1;
        let frame = Frame { particles, ..Frame::default() };
        let interior = Interior::new(&frame, 0, 1.0, Cut::Rest);
        let tip = Point::new(-4.0, 0.0);
        assert_eq!(interior.moved(tip, tip, 0), None);
        assert!((interior.carried(tip, 0).unwrap_or_default() - turned * tip).norm() < 1e-12);
        let alone = Point::new(50.5, 0.0);
        assert!((interior.carried(alone, 1).unwrap_or_default() - turned * alone).norm() < 1e-12);
    }
}
