//! Tips with little material ahead of them.

use super::Resolver;
use crate::fault::{KeyPath, Warning, short, show};
use crate::scene::{Crack, Guide, Scene};
use fissure_plane::{Outlook, Point};

/// Cells between a tip and what is ahead of it, at least: its integrals take four of them, and the ligament bends.
const FEWEST_CELLS: f64 = 8.0;

/// A live tip, at the end of its crack.
struct Tip<'s> {
    crack: &'s Crack,
    /// Points of its crack, from the tip on.
    points: Vec<Point>,
}

/// What a tip may have ahead of it.
#[derive(Debug, Clone, Copy)]
enum Obstacle<'s> {
    Outline,
    Hole,
    Itself,
    Crack(&'s str),
}

impl std::fmt::Display for Obstacle<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Outline => f.write_str("the outline"),
            Self::Hole => f.write_str("a hole"),
            Self::Itself => f.write_str("another part of itself"),
            Self::Crack(name) => write!(f, "crack `{name}`"),
        }
    }
}

impl Resolver<'_> {
    /// Warns of drawn tips with few cells between them and an outline, a hole or another drawn crack ahead. Flaws are
    /// not meant: they keep their `margin`, and are strewn to meet.
    pub(super) fn ligaments(&self, scene: &Scene) {
        let drawn = &scene.cracks[..self.origin.cracks.len()];
        for (i, crack) in drawn.iter().enumerate() {
            let found = tips(crack).filter_map(|tip| Some((tip.points[0], narrowest(&tip, drawn, scene)?)));
            let Some((tip, (clear, what))) = found.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { continue };
            let cells = clear / scene.cell_size;
            let message = format!(
                "ahead of the tip of crack `{}` at {} m it is only {cells:.1} cells to {what}: its load is measured badly there",
                crack.name,
                show(tip)
            );
            let spacing = rounded_down(scene.particle_spacing * cells / FEWEST_CELLS);
            let remedy = format!(
                "set `grid.particle_spacing` to {spacing} m or less for {FEWEST_CELLS} cells, or leave more room ahead of it"
            );
            self.warn(Warning::new(KeyPath::item("crack", self.origin.cracks[i]).then("line"), message, remedy));
        }
    }
}

/// A number of three digits at or just below a positive `value`: what "or less" may be said of.
fn rounded_down(value: f64) -> f64 {
    let unit = 10.0_f64.powf(value.log10().floor() - 2.0);
    short((value / unit * (1.0 + 1e-9)).floor() * unit)
}

/// The live tips of a crack that no schedule moves: such a one goes on whatever is measured.
fn tips(crack: &Crack) -> impl Iterator<Item = Tip<'_>> {
    let is_measured =
        |live: bool, guide: &Option<Guide>| live && guide.as_ref().is_none_or(|g| g.schedule.points.is_empty());
    let start = is_measured(crack.start_live, &crack.start_guide).then(|| crack.points.clone());
    let end = is_measured(crack.end_live, &crack.end_guide).then(|| crack.points.iter().rev().copied().collect());
    [start, end].into_iter().flatten().map(move |points| Tip { crack, points })
}

/// What is nearest ahead of a tip and how far it is [m], where that is less than the fewest cells.
fn narrowest<'s>(tip: &Tip<'s>, drawn: &'s [Crack], scene: &'s Scene) -> Option<(f64, Obstacle<'s>)> {
    let outlook = Outlook::new(tip.points[0], tip.points.first()? - tip.points.get(1)?)?;
    let rings = scene.bodies[tip.crack.body].region.rings().enumerate().flat_map(|(k, ring)| {
        let what = if k == 0 { Obstacle::Outline } else { Obstacle::Hole };
        (0..ring.len()).map(move |i| (what, ring[i], ring[(i + 1) % ring.len()]))
    });
    // Of its own crack, all but the segment that the tip is the end of.
    let own = tip.points[1..].windows(2).map(|w| (Obstacle::Itself, w[0], w[1]));
    let others = drawn.iter().filter(|c| !std::ptr::eq(*c, tip.crack) && c.body == tip.crack.body);
    let others = others.flat_map(|c| c.points.windows(2).map(move |w| (Obstacle::Crack(&c.name), w[0], w[1])));
    // A ligament of exactly so many cells is not narrow for being flattened.
    outlook.clearance(rings.chain(own).chain(others), 0.999 * FEWEST_CELLS * scene.cell_size)
}
