//! Parts of a drawn body that are too small for the grid.

use super::Resolver;
use crate::fault::{KeyPath, Warning, short, show};
use fissure_plane::Region;

/// A part with the area of fewer particles may hold none, whatever its shape.
const FEWEST_PARTICLES: f64 = 4.0;

impl Resolver<'_> {
    /// The parts of body `name` that have room for particles: at least one wide and high, and a few in all. What is
    /// left out is told.
    ///
    /// Crossing outlines leave crumbs that nobody drew on purpose. When all parts are that small, all stay, and the
    /// validation says so.
    pub(super) fn without_crumbs(&self, path: &KeyPath, name: &str, parts: Vec<Region>, spacing: f64) -> Vec<Region> {
        let is_crumb = |part: &Region| side(part) < spacing || part.area() < FEWEST_PARTICLES * spacing * spacing;
        let crumbs: Vec<&Region> = parts.iter().filter(|part| is_crumb(part)).collect();
        if crumbs.is_empty() || crumbs.len() == parts.len() {
            return parts;
        }
        let largest = crumbs.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
        if let Some(largest) = largest {
            let (low, high) = largest.bounds();
            let message = format!(
                "{} of {} parts of body `{name}` are too small for the particle spacing of {} m and are left out, the \
                 largest is {} m x {} m at {} m",
                crumbs.len(),
                parts.len(),
                short(spacing),
                short(high.x - low.x),
                short(high.y - low.y),
                show(low)
            );
            let remedy = format!(
                "a `grid.particle_spacing` of {} m resolves it; if they are not meant, delete them in the SVG editor",
                short((largest.area() / 16.0).sqrt().min(side(largest) / 4.0))
            );
            self.warn(Warning::new(path.clone(), message, remedy));
        }
        parts.into_iter().filter(|part| !is_crumb(part)).collect()
    }
}

/// The smaller side of a region's box.
fn side(region: &Region) -> f64 {
    let (low, high) = region.bounds();
    (high.x - low.x).min(high.y - low.y)
}
