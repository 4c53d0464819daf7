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

/// A particle in its bin: what a search looks at lies side by side.
#[derive(Debug, Clone, Copy)]
struct Binned {
    /// Column and row of the bin.
    bin: [i32; 2],
    particle: u32,
    piece: u32,
    place: Point,
}

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
        let p = nearest(&self.now, self.bin, place, piece)?;
        let back = particles.deformation_gradient[p].try_inverse()?;
        Some((particles.rest[p] + back * (place - particles.position[p]), particles.velocity[p]))
    }

    /// Position [m] and velocity [m/s] of the material of fragment `piece` that is at `rest` [m] at rest, as the
    /// nearest of its particles sees it: x = x_p + F_p (X − X_p). None where none of them is near.
    pub(crate) fn moved(&self, rest: Point, piece: u32) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let p = nearest(&self.rest, self.bin, rest, piece)?;
        let way = particles.deformation_gradient[p] * (rest - particles.rest[p]);
        Some((particles.position[p] + way, particles.velocity[p]))
    }
}

/// The particle of fragment `piece`, of those in bins of width `bin` [m], whose place is nearest to `place`.
fn nearest(sorted: &[Binned], bin: f64, place: Point, piece: u32) -> Option<usize> {
    let [column, row] = bin_of(place, bin);
    let mut nearest: Option<(f64, u32)> = None;
    for column in column.saturating_sub(1)..=column.saturating_add(1) {
        let (low, high) = ([column, row.saturating_sub(1)], [column, row.saturating_add(1)]);
        let begin = sorted.partition_point(|binned| binned.bin < low);
        let near = sorted[begin..].iter().take_while(|binned| binned.bin <= high);
        for binned in near.filter(|binned| binned.piece == piece) {
            let distance = (binned.place - place).norm_squared();
            if nearest.is_none_or(|(least, _)| distance < least) {
                nearest = Some((distance, binned.particle));
            }
        }
    }
    nearest.map(|(_, particle)| particle as usize)
}

fn binned(frame: &Frame, body: u32, places: &[Point], bin: f64) -> Vec<Binned> {
    let particles = &frame.particles;
    let of_body = (0..places.len()).filter(|&p| particles.body[p] == body);
    let mut order: Vec<([i32; 2], u32)> = of_body.map(|p| (bin_of(places[p], bin), p as u32)).collect();
    order.sort_unstable();
    let binned = |(bin, particle)| {
        let p = particle as usize;
        Binned { bin, particle, piece: particles.piece[p], place: places[p] }
    };
    order.into_iter().map(binned).collect()
}

/// Column and row of the bin that holds `place`; far away ones are all in the last.
fn bin_of(place: Point, bin: f64) -> [i32; 2] {
    [place.x, place.y].map(|x| (x / bin).floor() as i32)
}
