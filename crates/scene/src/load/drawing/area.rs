//! Areas: what paths fill, on an integer grid, where crossings, unions and intersections are exact.

use super::bridge::bridges;
use super::flatten::Polyline;
use super::grid::{Grid, GridPoint};
use super::pinch::part_touching_rings;
use fissure_plane::{Point, Region, signed_area};
use i_overlay::core::fill_rule::FillRule as OverlayFill;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::string::clip::{ClipRule, IntClip as _};

/// An outer ring (counter-clockwise) and the rings of its holes (clockwise).
type Shape = Vec<Vec<GridPoint>>;

/// Which places closed rings fill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FillRule {
    /// Those that the rings turn around a number of times other than zero.
    NonZero,
    /// Those that they turn around an odd number of times.
    EvenOdd,
}

/// A part of the plane: connected shapes with holes, which do not overlap.
#[derive(Debug, Clone, Default)]
pub(super) struct Area(Vec<Shape>);

impl Area {
    /// What closed `rings` fill.
    pub(super) fn filled(rings: &[Vec<GridPoint>], rule: FillRule) -> Self {
        let mut overlay = overlay(rings.iter().map(Vec::len).sum());
        overlay.add_source(rings, ShapeType::Subject);
        let rule = match rule {
            FillRule::NonZero => OverlayFill::NonZero,
            FillRule::EvenOdd => OverlayFill::EvenOdd,
        };
        Self(overlay.overlay(OverlayRule::Subject, rule))
    }

    /// What any of the areas covers.
    pub(super) fn union(areas: &[Self]) -> Self {
        Self::union_with(areas, &[])
    }

    /// What any of the areas covers, joined where they share an edge but for a gap of at most `gap` [m].
    ///
    /// Holes narrower than that, which are what is left of such gaps, are filled. None when there are too many such
    /// edges.
    pub(super) fn joined(areas: &[Self], gap: f64, grid: Grid) -> Option<Self> {
        let shapes = areas.iter().map(|area| area.rings().collect());
        let mut joined = Self::union_with(areas, &bridges(shapes, gap / grid.step)?);
        for shape in &mut joined.0 {
            let mut rings = std::mem::take(shape).into_iter();
            shape.extend(rings.next());
            shape.extend(rings.filter(|ring| mean_width(&places(ring, grid)) >= gap));
        }
        Some(joined)
    }

    fn union_with(areas: &[Self], strips: &[Vec<GridPoint>]) -> Self {
        let mut overlay = overlay(areas.iter().flat_map(|a| a.rings()).map(<[_]>::len).sum());
        areas.iter().for_each(|area| overlay.add_source(&area.0, ShapeType::Subject));
        overlay.add_source(strips, ShapeType::Subject);
        Self(overlay.overlay(OverlayRule::Subject, OverlayFill::NonZero))
    }

    /// What both areas cover.
    pub(super) fn intersection(&self, other: &Self) -> Self {
        let mut overlay = overlay(self.rings().chain(other.rings()).map(<[_]>::len).sum());
        overlay.add_source(&self.0, ShapeType::Subject);
        overlay.add_source(&other.0, ShapeType::Clip);
        Self(overlay.overlay(OverlayRule::Intersect, OverlayFill::NonZero))
    }

    /// Whether it covers nothing.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The parts of a polyline that lie in the area.
    pub(super) fn cut_line(&self, (points, closed): Polyline, grid: Grid) -> Vec<Polyline> {
        let mut line: Vec<GridPoint> = points.iter().map(|&p| grid.snap(p)).collect();
        if closed {
            line.push(line[0]);
        }
        line.dedup();
        let rings: Vec<_> = self.0.iter().flatten().cloned().collect();
        let rule = ClipRule { invert: false, boundary_included: true };
        let parts = rings.clip_path(&line, OverlayFill::NonZero, rule);
        if let [part] = parts.as_slice()
            && (*part == line || part.iter().eq(line.iter().rev()))
        {
            return vec![(points, closed)]; // Nothing was cut off.
        }
        parts.iter().map(|part| (places(part, grid), false)).collect()
    }

    /// All rings.
    pub(super) fn rings(&self) -> impl Iterator<Item = &[GridPoint]> {
        self.0.iter().flatten().map(Vec::as_slice)
    }

    /// The connected parts as regions, from left to right, without those narrower than `width` [m] on average.
    ///
    /// Rings of a region do not touch: where they meet in a point they are parted by a notch of at most `notch` [m].
    pub(super) fn regions(&self, grid: Grid, width: f64, notch: f64) -> Vec<Region> {
        let mut shapes: Vec<Vec<Vec<Point>>> = self
            .0
            .iter()
            .map(|shape| shape.iter().map(|ring| places(ring, grid)).collect::<Vec<_>>())
            .filter(|shape| shape.first().is_some_and(|exterior| mean_width(exterior) >= width))
            .collect();
        part_touching_rings(&mut shapes, notch);
        let mut regions: Vec<Region> = shapes
            .into_iter()
            .filter_map(|shape| {
                let mut rings = shape.into_iter();
                let exterior = rings.next()?;
                Some(Region { exterior, holes: rings.filter(|hole| mean_width(hole) >= width).collect() })
            })
            .collect();
        let corner = |region: &Region| region.bounds().0;
        regions.sort_by(|a, b| {
            let (a, b) = (corner(a), corner(b));
            a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y))
        });
        regions
    }
}

/// An overlay whose shapes have connected interiors: what hangs together in a point only is apart.
///
/// Corners on straight edges stay, since another ring may touch there.
fn overlay(capacity: usize) -> Overlay<i64> {
    let options = IntOverlayOptions { preserve_output_collinear: true, ..IntOverlayOptions::ogc() };
    Overlay::new_custom(capacity, options, Default::default())
}

fn places(ring: &[GridPoint], grid: Grid) -> Vec<Point> {
    ring.iter().map(|&p| grid.place(p)).collect()
}

/// Width of a long thin ring: twice its area over its length.
fn mean_width(ring: &[Point]) -> f64 {
    let length: f64 = (0..ring.len()).map(|i| (ring[(i + 1) % ring.len()] - ring[i]).norm()).sum();
    2.0 * signed_area(ring).abs() / length
}
