//! The paths of an element, with all that decides which area they cover.

use super::ROUNDING;
use super::area::{Area, FillRule};
use super::flatten::{Budget, Polyline, flatten};
use super::grid::{Grid, GridPoint};
use super::stroke::stroke_outline;
use crate::load::chord::Chord;
use crate::load::seating::Complaint;
use fissure_plane::Point;
use kurbo::{Affine, BezPath, PathEl, Rect};
use std::collections::HashMap;

/// A path with its map to metres and the clips that are on it.
#[derive(Clone)]
pub(super) struct Piece<'t> {
    path: &'t usvg::Path,
    around: Surroundings<'t>,
}

/// What the groups around a node do to it.
#[derive(Clone)]
pub(super) struct Surroundings<'t> {
    /// From the units inside to metres.
    to_metres: Affine,
    /// The clips, each with the map from the units of its user to metres.
    clips: Vec<(&'t usvg::ClipPath, Affine)>,
    /// Whether a group is wholly transparent.
    transparent: bool,
}

impl<'t> Surroundings<'t> {
    /// Of the outermost nodes of a drawing.
    pub(super) fn outermost(to_metres: Affine) -> Self {
        Self { to_metres, clips: Vec::new(), transparent: false }
    }

    /// Inside of `group`, which is in these surroundings.
    fn inside(&self, group: &'t usvg::Group) -> Self {
        let mut inside = self.clone();
        inside.to_metres *= affine(group.transform());
        inside.clips.extend(group.clip_path().map(|clip| (clip, inside.to_metres)));
        inside.transparent |= group.opacity().get() == 0.0;
        inside
    }
}

/// Collects the paths of the elements called `id` below `group`, all there are without an id.
pub(super) fn collect_pieces<'t>(
    group: &'t usvg::Group,
    id: Option<&str>,
    around: &Surroundings<'t>,
    pieces: &mut Vec<Piece<'t>>,
) {
    for node in group.children() {
        let wanted = id.filter(|id| *id != node.id());
        match node {
            usvg::Node::Group(group) => collect_pieces(group, wanted, &around.inside(group), pieces),
            usvg::Node::Text(text) => {
                collect_pieces(text.flattened(), wanted, &around.inside(text.flattened()), pieces);
            }
            usvg::Node::Path(path) if wanted.is_none() => pieces.push(Piece { path, around: around.clone() }),
            usvg::Node::Path(_) | usvg::Node::Image(_) => {}
        }
    }
}

impl Piece<'_> {
    /// Whether anything of it can be seen.
    pub(super) fn is_painted(&self) -> bool {
        self.path.is_visible() && !self.around.transparent && (self.fill().is_some() || self.pen().is_some())
    }

    /// The rule of its fill, if it is filled.
    fn fill(&self) -> Option<FillRule> {
        let fill = self.path.fill().filter(|fill| fill.opacity().get() > 0.0)?;
        Some(match fill.rule() {
            usvg::FillRule::EvenOdd => FillRule::EvenOdd,
            usvg::FillRule::NonZero => FillRule::NonZero,
        })
    }

    /// Its stroke, if it has one.
    fn pen(&self) -> Option<&usvg::Stroke> {
        self.path.stroke().filter(|stroke| stroke.opacity().get() > 0.0)
    }

    /// A rectangle around its path and its stroke [m]; not finite when the path or its map is not.
    pub(super) fn reach(&self) -> Rect {
        let to_metres = self.around.to_metres;
        let pen = self.pen().filter(|_| self.fill().is_none()).map_or(0.0, |pen| {
            let corner = f64::from(pen.miterlimit().get()).max(std::f64::consts::SQRT_2);
            0.5 * f64::from(pen.width().get()) * corner
        });
        to_metres.transform_rect_bbox(bezier(self.path.data()).control_box().inflate(pen, pen))
    }

    /// The area that it covers: of its fill, or of its stroke when its fill covers nothing; within its clips.
    pub(super) fn area(&self, tracing: &mut Tracing) -> Result<Area, Complaint> {
        let path = bezier(self.path.data());
        let mut area = Area::default();
        if let Some(rule) = self.fill() {
            area = tracing.fill(&(self.around.to_metres * &path), rule)?;
        }
        if let (Some(pen), true) = (self.pen(), area.is_empty()) {
            let outline = stroke_outline(&path, pen, tracing.tolerance / most_stretch(self.around.to_metres))?;
            area = tracing.fill(&(self.around.to_metres * &outline), FillRule::NonZero)?;
        }
        for &(clip, to_metres) in &self.around.clips {
            area = tracing.clipped(&area, clip, to_metres)?;
        }
        Ok(area)
    }

    /// The polylines that it draws [m]; outside of its clips they are cut off.
    pub(super) fn polylines(&self, tracing: &mut Tracing) -> Result<Vec<Polyline>, Complaint> {
        let path = self.around.to_metres * bezier(self.path.data());
        let mut lines = flatten(&path, tracing.tolerance, &mut tracing.budget, None)?;
        for &(clip, to_metres) in &self.around.clips {
            let area = tracing.clip_area(clip, to_metres)?;
            lines = lines.into_iter().flat_map(|line| area.cut_line(line, tracing.grid)).collect();
        }
        Ok(lines)
    }
}

/// What turns the pieces of one element into areas: how finely, with what may still be spent, and the clips so far.
pub(super) struct Tracing {
    grid: Grid,
    tolerance: f64,
    budget: Budget,
    /// Of all curves that areas have been made of.
    chords: Vec<Chord>,
    /// By the id of the clip and the map of its user to metres.
    clips: HashMap<(String, [u64; 6]), Area>,
}

impl Tracing {
    /// For an element within `reach` of the origin, curves flattened to `tolerance`, both in m.
    pub(super) fn new(reach: f64, tolerance: f64) -> Self {
        let (grid, budget) = (Grid::covering(reach), Budget::of_element());
        Self { grid, tolerance, budget, chords: Vec::new(), clips: HashMap::new() }
    }

    /// The chords of all curves that areas have been made of, on the grid.
    pub(super) fn chords(self) -> Vec<Chord> {
        let Self { grid, mut chords, .. } = self;
        chords.iter_mut().for_each(|chord| chord.ends = chord.ends.map(|end| grid.place(grid.snap(end))));
        chords
    }

    /// The grid on which all areas are.
    pub(super) fn grid(&self) -> Grid {
        self.grid
    }

    /// What any of the areas covers, joined where they share an edge but for a gap of at most `gap` [m].
    pub(super) fn joined(&mut self, areas: &[Area], gap: f64) -> Result<Area, Complaint> {
        if let [only] = areas {
            return Ok(only.clone());
        }
        self.budget.spend_crossings(areas.iter().flat_map(Area::rings))?;
        Area::joined(areas, gap, self.grid).ok_or_else(Budget::too_many_crossings)
    }

    /// What a path in metres fills; open subpaths are closed by a straight line, as SVG does.
    fn fill(&mut self, path: &BezPath, rule: FillRule) -> Result<Area, Complaint> {
        let mut lines = flatten(path, self.tolerance, &mut self.budget, Some(&mut self.chords))?;
        // What a map collapses to a line covers nothing, and its edges, all on one another, would be split without end.
        lines.retain(|(points, _)| !is_flat(points, ROUNDING * self.tolerance));
        let snap = |(points, _): Polyline| points.into_iter().map(|p| self.grid.snap(p)).collect();
        let rings: Vec<Vec<GridPoint>> = lines.into_iter().map(snap).collect();
        self.budget.spend_crossings(rings.iter().map(Vec::as_slice))?;
        Ok(Area::filled(&rings, rule))
    }

    /// What a clip leaves of an area.
    fn clipped(&mut self, area: &Area, clip: &usvg::ClipPath, to_metres: Affine) -> Result<Area, Complaint> {
        let clip = self.clip_area(clip, to_metres)?;
        self.budget.spend_crossings(area.rings().chain(clip.rings()))?;
        Ok(area.intersection(&clip))
    }

    /// The area that a clip leaves: what its shapes fill by their clip rules, within the clips that are on them and on
    /// it.
    fn clip_area(&mut self, clip: &usvg::ClipPath, to_metres: Affine) -> Result<Area, Complaint> {
        let key = (clip.id().to_owned(), to_metres.as_coeffs().map(f64::to_bits));
        if let Some(area) = self.clips.get(&key) {
            return Ok(area.clone());
        }
        let inside = Surroundings::outermost(to_metres * affine(clip.transform()));
        let mut pieces = Vec::new();
        collect_pieces(clip.root(), None, &inside, &mut pieces);
        let shapes = pieces.iter().map(|piece| piece.area(self)).collect::<Result<Vec<_>, _>>()?;
        self.budget.spend_crossings(shapes.iter().flat_map(Area::rings))?;
        let mut area = Area::union(&shapes);
        if let Some(outer) = clip.clip_path() {
            area = self.clipped(&area, outer, to_metres)?;
        }
        self.clips.insert(key, area.clone());
        Ok(area)
    }
}

/// Whether `points` lie within `width` of one line [m].
fn is_flat(points: &[Point], width: f64) -> bool {
    let Some(&first) = points.first() else { return true };
    let farthest = points.iter().map(|p| p - first).max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let along = farthest.and_then(|along| along.try_normalize(0.0));
    along.is_none_or(|along| points.iter().all(|p| along.perp(&(p - first)).abs() <= width))
}

/// A bound on the factor by which a map stretches lengths.
fn most_stretch(map: Affine) -> f64 {
    let [a, b, c, d, ..] = map.as_coeffs();
    (a * a + b * b + c * c + d * d).sqrt()
}

fn affine(t: usvg::Transform) -> Affine {
    Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from))
}

fn bezier(data: &usvg::tiny_skia_path::Path) -> BezPath {
    use usvg::tiny_skia_path::PathSegment;
    let point = |p: usvg::tiny_skia_path::Point| kurbo::Point::new(p.x.into(), p.y.into());
    data.segments()
        .map(|segment| match segment {
            PathSegment::MoveTo(p) => PathEl::MoveTo(point(p)),
            PathSegment::LineTo(p) => PathEl::LineTo(point(p)),
            PathSegment::QuadTo(p, q) => PathEl::QuadTo(point(p), point(q)),
            PathSegment::CubicTo(p, q, r) => PathEl::CurveTo(point(p), point(q), point(r)),
            PathSegment::Close => PathEl::ClosePath,
        })
        .collect()
}
