//! Flaws: cracks scattered at random.

use super::{Resolved, Resolver};
use crate::document::FlawsKeys;
use crate::fault::{KeyPath, SceneFault, short};
use crate::load::scatter::{Flaws, scatter};
use crate::range::{DEGREES, DEGREES_APART, FLAW_DENSITY, ITEMS, LENGTH, SPREAD};
use crate::scene::{Crack, Scene};
use crate::validate::{outside, overlap};
use fissure_plane::{Point, Region};

/// Least distance of flaws from everything else, in cells, unless the scene says otherwise: what a tip needs around it
/// to be measured.
const MARGIN: f64 = 2.0;
/// Most flaws of one set: beyond it a density is a slip of the pen.
const MOST_FLAWS: f64 = 10_000.0;

impl<'d> Resolver<'d> {
    /// Adds the flaws to the cracks of the scene.
    pub(super) fn flaws(&self, scene: &mut Scene, tolerance: f64) -> Resolved<()> {
        for (i, keys) in self.document.flaws.iter().enumerate() {
            let path = KeyPath::item("flaws", i);
            let bodies = self.bodies(path.then("body"), keys.body.as_deref(), scene)?;
            let shape_path = path.then("shape");
            let shape = match &keys.shape {
                Some(shape) => Some(self.sound_regions(&shape_path, "the outline of the flaws", shape, tolerance)?),
                None => None,
            };
            let regions: Vec<&Region> = bodies.iter().map(|&b| &scene.bodies[b].region).collect();
            let area: f64 = match &shape {
                Some(shapes) => shapes.iter().flat_map(|s| regions.iter().map(move |r| overlap(s, r))).sum(),
                None => regions.iter().map(|r| r.area()).sum(),
            };
            if area == 0.0 {
                return Err(outside(shape_path, "no body reaches into the shape"));
            }
            let mut flaws = parameters(&path, keys, area, scene.cell_size)?;
            flaws.stream = i as u64;
            ITEMS.check(&path, "the scene, with its cracks and these flaws,", scene.cracks.len() + flaws.count)?;
            let lines: Vec<&[Point]> = scene.cracks.iter().map(|c| c.points.as_slice()).collect();
            let placed = scatter(&flaws, &regions, shape.as_deref(), &lines);
            if placed.len() < flaws.count {
                return Err(crowded(&path, keys, &flaws, placed.len(), area));
            }
            let name = keys.name.clone().unwrap_or_else(|| format!("flaws-{}", i + 1));
            let [start_live, end_live] = keys.tips.live();
            for (k, flaw) in placed.into_iter().enumerate() {
                scene.cracks.push(Crack {
                    name: format!("{name}.{}", k + 1),
                    body: bodies[flaw.region],
                    points: flaw.ends.to_vec(),
                    start_live,
                    end_live,
                    start_guide: None,
                    end_guide: None,
                    crosses: false,
                });
            }
        }
        Ok(())
    }
}

fn parameters(path: &KeyPath, keys: &FlawsKeys, area: f64, cell_size: f64) -> Resolved<Flaws> {
    LENGTH.check(path.then("length"), "the length of the flaws", keys.length)?;
    SPREAD.check(path.then("length_spread"), "the spread of their lengths", keys.length_spread)?;
    let margin = keys.margin.unwrap_or(MARGIN * cell_size);
    LENGTH.check(path.then("margin"), "the margin of the flaws", margin)?;
    let all_directions = if keys.angle.is_none() { 90.0 } else { 0.0 };
    let (angle, angle_spread) = (keys.angle.unwrap_or(0.0), keys.angle_spread.unwrap_or(all_directions));
    DEGREES.check(path.then("angle"), "the direction of the flaws", angle)?;
    DEGREES_APART.check(path.then("angle_spread"), "the spread of their directions", angle_spread)?;
    let (key, count) = match (keys.density, keys.count) {
        (Some(density), None) => {
            FLAW_DENSITY.check(path.then("density"), "the density of the flaws", density)?;
            let count = (density * area).round();
            if density > 0.0 && count == 0.0 {
                let message = format!("a density of {density} per m² gives no flaw on {} m²", short(area));
                let remedy = format!("one flaw is {} per m², or say `count = ...`", short(1.0 / area));
                return Err(SceneFault::new(path.then("density"), message, remedy));
            }
            ("density", count)
        }
        (None, Some(count)) => ("count", f64::from(count)),
        (density, _) => {
            let key = if density.is_some() { "count" } else { "density" };
            let message = "flaws need exactly one of `density` and `count`";
            return Err(SceneFault::new(path.then(key), message, "keep or add one of them"));
        }
    };
    if count > MOST_FLAWS {
        let message = format!("these are {count} flaws on {} m²", short(area));
        let remedy = format!("at most {MOST_FLAWS}, which is {} per m²", short(MOST_FLAWS / area));
        return Err(SceneFault::new(path.then(key), message, remedy));
    }
    Ok(Flaws {
        count: count as usize,
        length: keys.length,
        length_spread: keys.length_spread,
        angle: angle.to_radians(),
        angle_spread: angle_spread.to_radians(),
        margin,
        seed: keys.seed,
        stream: 0,
    })
}

/// The fault of more flaws than there is room for.
fn crowded(path: &KeyPath, keys: &FlawsKeys, flaws: &Flaws, fit: usize, area: f64) -> SceneFault {
    let key = if keys.density.is_some() { "density" } else { "count" };
    let margin = short(flaws.margin);
    let message = format!(
        "only {fit} of {} flaws fit into {} m² when they keep {margin} m from each other, the outline and cracks",
        flaws.count,
        short(area)
    );
    let fits = match (keys.density, fit) {
        (_, 0) => String::new(),
        (Some(_), fit) => format!("ask for at most `density = {}`, or ", short(fit as f64 / area)),
        (None, fit) => format!("ask for at most `count = {fit}`, or "),
    };
    SceneFault::new(
        path.then(key),
        message,
        format!("{fits}make `length` ({} m) or `margin` ({margin} m) smaller", flaws.length),
    )
}
