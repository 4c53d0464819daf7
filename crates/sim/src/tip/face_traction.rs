//! What faces that press on each other hand on close to a tip, as a traction.
//!
//! Nodes gather from the faces what lies within a cell of them, and near the tip the ties between the faces take a part
//! of it, now more and now less, as the tip lies in its cell. The auxiliary fields are as singular as 1/√r, so that it
//! matters much at which node the friction of the last cell is counted. But the traction itself is smooth where the
//! faces stay shut up to the tip, and its mean over a few cells is hardly touched by that: K_II of a crack under
//! pressure with a friction of 0.4, six cells half long, is off by up to 0.025 of that of the open crack with the mean,
//! by 0.045 node by node.

use super::zone::FaceContact;
use fissure_scene::Vector;

/// Contacts beyond this distance from the tip do not count in the mean [cells].
const FARTHEST: f64 = 4.0;
/// Contacts within this distance tell whether the faces are shut up to the tip [cells].
const AT_TIP: f64 = 2.0;
/// Faces whose pressure at the tip is less than this part of the mean begin to be open there, and nothing is known of
/// where between the nodes what presses comes to its end.
const LEAST_PRESSURE: f64 = 0.5;

/// The traction near the tip, and how much of the contacts it stands for.
pub(super) struct FaceTraction {
    /// On the face on the +e2 side [Pa].
    pub(super) mean: Vector,
    /// 1 where faces are shut up to the tip, 0 where they are open there.
    part: f64,
    /// What the mean is over.
    slope: Slope,
    cell_size: f64,
}

impl FaceTraction {
    /// From contacts that are known up to `outer` behind the tip [m].
    pub(super) fn of(contacts: &[FaceContact], cell_size: f64, outer: f64) -> Self {
        let mean = |slope: Slope| {
            let counted = contacts.iter().filter(|c| c.behind > -cell_size);
            let force: Vector = counted.map(|c| c.force * slope.at(c.behind / cell_size)).sum();
            force / (slope.sum() * cell_size)
        };
        let slope = Slope::down_to((outer / cell_size).min(FARTHEST));
        let (shut, at_tip) = (mean(slope), mean(Slope::down_to(AT_TIP)));
        let part = if shut.y > 0.0 { (at_tip.y / (LEAST_PRESSURE * shut.y)).clamp(0.0, 1.0) } else { 0.0 };
        Self { mean: shut, part, slope, cell_size }
    }

    /// How much of a contact at a distance `behind` the tip [m] the mean stands for; more than 1 ahead of the tip.
    pub(super) fn part(&self, behind: f64) -> f64 {
        self.part * self.slope.at(behind / self.cell_size)
    }

    /// ∫ q/√r over that part of the faces, `q` at a distance behind the tip [√m].
    pub(super) fn inverse_root(&self, q: impl Fn(f64) -> f64) -> f64 {
        const PARTS: u32 = 32;
        let step = ((self.slope.0 + 1.0) * self.cell_size).sqrt() / f64::from(PARTS);
        let part = |k: u32| {
            // With r = x², dr = 2x dx, nothing is singular.
            let r = (step * (f64::from(k) + 0.5)).powi(2);
            self.part(r) * q(r)
        };
        2.0 * step * (0..PARTS).map(part).sum::<f64>()
    }
}

/// A straight line from 1 at the tip to 0 at so many cells behind it and 0 from there on, the corner rounded over a
/// cell to both sides: the convolution with the hat of a node.
///
/// Its sum over nodes a cell apart that gather a traction of 1 does not depend on where the tip lies between them: what
/// nodes make of a straight line is that line, and the sum of a convolution with their hats is an integral.
#[derive(Clone, Copy)]
struct Slope(f64);

impl Slope {
    /// The slope that is 0 from so many cells on, two or more.
    fn down_to(cells: f64) -> Self {
        Self(cells - 1.0)
    }

    /// At a place, in cells behind the tip.
    fn at(self, place: f64) -> f64 {
        let above = self.0 - place;
        let corner = (1.0 - above.abs()).max(0.0).powi(3) / 6.0;
        (above.max(0.0) + corner) / self.0
    }

    /// What nodes of a traction of 1 from the tip on sum up to [cells]: half the length, and the rounded corner twice,
    /// as it is and as what nodes make of it lies above it.
    fn sum(self) -> f64 {
        0.5 * self.0 + 1.0 / (6.0 * self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What nodes one cell apart, the first ahead of the tip by `ahead` cells, gather of a traction of 1 on faces that
    /// are shut from `open` cells behind the tip on.
    fn contacts(ahead: f64, open: f64) -> Vec<FaceContact> {
        let ramp = |r: f64| 0.5 * r.max(0.0).powi(2);
        let node = |k: i32| {
            let behind = f64::from(k) - ahead;
            let from = behind - open;
            let length = ramp(from + 1.0) - 2.0 * ramp(from) + ramp(from - 1.0);
            FaceContact { place: Vector::new(-behind, 0.0), behind, force: Vector::new(0.4, 1.0) * length }
        };
        (0..9).map(node).collect()
    }

    /// Truth: a traction of 1, wherever the tip lies between nodes; where a node has a fifth of the force of its
    /// neighbour as well, nearly the same. ∫ 1/√r lies between those over one cell and over four. Faces that are open
    /// for two cells or more hand on nothing at the tip.
    #[test]
    fn the_mean_of_shut_faces_is_their_traction() {
        for outer in [2.0, 3.3, 4.0, 6.0] {
            for ahead in [0.0, 0.1, 0.25, 0.5, 0.75, 0.99] {
                let mut shut = contacts(ahead, 0.0);
                let found = FaceTraction::of(&shut, 1.0, outer);
                // Over two cells hardly anything of the line is straight.
                let round_off = if outer < 3.0 { 0.01 } else { 1e-14 };
                assert!((found.mean - Vector::new(0.4, 1.0)).norm() < round_off, "{ahead}: {:?}", found.mean);
                assert!((found.part(0.0) - 1.0).abs() < 1e-14 && found.part(outer) == 0.0 || outer > 4.0);
                let roots = found.inverse_root(|_| 1.0);
                assert!(roots > 1.0 && roots < 4.0, "{roots}");
                let moved = shut[1].force * 0.2;
                shut[1].force -= moved;
                shut[2].force += moved;
                let disturbed = FaceTraction::of(&shut, 1.0, outer);
                // The steepest that the line is, over its sum.
                let line = outer.min(4.0) - 1.0;
                let most = 0.22 / (0.5 * line * line + 1.0 / 6.0);
                assert!((disturbed.mean - found.mean).norm() < most, "{ahead}: {:?}", disturbed.mean);
                assert_eq!(FaceTraction::of(&contacts(ahead, 3.0), 1.0, outer).part(0.0), 0.0);
            }
        }
        assert_eq!(FaceTraction::of(&[], 1.0, 4.0).part(0.0), 0.0);
    }
}
