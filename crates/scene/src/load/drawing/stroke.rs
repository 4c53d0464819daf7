//! The outline of a stroke.

use super::limits::{MOST_DASHES, MOST_STROKED_SEGMENTS};
use crate::load::seating::Complaint;
use kurbo::{BezPath, Cap, Join, ParamCurveArclen as _, PathEl, Stroke, StrokeOpts};

/// The area that a pen leaves on its way along `path`, as a path to be filled nonzero; in the path's own units.
///
/// `tolerance`: how far the outline may be off, in the same units.
pub(super) fn stroke_outline(path: &BezPath, pen: &usvg::Stroke, tolerance: f64) -> Result<BezPath, Complaint> {
    let segments = path.elements().len();
    if segments > MOST_STROKED_SEGMENTS {
        let message = format!("its stroke has {segments} segments, more than {MOST_STROKED_SEGMENTS}");
        return Err((message, "simplify the path, or turn its stroke into a path in the SVG editor".into()));
    }
    let cap = match pen.linecap() {
        usvg::LineCap::Butt => Cap::Butt,
        usvg::LineCap::Round => Cap::Round,
        usvg::LineCap::Square => Cap::Square,
    };
    let join = match pen.linejoin() {
        usvg::LineJoin::Miter | usvg::LineJoin::MiterClip => Join::Miter,
        usvg::LineJoin::Round => Join::Round,
        usvg::LineJoin::Bevel => Join::Bevel,
    };
    let width = f64::from(pen.width().get());
    let mut style =
        Stroke::new(width).with_caps(cap).with_join(join).with_miter_limit(f64::from(pen.miterlimit().get()));
    // Caps make dots of dashes and subpaths without length, which have to be given one to be seen.
    let dot = if cap == Cap::Butt { 0.0 } else { DOT * width };
    if let Some(dashes) = pen.dasharray() {
        style = dashed(style, path, dashes, f64::from(pen.dashoffset()), dot, tolerance)?;
    }
    let path = with_dots(path, dot);
    Ok(kurbo::stroke(path.iter(), &style, &StrokeOpts::default(), tolerance))
}

/// Length of a dot without its caps, in widths of the pen.
const DOT: f64 = 1e-3;

/// The style with dashes; those shorter than `dot` get that length.
fn dashed(
    style: Stroke,
    path: &BezPath,
    dashes: &[f32],
    offset: f64,
    dot: f64,
    tolerance: f64,
) -> Result<Stroke, Complaint> {
    let mut dashes: Vec<f64> = dashes.iter().map(|&d| f64::from(d)).collect();
    let period: f64 = dashes.iter().sum();
    let length: f64 = path.segments().map(|s| s.arclen(0.01 * period.max(tolerance))).sum();
    let count = dashes.len() as f64 * length / period / 2.0;
    if count.is_nan() || count > MOST_DASHES {
        let message = format!("its stroke has {count:.0} dashes, more than {MOST_DASHES}");
        return Err((message, "make them longer, or draw the line without dashes".into()));
    }
    for pair in dashes.chunks_exact_mut(2).filter(|pair| pair[0] < dot) {
        pair[1] = (pair[1] + pair[0] - dot).max(0.0);
        pair[0] = dot;
    }
    Ok(style.with_dashes(offset.rem_euclid(period), dashes))
}

/// The path with a length of `dot` for the lines that have none.
fn with_dots(path: &BezPath, dot: f64) -> BezPath {
    let mut last = kurbo::Point::ORIGIN;
    let longer = |element: &PathEl| {
        let element = match *element {
            PathEl::LineTo(p) if p == last => PathEl::LineTo(p + (dot, 0.0)),
            element => element,
        };
        last = element.end_point().unwrap_or(last);
        element
    };
    path.elements().iter().map(longer).collect()
}
