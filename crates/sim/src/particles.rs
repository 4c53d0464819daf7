//! Laying particles into bodies, and picking some of them.

use crate::SimulationError;
use crate::boundary::selector::Selector;
use crate::grid::coverage::Cover;
use crate::grid::scan::Places;
use crate::grid::spans::{Span, SpanRows};
use crate::loose;
use crate::solver::Snapshot;
use crate::threads;
use fissure_plane::{Matrix, Point, Vector, bounds};
use fissure_scene::{KeyPath, ParticleFrame, Scene, SceneFault, Selection};
use std::collections::BTreeMap;
use std::ops::Range;

/// The particles of all bodies at rest, in the order body, row, column. Shape: one entry per particle in every list.
#[derive(Debug, Clone)]
pub(crate) struct Particles {
    /// Corner from which particles are counted: the lower left of the box around all bodies [m].
    pub(crate) anchor: Point,
    /// Distance between particles s [m].
    pub(crate) spacing: f64,
    /// Column and row: the particle lies at `anchor` + s (i + ½, j + ½).
    pub(crate) place: Vec<[i32; 2]>,
    /// Rest position X_p [m].
    pub(crate) rest: Vec<Point>,
    /// Body.
    pub(crate) body: Vec<u32>,
    /// Material.
    pub(crate) material: Vec<u32>,
    /// Volume at rest per unit thickness V_p [m²]: s², but at an outline what of the body lies there.
    pub(crate) volume: Vec<f64>,
    /// Mass per unit thickness m_p [kg/m].
    pub(crate) mass: Vec<f64>,
    /// Particles whose volume is not s², rising, with the way from where they stand to the centre of it [m].
    off_center: Vec<(u32, Vector)>,
    /// Which particle stands where.
    lattice: SpanRows,
}

/// The least volume of a particle, in s²: that of one in a corner so sharp that next to nothing is there.
const LEAST_VOLUME: f64 = 1e-3;

/// Particles whose motion is on its way into a frame at once: few beside the frame, many enough to share out.
const AT_ONCE: usize = 1 << 17;

/// More places than this along an axis are not counted.
const MOST_PLACES: f64 = (1 << 30) as f64;

impl Particles {
    /// Fills the bodies of `scene` with particles on one lattice; those whose centre lies inside belong to the body,
    /// without corners that nothing holds.
    ///
    /// Together they have the volume of the body: what lies in a square without a particle goes to the one beside.
    ///
    /// # Errors
    /// When a body holds none, or the bodies reach too far to count their places.
    pub(crate) fn fill(scene: &Scene) -> Result<Self, SimulationError> {
        let (mut low, mut high) = bounds(&[]);
        for body in &scene.bodies {
            let (l, h) = body.region.bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        let s = scene.particle_spacing;
        let width = (high - low).amax();
        if width / s >= MOST_PLACES {
            return Err(SimulationError::TooWide { width, cell_size: scene.cell_size });
        }
        // Counted first, so that every list gets just the room it needs.
        let places = Places { anchor: low, spacing: s };
        let mut runs: Vec<(usize, i32, Range<i32>)> = Vec::new();
        for (index, body) in scene.bodies.iter().enumerate() {
            let mut of_body: Vec<loose::Run> = Vec::new();
            places.for_each_run_inside(&body.region, |row, columns| of_body.push((row, columns)));
            if s == 0.5 * scene.cell_size {
                loose::drop_loose(&mut of_body);
            }
            runs.extend(of_body.iter().map(|(row, columns)| (index, *row, columns.clone())));
            if of_body.is_empty() {
                let message = format!("body `{}` holds no particle at a spacing of {s} m", body.name);
                let (path, remedy) =
                    (KeyPath::item("body", index).then("shape"), "make `grid.particle_spacing` smaller");
                return Err(SceneFault::new(path, message, remedy).into());
            }
        }
        let mut particles = Self::with_room(low, s, runs.iter().map(|(_, _, columns)| columns.len()).sum());
        for (index, row, columns) in runs {
            let body = &scene.bodies[index];
            for column in columns {
                let center = places.at(column, row);
                let material = body.material_at(center);
                particles.place.push([column, row]);
                particles.rest.push(center);
                particles.body.push(index as u32);
                particles.material.push(material as u32);
                particles.volume.push(s * s);
                particles.mass.push(0.0);
            }
        }
        particles.lattice = lattice_of(&particles.place);
        let mut first = 0;
        for (index, body) in scene.bodies.iter().enumerate() {
            let count = particles.body[first..].partition_point(|&of| of as usize == index);
            particles.trim(first..first + count, &places.covers_along(&body.region), scene.cell_size / s);
            first += count;
        }
        for (p, mass) in particles.mass.iter_mut().enumerate() {
            *mass = particles.volume[p] * scene.materials[particles.material[p] as usize].density;
        }
        Ok(particles)
    }

    /// Gives the particles of a body, which are `own`, the volume of it: `covers` are the squares that its outline
    /// crosses. Cells are `side` squares wide.
    fn trim(&mut self, own: Range<usize>, covers: &[Cover], side: f64) {
        // Of each particle at the outline: part of a square, and its first moment about the middle [squares].
        let mut parts: BTreeMap<usize, (f64, Vector)> = BTreeMap::new();
        for cover in covers {
            if let Some(p) = self.at_of(&own, cover.place) {
                parts.insert(p, (cover.part, cover.center * cover.part));
            }
        }
        for cover in covers.iter().filter(|cover| self.at_of(&own, cover.place).is_none()) {
            let Some(p) = self.beside(&own, cover, side) else { continue };
            let (volume, moment) = parts.entry(p).or_insert((1.0, Vector::zeros()));
            *volume += cover.part;
            *moment += (offset(self.place[p], cover.place) + cover.center) * cover.part;
        }
        let square = self.spacing * self.spacing;
        for (p, (volume, moment)) in parts {
            self.volume[p] = square * volume.max(LEAST_VOLUME);
            self.off_center.push((p as u32, moment * (self.spacing / volume)));
        }
    }

    /// The particle of `own`, those of one body, at a place.
    fn at_of(&self, own: &Range<usize>, [i, j]: [i32; 2]) -> Option<usize> {
        let found = self.place[own.clone()].binary_search_by_key(&(j, i), |place| (place[1], place[0]));
        found.ok().map(|index| own.start + index)
    }

    /// The particle of `own` that takes what lies in a square without one: in the same cell of `side` squares if there
    /// is one, else the nearest; none within reach of a spike thinner than a square.
    fn beside(&self, own: &Range<usize>, cover: &Cover, side: f64) -> Option<usize> {
        const REACH: i32 = 2;
        let cell = |place: [i32; 2]| place.map(|k| ((f64::from(k) + 0.5) / side).floor());
        let mut nearest: Option<(bool, f64, usize)> = None;
        for (i, j) in (-REACH..=REACH).flat_map(|j| (-REACH..=REACH).map(move |i| (i, j))) {
            let place = [cover.place[0] + i, cover.place[1] + j];
            let Some(p) = self.at_of(own, place) else { continue };
            let away = (offset(place, cover.place) + cover.center).norm_squared();
            let candidate = (cell(place) != cell(cover.place), away, p);
            if nearest.is_none_or(|n| candidate < n) {
                nearest = Some(candidate);
            }
        }
        nearest.map(|(_, _, p)| p)
    }

    /// From where a particle stands to the centre of its volume [m]; none of a whole one.
    pub(crate) fn off_center(&self, particle: usize) -> Option<Vector> {
        let found = self.off_center.binary_search_by_key(&(particle as u32), |&(p, _)| p);
        found.ok().map(|index| self.off_center[index].1)
    }

    /// No particles, with room for `count`.
    fn with_room(anchor: Point, spacing: f64, count: usize) -> Self {
        Self {
            anchor,
            spacing,
            place: Vec::with_capacity(count),
            rest: Vec::with_capacity(count),
            body: Vec::with_capacity(count),
            material: Vec::with_capacity(count),
            volume: Vec::with_capacity(count),
            mass: Vec::with_capacity(count),
            off_center: Vec::new(),
            lattice: SpanRows::default(),
        }
    }

    /// Which particle stands where.
    pub(crate) fn lattice(&self) -> &SpanRows {
        &self.lattice
    }

    /// The particle at a place of the lattice.
    pub(crate) fn at(&self, [i, j]: [i32; 2]) -> Option<usize> {
        self.lattice.number(i, j)
    }

    /// The particles in the box from `low` to `high` (column, row; both included), row by row, columns rising.
    pub(crate) fn within(&self, low: [i32; 2], high: [i32; 2]) -> impl Iterator<Item = usize> {
        self.lattice.within(low, high).map(|(_, _, particle)| particle)
    }

    /// The particles at rest in a box [m], which may be a row larger, row by row.
    pub(crate) fn in_box(&self, low: Point, high: Point) -> impl Iterator<Item = usize> {
        let first = ((low - self.anchor) / self.spacing).map(|t| t.floor() as i32);
        let last = ((high - self.anchor) / self.spacing).map(|t| t.ceil() as i32);
        self.within([first.x, first.y], [last.x, last.y])
    }

    /// The particles as a frame holds them, pieces left 0, without how they move: see [`Particles::add_motions`].
    pub(crate) fn frame_at_rest(&self) -> ParticleFrame {
        ParticleFrame {
            id: (0..self.len() as u32).collect(),
            body: self.body.clone(),
            piece: vec![0; self.len()],
            rest: self.rest.clone(),
            mass: Some(self.mass.clone()),
            ..ParticleFrame::default()
        }
    }

    /// The particles as a frame holds them, pieces left 0, moving as `solver` says.
    pub(crate) fn frame(&self, solver: &(impl Snapshot + ?Sized)) -> ParticleFrame {
        let mut frame = self.frame_at_rest();
        solver.add_motions(&mut frame);
        frame
    }

    /// Adds to `frame`, which has what some particles are at rest, how these move: `now` tells of particles, by their
    /// numbers, how they are.
    pub(crate) fn add_motions(
        frame: &mut ParticleFrame,
        now: impl Fn(&mut dyn Iterator<Item = usize>) -> Vec<ParticleNow> + Sync,
    ) {
        let ParticleFrame { id, position, velocity, deformation_gradient, cauchy_stress, .. } = frame;
        position.reserve_exact(id.len());
        velocity.reserve_exact(id.len());
        deformation_gradient.reserve_exact(id.len());
        cauchy_stress.reserve_exact(id.len());
        for many in id.chunks(AT_ONCE) {
            let of_block = |block: Range<usize>| now(&mut many[block].iter().map(|&p| p as usize));
            for now in threads::ranges(many.len(), of_block).into_iter().flatten() {
                position.push(now.position);
                velocity.push(now.velocity);
                deformation_gradient.push(Matrix::identity() + now.gradient);
                cauchy_stress.push(now.cauchy_stress);
            }
        }
    }

    /// Number of particles.
    pub(crate) fn len(&self) -> usize {
        self.rest.len()
    }

    /// Numbers of the particles in `selection`, rising.
    pub(crate) fn select(&self, scene: &Scene, selection: &Selection) -> Vec<u32> {
        let s = self.spacing;
        let selector = Selector::new(scene, selection);
        // Of an edge: the layer of particles whose domain touches it, or that have taken what lies beyond theirs.
        let deep = (1.0 + 1e-6) * s;
        let is_selected = |p: &usize| selector.selects(self.rest[*p], self.body[*p] as usize, deep, 0.0);
        (0..self.len()).filter(is_selected).map(|p| p as u32).collect()
    }

    /// How each particle moves at time zero.
    pub(crate) fn first_motions(&self, scene: &Scene) -> Vec<FirstMotion> {
        let mut motions = vec![FirstMotion { velocity: Vector::zeros(), angular_velocity: 0.0 }; self.len()];
        for (index, body) in scene.bodies.iter().enumerate() {
            for part in &body.velocities {
                let selected = self.select(scene, &part.selection);
                for p in selected.into_iter().map(|p| p as usize).filter(|&p| self.body[p] as usize == index) {
                    let arm = self.rest[p] - part.center;
                    motions[p].velocity += part.velocity + Vector::new(-arm.y, arm.x) * part.angular_velocity;
                    motions[p].angular_velocity += part.angular_velocity;
                }
            }
        }
        motions
    }

    /// The fault of the selection of item `index` of `array`, a load or a support, that meets no particle.
    pub(crate) fn no_particle(&self, array: &str, index: usize, selection: &Selection) -> SceneFault {
        nothing_selected("particle", &self.rest, array, index, selection)
    }
}

/// The fault of the selection of item `index` of `array`, which meets none of `places`, where each `what` is.
pub(crate) fn nothing_selected(
    what: &str,
    places: &[Point],
    array: &str,
    index: usize,
    selection: &Selection,
) -> SceneFault {
    let path = KeyPath::item(array, index).then("select");
    let distance = |to: &dyn Fn(Point) -> f64| places.iter().map(|&p| to(p)).fold(f64::INFINITY, f64::min);
    let (why, remedy) = match selection {
        Selection::Near { points, radius } => {
            let off = distance(&|p| points.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min));
            let why = format!("the nearest is {off:.3e} m away from its points, more than its radius of {radius} m");
            (why, format!("move the points, or make `radius` at least {} m", round_up(1.5 * off)))
        }
        Selection::Region(region) => {
            let off = distance(&|p| region.distance_to_rings(p));
            (
                format!("the nearest is {off:.3e} m away from its region"),
                "move the region onto a body, or make it larger".into(),
            )
        }
        Selection::Edge { side, .. } => {
            let side = format!("{side:?}").to_lowercase();
            let why = format!("no piece of an outline lies along the {side} side of the bodies' box");
            (why, "select a `region` or points `near` the place instead".into())
        }
        Selection::All | Selection::Bodies(_) | Selection::Outline(_) => {
            ("there is none in it or along it".into(), "check it against the bodies".into())
        }
    };
    SceneFault::new(path, format!("{array} {} selects no {what}: {why}", index + 1), remedy)
}

/// From one square to another, in squares.
fn offset(from: [i32; 2], to: [i32; 2]) -> Vector {
    Vector::new(f64::from(to[0] - from[0]), f64::from(to[1] - from[1]))
}

/// How a particle is at one moment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ParticleNow {
    /// [m].
    pub(crate) position: Point,
    /// [m/s].
    pub(crate) velocity: Vector,
    /// Displacement gradient H = F − I [–].
    pub(crate) gradient: Matrix,
    /// [Pa].
    pub(crate) cauchy_stress: Matrix,
}

/// How a particle moves at time zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstMotion {
    /// [m/s].
    pub(crate) velocity: Vector,
    /// Counter-clockwise [rad/s].
    pub(crate) angular_velocity: f64,
}

/// Spans of the particles in each row, numbered as they are. Of two particles in one place, where the outlines of
/// bodies overlap by rounding, it holds the first.
fn lattice_of(place: &[[i32; 2]]) -> SpanRows {
    let mut runs: Vec<(i32, Span)> = Vec::new();
    for (p, &[i, j]) in place.iter().enumerate() {
        match runs.last_mut() {
            Some((row, span)) if *row == j && span.end == i => span.end += 1,
            _ => runs.push((j, Span { first: i, end: i + 1, number: p as u32 })),
        }
    }
    runs.sort_unstable_by_key(|(row, span)| (*row, span.first, span.number));
    let mut lattice = SpanRows::default();
    let mut taken = (i32::MIN, i32::MIN);
    for (row, mut span) in runs {
        if taken.0 == row && span.first < taken.1 {
            let twice = taken.1 - span.first;
            span = Span { first: taken.1, number: span.number + twice as u32, ..span };
        }
        if span.first < span.end {
            taken = (row, span.end);
            lattice.push(row, span);
        }
    }
    lattice
}

/// The next number with two digits.
fn round_up(value: f64) -> f64 {
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    let rounded = (value / unit).ceil() * unit;
    format!("{rounded:.1e}").parse().unwrap_or(rounded)
}
