//! What the two faces of a crack do to each other where they meet.

use fissure_plane::Vector;

/// The impulse, per unit thickness [N s/m], that the face above gets, and the one below loses, where faces of masses
/// `mass`, above and below [kg/m], come nearer to each other than they may; none where they do not.
///
/// `speed`: velocity above less velocity below [m/s]; `normal`: unit vector from below to above; `allowed`: the speed
/// along the normal that is left, negative when the faces may still approach [m/s]. Afterwards the faces have just this
/// speed along the normal. `friction` after Coulomb: along the faces the impulse is at most so many times the one along
/// the normal, and what sticks stops; infinity sticks always.
pub(crate) fn face_impulse(
    speed: Vector,
    normal: Vector,
    allowed: f64,
    mass: [f64; 2],
    friction: f64,
) -> Option<Vector> {
    let approach = speed.dot(&normal);
    if approach >= allowed {
        return None;
    }
    let reduced = mass[0] * mass[1] / (mass[0] + mass[1]);
    let sliding = speed - normal * approach;
    let sliding_speed = sliding.norm();
    let mut impulse = normal * ((allowed - approach) * reduced);
    if friction > 0.0 && sliding_speed > 0.0 {
        let most = friction * (allowed - approach);
        impulse -= sliding * (reduced * (most / sliding_speed).min(1.0));
    }
    Some(impulse)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Truth: Coulomb's law. Faces of 1 and 3 kg/m (0.75 together) meet at 4 m/s and slide at 2 m/s.
    #[test]
    fn faces_slide_below_the_friction_that_holds_them_and_stick_above() {
        let (speed, normal) = (Vector::new(2.0, -4.0), Vector::new(0.0, 1.0));
        let impulse = |allowed, friction| face_impulse(speed, normal, allowed, [1.0, 3.0], friction);
        assert_eq!(impulse(0.0, 0.0), Some(Vector::new(0.0, 3.0)));
        assert_eq!(impulse(0.0, 0.25), Some(Vector::new(-0.75, 3.0)));
        for stuck in [0.5, 2.0, f64::INFINITY] {
            assert_eq!(impulse(0.0, stuck), Some(Vector::new(-1.5, 3.0)));
        }
        assert_eq!(impulse(-1.0, 0.25), Some(Vector::new(-0.5625, 2.25)));
        assert_eq!(impulse(-4.0, 0.25), None);
    }
}
