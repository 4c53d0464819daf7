//! Bridges that no particle lies in, between the end of a crack and what lies near it.

use super::Resolver;
use crate::fault::{KeyPath, Warning, show};
use crate::scene::{Crack, Scene};
use fissure_plane::{Point, nearest_on_segment};

/// An end that is nearer to a line than this part of a particle's width lies on it.
const ON_IT: f64 = 1e-6;

impl Resolver<'_> {
    /// Warns of drawn cracks that end for good less than a particle away from an outline or another drawn crack: cells
    /// hold what lies on both sides no more, but one fragment it is, as nothing closes it off.
    pub(super) fn bridges(&self, scene: &Scene) {
        let drawn = &scene.cracks[..self.origin.cracks.len()];
        for (i, crack) in drawn.iter().enumerate() {
            let ends = [(crack.start_live, crack.points.first()), (crack.end_live, crack.points.last())];
            let dead = ends.into_iter().filter(|(live, _)| !live).filter_map(|(_, end)| end.copied());
            let found = dead.filter_map(|end| Some((end, narrowest(end, crack, drawn, scene)?)));
            let Some((end, (width, what))) = found.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { continue };
            let message = format!(
                "crack `{}` ends at {} m, {width:.2e} m from {what}: no particle lies between, so nothing holds there, but a \
                 thread of the mesh",
                crack.name,
                show(end)
            );
            let remedy = format!("let it end on {what}, or leave {:.2e} m and more", 2.0 * scene.cell_size);
            self.warn(Warning::new(KeyPath::item("crack", self.origin.cracks[i]).then("line"), message, remedy));
        }
    }
}

/// What is nearest to the end of a crack and how far it is [m], where that is less than a particle's width.
fn narrowest(end: Point, crack: &Crack, drawn: &[Crack], scene: &Scene) -> Option<(f64, String)> {
    let rings = scene.bodies[crack.body].region.rings();
    let outlines = rings.flat_map(|ring| (0..ring.len()).map(|i| (None, ring[i], ring[(i + 1) % ring.len()])));
    let others = drawn.iter().filter(|other| !std::ptr::eq(*other, crack) && other.body == crack.body);
    let others = others.flat_map(|other| other.points.windows(2).map(|w| (Some(&other.name), w[0], w[1])));
    let ways = outlines.chain(others).map(|(what, a, b)| ((nearest_on_segment(a, b, end) - end).norm(), what));
    let (width, what) = ways.min_by(|p, q| p.0.total_cmp(&q.0))?;
    let is_bridge = (ON_IT * scene.particle_spacing..scene.particle_spacing).contains(&width);
    is_bridge.then(|| (width, what.map_or("the outline".to_owned(), |name| format!("crack `{name}`"))))
}
