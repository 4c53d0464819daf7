//! The lattice: nodes, particles, and what weight every particle has at every field. It changes only where a crack
//! grows.

use super::cut::CutParticles;
use super::riders::Riders;
use super::run::Run;
use crate::SimulationError;
use crate::crack::changes::Changes;
use crate::crack::cracks::Cracks;
use crate::crack::division::{Around, Division, Shares, TipCut};
use crate::grid::Grid;
use crate::grid::fields::Fields;
use crate::grid::kernel::{self, Stencil};
use crate::grid::owners::Owners;
use crate::grid::walker::Walker;
use crate::material::elastic::Elastic;
use crate::particles::Particles;
use crate::saved::{self, Fits};
use fissure_plane::Point;
use fissure_scene::{Kernel, Scene, TipDivision};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Nodes and particles at rest, divided by the cracks.
#[derive(Debug)]
pub(super) struct Lattice {
    /// The nodes.
    pub(super) grid: Grid,
    /// The particles at rest.
    pub(super) particles: Arc<Particles>,
    /// The materials of the scene.
    pub(super) materials: Vec<Elastic>,
    /// The cracks as they divide pairs of a particle and a node.
    pub(super) division: Division,
    /// How particles see nodes now.
    pub(super) layout: Layout,
    /// Nodes that several bodies see.
    pub(super) owners: Owners,
    /// Body of each crack.
    pub(super) body_of_crack: Vec<u32>,
    /// Mass of the lightest particle [kg/m].
    pub(super) least_mass: f64,
    /// One over the mass of each field [m/kg]; zero where there is none.
    pub(super) inverse_mass: Vec<f64>,
    /// Particles that were cut anew last.
    pub(super) recut: Vec<usize>,
    /// Nodes of which a field has got mass, or has lost all, since this was last asked for.
    pub(super) turned: Vec<usize>,
    kernel: Kernel,
    tip_division: TipDivision,
    /// How far ahead of a tip nodes are split, in cells.
    split_ahead: f64,
}

/// What of a lattice depends on how its cracks came to be where they are.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Layout {
    /// Fields at nodes.
    pub(super) fields: Fields,
    /// Mass of each field [kg/m].
    pub(super) mass: Vec<f64>,
    /// Particles on the general path with their stencils.
    pub(super) cut: CutParticles,
    /// What of particles on the general path lies on the other side of a crack than where they stand.
    pub(super) far: CutParticles,
    /// Runs of uncut cells above each row of nodes.
    pub(super) runs: Vec<Vec<Run>>,
    /// Particles that ride on others: see [`super::riders`].
    pub(super) riders: Riders,
}

/// What [`Lattice::may_have_changed`] has told, and of which cell and nodes. Places that follow each other mostly share
/// theirs.
#[derive(Debug)]
pub(super) struct LastTold {
    of: ((i64, i64), Point, Point),
    may_have_changed: bool,
}

impl Lattice {
    /// The nodes and particles of `scene`, not yet cut: see [`Lattice::cut_all`]. Nodes are split `split_ahead` cells
    /// ahead of a tip.
    ///
    /// # Errors
    /// When the bodies reach too far to count their cells.
    pub(super) fn new(scene: &Scene, particles: Arc<Particles>, split_ahead: f64) -> Result<Self, SimulationError> {
        let (mut low, mut high) = fissure_plane::bounds(&[]);
        for body in &scene.bodies {
            let (l, h) = body.region.bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        let kernel = kernel_of(scene);
        // The wider kernels reach one node beyond the cell.
        let margin = if kernel::width(kernel) == 2 { 0 } else { 1 };
        let empty = Grid::around(particles.anchor, low, high, scene.cell_size, margin)
            .ok_or(SimulationError::TooWide { width: (high - low).amax(), cell_size: scene.cell_size })?;
        let mut grid = empty.clone();
        let lowest = particles.rest.iter().map(|&place| stencil(kernel, particles.spacing, &empty, place).first);
        grid.lay(lowest, kernel::width(kernel), 0);
        let (tip_division, cut) = (scene.solver.tip_division, TipCut::tied(split_ahead));
        let layout = Layout {
            fields: Fields::new(grid.len()),
            mass: vec![0.0; grid.len()],
            cut: CutParticles::new(particles.len()),
            far: CutParticles::new(particles.len()),
            runs: vec![Vec::new(); grid.rows()],
            riders: Riders::default(),
        };
        let owners =
            if scene.bodies.len() > 1 { owners_of_nodes(kernel, &grid, &particles) } else { Owners::default() };
        Ok(Self {
            grid,
            least_mass: particles.mass.iter().copied().fold(f64::INFINITY, f64::min),
            particles,
            owners,
            body_of_crack: Vec::new(),
            materials: scene.materials.iter().map(|m| Elastic::new(m, scene.plane)).collect(),
            division: Division::new(
                Vec::new(),
                tip_division,
                cut,
                scene.cell_size,
                scene.particle_spacing,
                kernel::reach(kernel),
            ),
            layout,
            inverse_mass: Vec::new(),
            recut: Vec::new(),
            turned: Vec::new(),
            kernel,
            tip_division,
            split_ahead,
        })
    }

    /// Divides pairs by `cracks` from now on. Returns what has changed.
    pub(super) fn set_cracks(&mut self, cracks: &Cracks) -> Changes {
        let reach = self.reach() * self.grid.cell_size;
        let changes = self.division.follow(cracks.len(), |index, before| cracks.changed_line(index, before, reach));
        self.body_of_crack.clear();
        self.body_of_crack.extend(cracks.iter().map(|crack| crack.body));
        changes
    }

    /// The box from the lowest to the highest of the nodes that a particle at `place` sees.
    pub(super) fn nodes_seen_from(&self, place: Point) -> (Point, Point) {
        let Stencil { first, width, .. } = self.stencil(place);
        let last = first.map(|k| k.saturating_add(width as i32 - 1));
        (self.grid.place(first), self.grid.place(last))
    }

    /// Whether pairs of `place`, told a hair beside it at `nudged`, may be divided otherwise than before `changes`.
    /// `last`: what was told last.
    pub(super) fn may_have_changed(
        &self,
        changes: &Changes,
        place: Point,
        nudged: Point,
        last: &mut Option<LastTold>,
    ) -> bool {
        let (low, high) = self.nodes_seen_from(place);
        let of = (self.division.key(nudged), low.inf(&nudged), high.sup(&nudged));
        if let Some(last) = last.as_ref().filter(|last| last.of == of) {
            return last.may_have_changed;
        }
        let may_have_changed = self.division.may_have_changed(changes, nudged, of.1, of.2);
        *last = Some(LastTold { of, may_have_changed });
        may_have_changed
    }

    /// The shares of a pair of `place`, which belongs to `body`, and a node at `node`. A crack goes on beyond its
    /// mouth, where another body may lie that it does not cut.
    pub(super) fn shares(&self, body: u32, place: Point, node: Point) -> Shares {
        self.of_body(body, self.division.pair(place, node))
    }

    /// As [`Lattice::shares`], `around` being what may divide pairs of the place.
    pub(super) fn shares_of(&self, body: u32, around: &Around<'_>, node: Point) -> Shares {
        self.of_body(body, around.pair(node))
    }

    /// What is left of `shares` without the cracks of other bodies.
    fn of_body(&self, body: u32, shares: Shares) -> Shares {
        let is_own = |crack: u32| self.body_of_crack[crack as usize] == body;
        if shares.iter().all(|share| share.crossed.iter().all(|&(crack, _)| is_own(crack))) {
            return shares;
        }
        let mut own = Shares::new();
        for mut share in shares {
            share.crossed.retain(|&mut (crack, _)| is_own(crack));
            match own.iter_mut().find(|other| other.crossed == share.crossed) {
                Some(other) => {
                    other.fraction += share.fraction;
                    other.gradient += share.gradient;
                }
                None => own.push(share),
            }
        }
        own
    }

    /// Whether a crack of `body` lies between two places of it.
    pub(super) fn is_across(&self, body: u32, from: Point, to: Point) -> bool {
        self.division.crossed(from, to).iter().any(|&(crack, _)| self.body_of_crack[crack as usize] == body)
    }

    /// The material of a particle.
    pub(super) fn material(&self, particle: usize) -> &Elastic {
        &self.materials[self.particles.material[particle] as usize]
    }

    /// Time that the fastest wave takes for a cell [s].
    pub(super) fn crossing_time(&self) -> f64 {
        let fastest = self.materials.iter().map(Elastic::dilatational_wave_speed).fold(0.0, f64::max);
        self.grid.cell_size / fastest
    }

    /// How far ahead of a tip nodes are split, in cells.
    pub(super) fn split_ahead(&self) -> f64 {
        self.split_ahead
    }

    /// Whether ties hold the two sides of the nodes around a tip together.
    pub(super) fn has_ties(&self) -> bool {
        self.tip_division == TipDivision::PartlyCut
    }

    /// Whether uncut cells can go as rows.
    pub(super) fn has_rows(&self) -> bool {
        self.kernel == Kernel::Bilinear
            && (self.grid.cell_size - 2.0 * self.particles.spacing).abs() < 1e-12 * self.grid.cell_size
    }

    /// How far a particle sees nodes along an axis, in cells.
    pub(super) fn reach(&self) -> f64 {
        kernel::reach(self.kernel)
    }

    /// The weights of a place at the nodes around it.
    pub(super) fn stencil(&self, place: Point) -> kernel::Stencil {
        stencil(self.kernel, self.particles.spacing, &self.grid, place)
    }

    /// The fields at nodes.
    pub(super) fn fields(&self) -> &Fields {
        &self.layout.fields
    }

    /// Mass of each field [kg/m].
    pub(super) fn mass(&self) -> &[f64] {
        &self.layout.mass
    }

    /// Number of fields.
    pub(super) fn field_count(&self) -> usize {
        self.layout.fields.len()
    }

    /// Where the node of a field is at rest [m].
    pub(super) fn position(&self, field: usize) -> Point {
        self.grid.position(self.layout.fields.node(field))
    }

    /// Where the node of each field is on the lattice.
    pub(super) fn places_of_fields(&self) -> impl Iterator<Item = [i32; 2]> {
        let further = self.grid.len()..self.field_count();
        let own = self.grid.nodes().map(|(_, place)| place);
        own.chain(further.map(|field| self.grid.place_of(self.layout.fields.node(field))))
    }

    /// Goes on with a layout that was checked.
    pub(super) fn set_layout(&mut self, layout: Layout) {
        self.layout = layout;
        self.invert_masses();
    }

    /// The fields of a node that have mass, its own first.
    pub(super) fn fields_with_mass(&self, node: usize) -> Vec<u32> {
        let all = std::iter::once(node as u32).chain(self.layout.fields.of(node).iter().copied());
        all.filter(|&field| self.layout.mass[field as usize] > 0.0).collect()
    }

    /// Makes what follows from the masses of the fields.
    pub(super) fn invert_masses(&mut self) {
        self.inverse_mass.clear();
        self.inverse_mass.extend(self.layout.mass.iter().map(|&m| if m > 0.0 { 1.0 / m } else { 0.0 }));
    }

    /// As [`Lattice::invert_masses`], of fields the masses of which have changed, and of new ones.
    pub(super) fn invert_masses_of(&mut self, fields: impl Iterator<Item = u32>) {
        let inverse = |m: f64| if m > 0.0 { 1.0 / m } else { 0.0 };
        let new = &self.layout.mass[self.inverse_mass.len()..];
        self.inverse_mass.extend(new.iter().map(|&m| inverse(m)));
        for field in fields {
            self.inverse_mass[field as usize] = inverse(self.layout.mass[field as usize]);
        }
    }

    /// Checks a layout that was read against this lattice, with so many `cracks`.
    ///
    /// # Errors
    /// [`SimulationError::BadState`]
    pub(super) fn check(&self, layout: &Layout, cracks: usize) -> Fits {
        let fields = layout.fields.len();
        let bodies = self.particles.body.last().map_or(0, |&last| last as usize + 1);
        layout.fields.check(self.grid.len(), bodies, cracks)?;
        saved::ensure(layout.mass.len() == fields, "its number of fields")?;
        saved::finite("a field", &layout.mass)?;
        layout.cut.check(self.particles.len(), fields)?;
        layout.far.check(self.particles.len(), fields)?;
        layout.riders.check(self.particles.len())?;
        saved::ensure(layout.runs.len() == self.grid.rows(), "its number of rows")?;
        for (index, runs) in layout.runs.iter().enumerate() {
            let row = self.grid.row(index);
            let above = self.grid.row_index(row.row + 1).map_or(0..0, |above| self.grid.row(above).nodes);
            saved::ensure(runs.iter().all(|run| run.lies_in(&row.nodes, &above)), "a run of cells")?;
        }
        saved::below("a run of cells", layout.runs.iter().flatten().map(|run| run.material), self.materials.len())
    }
}

/// The nodes of `grid` that particles of several bodies see.
fn owners_of_nodes(kernel: Kernel, grid: &Grid, particles: &Particles) -> Owners {
    Owners::new(grid.len(), |see| {
        let mut walker = Walker::new(grid);
        for (&body, &place) in particles.body.iter().zip(&particles.rest) {
            let stencil = stencil(kernel, particles.spacing, grid, place);
            // All nodes of a particle exist.
            let Some(rows) = walker.rows(stencil.first, stencil.width) else { continue };
            for row in &rows[..stencil.width] {
                (*row..row + stencil.width).for_each(|node| see(body, node));
            }
        }
    })
}

/// The kernel that particles at rest see.
///
/// The domains of particles on the lattice, a whole number of them along a cell, each lie in one cell. The mean of
/// a hat over such a domain is the hat at its middle: GIMP is the bilinear kernel. Told from it only by round-off in
/// where domains end, it would have nodes with a mass of 1e-32 particles beyond every edge, and particles that nothing
/// holds beside cracks.
pub(super) fn kernel_of(scene: &Scene) -> Kernel {
    match scene.solver.kernel {
        Kernel::Gimp => Kernel::Bilinear,
        other => other,
    }
}

fn stencil(kernel: Kernel, spacing: f64, grid: &Grid, place: Point) -> kernel::Stencil {
    let x = grid.in_cells(place);
    let half_size = 0.5 * spacing / grid.cell_size;
    kernel::Stencil::new(kernel, half_size, [x.x, x.y], 1.0 / grid.cell_size)
}
