//! What the material within a fragment carries.

use crate::extrude::Extrusion;
use crate::snap::GridPoint;
use crate::source::Carried;
use crate::triangulate::Cap;
use fissure_scene::{Cut, Frame, Point, Vector};

/// Width of a bin, in particle spacings: the nearest particle of most places lies in their bin or in one beside it,
/// unless the material has stretched to twice its length.
const BIN: f64 = 2.0;

/// The particles of a body, to be found by where they are.
#[derive(Debug)]
pub(crate) struct Interior<'a> {
    frame: &'a Frame,
    bin: f64,
    /// By where they are now.
    now: Vec<Binned>,
    /// By where they are at rest, if that is needed.
    rest: Vec<Binned>,
}

/// Column and row of the bin of a particle, and its index.
type Binned = ([i32; 2], u32);

impl<'a> Interior<'a> {
    /// Those of body `body`, to be found as `cut` needs them; `spacing` [m] is their distance at rest.
    pub(crate) fn new(frame: &'a Frame, body: u32, spacing: f64, cut: Cut) -> Self {
        let bin = BIN * spacing;
        let binned = |places| binned(frame, body, places, bin);
        let rest = if cut == Cut::Rest { binned(&frame.particles.rest) } else { Vec::new() };
        Self { frame, bin, now: binned(&frame.particles.position), rest }
    }

    /// What the corners within a polygon of fragment `piece` carry; where no particle is near, one has moved as the
    /// nearest corner of the outline.
    pub(crate) fn of_cap(&self, cap: &Cap, extrusion: &Extrusion<'_>, piece: u32) -> Vec<Carried> {
        let outer = extrusion.outer(cap);
        let of_corner = |&point: &GridPoint| {
            let place = extrusion.grid.place(point);
            if let Some((rest, velocity)) = self.at(place, piece) {
                return Carried::within(rest, velocity);
            }
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
        let p = self.nearest(&self.now, &particles.position, place, piece)?;
        let back = particles.deformation_gradient[p].try_inverse()?;
        Some((particles.rest[p] + back * (place - particles.position[p]), particles.velocity[p]))
    }

    /// Position [m] and velocity [m/s] of the material of fragment `piece` that is at `rest` [m] at rest, as the
    /// nearest of its particles sees it: x = x_p + F_p (X − X_p). None where none of them is near.
    pub(crate) fn moved(&self, rest: Point, piece: u32) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let p = self.nearest(&self.rest, &particles.rest, rest, piece)?;
        let way = particles.deformation_gradient[p] * (rest - particles.rest[p]);
        Some((particles.position[p] + way, particles.velocity[p]))
    }

    /// The particle of fragment `piece` whose place, of `places`, is nearest to `place`.
    fn nearest(&self, sorted: &[Binned], places: &[Point], place: Point, piece: u32) -> Option<usize> {
        let [column, row] = bin_of(place, self.bin);
        let mut nearest: Option<(f64, usize)> = None;
        for column in column.saturating_sub(1)..=column.saturating_add(1) {
            let low = [column, row.saturating_sub(1)];
            let begin = sorted.partition_point(|(bin, _)| *bin < low);
            let column = sorted[begin..].iter().take_while(|(bin, _)| *bin <= [column, row.saturating_add(1)]);
            let piece_of = |p: usize| self.frame.particles.piece[p];
            for p in column.map(|&(_, p)| p as usize).filter(|&p| piece_of(p) == piece) {
                let distance = (places[p] - place).norm_squared();
                if nearest.is_none_or(|(least, _)| distance < least) {
                    nearest = Some((distance, p));
                }
            }
        }
        nearest.map(|(_, p)| p)
    }
}

fn binned(frame: &Frame, body: u32, places: &[Point], bin: f64) -> Vec<Binned> {
    let of_body = (0..places.len()).filter(|&p| frame.particles.body[p] == body);
    let mut binned: Vec<Binned> = of_body.map(|p| (bin_of(places[p], bin), p as u32)).collect();
    binned.sort_unstable();
    binned
}

/// Column and row of the bin that holds `place`; far away ones are all in the last.
fn bin_of(place: Point, bin: f64) -> [i32; 2] {
    [place.x, place.y].map(|x| (x / bin).floor() as i32)
}
