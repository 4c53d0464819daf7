//! The outline of a stroke.

use crate::load::seating::Complaint;
use kurbo::{BezPath, Cap, Join, ParamCurveArclen as _, Stroke, StrokeOpts};

/// Dashes of one path at most.
const MOST_DASHES: f64 = 20_000.0;

/// The area that a pen leaves on its way along `path`, as a path to be filled nonzero; in the path's own units.
///
/// `tolerance`: how far the outline may be off, in the same units.
pub(super) fn stroke_outline(path: &BezPath, pen: &usvg::Stroke, tolerance: f64) -> Result<BezPath, Complaint> {
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
    if let Some(dashes) = pen.dasharray() {
        let dashes: Vec<f64> = dashes.iter().map(|&d| f64::from(d)).collect();
        let period: f64 = dashes.iter().sum();
        let length: f64 = path.segments().map(|s| s.arclen(0.01 * period.max(tolerance))).sum();
        let count = dashes.len() as f64 * length / period / 2.0;
        if count.is_nan() || count > MOST_DASHES {
            let message = format!("its stroke has {count:.0} dashes, more than {MOST_DASHES}");
            return Err((message, "make them longer, or draw the line without dashes".into()));
        }
        style = style.with_dashes(f64::from(pen.dashoffset()).rem_euclid(period), dashes);
    }
    Ok(kurbo::stroke(path.iter(), &style, &StrokeOpts::default(), tolerance))
}
