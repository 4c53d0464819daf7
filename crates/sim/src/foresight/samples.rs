//! A body as a few thousand places with mass, and the loads as forces at places: what estimates are made of.

use crate::boundary::selector::Selector;
use crate::particles::Particles;
use fissure_scene::{LoadKind, OutlineStretch, Point, Scene, Selection, Vector};

/// Places along the larger side of the box around all bodies.
const RESOLUTION: f64 = 64.0;

/// A force at a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedForce {
    pub(super) body: usize,
    pub(super) place: Point,
    /// [N/m].
    pub(super) force: Vector,
}

/// A scene laid out coarsely.
#[derive(Debug)]
pub(super) struct Samples {
    pub(super) particles: Particles,
    /// Forces of each load, at a curve factor of 1.
    pub(super) loads: Vec<Vec<PlacedForce>>,
    /// Places that each support holds.
    pub(super) supports: Vec<Vec<(usize, Point)>>,
}

impl Samples {
    /// Lays out a scene; none where even a fine lattice misses a body.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let (low, high) = fissure_plane::bounds(
            &scene.bodies.iter().flat_map(|b| b.region.exterior.iter().copied()).collect::<Vec<_>>(),
        );
        let size = (high - low).amax();
        let spacing = scene.particle_spacing.max(size / RESOLUTION);
        let factor = spacing / scene.particle_spacing;
        let coarse = Scene { particle_spacing: spacing, cell_size: scene.cell_size * factor, ..scene.clone() };
        let particles = Particles::fill(&coarse).ok()?;
        let selected = |selection: &Selection| -> Vec<(usize, Point)> {
            let found = particles.select(&coarse, selection);
            if found.is_empty() {
                return center(selection).map(|place| (nearest_body(&particles, place), place)).into_iter().collect();
            }
            found.iter().map(|&p| (particles.body[p as usize] as usize, particles.rest[p as usize])).collect()
        };
        let shared = |total: Vector, places: Vec<(usize, Point)>| -> Vec<PlacedForce> {
            let part = total / places.len().max(1) as f64;
            places.into_iter().map(|(body, place)| PlacedForce { body, place, force: part }).collect()
        };
        let forces = |load: &fissure_scene::Load| match &load.kind {
            LoadKind::Force(total) => shared(*total, selected(&load.selection)),
            LoadKind::Traction(t) => on_outlines(scene, &particles, &load.selection, |_| *t, spacing),
            LoadKind::Pressure(p) => {
                on_outlines(scene, &particles, &load.selection, |way| Vector::new(-way.y, way.x) * *p, spacing)
            }
            // On both faces the same: a crack says itself what that does to its tips.
            LoadKind::FacePressure(..) => Vec::new(),
            LoadKind::PerPoint(forces) => forces
                .iter()
                .map(|&(place, force)| PlacedForce { body: nearest_body(&particles, place), place, force })
                .collect(),
        };
        let loads = scene.loads.iter().map(forces).collect();
        let supports = scene.supports.iter().map(|s| selected(&s.selection)).collect();
        Some(Self { loads, supports, particles })
    }
}

/// A traction, along a direction of the edge, as forces on the parts of outlines that are selected.
fn on_outlines(
    scene: &Scene,
    particles: &Particles,
    selection: &Selection,
    traction: impl Fn(Vector) -> Vector,
    spacing: f64,
) -> Vec<PlacedForce> {
    let mut forces = Vec::new();
    for OutlineStretch { from, to, .. } in Selector::new(scene, selection).parts(scene) {
        let length = (to - from).norm();
        let traction = traction((to - from) / length);
        let parts = (length / spacing).ceil().max(1.0);
        let body = nearest_body(particles, nalgebra::center(&from, &to));
        let place = |k: usize| from + (to - from) * ((k as f64 + 0.5) / parts);
        let force = traction * (length / parts);
        forces.extend((0..parts as usize).map(|k| PlacedForce { body, place: place(k), force }));
    }
    forces
}

/// The middle of a selection that is smaller than the lattice.
fn center(selection: &Selection) -> Option<Point> {
    let middle = |points: &[Point]| {
        let (low, high) = fissure_plane::bounds(points);
        (!points.is_empty()).then(|| nalgebra::center(&low, &high))
    };
    match selection {
        Selection::Near { points, .. } => middle(points),
        Selection::Region(region) => middle(&region.exterior),
        _ => None,
    }
}

fn nearest_body(particles: &Particles, place: Point) -> usize {
    let distance = |p: &usize| (particles.rest[*p] - place).norm_squared();
    let nearest = (0..particles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(0, |p| particles.body[p] as usize)
}

/// A number of two digits near `value`, on the side that `round` takes.
pub(super) fn two_digits(value: f64, round: fn(f64) -> f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return value;
    }
    let unit = 10_f64.powf(value.log10().floor() - 1.0);
    format!("{:.1e}", round(value / unit) * unit).parse().unwrap_or(value)
}
