//! Rigid obstacles that move on keyframes, and what they do to the velocity of material inside them.

use fissure_plane::{Point, Region, Vector, bounds};
use fissure_scene::{Collider, ColliderShape, Contact, Pose};
use parry2d_f64::math::Vector as ParryVector;
use parry2d_f64::shape::SharedShape;

/// A collider ready for queries: [`Obstacle::at`] gives it at one moment.
#[derive(Clone)]
pub(crate) struct Obstacle {
    outline: Outline,
    keyframes: Vec<(f64, Pose)>,
    contact: Contact,
    friction: f64,
}

impl std::fmt::Debug for Obstacle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Obstacle").field("keyframes", &self.keyframes).finish_non_exhaustive()
    }
}

/// What a query needs to know of the shape, in its own frame.
#[derive(Clone)]
enum Outline {
    HalfPlane { normal: Vector },
    Disc { radius: f64 },
    Ring { shape: SharedShape, region: Region, low: Point, high: Point },
}

/// An obstacle at one moment.
#[derive(Clone, Copy)]
pub(crate) struct PlacedObstacle<'a> {
    obstacle: &'a Obstacle,
    pose: Pose,
    sine: f64,
    cosine: f64,
    velocity: Vector,
    angular_velocity: f64,
}

/// Distance to the surface and the way out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surface {
    /// Signed distance [m]: negative inside.
    pub(crate) distance: f64,
    /// Unit normal of the nearest point of the surface, out of the obstacle, world frame.
    pub(crate) normal: Vector,
}

impl Obstacle {
    pub(crate) fn new(collider: &Collider) -> Self {
        let ring = |ring: Vec<Point>| {
            let count = ring.len() as u32;
            let vertices = ring.iter().map(|p| ParryVector::new(p.x, p.y)).collect();
            let edges = (0..count).map(|i| [i, (i + 1) % count]).collect();
            let (low, high) = bounds(&ring);
            Outline::Ring {
                shape: SharedShape::polyline(vertices, Some(edges)),
                region: Region { exterior: ring, holes: Vec::new() },
                low,
                high,
            }
        };
        let outline = match &collider.shape {
            // A plane and a disc need no search (and parry's projection of a disc's centre is not a number).
            ColliderShape::HalfPlane { normal } => Outline::HalfPlane { normal: *normal },
            ColliderShape::Disc { radius } => Outline::Disc { radius: *radius },
            ColliderShape::Box { half_extents: h } => {
                ring(vec![Point::new(-h.x, -h.y), Point::new(h.x, -h.y), Point::new(h.x, h.y), Point::new(-h.x, h.y)])
            }
            ColliderShape::Polygon { ring: points } => ring(points.clone()),
        };
        Self { outline, keyframes: collider.keyframes.clone(), contact: collider.contact, friction: collider.friction }
    }

    /// The obstacle at `time` [s]: pose linear between keyframes, constant outside; velocity that of the interval that
    /// begins at or before `time`.
    pub(crate) fn at(&self, time: f64) -> PlacedObstacle<'_> {
        let (pose, velocity, angular_velocity) = motion(&self.keyframes, time);
        let (sine, cosine) = pose.angle.sin_cos();
        PlacedObstacle { obstacle: self, pose, sine, cosine, velocity, angular_velocity }
    }
}

/// Pose, velocity [m/s] and angular velocity [rad/s] at `time`.
fn motion(keyframes: &[(f64, Pose)], time: f64) -> (Pose, Vector, f64) {
    let next = keyframes.partition_point(|k| k.0 <= time);
    let resting = |pose: Pose| (pose, Vector::zeros(), 0.0);
    match (next.checked_sub(1).and_then(|i| keyframes.get(i)), keyframes.get(next)) {
        (Some(&(from, a)), Some(&(to, b))) => {
            let duration = to - from;
            let (velocity, angular_velocity) = ((b.position - a.position) / duration, (b.angle - a.angle) / duration);
            let elapsed = time - from;
            (
                Pose { position: a.position + velocity * elapsed, angle: a.angle + angular_velocity * elapsed },
                velocity,
                angular_velocity,
            )
        }
        (Some(&(_, pose)), None) | (None, Some(&(_, pose))) => resting(pose),
        (None, None) => resting(Pose { position: Point::origin(), angle: 0.0 }),
    }
}

impl PlacedObstacle<'_> {
    /// Where the obstacle is.
    pub(crate) fn pose(&self) -> Pose {
        self.pose
    }

    fn to_local(self, v: Vector) -> Vector {
        Vector::new(self.cosine * v.x + self.sine * v.y, self.cosine * v.y - self.sine * v.x)
    }

    fn to_world(self, v: Vector) -> Vector {
        Vector::new(self.cosine * v.x - self.sine * v.y, self.cosine * v.y + self.sine * v.x)
    }

    /// Velocity of the obstacle at `point` [m/s].
    pub(crate) fn velocity(&self, point: Point) -> Vector {
        let arm = point - self.pose.position;
        self.velocity + self.angular_velocity * Vector::new(-arm.y, arm.x)
    }

    /// Signed distance and normal of the surface point nearest to `point`.
    ///
    /// Where several are nearest (the centre of a disc, the middle of a box) one of them is taken.
    pub(crate) fn surface(&self, point: Point) -> Surface {
        let local = Point::from(self.to_local(point - self.pose.position));
        let surface = self.obstacle.outline.surface(local);
        Surface { normal: self.to_world(surface.normal), ..surface }
    }

    /// As [`PlacedObstacle::surface`], of that part of the surface that faces what has the `outward` normal; none where
    /// nothing does.
    ///
    /// Two faces of a crack may lie where an obstacle between them is nearest to one of its sides from both.
    pub(crate) fn surface_facing(&self, point: Point, outward: Vector) -> Option<Surface> {
        let nearest = self.surface(point);
        if nearest.normal.dot(&outward) < 0.0 {
            return Some(nearest);
        }
        let Outline::Ring { region, .. } = &self.obstacle.outline else { return None };
        let local = Point::from(self.to_local(point - self.pose.position));
        let found = facing_edge(&region.exterior, local, self.to_local(outward))?;
        Some(Surface { normal: self.to_world(found.normal), ..found })
    }

    /// The surface point nearest to `point` when that is inside the obstacle or on its surface.
    pub(crate) fn contact(&self, point: Point) -> Option<Surface> {
        let local = Point::from(self.to_local(point - self.pose.position));
        // Most nodes of a grid are far from a small obstacle.
        if let Outline::Ring { low, high, .. } = &self.obstacle.outline
            && (local.x < low.x || local.y < low.y || local.x > high.x || local.y > high.y)
        {
            return None;
        }
        let surface = self.obstacle.outline.surface(local);
        (surface.distance <= 0.0).then(|| Surface { normal: self.to_world(surface.normal), ..surface })
    }

    /// The velocity of material at `point` [m/s] after contact; outside the obstacle it is unchanged.
    ///
    /// Relative to the obstacle's own velocity: *stick* takes it on. *Separate* and *slip* lose the normal part v_n
    /// (thesis eq. 11), separate only when approaching (v_n < 0); the tangential part then loses up to friction · |v_n|
    /// (Coulomb; Stomakhin et al. 2013, section 8). Slip holds material that wants to leave, without friction.
    pub(crate) fn resolve(&self, velocity: Vector, point: Point) -> Vector {
        self.contact(point).map_or(velocity, |surface| self.resolve_at(velocity, point, surface.normal))
    }

    /// As [`PlacedObstacle::resolve`], of material that touches the surface at `point` where its normal is `normal`.
    pub(crate) fn resolve_at(&self, velocity: Vector, point: Point, normal: Vector) -> Vector {
        let own = self.velocity(point);
        let relative = velocity - own;
        let approach = -relative.dot(&normal);
        match self.obstacle.contact {
            Contact::Stick => own,
            Contact::Separate if approach <= 0.0 => velocity,
            Contact::Separate | Contact::Slip => {
                let tangential = relative + approach * normal;
                // Not 0 · ∞ for a friction without bound.
                let lost = if approach > 0.0 { self.obstacle.friction * approach } else { 0.0 };
                let speed = tangential.norm();
                if speed <= lost { own } else { own + tangential * (1.0 - lost / speed) }
            }
        }
    }
}

impl Outline {
    fn surface(&self, local: Point) -> Surface {
        match self {
            Self::HalfPlane { normal } => Surface { distance: local.coords.dot(normal), normal: *normal },
            Self::Disc { radius } => Surface {
                distance: local.coords.norm() - radius,
                normal: local.coords.try_normalize(0.0).unwrap_or_else(Vector::x),
            },
            Self::Ring { shape, region, low, high } => {
                // Parry finds the nearest point; inside or outside is decided exactly, also for concave rings.
                let nearest = shape.project_local_point(ParryVector::new(local.x, local.y), false).point;
                let away = local - Point::new(nearest.x, nearest.y);
                let distance = away.norm();
                let inside = region.contains(local);
                let signed = if inside { -distance } else { distance };
                // So close to the surface the direction to it is round-off: the edge itself has the normal.
                if distance <= 1e-12 * (high - low).norm() {
                    return Surface { distance: signed, normal: nearest_edge_normal(&region.exterior, local) };
                }
                Surface { distance: signed, normal: away / signed }
            }
        }
    }
}

/// The nearest edge of the counter-clockwise `ring` above or below which `point` lies, of those whose outward normals
/// are against `outward`: the distance from its line and its normal.
fn facing_edge(ring: &[Point], point: Point, outward: Vector) -> Option<Surface> {
    let mut nearest: Option<Surface> = None;
    for i in 0..ring.len() {
        let (a, along) = (ring[i], ring[(i + 1) % ring.len()] - ring[i]);
        let Some(normal) = Vector::new(along.y, -along.x).try_normalize(0.0) else { continue };
        let share = (point - a).dot(&along) / along.norm_squared();
        if normal.dot(&outward) >= 0.0 || !(0.0..=1.0).contains(&share) {
            continue;
        }
        let distance = (point - a).dot(&normal);
        if nearest.is_none_or(|n| distance.abs() < n.distance.abs()) {
            nearest = Some(Surface { distance, normal });
        }
    }
    nearest
}

/// Outward unit normal of the edge of the counter-clockwise `ring` that is nearest to `point`.
fn nearest_edge_normal(ring: &[Point], point: Point) -> Vector {
    let mut nearest = (f64::INFINITY, Vector::y());
    for i in 0..ring.len() {
        let (a, along) = (ring[i], ring[(i + 1) % ring.len()] - ring[i]);
        let length_squared = along.norm_squared();
        if length_squared == 0.0 {
            continue;
        }
        let share = ((point - a).dot(&along) / length_squared).clamp(0.0, 1.0);
        let distance = (point - a - share * along).norm();
        if distance < nearest.0 {
            nearest = (distance, Vector::new(along.y, -along.x) / length_squared.sqrt());
        }
    }
    nearest.1
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

    fn collider(shape: ColliderShape, contact: Contact, friction: f64, keyframes: Vec<(f64, Pose)>) -> Obstacle {
        Obstacle::new(&Collider { name: String::new(), shape, keyframes, contact, friction })
    }

    fn pose(x: f64, y: f64, angle: f64) -> Pose {
        Pose { position: Point::new(x, y), angle }
    }

    fn resting(shape: ColliderShape) -> Obstacle {
        collider(shape, Contact::Separate, 0.0, vec![(0.0, pose(0.0, 0.0, 0.0))])
    }

    /// Truth: the drawing. Of a wedge between two faces the upper face sees the upper flank, the lower one the lower,
    /// at its middle and off it alike.
    #[test]
    fn each_face_sees_the_flank_that_faces_it() {
        let ring = [[0.0, 0.0], [4.0, -1.0], [4.0, 1.0]].map(Point::from).to_vec();
        let wedge = resting(ColliderShape::Polygon { ring });
        let flank = Vector::new(-1.0, 4.0).normalize();
        for y in [-0.2, 0.0, 0.1] {
            let place = Point::new(3.0, y);
            let above = wedge.at(0.0).surface_facing(place, -Vector::y()).unwrap();
            let below = wedge.at(0.0).surface_facing(place, Vector::y()).unwrap();
            let depth = |y: f64| (0.75 - y) * flank.y;
            assert!((above.normal - flank).norm() < 1e-12 && (above.distance + depth(y)).abs() < 1e-12);
            assert!((below.normal - Vector::new(flank.x, -flank.y)).norm() < 1e-12);
            assert!((below.distance + depth(-y)).abs() < 1e-12);
        }
    }

    /// A C, open to the right: its hull contains the notch, it does not.
    fn notched() -> Vec<Point> {
        [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [4.0, 3.0], [4.0, 4.0], [0.0, 4.0]]
            .map(Point::from)
            .to_vec()
    }

    fn assert_surface(found: Surface, distance: f64, normal: [f64; 2]) {
        assert!((found.distance - distance).abs() < 1e-14, "{found:?}, expected {distance}");
        assert!((found.normal - Vector::from(normal)).norm() < 1e-14, "{found:?}, expected {normal:?}");
    }

    #[test]
    fn half_plane_and_disc() {
        let ground = resting(ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) });
        let ground = ground.at(0.0);
        assert_surface(ground.surface(Point::new(1e6, -0.25)), -0.25, [0.0, 1.0]);
        assert_surface(ground.surface(Point::new(7.0, 3.0)), 3.0, [0.0, 1.0]);
        assert!(ground.contact(Point::new(5.0, 0.0)).is_some(), "a node on the surface touches");
        assert!(ground.contact(Point::new(5.0, 1e-300)).is_none());

        let disc = resting(ColliderShape::Disc { radius: 2.0 });
        let disc = disc.at(0.0);
        assert_surface(disc.surface(Point::new(0.6, 0.8)), -1.0, [0.6, 0.8]);
        assert_surface(disc.surface(Point::new(-3.0, 4.0)), 3.0, [-0.6, 0.8]);
        assert_surface(disc.surface(Point::new(0.0, -2.0)), 0.0, [0.0, -1.0]);
        let center = disc.contact(Point::origin()).unwrap();
        assert_eq!((center.distance, center.normal.norm()), (-2.0, 1.0));
    }

    #[test]
    fn box_and_concave_polygon() {
        let block = resting(ColliderShape::Box { half_extents: Vector::new(2.0, 1.0) });
        let block = block.at(0.0);
        assert_surface(block.surface(Point::new(1.75, 0.5)), -0.25, [1.0, 0.0]);
        assert_surface(block.surface(Point::new(0.0, -0.75)), -0.25, [0.0, -1.0]);
        assert_surface(block.surface(Point::new(2.0, 0.3)), 0.0, [1.0, 0.0]);
        assert_surface(block.surface(Point::new(5.0, 5.0)), 5.0, [0.6, 0.8]);
        assert!(block.contact(Point::new(2.1, 0.0)).is_none());

        let notch = resting(ColliderShape::Polygon { ring: notched() });
        let notch = notch.at(0.0);
        // In the mouth of the C: outside, although inside the hull; nearest is the inner wall.
        assert!(notch.contact(Point::new(1.5, 2.0)).is_none());
        assert_surface(notch.surface(Point::new(1.5, 2.0)), 0.5, [1.0, 0.0]);
        assert_surface(notch.contact(Point::new(0.75, 2.0)).unwrap(), -0.25, [1.0, 0.0]);
        assert_surface(notch.contact(Point::new(2.0, 0.75)).unwrap(), -0.25, [0.0, 1.0]);
        // Inside, nearest to the concave corner: the way out is towards the corner.
        assert_surface(notch.contact(Point::new(0.7, 0.6)).unwrap(), -0.5, [0.6, 0.8]);
        assert_surface(notch.surface(Point::new(1.0, 2.0)), 0.0, [1.0, 0.0]);
    }

    proptest! {
        /// Truth: brute force over the edges, turned and moved; the sign from exact winding.
        #[test]
        fn polygon_distance_is_that_of_the_nearest_edge(x in -2.0..6.0, y in -2.0..6.0, angle in -7.0..7.0) {
            let ring = notched();
            let local = Point::new(x, y);
            let distance = (0..ring.len())
                .map(|i| {
                    let (a, along) = (ring[i], ring[(i + 1) % 8] - ring[i]);
                    let share = ((local - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                    (local - a - share * along).norm()
                })
                .fold(f64::INFINITY, f64::min);
            let in_shape = (0.0..4.0).contains(&x) && (0.0..4.0).contains(&y) && !((1.0..=4.0).contains(&x) && (1.0..=3.0).contains(&y));
            let obstacle = collider(ColliderShape::Polygon { ring }, Contact::Separate, 0.0, vec![(0.0, pose(3.0, -1.0, angle))]);
            let world = Point::new(3.0, -1.0) + nalgebra::Rotation2::new(angle) * local.coords;
            let found = obstacle.at(1.0).surface(world);
            let signed = if in_shape { -distance } else { distance };
            prop_assert!((found.distance - signed).abs() < 1e-13);
            prop_assert!((found.normal.norm() - 1.0).abs() < 1e-12);
            // The normal leads to the surface.
            prop_assert!(obstacle.at(1.0).surface(world - found.distance * found.normal).distance.abs() < 1e-12);
        }
    }

    #[test]
    fn keyframes_give_pose_and_velocity() {
        let moving = collider(
            ColliderShape::Disc { radius: 1.0 },
            Contact::Stick,
            0.0,
            vec![(1.0, pose(0.0, 0.0, 0.0)), (3.0, pose(4.0, 2.0, 8.0)), (4.0, pose(4.0, 2.0, 8.0))],
        );
        assert_eq!(moving.at(0.0).pose(), pose(0.0, 0.0, 0.0));
        assert_eq!(moving.at(0.0).velocity(Point::new(1.0, 0.0)), Vector::zeros());
        assert_eq!(moving.at(2.0).pose(), pose(2.0, 1.0, 4.0));
        // v + ω × r with v = (2, 1), ω = 4, r = (0, 0.5).
        assert_eq!(moving.at(2.0).velocity(Point::new(2.0, 1.5)), Vector::new(0.0, 1.0));
        assert_eq!(moving.at(3.5).velocity(Point::new(2.0, 1.5)), Vector::zeros());
        assert_eq!(moving.at(9.0).pose(), pose(4.0, 2.0, 8.0));
        // A jump: two keyframes at one time.
        let jump = collider(
            ColliderShape::Disc { radius: 1.0 },
            Contact::Stick,
            0.0,
            vec![(0.0, pose(0.0, 0.0, 0.0)), (0.0, pose(1.0, 0.0, 0.0))],
        );
        assert_eq!(
            (jump.at(0.0).pose(), jump.at(0.0).velocity(Point::origin())),
            (pose(1.0, 0.0, 0.0), Vector::zeros())
        );
    }

    #[test]
    fn contact_laws() {
        // A floor at 45 degrees that moves along its own normal n at √2 m/s.
        let n = Vector::new(-FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        let t = Vector::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        let own = 2.0_f64.sqrt() * n;
        let floor = |contact, friction| {
            collider(
                ColliderShape::HalfPlane { normal: Vector::new(0.0, 1.0) },
                contact,
                friction,
                vec![(0.0, pose(0.0, 0.0, 0.5 * FRAC_PI_2)), (1.0, pose(-1.0, 1.0, 0.5 * FRAC_PI_2))],
            )
        };
        let inside = Point::new(1.0, -1.0);
        let check = |contact, friction, relative: Vector, expected: Vector| {
            let found = floor(contact, friction).at(0.0).resolve(own + relative, inside);
            assert!((found - own - expected).norm() < 1e-14, "{contact:?} {friction}: {}", found - own);
        };
        let (approaching, leaving) = (3.0 * t - 2.0 * n, 3.0 * t + 2.0 * n);
        check(Contact::Separate, 0.0, approaching, 3.0 * t);
        check(Contact::Separate, 0.5, approaching, 2.0 * t);
        check(Contact::Separate, 2.0, approaching, Vector::zeros());
        check(Contact::Separate, f64::INFINITY, approaching, Vector::zeros());
        check(Contact::Separate, 0.5, leaving, leaving);
        check(Contact::Slip, 0.5, approaching, 2.0 * t);
        check(Contact::Slip, 0.5, leaving, 3.0 * t);
        check(Contact::Slip, f64::INFINITY, 3.0 * t, 3.0 * t);
        check(Contact::Stick, 0.0, leaving, Vector::zeros());
        // Outside nothing happens.
        let outside = Point::new(-1.0, 1.0);
        assert_eq!(floor(Contact::Stick, 0.0).at(0.0).resolve(Vector::new(5.0, 6.0), outside), Vector::new(5.0, 6.0));
    }
}
