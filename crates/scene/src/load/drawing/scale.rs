//! How large a drawing is: from pixels to metres.

use crate::document::{Drawing, Origin};
use crate::fault::{KeyPath, SceneFault};
use crate::range::{COORDINATE, LENGTH};
use kurbo::Affine;
use usvg::roxmltree;

/// Metres of an SVG pixel: 96 make an inch.
const METRES_PER_PIXEL: f64 = 0.0254 / 96.0;

/// From usvg's pixels (y down) to metres (y up), and the larger side of the drawing [m].
pub(super) fn scale(
    drawing: &Drawing,
    document: &roxmltree::Document<'_>,
    size: usvg::Size,
) -> Result<(Affine, f64), SceneFault> {
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
    // Units are as high as they are wide unless the drawing asks for its page to be filled.
    let [across, _, _, down, ..] = to_pixels.as_coeffs();
    let stretch = down / across;
    let to_metres =
        Affine::scale_non_uniform(metres_per_unit, -metres_per_unit * stretch) * from_origin * to_pixels.inverse();
    Ok((to_metres, metres_per_unit * w.max(h * stretch)))
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
