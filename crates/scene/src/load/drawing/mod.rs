//! Outlines and lines from an SVG drawing.
//!
//! An element means what an SVG viewer shows of it, whatever its colour. Its area is what its fill covers by its own
//! fill rule; an element without fill is the area of its stroke; a group is the union of what it holds. Clips apply.
//! Only when nothing of an element can be seen does it count as if it were shown, and if it has no paint, as if it were
//! filled. A line is the path of its element, whatever its paint.
//!
//! Curves come from usvg in single precision, about 1e-7 of the size of the drawing.

mod area;
mod bridge;
mod cost;
mod effects;
mod entities;
mod flatten;
mod fonts;
mod grid;
mod limits;
mod names;
mod piece;
mod pinch;
mod scale;
mod stroke;
mod styles;
mod views;

use super::chord::Chord;
use super::error::{DRAWING, FONT, LoadError};
use super::seating::Complaint;
use crate::document::Drawing;
use crate::fault::{SceneFault, show};
use effects::Effects;
use fissure_plane::{Point, Region, bounds};
use fonts::Fonts;
use kurbo::Affine;
use limits::{Excess, MOST_NODES, MOST_PARTS};
pub(super) use names::WHOLE_DRAWING;
use names::{Element, Names};
use piece::{Piece, Surroundings, Tracing, collect_pieces};
use std::path::{Path, PathBuf};
use styles::Styles;
use usvg::roxmltree::{Document, Error, ParsingOptions, TextPos};
use views::{View, Views};

/// Nothing of a drawing may reach farther than this many times its size.
const FARTHEST: f64 = 1e6;
/// Parts and holes narrower than this part of the flattening tolerance are rounding.
const ROUNDING: f64 = 1e-3;
/// Rings that touch are parted by this part of the flattening tolerance.
const NOTCH: f64 = 0.25;
/// Elements of a group that lie closer along an edge than this many flattening tolerances share it.
const GAP: f64 = 2.0;

/// A drawing, scaled to metres.
pub(crate) struct LoadedDrawing {
    names: Names,
    effects: Effects,
    views: Views,
    to_metres: Affine,
    /// The larger side of its page [m].
    size: f64,
}

impl LoadedDrawing {
    /// Reads the drawing of a scene; `locate` finds the files that the scene names.
    pub(crate) fn read(
        drawing: &Drawing,
        locate: impl Fn(&Path) -> PathBuf,
        fault: impl Fn(SceneFault) -> LoadError,
    ) -> Result<Self, LoadError> {
        let path = locate(&drawing.file);
        let text = DRAWING.read_text(&path)?;
        let font = match &drawing.font {
            Some(font) => {
                let file = locate(font);
                let bytes = FONT.read(&file)?;
                Some((file, bytes))
            }
            None => None,
        };
        Self::parse(drawing, &path, text, font, fault)
    }

    /// The same from what was read: the text of the drawing at `path`, and the font with its path.
    pub(crate) fn parse(
        drawing: &Drawing,
        path: &Path,
        text: String,
        font: Option<(PathBuf, Vec<u8>)>,
        fault: impl Fn(SceneFault) -> LoadError,
    ) -> Result<Self, LoadError> {
        let malformed = |span, message: String| {
            LoadError::malformed(path, &text, span, message, "open the drawing in an SVG editor and save it again")
        };
        let excess = |Excess { span, message }: Excess| {
            LoadError::malformed(path, &text, Some(span), message, "simplify the drawing in an SVG editor")
        };
        entities::check_text(&text).map_err(excess)?;
        let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..Default::default() };
        let document = Document::parse_with_options(&text, options).map_err(|e| match e {
            Error::NodesLimitReached => {
                excess(Excess::new(0..1, format!("the drawing has more than {MOST_NODES} nodes")))
            }
            e => {
                let start = byte_offset(&text, e.pos());
                malformed(Some(start..(start + 1).min(text.len())), format!("not valid SVG: {e}"))
            }
        })?;
        let styles = Styles::read(&document).map_err(excess)?;
        cost::check_document(&document, &styles).map_err(excess)?;
        let fonts = if document.descendants().any(|n| n.tag_name().name() == "text") {
            Fonts::load(font.as_ref().map(|(file, bytes)| (file.as_path(), bytes.as_slice())))?
        } else {
            Fonts::default()
        };
        let (names, with_ids) = Names::read(path, &text, &document);
        let effects = Effects::read(&document, &styles);
        let views = Views::new(with_ids, fonts);
        let tree = views.tree(View::Drawn).map_err(|(message, _)| malformed(None, message))?;
        let (to_metres, size) = scale::scale(drawing, &document, tree.size()).map_err(fault)?;
        Ok(Self { names, effects, views, to_metres, size })
    }

    /// The regions that element `name` covers, from left to right, curves flattened to `tolerance` [m].
    ///
    /// They are simple and apart: places where outlines touch themselves are parted by a notch smaller than the
    /// tolerance.
    pub(crate) fn regions(&self, name: &str, tolerance: f64) -> Result<Vec<Region>, Complaint> {
        Ok(self.outlines(name, tolerance)?.0)
    }

    /// The regions that element `name` covers, as [`LoadedDrawing::regions`] gives them, and the chords of all curves
    /// that they were made of.
    pub(crate) fn outlines(&self, name: &str, tolerance: f64) -> Result<(Vec<Region>, Vec<Chord>), Complaint> {
        let element = self.names.find(name)?;
        let place = |(message, remedy): Complaint| (format!("{}: {message}", self.names.place(name, element)), remedy);
        self.effects.check_masks(element.number, &self.names.place(name, element))?;
        let pieces = self.pieces(name, element, |piece| piece.is_painted())?;
        let mut tracing = Tracing::new(self.reach(&pieces).map_err(place)?, tolerance);
        let areas =
            pieces.iter().map(|piece| piece.area(&mut tracing)).collect::<Result<Vec<_>, _>>().map_err(place)?;
        let area = tracing.joined(&areas, GAP * tolerance).map_err(place)?;
        let regions = area.regions(tracing.grid(), ROUNDING * tolerance, NOTCH * tolerance);
        if regions.is_empty() {
            return Err(place(("it encloses no area".into(), "draw a closed outline".into())));
        }
        if regions.len() > MOST_PARTS {
            let message = format!("it falls into {} parts, more than {MOST_PARTS}", regions.len());
            return Err(place((message, "simplify it in the SVG editor".into())));
        }
        Ok((regions, tracing.chords()))
    }

    /// The open line that element `name` is.
    pub(crate) fn line(&self, name: &str, tolerance: f64) -> Result<Vec<Point>, Complaint> {
        let element = self.names.find(name)?;
        let place = |(message, remedy): Complaint| (format!("{}: {message}", self.names.place(name, element)), remedy);
        let pieces = self.pieces(name, element, |_| true)?;
        let mut tracing = Tracing::new(self.reach(&pieces).map_err(place)?, tolerance);
        let mut lines = Vec::new();
        for piece in &pieces {
            lines.extend(piece.polylines(&mut tracing).map_err(place)?);
        }
        match (lines.pop(), lines.len()) {
            (Some((points, false)), 0) => Ok(without_repeats(points)),
            (Some((points, true)), 0) => {
                let message = format!("the line `{name}` is closed, it comes back to {} m", show(points[0]));
                Err((message, "open it: a crack or guide has two ends".into()))
            }
            (None, _) => Err((format!("the line `{name}` is clipped away"), "release its clip".into())),
            (_, more) => {
                let message = format!("`{name}` consists of {} lines", more + 1);
                Err((message, "give each line its own id".into()))
            }
        }
    }

    /// The larger side of the page [m].
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Smallest rectangle around the area of element `name` [m].
    pub(crate) fn bounds(&self, name: &str) -> Result<(Point, Point), Complaint> {
        /// Curves are flattened to this part of the drawing's size, to know how large an element is.
        const PART: f64 = 1e-5;
        let regions = self.regions(name, PART * self.size)?;
        Ok(bounds(&regions.iter().flat_map(|r| r.exterior.iter().copied()).collect::<Vec<_>>()))
    }

    /// What element `name` has that its area does not show: message and remedy of each.
    pub(crate) fn remarks(&self, name: &str) -> Vec<Complaint> {
        let of = |element: &Element| self.effects.remarks(element.number, &self.names.place(name, element));
        self.names.find(name).map(of).unwrap_or_default()
    }

    /// The paths of an element that count, in the first view in which there are any.
    fn pieces(
        &self,
        name: &str,
        element: &Element,
        counts: impl Fn(&Piece<'_>) -> bool,
    ) -> Result<Vec<Piece<'_>>, Complaint> {
        for view in View::ALL {
            let mut pieces = Vec::new();
            let around = Surroundings::outermost(self.to_metres);
            collect_pieces(self.views.tree(view)?.root(), element.key.as_deref(), &around, &mut pieces);
            pieces.retain(&counts);
            if !pieces.is_empty() {
                return Ok(pieces);
            }
        }
        Err(self.names.explain_absence(name, element))
    }

    /// The largest coordinate of `pieces` [m].
    fn reach(&self, pieces: &[Piece<'_>]) -> Result<f64, Complaint> {
        let rectangles = pieces.iter().map(Piece::reach);
        let reach = rectangles
            .flat_map(|r| [r.x0, r.y0, r.x1, r.y1])
            .fold(0.0_f64, |reach, x| if x.is_nan() { f64::INFINITY } else { reach.max(x.abs()) });
        if reach > FARTHEST * self.size || !reach.is_finite() {
            let message = format!("it reaches to {reach:e} m, more than {FARTHEST:e} times the size of the drawing");
            return Err((message, "look for huge numbers in its path, its stroke and its transforms".into()));
        }
        Ok(reach)
    }
}

fn without_repeats(mut points: Vec<Point>) -> Vec<Point> {
    points.dedup();
    points
}

fn byte_offset(text: &str, position: TextPos) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.row.saturating_sub(1) as usize).map(str::len).sum();
    let line = text.get(line_start..).unwrap_or_default();
    let column = line.char_indices().nth(position.col.saturating_sub(1) as usize).map_or(0, |(i, _)| i);
    (line_start + column).min(text.len().saturating_sub(1))
}
