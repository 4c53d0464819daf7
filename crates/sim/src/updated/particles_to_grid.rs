//! From the particles to the grid.
//!
//! Particles go to the grid by bands of rows of nodes. A band and the one its particles reach above it lie in one piece
//! of memory, and the pieces of every other band do not touch: all even bands at once, then all odd ones. The order of
//! additions at a node is then the same for any number of threads.

use super::lattice::Lattice;
use super::nodes::Nodes;
use super::points::Points;
use super::setup::Setup;
use super::shares::{BATCH, Carried, Shares};
use crate::grid::walker::Walker;
use crate::grid::{kernel, pieces};
use crate::threads::prelude::*;
use crate::wide::{Loop, run_widest};
use fissure_scene::Vector;

/// What goes to the grid.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToGrid<'a> {
    pub(super) setup: &'a Setup,
    pub(super) points: &'a Points,
    pub(super) lattice: &'a Lattice,
}

/// The nodes that the particles of one band reach.
pub(super) struct Piece<'a> {
    /// Index of the band.
    band: usize,
    /// Its first node.
    start: usize,
    mass: &'a mut [f64],
    momentum: [&'a mut [f64]; 2],
    force: [&'a mut [f64]; 2],
}

impl Piece<'_> {
    /// Adds mass, momentum and force, along x and y each, to the nodes from `node` on.
    #[inline(always)]
    pub(super) fn add<const L: usize>(&mut self, node: usize, [mass, px, py, fx, fy]: &[[f64; L]; 5]) {
        let at = node - self.start;
        add(self.mass, at, mass);
        let ([own_px, own_py], [own_fx, own_fy]) = (&mut self.momentum, &mut self.force);
        add(own_px, at, px);
        add(own_py, at, py);
        add(own_fx, at, fx);
        add(own_fy, at, fy);
    }
}

/// The same, for the momentum alone.
struct MomentumPiece<'a> {
    band: usize,
    start: usize,
    momentum: [&'a mut [f64]; 2],
}

/// The first `L` of all weights; those from the width of the kernel on are 0.
#[inline(always)]
pub(super) fn first<const L: usize>(all: &[f64; kernel::MAX_WIDTH]) -> [f64; L] {
    std::array::from_fn(|a| all[a])
}

/// From a particle at `place` to node `a` of its stencil along one axis, or to one beyond it [m].
#[inline(always)]
pub(super) fn arm(first: i32, a: usize, origin: f64, cell_size: f64, place: f64) -> f64 {
    (origin - place) + f64::from(first + a as i32) * cell_size
}

/// The same for each node.
#[inline(always)]
pub(super) fn arms<const L: usize>(first: i32, origin: f64, cell_size: f64, place: f64) -> [f64; L] {
    std::array::from_fn(|a| arm(first, a, origin, cell_size, place))
}

/// Adds `added` to the numbers from `at` on. What is beyond the stencil is 0, and may be beyond the last node.
#[inline(always)]
fn add<const L: usize>(values: &mut [f64], at: usize, added: &[f64; L]) {
    let values = &mut values[at..];
    match values.first_chunk_mut::<L>() {
        Some(values) => {
            for a in 0..L {
                values[a] += added[a];
            }
        }
        None => add_first(values, *added),
    }
}

/// Adds as many as there is room for. On its own, so that elsewhere what is added need not be in memory.
#[cold]
#[inline(never)]
fn add_first<const L: usize>(values: &mut [f64], added: [f64; L]) {
    values.iter_mut().zip(added).for_each(|(value, added)| *value += added);
}

/// The particles of one band that no crack divides, for a kernel of `W` nodes along an axis, `L` numbers side by side.
struct Band<'a, 'p, const W: usize, const L: usize, const AFFINE: bool> {
    to: ToGrid<'a>,
    piece: &'a mut Piece<'p>,
}

impl<const W: usize, const L: usize, const AFFINE: bool> Loop for Band<'_, '_, W, L, AFFINE> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let ToGrid { setup, points, lattice } = self.to;
        band_to_grid::<W, L, AFFINE>(setup, points, lattice, self.piece);
    }
}

/// Runs a [`Band`]. As arguments of their own the parts are known not to overlap the piece, so that what is read from
/// them need not be read again after each addition.
#[inline(always)]
fn band_to_grid<const W: usize, const L: usize, const AFFINE: bool>(
    setup: &Setup,
    points: &Points,
    lattice: &Lattice,
    piece: &mut Piece<'_>,
) {
    let mut walker = Walker::new(&lattice.grid);
    let (mut carried, mut shares) = (Carried::NONE, Shares::<W, L>::NONE);
    for particles in lattice.particles_of_band(piece.band).chunks(BATCH) {
        let mut count = 0;
        for &p in particles {
            if lattice.stencils.of(p as usize).is_none() {
                carried.put::<AFFINE>(count, setup, points, p as usize);
                count += 1;
            }
        }
        shares.fill::<AFFINE>(&carried, lattice);
        shares.send::<AFFINE>(count, &mut walker, piece);
    }
}

impl ToGrid<'_> {
    /// Mass, momentum and the forces of the stresses (thesis eq. 2, 5): afterwards `mass`, `before` and `after` of
    /// `nodes` hold these sums.
    pub(super) fn send(&self, nodes: &mut Nodes) {
        match kernel::width(self.lattice.kernel) {
            2 => self.all_bands::<2, 2>(nodes),
            3 => self.all_bands::<3, 4>(nodes),
            _ => self.all_bands::<4, 4>(nodes),
        }
        self.divided_to_grid(nodes);
    }

    fn all_bands<const W: usize, const L: usize>(&self, nodes: &mut Nodes) {
        for parity in 0..2 {
            let bands = self.lattice.bands(parity);
            let ranges = || bands.clone().map(|(_, nodes)| nodes);
            let [px, py] = &mut nodes.before;
            let [fx, fy] = &mut nodes.after;
            let mut all: Vec<Piece<'_>> = pieces(&mut nodes.mass, ranges())
                .zip(pieces(px, ranges()))
                .zip(pieces(py, ranges()))
                .zip(pieces(fx, ranges()))
                .zip(pieces(fy, ranges()))
                .zip(bands.clone())
                .map(|(((((mass, px), py), fx), fy), (band, nodes))| Piece {
                    band,
                    start: nodes.start,
                    mass,
                    momentum: [px, py],
                    force: [fx, fy],
                })
                .collect();
            let to = *self;
            let run = |piece: &mut Piece<'_>| match self.points.affine.is_empty() {
                true => run_widest(Band::<W, L, false> { to, piece }),
                false => run_widest(Band::<W, L, true> { to, piece }),
            };
            if self.setup.is_parallel() {
                all.par_iter_mut().for_each(run);
            } else {
                all.iter_mut().for_each(run);
            }
        }
    }

    /// The same for the particles that cracks divide.
    fn divided_to_grid(&self, nodes: &mut Nodes) {
        for (p, entries) in self.lattice.stencils.iter() {
            let point = &self.points.point[p];
            let m = self.setup.particles.mass[p];
            let tension = self.points.stress_times_volume(self.setup, p, point);
            let affine = self.points.affine.get(p);
            for e in entries {
                let d = e.field as usize;
                let v = affine.map_or(point.velocity, |c| point.velocity + c * self.lattice.arm(e, point.position));
                let force = tension * e.gradient;
                nodes.mass[d] += m * e.weight;
                for axis in 0..2 {
                    nodes.before[axis][d] += m * e.weight * v[axis];
                    nodes.after[axis][d] -= force[axis];
                }
            }
        }
    }

    /// Mean of the `velocities` of the particles at each field of the given `mass`.
    pub(super) fn mean(&self, velocities: &[Vector], mass: &[f64]) -> [Vec<f64>; 2] {
        let mut momentum = [vec![0.0; mass.len()], vec![0.0; mass.len()]];
        for parity in 0..2 {
            let bands = self.lattice.bands(parity);
            let ranges = || bands.clone().map(|(_, nodes)| nodes);
            let [px, py] = &mut momentum;
            let mut all: Vec<MomentumPiece<'_>> = pieces(px, ranges())
                .zip(pieces(py, ranges()))
                .zip(bands.clone())
                .map(|((px, py), (band, nodes))| MomentumPiece { band, start: nodes.start, momentum: [px, py] })
                .collect();
            let run = |piece: &mut MomentumPiece<'_>| self.band_momentum(velocities, piece);
            if self.setup.is_parallel() {
                all.par_iter_mut().for_each(run);
            } else {
                all.iter_mut().for_each(run);
            }
        }
        for (p, entries) in self.lattice.stencils.iter() {
            for e in entries {
                let v = velocities[p];
                let m = self.setup.particles.mass[p] * e.weight;
                momentum[0][e.field as usize] += m * v.x;
                momentum[1][e.field as usize] += m * v.y;
            }
        }
        for values in &mut momentum {
            for (v, m) in values.iter_mut().zip(mass) {
                *v = if *m > 0.0 { *v / m } else { 0.0 };
            }
        }
        momentum
    }

    fn band_momentum(&self, velocities: &[Vector], piece: &mut MomentumPiece<'_>) {
        let [px, py] = &mut piece.momentum;
        let mut walker = Walker::new(&self.lattice.grid);
        for &p in self.lattice.particles_of_band(piece.band) {
            let p = p as usize;
            if self.lattice.stencils.of(p).is_some() {
                continue;
            }
            let stencil = self.lattice.stencil(self.points.point[p].position);
            let Some(rows) = walker.rows(stencil.first, stencil.width) else { continue };
            for b in 0..stencil.width {
                let at = rows[b] - piece.start;
                for a in 0..stencil.width {
                    let v = velocities[p];
                    let mw = self.setup.particles.mass[p] * stencil.weight(a, b);
                    px[at + a] += mw * v.x;
                    py[at + a] += mw * v.y;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide::run_in_all;
    use fissure_plane::Point;
    use fissure_scene::Kernel;

    /// The bands of a grid, one after the other, into one list each of mass, momentum and force.
    struct AllBands<'a>(ToGrid<'a>);

    impl Loop for AllBands<'_> {
        type Output = Vec<f64>;

        #[inline(always)]
        fn run(self) -> Vec<f64> {
            let ToGrid { setup, points, lattice } = self.0;
            let mut sums = [(); 5].map(|()| vec![0.0; lattice.grid.len()]);
            let [mass, px, py, fx, fy] = sums.each_mut().map(Vec::as_mut_slice);
            let mut piece = Piece { band: 0, start: 0, mass, momentum: [px, py], force: [fx, fy] };
            for band in 0..lattice.grid.bands() {
                piece.band = band;
                match lattice.kernel {
                    Kernel::Bilinear => band_to_grid::<2, 2, true>(setup, points, lattice, &mut piece),
                    Kernel::Gimp | Kernel::Quadratic => {
                        band_to_grid::<3, 4, true>(setup, points, lattice, &mut piece);
                    }
                    Kernel::Cubic => band_to_grid::<4, 4, true>(setup, points, lattice, &mut piece),
                }
            }
            sums.concat()
        }
    }

    /// Truth: the instructions that every machine has, and of the mass the sum over all weights.
    #[test]
    fn all_instructions_send_the_same_bits() {
        for kernel in [Kernel::Bilinear, Kernel::Gimp, Kernel::Quadratic, Kernel::Cubic] {
            let (setup, points, lattice) = super::super::tests::shaken(kernel);
            let to = ToGrid { setup: &setup, points: &points, lattice: &lattice };
            let found = run_in_all(|| AllBands(to));
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            for (name, sums) in &found[1..] {
                assert!(bits(sums) == bits(&found[0].1), "{name}, {kernel:?}");
            }
            let mut mass = vec![0.0; lattice.grid.len()];
            for (p, point) in points.point.iter().enumerate() {
                let place: Point = point.position;
                lattice.for_each_entry(p, place, |node, weight| mass[node] += setup.particles.mass[p] * weight);
            }
            let most = mass.iter().fold(0.0, |a: f64, m| a.max(*m));
            let off = mass.iter().zip(&found[0].1).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-14 * most, "{kernel:?}: {off} of {most}");
        }
    }
}
