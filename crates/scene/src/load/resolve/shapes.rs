//! Shapes and lines of a scene file as regions and polylines.

use super::{Resolved, Resolver};
use crate::document::{CircleKeys, Line, PolygonKeys, Shape};
use crate::fault::{Check, KeyPath, SceneFault, Warning, show};
use crate::load::chord::Chord;
use crate::load::drawing::LoadedDrawing;
use crate::load::seating::Complaint;
use crate::range::{COORDINATE, LENGTH, POINTS};
use crate::validate::validate_region;
use fissure_plane::{
    Point, Region, Vector, bounds, circle_ring, clean_ring, find_crossing, oriented, polyline_length, signed_area,
};

impl<'d> Resolver<'d> {
    /// The box around all bodies.
    pub(super) fn bodies_box(&self) -> Resolved<(Point, Point)> {
        let mut corners = Vec::new();
        for (i, body) in self.document.body.iter().enumerate() {
            let (low, high) = self.shape_box(&KeyPath::item("body", i).then("shape"), &body.shape)?;
            corners.extend([low, high]);
        }
        Ok(bounds(&corners))
    }

    /// The box around a shape.
    pub(super) fn shape_box(&self, path: &KeyPath, shape: &Shape) -> Resolved<(Point, Point)> {
        match shape {
            Shape::Rectangle(r) => Ok(rectangle(&path.then("rectangle"), r.min, r.max)?.bounds()),
            Shape::Circle(c) => {
                circle_in_range(&path.then("circle"), c)?;
                let (center, half) = (Point::from(c.center), Vector::new(c.radius, c.radius));
                Ok((center - half, center + half))
            }
            Shape::Polygon(polygon) => {
                let corners = points(&polygon.exterior);
                COORDINATE.check_points(&path.then("polygon"), "a corner of the polygon", &corners)?;
                Ok(bounds(&corners))
            }
            Shape::Svg(id) => {
                let path = path.then("svg");
                let (low, high) = self.drawing(&path, id)?.bounds(id).map_err(at(&path))?;
                COORDINATE.check_points(&path, &format!("the place of `{id}`"), &[low, high])?;
                Ok((low, high))
            }
        }
    }

    pub(super) fn drawing(&self, path: &KeyPath, id: &str) -> Resolved<&'d LoadedDrawing> {
        self.drawing.ok_or_else(|| {
            let message = format!("`svg = \"{id}\"` needs a drawing, but the scene has none");
            SceneFault::new(path.clone(), message, "add `[drawing]` with `file = \"...svg\"`")
        })
    }

    /// The regions a shape consists of: one, or several for a drawing of separate outlines.
    pub(super) fn regions(&self, path: &KeyPath, shape: &Shape, tolerance: f64) -> Resolved<Vec<Region>> {
        Ok(self.outlines(path, shape, tolerance)?.0)
    }

    /// The regions a shape consists of, with the chords of its curves.
    pub(super) fn outlines(
        &self,
        path: &KeyPath,
        shape: &Shape,
        tolerance: f64,
    ) -> Resolved<(Vec<Region>, Vec<Chord>)> {
        match shape {
            Shape::Rectangle(r) => {
                rectangle(&path.then("rectangle"), r.min, r.max).map(|region| (vec![region], Vec::new()))
            }
            Shape::Circle(c) => {
                let path = path.then("circle");
                circle_in_range(&path, c)?;
                let exterior = circle_ring(Point::from(c.center), c.radius, tolerance);
                let chords = Chord::of_circle(&exterior);
                Ok((vec![Region { exterior, holes: Vec::new() }], chords))
            }
            Shape::Polygon(polygon) => {
                let path = path.then("polygon");
                enough_corners(&path, polygon)?;
                let ring = |list: &[[f64; 2]], outer: bool| oriented(clean_ring(&points(list), 0.0), outer);
                let region = Region {
                    exterior: ring(&polygon.exterior, true),
                    holes: polygon.holes.iter().map(|h| ring(h, false)).collect(),
                };
                Ok((vec![region], Vec::new()))
            }
            Shape::Svg(id) => {
                let path = path.then("svg");
                let drawing = self.drawing(&path, id)?;
                for (message, remedy) in drawing.remarks(id) {
                    self.warn(Warning::new(path.clone(), message, remedy));
                }
                drawing.outlines(id, tolerance).map_err(at(&path))
            }
        }
    }

    /// The regions of a shape that nothing validates later. `what`: what they are, in words.
    pub(super) fn sound_regions(
        &self,
        path: &KeyPath,
        what: &str,
        shape: &Shape,
        tolerance: f64,
    ) -> Resolved<Vec<Region>> {
        let regions = self.regions(path, shape, tolerance)?;
        regions.iter().try_for_each(|region| validate_region(path, what, region))?;
        Ok(regions)
    }

    pub(super) fn line(&self, path: &KeyPath, line: &Line, tolerance: f64) -> Resolved<Vec<Point>> {
        let points = match line {
            Line::Points(list) => points(list),
            Line::Svg(id) => {
                let path = path.then("svg");
                self.drawing(&path, id)?.line(id, tolerance).map_err(at(&path))?
            }
        };
        POINTS.check(path, "the line", points.len())?;
        COORDINATE.check_points(path, "a point of the line", &points)?;
        if points.len() < 2 || polyline_length(&points) == 0.0 {
            let message = match points.first() {
                Some(&p) => format!("the line has zero length, it lies at {} m", show(p)),
                None => "the line has no points".to_owned(),
            };
            return Err(SceneFault::new(path.clone(), message, "give it at least two different points"));
        }
        if let Some(at) = find_crossing(&[&points], false) {
            let message = format!("the line crosses itself at {} m", show(at));
            return Err(SceneFault::new(path.clone(), message, "draw it without a loop"));
        }
        Ok(points)
    }
}

pub(super) fn at(path: &KeyPath) -> impl Fn(Complaint) -> SceneFault + use<'_> {
    move |(message, remedy)| SceneFault::new(path.clone(), message, remedy)
}

pub(super) fn points(list: &[[f64; 2]]) -> Vec<Point> {
    list.iter().map(|&p| Point::from(p)).collect()
}

pub(super) fn rectangle(path: &KeyPath, min: [f64; 2], max: [f64; 2]) -> Resolved<Region> {
    COORDINATE.check_pair(path.then("min"), "`min`", min)?;
    COORDINATE.check_pair(path.then("max"), "`max`", max)?;
    if min[0] >= max[0] || min[1] >= max[1] {
        let message = format!("min = {min:?} is not below and left of max = {max:?}");
        return Err(SceneFault::new(path.clone(), message, "min is the lower left corner, max the upper right one"));
    }
    let exterior = vec![min, [max[0], min[1]], max, [min[0], max[1]]].into_iter().map(Point::from).collect();
    Ok(Region { exterior, holes: Vec::new() })
}

fn circle_in_range(path: &KeyPath, circle: &CircleKeys) -> Resolved<()> {
    COORDINATE.check_pair(path.then("center"), "the centre of the circle", circle.center)?;
    LENGTH.check(path.then("radius"), "the radius of the circle", circle.radius)
}

/// Common centre of area of regions.
pub(super) fn center_of_area(regions: &[Region]) -> Point {
    let Some(&origin) = regions.iter().flat_map(|r| &r.exterior).next() else { return Point::origin() };
    let mut moment = Vector::zeros();
    for ring in regions.iter().flat_map(Region::rings) {
        for i in 0..ring.len() {
            let (p, q) = (ring[i] - origin, ring[(i + 1) % ring.len()] - origin);
            moment += (p + q) * ((p.x * q.y - q.x * p.y) / 6.0);
        }
    }
    let area: f64 = regions.iter().flat_map(Region::rings).map(signed_area).sum();
    origin + moment / area
}

/// That an inline polygon has corners to make rings of.
fn enough_corners(path: &KeyPath, polygon: &PolygonKeys) -> Check {
    std::iter::once(&polygon.exterior).chain(&polygon.holes).find(|ring| ring.len() < 3).map_or(Ok(()), |ring| {
        Err(SceneFault::new(
            path.clone(),
            format!("a ring has {} corners", ring.len()),
            "a ring needs at least 3 corners",
        ))
    })
}
