//! What a scene is made of, counted before any of it is laid, and what a formulation makes of it.

use crate::grid::kernel;
use fissure_plane::{Point, polyline_length};
use fissure_scene::Scene;

/// What a scene is made of, as numbers, before any of it is laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Amounts {
    /// Particles of all bodies.
    pub(crate) particles: f64,
    /// Nodes of the grid.
    pub(crate) nodes: f64,
    /// Vertices of all outlines, half a cell apart.
    pub(crate) outline_points: f64,
    /// Particles that do not lie in whole cells: along the outlines, and within reach of cracks.
    pub(crate) cut_particles: f64,
    /// Of these, those within reach of cracks.
    pub(crate) crack_particles: f64,
    /// Cells within reach of cracks.
    pub(crate) crack_cells: f64,
    /// Length by which cracks are expected to grow, in cells.
    pub(crate) grown_cells: f64,
}

/// What a formulation of the solver holds [bytes].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Need {
    /// While it runs.
    pub(crate) solver: f64,
    /// Its state as bytes.
    pub(crate) state: f64,
}

/// Rows of nodes beside an outline that no inner cell accounts for: what stencils reach beyond it, and what bands and
/// spans hold besides.
const ROWS_BESIDE_OUTLINE: f64 = 5.0;

impl Amounts {
    /// Counts what `scene` is made of, in a time that goes with its outlines. `growth`: length by which its cracks are
    /// expected to grow [m].
    pub(crate) fn of(scene: &Scene, growth: f64) -> Self {
        let (s, h) = (scene.particle_spacing, scene.cell_size);
        let area: f64 = scene.bodies.iter().map(|b| b.region.area()).sum();
        let ring_length = |ring: &[Point]| polyline_length(ring) + (ring[ring.len() - 1] - ring[0]).norm();
        let rings = scene.bodies.iter().flat_map(|b| b.region.rings()).filter(|ring| !ring.is_empty());
        let outline: f64 = rings.map(ring_length).sum();
        let reach = 0.5 * kernel::width(scene.solver.kernel) as f64;
        let segments = scene.cracks.iter().flat_map(|c| c.points.windows(2));
        let crack_cells: f64 = segments.map(|w| cells_around(w[0], w[1], h, reach)).sum();
        let particles = area / (s * s);
        let crack_particles = (crack_cells * (h / s).powi(2)).min(particles);
        Self {
            particles,
            nodes: area / (h * h) + ROWS_BESIDE_OUTLINE * outline / h,
            outline_points: 2.0 * outline / h,
            cut_particles: (outline / s + crack_particles).min(particles),
            crack_particles,
            crack_cells,
            grown_cells: growth / h,
        }
    }
}

/// Pieces of a crack, in cells, that get a box of their own when the cells around it are counted.
const PIECE: f64 = 16.0;

/// How many cells lie in boxes around the pieces of a segment that leave `reach` cells on all sides: more than the
/// crack divides now, as much as its lists take while they are laid.
fn cells_around(a: Point, b: Point, cell_size: f64, reach: f64) -> f64 {
    let pieces = ((b - a).amin() / (PIECE * cell_size)).ceil().max(1.0);
    let along = (b - a).abs() / (cell_size * pieces);
    pieces * (along.x + 2.0 * reach + 1.0) * (along.y + 2.0 * reach + 1.0)
}
