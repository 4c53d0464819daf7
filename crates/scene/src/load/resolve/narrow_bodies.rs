//! Bodies with places that are narrow for the particles.

use super::Resolver;
use crate::fault::{KeyPath, Warning, short, show};
use crate::scene::Scene;
use fissure_plane::{NarrowKind, narrow_places};

/// What is narrower than this, in particle spacings, is not seen as it is: it holds one row of particles or none, and
/// its two sides share the nodes of the grid.
const FEWEST_SPACINGS: f64 = 2.0;

/// What is narrower than this, in particle spacings, is a point in which parts touch: no spacing that anybody waits for
/// resolves it.
const PINCH: f64 = 0.1;

impl Resolver<'_> {
    /// Warns of necks, gaps and holes that the particles hardly show.
    pub(super) fn narrow_bodies(&self, scene: &Scene) {
        let spacing = scene.particle_spacing;
        for (index, body) in scene.bodies.iter().enumerate() {
            let places = narrow_places(&body.region, FEWEST_SPACINGS * spacing);
            for kind in [NarrowKind::Neck, NarrowKind::Gap, NarrowKind::Hole] {
                let mut of_kind = places.iter().filter(|place| place.kind == kind);
                let Some(narrowest) = of_kind.next() else { continue };
                let name = &body.name;
                let (what, outcome) = match kind {
                    NarrowKind::Neck => (
                        format!("body `{name}`"),
                        "it may hold no particle there, and is as stiff as one row of them at best",
                    ),
                    NarrowKind::Gap => {
                        (format!("a gap in body `{name}`"), "the material on both sides of it moves as one")
                    }
                    NarrowKind::Hole => (format!("a hole in body `{name}`"), "the particles hardly show it"),
                };
                let others = match of_kind.count() {
                    0 => String::new(),
                    1 => ", and below two spacings in one more place".to_owned(),
                    more => format!(", and below two spacings in {more} more places"),
                };
                let message = format!(
                    "{what} is {} m wide at {} m, {:.2} particle spacings{others}: {outcome}",
                    short(narrowest.width),
                    show(narrowest.place),
                    narrowest.width / spacing
                );
                let remedy = if narrowest.width < PINCH * spacing {
                    "draw it wider, or leave its parts apart".to_owned()
                } else {
                    let enough = short(narrowest.width / FEWEST_SPACINGS);
                    format!("set `grid.particle_spacing` to {enough} m or less, or draw it wider")
                };
                let path = KeyPath::item("body", self.origin.bodies[index]).then("shape");
                self.warn(Warning::new(path, message, remedy));
            }
        }
    }
}
