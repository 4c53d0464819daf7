//! Where particles are: the box around them and the lowest node of each.

use super::lattice::Lattice;
use super::points::MaterialPoint;
use crate::grid::kernel;
use crate::grid::walker::Walker;
use crate::wide::Loop;
use fissure_scene::{Kernel, Point};

/// Particles that one task looks at.
pub(super) const PART: usize = 4096;

/// Where particles are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Survey {
    /// The box around them [m].
    pub(super) low: Point,
    pub(super) high: Point,
    /// Whether the grid has all nodes that they reach.
    pub(super) has_nodes: bool,
    /// Whether any of them has another lowest node than before.
    pub(super) has_changed: bool,
}

impl Survey {
    /// Of no particle.
    pub(super) const NONE: Self = Self {
        low: Point::new(f64::INFINITY, f64::INFINITY),
        high: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
        has_nodes: true,
        has_changed: false,
    };

    /// Of the particles of both.
    pub(super) fn with(self, other: Self) -> Self {
        Self {
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
            has_nodes: self.has_nodes && other.has_nodes,
            has_changed: self.has_changed || other.has_changed,
        }
    }
}

/// Particles of a survey whose places are looked at side by side.
const SIDE_BY_SIDE: usize = 16;

/// A part of the particles while their lowest nodes are found.
pub(super) struct SurveyOfPart<'a> {
    pub(super) lattice: &'a Lattice,
    pub(super) points: &'a [MaterialPoint],
    /// Where their lowest nodes are, and their numbers.
    pub(super) places: &'a mut [[i32; 2]],
    pub(super) nodes: &'a mut [u32],
}

impl Loop for SurveyOfPart<'_> {
    type Output = Survey;

    #[inline(always)]
    fn run(self) -> Survey {
        // Known where the loop is compiled, the kernel takes no branches in it.
        match self.lattice.kernel {
            Kernel::Bilinear => self.run_by(Kernel::Bilinear),
            Kernel::Gimp => self.run_by(Kernel::Gimp),
            Kernel::Quadratic => self.run_by(Kernel::Quadratic),
            Kernel::Cubic => self.run_by(Kernel::Cubic),
        }
    }
}

impl SurveyOfPart<'_> {
    #[inline(always)]
    fn run_by(self, kernel: Kernel) -> Survey {
        let Self { lattice, points, places, nodes } = self;
        let is_of_grid = lattice.order.is_of_grid();
        let (mut survey, mut walker) = (Survey::NONE, Walker::new(&lattice.grid));
        let (mut low, mut high) = ([[f64::INFINITY; SIDE_BY_SIDE]; 2], [[f64::NEG_INFINITY; SIDE_BY_SIDE]; 2]);
        let (mut at, mut lowest) = ([[0.0; SIDE_BY_SIDE]; 2], [[0; SIDE_BY_SIDE]; 2]);
        let parts = points.chunks(SIDE_BY_SIDE).zip(places.chunks_mut(SIDE_BY_SIDE));
        for ((points, places), nodes) in parts.zip(nodes.chunks_mut(SIDE_BY_SIDE)) {
            for k in 0..SIDE_BY_SIDE {
                // Those that are missing are where the last one is.
                let point = points[k.min(points.len() - 1)].position;
                (at[0][k], at[1][k]) = (point.x, point.y);
            }
            for axis in 0..2 {
                for k in 0..SIDE_BY_SIDE {
                    lowest[axis][k] = lattice.axis_stencil(kernel, axis, at[axis][k]).first;
                    low[axis][k] = low[axis][k].min(at[axis][k]);
                    high[axis][k] = high[axis][k].max(at[axis][k]);
                }
            }
            let mut moved = 0;
            for (k, place) in places.iter().enumerate() {
                moved |= (place[0] ^ lowest[0][k]) | (place[1] ^ lowest[1][k]);
            }
            if is_of_grid && moved == 0 {
                continue;
            }
            for (k, (place, node)) in places.iter_mut().zip(nodes).enumerate() {
                *place = [lowest[0][k], lowest[1][k]];
                match walker.lowest_node(*place, kernel::width(kernel)) {
                    Some(now) => {
                        survey.has_changed |= *node != now as u32;
                        *node = now as u32;
                    }
                    None => survey.has_nodes = false,
                }
            }
        }
        for k in 0..SIDE_BY_SIDE {
            survey.low = survey.low.inf(&Point::new(low[0][k], low[1][k]));
            survey.high = survey.high.sup(&Point::new(high[0][k], high[1][k]));
        }
        survey
    }
}
