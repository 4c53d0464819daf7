//! Which material loads, supports and velocities mean.

use super::shapes::points;
use super::{Resolved, Resolver};
use crate::document::{Select, Shape};
use crate::fault::{KeyPath, SceneFault, short, show};
use crate::load::along::stretches_along;
use crate::scene::{Scene, Selection};
use fissure_plane::{Point, polyline_length};

/// A drawn line this near to an edge, in particle spacings, selects it.
const EDGE_TOLERANCE: f64 = 1.0;

impl<'d> Resolver<'d> {
    pub(super) fn selection(
        &self,
        path: &KeyPath,
        select: &Select,
        scene: &Scene,
        tolerance: f64,
    ) -> Resolved<Selection> {
        let path = path.then("select");
        if let Some(crack) = &select.crack {
            let message =
                format!("the faces of crack `{crack}` are selected, but only a load with a `pressure` acts on faces");
            return Err(SceneFault::new(
                path.then("crack"),
                message,
                "give the load a `pressure`, or select an edge, a region or points",
            ));
        }
        let bodies = match &select.body {
            Some(name) => Some(self.bodies(path.then("body"), Some(name), scene)?),
            None => None,
        };
        let ways = [
            ("edge", select.edge.is_some()),
            ("region", select.region.is_some()),
            ("near", select.near.is_some()),
            ("svg", select.svg.is_some()),
        ];
        let given: Vec<&str> = ways.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect();
        if let [first, second, ..] = given.as_slice() {
            return Err(combined(path, &format!("`{first}` and `{second}`")));
        }
        if select.radius.is_some() != select.near.is_some() {
            let message = "`near` and `radius` belong together";
            return Err(SceneFault::new(path, message, "write `select = { near = [[x, y]], radius = ... }`"));
        }
        if let Some(side) = select.edge {
            return Ok(Selection::Edge { side, bodies });
        }
        if let Some(id) = &select.svg {
            return self.drawn_selection(path, id, bodies, scene, tolerance);
        }
        if bodies.is_some() && !given.is_empty() {
            return Err(combined(path, "`body` with `region` or `near`"));
        }
        if let Some(shape) = &select.region {
            return self.selected_region(&path.then("region"), shape, tolerance);
        }
        Ok(match &select.near {
            Some(near) => Selection::Near { points: points(near), radius: select.radius.unwrap_or_default() },
            None => bodies.map_or(Selection::All, Selection::Bodies),
        })
    }

    fn selected_region(&self, path: &KeyPath, shape: &Shape, tolerance: f64) -> Resolved<Selection> {
        let mut regions = self.regions(path, shape, tolerance)?;
        if regions.len() != 1 {
            let message = format!("the shape has {} separate outlines", regions.len());
            return Err(SceneFault::new(path.clone(), message, "select one outline at a time"));
        }
        Ok(Selection::Region(regions.swap_remove(0)))
    }

    /// An open line selects the edges it is drawn on, a closed shape what lies inside.
    fn drawn_selection(
        &self,
        path: KeyPath,
        id: &str,
        bodies: Option<Vec<usize>>,
        scene: &Scene,
        tolerance: f64,
    ) -> Resolved<Selection> {
        let key = path.then("svg");
        let Ok(line) = self.drawing(&key, id)?.line(id, tolerance) else {
            if bodies.is_some() {
                return Err(combined(path, "`body` with a closed shape"));
            }
            return self.selected_region(&path, &Shape::Svg(id.to_owned()), tolerance);
        };
        let bodies = bodies.unwrap_or_else(|| (0..scene.bodies.len()).collect());
        let reach = EDGE_TOLERANCE * scene.particle_spacing;
        let along = |&body: &usize| stretches_along(&line, &scene.bodies[body].region, body, reach);
        let stretches: Vec<_> = bodies.iter().flat_map(along).collect();
        let (drawn, found) = (polyline_length(&line), stretches.iter().map(|s| (s.to - s.from).norm()).sum::<f64>());
        // A line that only crosses an edge runs along it for a spacing or two.
        if found < 0.5 * drawn {
            return Err(beside_the_edge(key, id, [line[0], line[line.len() - 1]], [drawn, found], reach));
        }
        Ok(Selection::Outline(stretches))
    }
}

pub(super) fn combined(path: KeyPath, keys: &str) -> SceneFault {
    SceneFault::new(path, format!("a selection cannot combine {keys}"), "select by one of them")
}

/// The fault of a line that runs along no edge.
fn beside_the_edge(
    key: KeyPath,
    id: &str,
    [first, last]: [Point; 2],
    [drawn, found]: [f64; 2],
    reach: f64,
) -> SceneFault {
    let message = format!(
        "the line `{id}` from {} m to {} m, {} m long, selects no edge: {} m of an edge run along it",
        show(first),
        show(last),
        short(drawn),
        short(found)
    );
    let remedy = format!(
        "draw it on the edge, not farther than a particle spacing ({} m) from it, or close it to select what is inside",
        short(reach)
    );
    SceneFault::new(key, message, remedy)
}
