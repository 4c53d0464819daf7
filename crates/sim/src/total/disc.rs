//! What the particles of a disc do, read from a copy of what the nodes around it do.
//!
//! Up to sixteen particles see the same node. What it does is fetched once, and lies side by side, so that one
//! instruction adds all of it to a particle. The sums are those of a [`Reader`](super::reader::Reader), to the bit.

use super::lattice::Lattice;
use super::motion::Motion;
use super::reader::ParticleRates;
use crate::grid::kernel::Stencil;
use crate::grid::scan::Places;
use crate::wide::{Loop, run_widest};
use fissure_plane::{Matrix, Point, Vector};

/// What a node does: displacement [m], velocity [m/s] and acceleration [m/s²], x and y of each, and two zeros.
type Doing = [f64; 8];

/// A particle of a disc, with its displacement gradient and how fast it moves.
pub(super) type Found = (usize, Matrix, ParticleRates);

/// The particles of a body within `radius` [m] of `center`, row by row, and what of each lies where it stands.
pub(super) fn particles_of_disc(
    lattice: &Lattice,
    motion: &Motion,
    body: u32,
    (center, radius): (Point, f64),
) -> Vec<Found> {
    let disc = Disc::new(lattice, body, center, radius);
    let mut found: Vec<Found> = Vec::with_capacity(disc.most());
    let mut whole: Vec<Whole> = Vec::with_capacity(disc.most());
    let mut reader = lattice.reader();
    disc.for_each(&mut |p, place, _| {
        let is_whole = lattice.layout.cut.entries_of(p).is_none();
        let (strain, rates) = if is_whole {
            whole.push(Whole { slot: found.len(), place });
            Default::default()
        } else {
            reader.strain_and_rates(p, motion)
        };
        found.push((p, strain, rates));
    });
    disc.read(motion, &whole, &mut found);
    found
}

/// The particles of a body around a place.
pub(super) struct Disc<'a> {
    lattice: &'a Lattice,
    body: u32,
    /// [m].
    center: Point,
    /// [m].
    radius: f64,
    /// The lowest and the highest column and row that it may reach.
    low: [i32; 2],
    high: [i32; 2],
}

/// A particle that no crack cuts.
pub(super) struct Whole {
    /// Its number in what takes what it does.
    pub(super) slot: usize,
    /// Column and row, counted from the lowest ones.
    pub(super) place: [usize; 2],
}

/// Takes what particles do, by their numbers.
pub(super) trait Taking {
    /// The displacement gradient of a particle, and how fast it moves.
    fn take(&mut self, slot: usize, strain: Matrix, rates: ParticleRates);
}

impl Taking for Vec<Found> {
    #[inline(always)]
    fn take(&mut self, slot: usize, strain: Matrix, rates: ParticleRates) {
        (self[slot].1, self[slot].2) = (strain, rates);
    }
}

impl<'a> Disc<'a> {
    /// Those of `body` within `radius` [m] of `center`.
    pub(super) fn new(lattice: &'a Lattice, body: u32, center: Point, radius: f64) -> Self {
        let particles = &lattice.particles;
        let reach = (radius / particles.spacing).ceil() as i32 + 1;
        let middle = (center - particles.anchor) / particles.spacing;
        let middle = [middle.x.floor() as i32, middle.y.floor() as i32];
        let (low, high) = (middle.map(|c| c.saturating_sub(reach)), middle.map(|c| c.saturating_add(reach)));
        Self { lattice, body, center, radius, low, high }
    }

    /// More than it has, unless it is very large.
    pub(super) fn most(&self) -> usize {
        let across = self.high[0].saturating_sub(self.low[0]).clamp(0, 128) as usize + 2;
        across * across
    }

    /// Calls `visit` with each particle, row by row, its column and row, counted from the lowest ones, and where it
    /// stands.
    pub(super) fn for_each(&self, visit: &mut impl FnMut(usize, [usize; 2], Point)) {
        let &Self { lattice, body, center, radius, low, high } = self;
        let particles = &lattice.particles;
        // What need not be read need not be waited for: particles come body by body, and stand in a lattice.
        let is_alone = particles.body.first() == particles.body.last();
        let places = self.places();
        particles.lattice().within(low, high).for_each(|(i, j, p)| {
            let place = places.at(i, j);
            if (place - center).norm_squared() < radius * radius && (is_alone || particles.body[p] == body) {
                visit(p, [(i - low[0]) as usize, (j - low[1]) as usize], place);
            }
        });
    }

    /// Where particles stand.
    fn places(&self) -> Places {
        Places { anchor: self.lattice.particles.anchor, spacing: self.lattice.particles.spacing }
    }

    /// Tells `taking` what those do that no crack cuts.
    pub(super) fn read(&self, motion: &Motion, whole: &[Whole], taking: &mut impl Taking) {
        if whole.is_empty() {
            return;
        }
        let &Self { lattice, center, radius, low, high, .. } = self;
        let places = self.places();
        // Along x that of a column, along y that of a row.
        let stencils: Vec<Stencil> =
            (0..=high[0].saturating_sub(low[0])).map(|k| lattice.stencil(places.at(low[0] + k, low[1] + k))).collect();
        let around = Around::new(lattice, motion, center, radius);
        run_widest(Reading { around, stencils, whole, taking });
    }
}

/// What the nodes around a disc do.
struct Around {
    /// The lowest node.
    low: [i32; 2],
    /// Nodes in a row.
    width: usize,
    /// Row by row; zeros where there is no node.
    doing: Vec<Doing>,
}

impl Around {
    fn new(lattice: &Lattice, motion: &Motion, center: Point, radius: f64) -> Self {
        let by = Vector::repeat(radius + lattice.reach() * lattice.grid.cell_size);
        let (low, high) = (center - by, center + by);
        let (first, last) = (lattice.grid.cell(low), lattice.grid.cell(high));
        // A node beyond, for what rounding does.
        let low_node = first.map(|k| k - 1);
        let [width, height] = [0, 1].map(|axis| (last[axis] - low_node[axis]) as usize + 3);
        let mut doing = vec![[0.0; 8]; width * height];
        for (node, place) in lattice.grid.nodes_around(low, high) {
            let [column, row] = [0, 1].map(|axis| (place[axis] - low_node[axis]) as usize);
            if column < width && row < height {
                let (u, v, a) = (motion.displacement(node), motion.velocity(node), motion.acceleration(node));
                doing[row * width + column] = [u.x, u.y, v.x, v.y, a.x, a.y, 0.0, 0.0];
            }
        }
        Self { low: low_node, width, doing }
    }
}

/// Reads particles that no crack cuts.
struct Reading<'a, T> {
    around: Around,
    stencils: Vec<Stencil>,
    whole: &'a [Whole],
    taking: &'a mut T,
}

impl<T: Taking> Loop for Reading<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        match self.stencils.first().map_or(0, |stencil| stencil.width) {
            2 => self.read::<2>(),
            3 => self.read::<3>(),
            _ => self.read::<4>(),
        }
    }
}

impl<T: Taking> Reading<'_, T> {
    /// Of a kernel that reaches `N` nodes along an axis.
    #[inline(always)]
    fn read<const N: usize>(&mut self) {
        let Self { around: Around { low, width, doing }, stencils, whole, taking } = self;
        for &Whole { slot, place: [column, row] } in *whole {
            let (x, y) = (&stencils[column], &stencils[row]);
            let at = (y.first[1] - low[1]) as usize * *width + (x.first[0] - low[0]) as usize;
            let (mut sums, mut slopes) = ([0.0; 8], [[0.0; 4]; 2]);
            for b in 0..N {
                let of_row = &doing[at + b * *width..][..N];
                for a in 0..N {
                    let (of_node, w) = (&of_row[a], x.weight[0][a] * y.weight[1][b]);
                    let slope = [x.gradient[0][a] * y.weight[1][b], x.weight[0][a] * y.gradient[1][b]];
                    for k in 0..8 {
                        sums[k] += of_node[k] * w;
                    }
                    for k in 0..4 {
                        slopes[0][k] += of_node[k] * slope[0];
                        slopes[1][k] += of_node[k] * slope[1];
                    }
                }
            }
            let [by_x, by_y] = slopes;
            let strain = Matrix::new(by_x[0], by_y[0], by_x[1], by_y[1]);
            let rates = ParticleRates {
                displacement: Vector::new(sums[0], sums[1]),
                velocity: Vector::new(sums[2], sums[3]),
                velocity_gradient: Matrix::new(by_x[2], by_y[2], by_x[3], by_y[3]),
                acceleration: Vector::new(sums[4], sums[5]),
            };
            taking.take(slot, strain, rates);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::crack::cracks::Cracks;
    use crate::particles::Particles;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use crate::total::Total;
    use fissure_scene::{Formulation, Kernel};
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        /// Truth: the reader that fetches the nodes of each particle anew. Every kernel, discs that reach beyond the
        /// body, beside a crack.
        #[test]
        fn a_disc_is_read_as_its_particles_are_one_by_one(
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic]),
            center in [-0.2_f64..1.9, -0.2_f64..1.3], radius in 0.05_f64..0.9, end in [0.3_f64..1.2, 0.3_f64..0.8], seed in 0_u64..1000,
        ) {
            let mut scene = free_body(rectangle([0.0, 0.0], [1.7, 1.1]), 0.05);
            (scene.solver.formulation, scene.solver.kernel) = (Formulation::Total, kernel);
            add_crack(&mut scene, &[[-0.1, 0.5], end]);
            let particles = Arc::new(Particles::fill(&scene).unwrap());
            let mut total = Total::new(&scene, particles, &Cracks::of_scene(&scene)).unwrap();
            let mut state = seed;
            let mut number = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            };
            let motion = &mut total.motion;
            motion.displacement.iter_mut().chain(&mut motion.velocity).flatten().for_each(|x| *x = number());
            motion.kick(&total.lattice.inverse_mass, Vector::new(0.3, -1.0), 0.1, 1e-3);
            let (lattice, motion) = (&total.lattice, &total.motion);
            let center = Point::from(center);
            let mut reader = lattice.reader();
            let within = |p: &usize| (lattice.particles.rest[*p] - center).norm_squared() < radius * radius;
            let one_by_one: Vec<Found> = (0..lattice.particles.len()).filter(within).map(|p| {
                let (strain, rates) = reader.strain_and_rates(p, motion);
                (p, strain, rates)
            }).collect();
            let found = particles_of_disc(lattice, motion, 0, (center, radius));
            prop_assert_eq!(format!("{:?}", found), format!("{:?}", one_by_one));
        }
    }
}
