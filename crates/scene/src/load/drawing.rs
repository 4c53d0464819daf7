//! Outlines and lines from an SVG drawing.
//!
//! Paint does not matter: an element counts whether or not it is filled, stroked or displayed. Curves come from usvg in
//! single precision, about 1e-7 of the size of the drawing.

use super::error::{DRAWING, FONT, LoadError};
use super::seating::Complaint;
use crate::document::{Drawing, Origin};
use crate::fault::{KeyPath, SceneFault, nearest, show};
use crate::geometry::{Point, Region, bounds};
use crate::outline::{FillRule, clean_ring, find_crossing, nest_rings};
use crate::validate::{COORDINATE, LENGTH};
use kurbo::{Affine, BezPath, PathEl, Shape as _};
use std::path::{Path, PathBuf};
use usvg::roxmltree;

/// Shows everything, filled and stroked, so that usvg drops nothing for its paint.
const SHOW_ALL: &str = "* { display: inline !important; visibility: visible !important; opacity: 1 !important; \
    fill: #000 !important; fill-opacity: 1 !important; stroke: #000 !important; stroke-opacity: 1 !important; \
    stroke-width: 1 !important; stroke-dasharray: none !important; marker: none !important; clip-path: none !important; \
    mask: none !important; filter: none !important }";

/// Metres of an SVG pixel: 96 make an inch.
const METRES_PER_PIXEL: f64 = 0.0254 / 96.0;

/// A drawing, scaled to metres.
pub(crate) struct LoadedDrawing {
    pub(crate) path: PathBuf,
    /// The files it is made of, for the hash of the scene.
    pub(crate) bytes: Vec<Vec<u8>>,
    text: String,
    tree: usvg::Tree,
    to_metres: Affine,
}

impl LoadedDrawing {
    /// Reads the drawing of a scene whose files are relative to `folder`.
    pub(crate) fn read(
        drawing: &Drawing,
        folder: &Path,
        fault: impl Fn(SceneFault) -> LoadError,
    ) -> Result<Self, LoadError> {
        let path = folder.join(&drawing.file);
        let text = DRAWING.read_text(&path)?;
        let malformed = |span, message: String| {
            LoadError::malformed(&path, &text, span, message, "open the drawing in an SVG editor and save it again")
        };
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(&text, options).map_err(|e| {
            let start = byte_offset(&text, e.pos());
            malformed(Some(start..(start + 1).min(text.len())), format!("not valid SVG: {e}"))
        })?;
        let mut bytes = vec![text.clone().into_bytes()];
        let mut options = usvg::Options { style_sheet: Some(SHOW_ALL.into()), ..Default::default() };
        if document.descendants().any(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "text"))) {
            if let Some(font) = &drawing.font {
                bytes.push(FONT.read(&folder.join(font))?);
            }
            let font = bytes.get(1).cloned();
            load_fonts(&mut options, font, &folder.join(drawing.font.as_deref().unwrap_or(Path::new(""))))?;
        }
        let tree = usvg::Tree::from_xmltree(&document, &options)
            .map_err(|e| malformed(None, format!("not valid SVG: {e}")))?;
        let to_metres = scale(drawing, &document, tree.size()).map_err(fault)?;
        Ok(Self { bytes, tree, to_metres, path: path.clone(), text: text.clone() })
    }

    /// The regions that element `id` encloses, curves flattened to `tolerance` [m].
    pub(crate) fn regions(&self, id: &str, tolerance: f64) -> Result<Vec<Region>, Complaint> {
        let mut rings = Vec::new();
        for (path, rule) in self.paths(id)? {
            let mut own = Vec::new();
            for (points, closed) in polylines(&path, tolerance) {
                let ring = clean_ring(&points, tolerance * 1e-3);
                if ring.len() < 3 && points.len() <= 2 && closed {
                    continue; // A stray point of an editor.
                }
                if !closed {
                    let (first, last) = (points[0], points[points.len() - 1]);
                    let message =
                        format!("the outline of `{id}` is open: it runs from {} m to {} m", show(first), show(last));
                    return Err((message, "close the path (end its data with Z)".into()));
                }
                own.push(ring);
            }
            no_crossing(id, &own)?;
            for region in nest_rings(&own, rule) {
                rings.push(region.exterior);
                rings.extend(region.holes);
            }
        }
        no_crossing(id, &rings)?;
        // Each path is now exteriors counter-clockwise and holes clockwise: a point covered by any of them turns nonzero.
        let regions = nest_rings(&rings, FillRule::NonZero);
        if regions.is_empty() {
            return Err((format!("`{id}` encloses no area"), "draw a closed outline".into()));
        }
        Ok(regions)
    }

    /// The open line that element `id` is.
    pub(crate) fn line(&self, id: &str, tolerance: f64) -> Result<Vec<Point>, Complaint> {
        let paths = self.paths(id)?;
        let mut lines: Vec<_> = paths.iter().flat_map(|(path, _)| polylines(path, tolerance)).collect();
        match (lines.pop(), lines.len()) {
            (Some((points, false)), 0) => Ok(without_repeats(points)),
            (Some((points, true)), 0) => {
                let message = format!("the line `{id}` is closed, it comes back to {} m", show(points[0]));
                Err((message, "open it: a crack or guide has two ends".into()))
            }
            (_, more) => {
                let message = format!("`{id}` consists of {} lines", more + 1);
                Err((message, "give each line its own id".into()))
            }
        }
    }

    /// Smallest rectangle around the curves of element `id` [m].
    pub(crate) fn bounds(&self, id: &str) -> Result<(Point, Point), Complaint> {
        let corners: Vec<Point> = self
            .paths(id)?
            .iter()
            .flat_map(|(path, _)| {
                let b = path.bounding_box();
                [Point::new(b.x0, b.y0), Point::new(b.x1, b.y1)]
            })
            .collect();
        Ok(bounds(&corners))
    }

    /// All paths of element `id` in metres, with their fill rules.
    fn paths(&self, id: &str) -> Result<Vec<(BezPath, FillRule)>, Complaint> {
        let mut paths = Vec::new();
        if let Some(node) = self.tree.node_by_id(id) {
            self.collect(node, &mut paths);
        }
        if paths.is_empty() {
            return Err(self.explain_absence(id));
        }
        Ok(paths)
    }

    fn collect(&self, node: &usvg::Node, paths: &mut Vec<(BezPath, FillRule)>) {
        match node {
            usvg::Node::Group(group) => group.children().iter().for_each(|n| self.collect(n, paths)),
            usvg::Node::Text(text) => text.flattened().children().iter().for_each(|n| self.collect(n, paths)),
            usvg::Node::Image(_) => {}
            usvg::Node::Path(path) => {
                let t = path.abs_transform();
                let own = Affine::new([t.sx, t.ky, t.kx, t.sy, t.tx, t.ty].map(f64::from));
                let rule = match path.fill().map(usvg::Fill::rule) {
                    Some(usvg::FillRule::EvenOdd) => FillRule::EvenOdd,
                    _ => FillRule::NonZero,
                };
                paths.push((self.to_metres * own * bezier(path.data()), rule));
            }
        }
    }

    /// Why there is nothing of element `id`.
    fn explain_absence(&self, id: &str) -> Complaint {
        let file = self.path.display();
        // The text was parsed before, with the same options.
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let Ok(document) = roxmltree::Document::parse_with_options(&self.text, options) else {
            return (format!("{file} has no element `{id}`"), String::new());
        };
        let Some(node) = document.descendants().find(|n| n.attribute("id") == Some(id)) else {
            let drawn = ["path", "rect", "circle", "ellipse", "line", "polyline", "polygon", "text", "g", "use"];
            let ids: Vec<&str> = document
                .descendants()
                .filter(|n| drawn.contains(&n.tag_name().name()))
                .filter_map(|n| n.attribute("id"))
                .collect();
            return (format!("{file} has no element `{id}`"), nearest(id, &ids));
        };
        let line = document.text_pos_at(node.range().start).row;
        let tag = node.tag_name().name();
        if node.descendants().any(|n| n.tag_name().name() == "text") {
            let message =
                format!("the text `{id}` ({file}:{line}) gives no outline: it is empty, or no font has its letters");
            return (message, "name a font file: `[drawing] font = \"...ttf\"`, or convert the text to paths".into());
        }
        let message = format!("`{id}` ({file}:{line}) is a <{tag}> that draws no line");
        (
            message,
            "give the id of a path, a basic shape, a text or a group, outside of <defs>, of a size above 0".into(),
        )
    }
}

fn no_crossing(id: &str, rings: &[Vec<Point>]) -> Result<(), Complaint> {
    let lines: Vec<&[Point]> = rings.iter().map(Vec::as_slice).collect();
    find_crossing(&lines, true).map_or(Ok(()), |at| {
        let message = format!("the outline of `{id}` crosses or touches itself at {} m", show(at));
        Err((message, "separate or unite its parts in the SVG editor".into()))
    })
}

fn without_repeats(mut points: Vec<Point>) -> Vec<Point> {
    points.dedup();
    points
}

/// The font that stands in for families that are not there; public domain, see `assets/fonts`.
const FALLBACK_FONT: &[u8] = include_bytes!("../../../../assets/fonts/Tuffy.ttf");

/// Loads fonts: the user's own in front, then the one that comes with Fissure, then the installed ones.
///
/// The first stands in for families that are not there and for the generic ones, so that a drawing that names no
/// installed font looks the same on every machine.
fn load_fonts(options: &mut usvg::Options<'_>, font: Option<Vec<u8>>, path: &Path) -> Result<(), LoadError> {
    let fonts = options.fontdb_mut();
    if let Some(font) = font {
        fonts.load_font_data(font);
        if fonts.is_empty() {
            return Err(LoadError::file(path, "not a font", "name a TrueType or OpenType file (.ttf, .otf)"));
        }
    }
    fonts.load_font_data(FALLBACK_FONT.to_vec());
    let fallback = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
    fonts.load_system_fonts();
    if let Some(family) = fallback {
        fonts.set_serif_family(&family);
        fonts.set_sans_serif_family(&family);
        fonts.set_monospace_family(&family);
        fonts.set_cursive_family(&family);
        fonts.set_fantasy_family(&family);
        options.font_family = family;
    }
    Ok(())
}

/// From usvg's pixels (y down) to metres (y up).
fn scale(drawing: &Drawing, document: &roxmltree::Document<'_>, size: usvg::Size) -> Result<Affine, SceneFault> {
    let key = |key: &str| KeyPath::setting("drawing", key);
    let root = document.root_element();
    let (width, height) = (f64::from(size.width()), f64::from(size.height()));
    let [x, y, w, h] = view_box(&root).unwrap_or([0.0, 0.0, width, height]);
    let to_pixels = view_box_to_pixels([x, y, w, h], [width, height], root.attribute("preserveAspectRatio"));
    let metres_per_unit = match (drawing.width, drawing.metres_per_unit) {
        (Some(_), Some(_)) => {
            let message = "both `width` and `metres_per_unit` are given";
            return Err(SceneFault::new(key("metres_per_unit"), message, "give one of them"));
        }
        (Some(metres), None) => {
            LENGTH.check(key("width"), "the width of the drawing", metres)?;
            metres / w
        }
        (None, Some(metres)) => {
            LENGTH.check(key("metres_per_unit"), "`metres_per_unit`", metres)?;
            metres
        }
        (None, None) => {
            if !has_physical_units(root.attribute("width")) {
                return Err(SceneFault::new(
                    KeyPath::top("drawing"),
                    format!("the drawing {} has no physical size", drawing.file.display()),
                    "say how large it is: `width = ...` (metres that its width spans) or `metres_per_unit = ...`",
                ));
            }
            METRES_PER_PIXEL * to_pixels.as_coeffs()[0]
        }
    };
    let origin = match drawing.origin {
        Origin::Center => [x + w / 2.0, y + h / 2.0],
        Origin::Corner => [x, y + h],
        Origin::Point(point) => {
            COORDINATE.check_pair(key("origin"), "the origin", point)?;
            point
        }
    };
    let from_origin = Affine::translate((-origin[0], -origin[1]));
    Ok(Affine::scale_non_uniform(metres_per_unit, -metres_per_unit) * from_origin * to_pixels.inverse())
}

fn view_box(root: &roxmltree::Node<'_, '_>) -> Option<[f64; 4]> {
    let text = root.attribute("viewBox")?;
    let numbers: Vec<f64> =
        text.split([' ', ',', '\n', '\t']).filter(|s| !s.is_empty()).map_while(|s| s.parse().ok()).collect();
    let numbers: [f64; 4] = numbers.try_into().ok()?;
    (numbers[2] > 0.0 && numbers[3] > 0.0).then_some(numbers)
}

/// The map from user units to pixels, as SVG defines it for a viewBox.
fn view_box_to_pixels([x, y, w, h]: [f64; 4], [width, height]: [f64; 2], aspect: Option<&str>) -> Affine {
    let aspect = aspect.unwrap_or("xMidYMid");
    let (sx, sy) = (width / w, height / h);
    if aspect.starts_with("none") {
        return Affine::scale_non_uniform(sx, sy) * Affine::translate((-x, -y));
    }
    let s = if aspect.contains("slice") { sx.max(sy) } else { sx.min(sy) };
    let share = |low: &str, high: &str| match () {
        () if aspect.contains(low) => 0.0,
        () if aspect.contains(high) => 1.0,
        () => 0.5,
    };
    let shift = ((width - s * w) * share("xMin", "xMax"), (height - s * h) * share("YMin", "YMax"));
    Affine::translate(shift) * Affine::scale(s) * Affine::translate((-x, -y))
}

fn has_physical_units(width: Option<&str>) -> bool {
    width.is_some_and(|w| ["mm", "cm", "in", "pt", "pc"].iter().any(|unit| w.trim().ends_with(unit)))
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

/// The subpaths of a path, flattened, each with whether it is closed (by Z or by ending where it began).
fn polylines(path: &BezPath, tolerance: f64) -> Vec<(Vec<Point>, bool)> {
    let mut lines: Vec<(Vec<Point>, bool)> = Vec::new();
    let mut start = Point::origin();
    kurbo::flatten(path.iter(), tolerance, |element| match element {
        PathEl::MoveTo(p) => {
            start = Point::new(p.x, p.y);
            lines.push((vec![start], false));
        }
        PathEl::LineTo(p) => {
            if lines.last().is_none_or(|(_, closed)| *closed) {
                lines.push((vec![start], false));
            }
            if let Some((points, _)) = lines.last_mut() {
                points.push(Point::new(p.x, p.y));
            }
        }
        PathEl::ClosePath => {
            if let Some((_, closed)) = lines.last_mut() {
                *closed = true;
            }
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    lines.retain(|(points, _)| points.len() > 1);
    for (points, closed) in &mut lines {
        let gap = (points[0] - points[points.len() - 1]).norm();
        *closed = *closed || (points.len() > 3 && gap <= tolerance * 1e-3);
    }
    lines
}

fn byte_offset(text: &str, position: roxmltree::TextPos) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.row.saturating_sub(1) as usize).map(str::len).sum();
    let line = text.get(line_start..).unwrap_or_default();
    let column = line.char_indices().nth(position.col.saturating_sub(1) as usize).map_or(0, |(i, _)| i);
    (line_start + column).min(text.len().saturating_sub(1))
}
