//! Outlines of bodies, colliders and selections.

use crate::fault::Check;
use crate::fault::{KeyPath, SceneFault, show};
use crate::range::{COORDINATE, CORNERS};
use fissure_plane::{Point, Region, bounds, find_crossing, orientation, signed_area};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

/// A region is finite, simple, oriented, and its holes lie inside and apart.
pub(crate) fn validate_region(path: &KeyPath, what: &str, region: &Region) -> Check {
    let fault = |message: String, remedy: &str| Err(SceneFault::new(path.clone(), message, remedy));
    CORNERS.check(path, what, region.rings().map(<[Point]>::len).sum())?;
    for ring in region.rings() {
        COORDINATE.check_points(path, what, ring)?;
        if ring.windows(3).all(|w| orientation(w[0], w[1], w[2]) == 0.0) {
            return fault(
                format!("{what} encloses no area ({} different corners)", ring.len()),
                "give it at least three corners, not on one line",
            );
        }
    }
    let rings: Vec<&[Point]> = region.rings().collect();
    if let Some(at) = find_crossing(&rings, true) {
        return fault(
            format!("{what} crosses or touches itself at {} m", show(at)),
            "draw each ring without crossings, and holes apart from each other and from the edge",
        );
    }
    if signed_area(&region.exterior) < 0.0 || region.holes.iter().any(|h| signed_area(h) > 0.0) {
        return fault(format!("{what} turns the wrong way"), "exteriors run counter-clockwise, holes clockwise");
    }
    let simple = |ring: &[Point]| Region { exterior: ring.to_vec(), holes: Vec::new() };
    let exterior = simple(&region.exterior);
    for (i, hole) in region.holes.iter().enumerate() {
        let inside_other = region.holes[..i].iter().any(|o| {
            let reverse = |r: &[Point]| r.iter().rev().copied().collect::<Vec<_>>();
            simple(&reverse(o)).contains(hole[0]) || simple(&reverse(hole)).contains(o[0])
        });
        if !exterior.contains(hole[0]) || inside_other {
            return fault(
                format!("a hole of {what} at {} m does not lie inside it", show(hole[0])),
                "holes lie inside the outline and not inside each other",
            );
        }
    }
    Ok(())
}

/// Whether a distance from a ring is rounding only.
pub(super) fn is_on(region: &Region, distance: f64) -> bool {
    let (low, high) = bounds(&region.exterior);
    distance <= 1e-12 * (low.coords.amax().max(high.coords.amax()))
}

/// Area that two regions share [m²]; 0 when it is no more than the rounding of a common border.
pub(crate) fn overlap(a: &Region, b: &Region) -> f64 {
    let ((a_low, a_high), (b_low, b_high)) = (a.bounds(), b.bounds());
    if a_low.x >= b_high.x || b_low.x >= a_high.x || a_low.y >= b_high.y || b_low.y >= a_high.y {
        return 0.0;
    }
    let rings = |region: &Region| -> Vec<Vec<[f64; 2]>> {
        region.rings().map(|ring| ring.iter().map(|p| [p.x, p.y]).collect()).collect()
    };
    let shared = rings(a).overlay_as::<i64>(&rings(b), OverlayRule::Intersect, FillRule::NonZero);
    let area = |ring: &Vec<[f64; 2]>| signed_area(&ring.iter().map(|&[x, y]| Point::new(x, y)).collect::<Vec<_>>());
    let shared = shared.iter().flatten().map(area).sum::<f64>();
    if shared > 1e-6 * a.area().min(b.area()) { shared } else { 0.0 }
}
