//! What the material within a fragment carries.

use fissure_scene::{Frame, Point, Vector};

/// Width of a bin, in particle spacings: the nearest particle of most places lies in their bin or in one beside it,
/// unless the material has stretched to twice its length.
const BIN: f64 = 2.0;

/// The particles of a body, to be found by where they are now.
#[derive(Debug)]
pub(crate) struct Interior<'a> {
    frame: &'a Frame,
    bin: f64,
    /// Bin and index of each particle, in this order.
    sorted: Vec<([i32; 2], u32)>,
}

impl<'a> Interior<'a> {
    /// Those of body `body`; `spacing` [m] is their distance at rest.
    pub(crate) fn new(frame: &'a Frame, body: u32, spacing: f64) -> Self {
        let particles = &frame.particles;
        let bin = BIN * spacing;
        let of_body = (0..particles.len()).filter(|&p| particles.body[p] == body);
        let mut sorted: Vec<_> = of_body.map(|p| (bin_of(particles.position[p], bin), p as u32)).collect();
        sorted.sort_unstable();
        Self { frame, bin, sorted }
    }

    /// Position at rest [m] and velocity [m/s] of the material of fragment `piece` at `place` [m], as the nearest of
    /// its particles sees it: X = X_p + F_p⁻¹ (x − x_p). None where none of them is near.
    pub(crate) fn at(&self, place: Point, piece: u32) -> Option<(Point, Vector)> {
        let particles = &self.frame.particles;
        let [column, row] = bin_of(place, self.bin);
        let mut nearest: Option<(f64, usize)> = None;
        for column in column.saturating_sub(1)..=column.saturating_add(1) {
            let low = [column, row.saturating_sub(1)];
            let begin = self.sorted.partition_point(|(bin, _)| *bin < low);
            let column = self.sorted[begin..].iter().take_while(|(bin, _)| *bin <= [column, row.saturating_add(1)]);
            for p in column.map(|&(_, p)| p as usize).filter(|&p| particles.piece[p] == piece) {
                let distance = (particles.position[p] - place).norm_squared();
                if nearest.is_none_or(|(least, _)| distance < least) {
                    nearest = Some((distance, p));
                }
            }
        }
        let (_, p) = nearest?;
        let back = particles.deformation_gradient[p].try_inverse()?;
        Some((particles.rest[p] + back * (place - particles.position[p]), particles.velocity[p]))
    }
}

/// Column and row of the bin that holds `place`; far away ones are all in the last.
fn bin_of(place: Point, bin: f64) -> [i32; 2] {
    [place.x, place.y].map(|x| (x / bin).floor() as i32)
}
