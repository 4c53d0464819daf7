//! Coulomb's friction on impulses.

use fissure_plane::Vector;

/// The part of the impulse `wanted` along a surface that friction bears where it is pressed by the impulse `normal`
/// [both N s/m], with the coefficient `friction`, which may be infinite. Nothing bears where nothing is pressed; what
/// is not a number stays so, for the watch of the step to tell.
pub(crate) fn borne_by_friction(wanted: f64, friction: f64, normal: f64) -> f64 {
    // Not 0 times infinity for a friction without bound; not `clamp`, which panics if the limit is not a number.
    let limit = if normal > 0.0 { friction * normal } else { 0.0 };
    if wanted > limit {
        limit
    } else if wanted < -limit {
        -limit
    } else {
        wanted
    }
}

/// The direction along a surface: its unit `normal`, turned left.
pub(crate) fn left_of(normal: Vector) -> Vector {
    Vector::new(-normal.y, normal.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_friction_bears_is_within_its_cone() {
        assert_eq!(borne_by_friction(3.0, 0.5, 4.0), 2.0);
        assert_eq!(borne_by_friction(-3.0, 0.5, 4.0), -2.0);
        assert_eq!(borne_by_friction(1.5, 0.5, 4.0), 1.5);
        // A surface that sticks whatever comes holds nothing where nothing presses.
        assert_eq!(borne_by_friction(1.5, f64::INFINITY, 4.0), 1.5);
        assert_eq!(borne_by_friction(1.5, f64::INFINITY, 0.0), 0.0);
    }

    #[test]
    fn no_number_of_a_wild_state_panics() {
        let wild = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, f64::MAX];
        for wanted in wild {
            for normal in wild {
                for friction in [0.0, 0.3, f64::INFINITY] {
                    let _ = borne_by_friction(wanted, friction, normal);
                }
            }
        }
    }
}
