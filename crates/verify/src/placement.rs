//! Where a scene lies on the grid: the same problem moved within a cell, mirrored, turned and at another spacing.

use fissure_scene::{
    Body, BoxSide, Collider, ColliderShape, CrackFrame, Frame, Guide, Load, LoadKind, Matrix, OutlineStretch, Point,
    Pose, Region, Scene, Selection, Support, TipRecord, ToughnessKind, Vector,
};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;

/// How far the spacing may be from that of the case, as a part of it.
const SPACING_RANGE: f64 = 0.1;
/// The body that moves the lattice stands so many cells to the lower left of all others.
const BALLAST_DISTANCE: f64 = 16.0;
/// Its name.
const BALLAST: &str = "ballast";

/// How everything is turned, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Turn {
    /// By right angles; exact.
    Quarters(u8),
    /// By any angle [rad].
    Angle(f64),
}

/// A place of a scene on the grid.
///
/// A scene is mirrored in the y axis first, then turned about the origin. The grid is counted from the lower left
/// corner of the box around all bodies, so that a scene cannot be moved on it by itself; what moves it is another body,
/// a *ballast* of two by two cells at rest far to the lower left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    /// Whether x becomes −x.
    mirror: bool,
    turn: Turn,
    /// Where the lower left corner of the box around all bodies lies within a cell, from 0 to 1 along both axes.
    shift: [f64; 2],
    /// Factor on the spacing of particles and nodes.
    spacing: f64,
}

impl fmt::Display for Placement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if *self == Self::NATURAL {
            return f.write_str("as drawn");
        }
        let degrees = match self.turn {
            Turn::Quarters(quarters) => 90.0 * f64::from(quarters),
            Turn::Angle(angle) => angle.to_degrees(),
        };
        let [x, y] = self.shift;
        let mirrored = if self.mirror { "mirrored, " } else { "" };
        write!(f, "{mirrored}turned by {degrees:.4}°, corner at ({x:.4}, {y:.4}) cells, spacing × {:.4}", self.spacing)
    }
}

impl Placement {
    /// As the case builds it.
    pub(crate) const NATURAL: Self = Self { mirror: false, turn: Turn::Quarters(0), shift: [0.0; 2], spacing: 1.0 };

    /// Place number `index` of the family `seed`. The first is the natural one. One in four is as people draw: corners
    /// on nodes, on particles or midway, quarter turns and the spacing of the case. The others lie anywhere.
    pub(crate) fn draw(seed: u64, index: usize) -> Self {
        if index == 0 {
            return Self::NATURAL;
        }
        // Every place has a sequence of its own, so that it does not depend on how many there are.
        let mut random = Pcg64::seed_from_u64(seed.wrapping_add((index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        // From 0 to below 1, in multiples of 2^-53.
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let mirror = uniform() < 0.5;
        let quarters = (4.0 * uniform()) as u8;
        let (angle, any_angle) = (TAU * uniform(), uniform() < 0.5);
        let shift = [uniform(), uniform()];
        let spacing = 1.0 + SPACING_RANGE * (2.0 * uniform() - 1.0);
        if index.is_multiple_of(4) {
            let shift = shift.map(|s| (4.0 * s).floor() / 4.0);
            return Self { mirror, turn: Turn::Quarters(quarters), shift, spacing: 1.0 };
        }
        let turn = if any_angle { Turn::Angle(angle) } else { Turn::Quarters(quarters) };
        Self { mirror, turn, shift, spacing }
    }

    /// The nearest placement that `scene` can have: one that holds some velocity along an axis only is turned by right
    /// angles, one with painted toughness not at all. Beside colliders there is no room for a ballast.
    pub(crate) fn fitted(self, scene: &Scene) -> Self {
        let shift = if scene.colliders.is_empty() { self.shift } else { [0.0; 2] };
        let fitted = Self { shift, ..self };
        if scene.toughness.iter().any(|patch| matches!(patch.kind, ToughnessKind::Image(_))) {
            return Self { mirror: false, turn: Turn::Quarters(0), ..fitted };
        }
        let is_bound = scene.supports.iter().any(|s| s.velocity[0].is_some() != s.velocity[1].is_some());
        match self.turn {
            Turn::Angle(angle) if is_bound => {
                Self { turn: Turn::Quarters((angle / FRAC_PI_2).round() as u8 % 4), ..fitted }
            }
            _ => fitted,
        }
    }

    /// The same with the spacing of the scene.
    pub(crate) fn at_own_spacing(self) -> Self {
        Self { spacing: 1.0, ..self }
    }

    /// Turned by any angle [rad].
    pub(crate) fn by_angle(angle: f64) -> Self {
        Self { turn: Turn::Angle(angle), ..Self::NATURAL }
    }

    /// Mirrored or not, then turned.
    #[cfg(test)]
    pub(crate) fn by_right_angles(mirror: bool, quarters: u8) -> Self {
        Self { mirror, turn: Turn::Quarters(quarters), ..Self::NATURAL }
    }

    /// What points and vectors are multiplied by.
    fn map(&self) -> Matrix {
        let (sine, cosine) = match self.turn {
            // Exactly.
            Turn::Quarters(quarters) => [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][usize::from(quarters % 4)],
            Turn::Angle(angle) => angle.sin_cos(),
        };
        let sign = if self.mirror { -1.0 } else { 1.0 };
        Matrix::new(sign * cosine, -sine, sign * sine, cosine)
    }

    fn angle(&self) -> f64 {
        match self.turn {
            Turn::Quarters(quarters) => FRAC_PI_2 * f64::from(quarters),
            Turn::Angle(angle) => angle,
        }
    }

    /// −1 where turning directions are reversed.
    fn handedness(&self) -> f64 {
        if self.mirror { -1.0 } else { 1.0 }
    }

    fn point(&self, point: Point) -> Point {
        Point::from(self.map() * point.coords)
    }

    /// A closed or open chain whose sides keep their meaning: reversed when everything is mirrored.
    fn ring(&self, ring: &[Point]) -> Vec<Point> {
        let mut ring: Vec<Point> = ring.iter().map(|&p| self.point(p)).collect();
        if self.mirror {
            ring.reverse();
        }
        ring
    }

    fn region(&self, region: &Region) -> Region {
        Region {
            exterior: self.ring(&region.exterior),
            holes: region.holes.iter().map(|hole| self.ring(hole)).collect(),
        }
    }

    /// The scene at this place. See [`Self::fitted`].
    pub(crate) fn place(&self, scene: &Scene) -> Scene {
        if *self == Self::NATURAL {
            return scene.clone();
        }
        let mut placed = scene.clone();
        placed.cell_size *= self.spacing;
        placed.particle_spacing *= self.spacing;
        placed.gravity = self.map() * scene.gravity;
        for body in &mut placed.bodies {
            self.place_body(body, scene);
        }
        for crack in &mut placed.cracks {
            crack.points = crack.points.iter().map(|&p| self.point(p)).collect();
            for guide in [&mut crack.start_guide, &mut crack.end_guide].into_iter().flatten() {
                self.place_guide(guide);
            }
        }
        for patch in &mut placed.toughness {
            if let ToughnessKind::Region { region, .. } = &mut patch.kind {
                *region = self.region(region);
            }
        }
        placed.loads.iter_mut().for_each(|load| self.place_load(load, scene));
        placed.supports.iter_mut().for_each(|support| self.place_support(support, scene));
        placed.colliders.iter_mut().for_each(|collider| self.place_collider(collider));
        if self.has_ballast() {
            self.add_ballast(&mut placed);
        }
        placed
    }

    fn has_ballast(&self) -> bool {
        self.shift != [0.0; 2]
    }

    fn add_ballast(&self, scene: &mut Scene) {
        let h = scene.cell_size;
        let (mut low, _) = box_around(&scene.bodies);
        for axis in 0..2 {
            low[axis] -= (BALLAST_DISTANCE + self.shift[axis]) * h;
        }
        let region = crate::problem::rectangle((low.x, low.y), (low.x + 2.0 * h, low.y + 2.0 * h));
        let material = scene.bodies[0].material;
        let number = scene.bodies.len();
        scene.bodies.push(Body {
            name: BALLAST.into(),
            region,
            material,
            inclusions: Vec::new(),
            velocities: Vec::new(),
            turns: Vec::new(),
        });
        // It must not fall onto the others.
        if scene.gravity != Vector::zeros() {
            scene.supports.push(Support {
                selection: Selection::Bodies(vec![number]),
                velocity: [Some(0.0); 2],
                curve: Default::default(),
            });
        }
    }

    fn place_body(&self, body: &mut Body, scene: &Scene) {
        body.region = self.region(&body.region);
        for inclusion in &mut body.inclusions {
            inclusion.region = self.region(&inclusion.region);
        }
        for motion in &mut body.velocities {
            motion.selection = self.selection(&motion.selection, scene);
            motion.velocity = self.map() * motion.velocity;
            motion.angular_velocity *= self.handedness();
            motion.center = self.point(motion.center);
        }
    }

    fn place_guide(&self, guide: &mut Guide) {
        guide.for_each_mut(&mut |guide| guide.points.iter_mut().for_each(|p| *p = self.point(*p)));
    }

    fn place_load(&self, load: &mut Load, scene: &Scene) {
        load.selection = self.selection(&load.selection, scene);
        match &mut load.kind {
            LoadKind::Force(vector) | LoadKind::Traction(vector) => *vector = self.map() * *vector,
            LoadKind::Pressure(_) | LoadKind::FacePressure(..) => {}
            LoadKind::PerPoint(forces) => {
                for (point, force) in forces {
                    (*point, *force) = (self.point(*point), self.map() * *force);
                }
            }
        }
    }

    fn place_support(&self, support: &mut Support, scene: &Scene) {
        support.selection = self.selection(&support.selection, scene);
        let [x, y] = support.velocity;
        let moved = self.map() * Vector::new(x.unwrap_or(0.0), y.unwrap_or(0.0));
        // Which axes are held: both, none, or after an odd number of quarter turns the other one.
        let swaps = matches!(self.turn, Turn::Quarters(1 | 3));
        let is_held = if swaps { [y.is_some(), x.is_some()] } else { [x.is_some(), y.is_some()] };
        support.velocity = [0, 1].map(|axis| is_held[axis].then_some(moved[axis]));
    }

    /// A mirrored shape in its own frame, under mirrored poses: M R(a) s = R(−a) M s.
    fn place_collider(&self, collider: &mut Collider) {
        if self.mirror {
            match &mut collider.shape {
                ColliderShape::HalfPlane { normal } => normal.x = -normal.x,
                ColliderShape::Polygon { ring } => {
                    ring.iter_mut().for_each(|p| p.x = -p.x);
                    ring.reverse();
                }
                ColliderShape::Disc { .. } | ColliderShape::Box { .. } => {}
            }
        }
        for (_, pose) in &mut collider.keyframes {
            pose.position = self.point(pose.position);
            pose.angle = self.angle() + self.handedness() * pose.angle;
        }
    }

    fn selection(&self, selection: &Selection, scene: &Scene) -> Selection {
        match selection {
            // The ballast is not part of the scene.
            Selection::All => Selection::Bodies((0..scene.bodies.len()).collect()),
            Selection::Bodies(bodies) => Selection::Bodies(bodies.clone()),
            Selection::Region(region) => Selection::Region(self.region(region)),
            Selection::Near { points, radius } => {
                Selection::Near { points: points.iter().map(|&p| self.point(p)).collect(), radius: *radius }
            }
            Selection::Edge { side, bodies } => {
                let bodies = bodies.clone().unwrap_or_else(|| (0..scene.bodies.len()).collect());
                match self.turn {
                    Turn::Quarters(_) => Selection::Edge { side: self.side(*side), bodies: Some(bodies) },
                    Turn::Angle(_) => self.outline(&stretches_of_side(scene, *side, &bodies)),
                }
            }
            Selection::Outline(stretches) => self.outline(stretches),
        }
    }

    fn outline(&self, stretches: &[OutlineStretch]) -> Selection {
        let place = |s: &OutlineStretch| {
            let (from, to) = (self.point(s.from), self.point(s.to));
            // The material stays to the left.
            let [from, to] = if self.mirror { [to, from] } else { [from, to] };
            OutlineStretch { body: s.body, from, to }
        };
        let mut placed: Vec<_> = stretches.iter().map(place).collect();
        if self.mirror {
            placed.reverse();
        }
        Selection::Outline(placed)
    }

    /// The side that one of an axis-parallel box becomes by quarter turns.
    fn side(&self, side: BoxSide) -> BoxSide {
        let outward = self.map() * outward_normal(side);
        match (outward.x > 0.5, outward.x < -0.5, outward.y > 0.5) {
            (true, ..) => BoxSide::Right,
            (_, true, _) => BoxSide::Left,
            (.., true) => BoxSide::Top,
            _ => BoxSide::Bottom,
        }
    }
}

/// Lowest and highest corner of the box around bodies.
fn box_around(bodies: &[Body]) -> (Point, Point) {
    let all = bodies.iter().map(|body| body.region.bounds());
    all.reduce(|(low, high), (l, h)| (low.inf(&l), high.sup(&h))).unwrap_or((Point::origin(), Point::origin()))
}

fn outward_normal(side: BoxSide) -> Vector {
    match side {
        BoxSide::Left => Vector::new(-1.0, 0.0),
        BoxSide::Right => Vector::new(1.0, 0.0),
        BoxSide::Bottom => Vector::new(0.0, -1.0),
        BoxSide::Top => Vector::new(0.0, 1.0),
    }
}

/// The stretches of outlines on one side of the box around bodies, in the order of the rings.
fn stretches_of_side(scene: &Scene, side: BoxSide, bodies: &[usize]) -> Vec<OutlineStretch> {
    let outward = outward_normal(side);
    let height = |p: Point| outward.dot(&p.coords);
    let points_of = |&body: &usize| scene.bodies[body].region.exterior.iter().copied();
    let top = bodies.iter().flat_map(points_of).map(height).fold(f64::NEG_INFINITY, f64::max);
    let is_on_side = |p: Point| height(p) >= top - 1e-6 * scene.cell_size;
    let stretches = bodies.iter().flat_map(|&body| {
        let ring = &scene.bodies[body].region.exterior;
        (0..ring.len()).map(move |i| OutlineStretch { body, from: ring[i], to: ring[(i + 1) % ring.len()] })
    });
    stretches.filter(|s| is_on_side(s.from) && is_on_side(s.to)).collect()
}

/// From the placed scene back to that of the case.
impl Placement {
    fn natural_point(&self, point: Point) -> Point {
        Point::from(self.map().tr_mul(&point.coords))
    }

    fn natural_vector(&self, vector: Vector) -> Vector {
        self.map().tr_mul(&vector)
    }

    fn natural_matrix(&self, matrix: Matrix) -> Matrix {
        self.map().transpose() * matrix * self.map()
    }

    /// What a tip of the placed scene would be in that of the case: place, directions, and the signs of K_II and the
    /// kink.
    pub(crate) fn natural_tip(&self, tip: TipRecord) -> TipRecord {
        if *self == Self::NATURAL {
            return tip;
        }
        let (sine, cosine) = tip.direction.sin_cos();
        let direction = self.natural_vector(Vector::new(cosine, sine));
        TipRecord {
            position: self.natural_point(tip.position),
            direction: direction.y.atan2(direction.x),
            mode_2: self.handedness() * tip.mode_2,
            kink_angle: self.handedness() * tip.kink_angle,
            ..tip
        }
    }

    /// Linear momentum, and angular momentum about the origin.
    pub(crate) fn natural_momenta(&self, (linear, angular): (Vector, f64)) -> (Vector, f64) {
        (self.natural_vector(linear), self.handedness() * angular)
    }

    /// What a frame of the placed scene would be in that of the case, without the ballast.
    pub(crate) fn natural_frame(&self, mut frame: Frame) -> Frame {
        if *self == Self::NATURAL {
            return frame;
        }
        if self.has_ballast() {
            remove_last_body(&mut frame);
        }
        let p = &mut frame.particles;
        p.rest.iter_mut().chain(&mut p.position).for_each(|x| *x = self.natural_point(*x));
        p.velocity.iter_mut().for_each(|v| *v = self.natural_vector(*v));
        p.deformation_gradient.iter_mut().chain(&mut p.cauchy_stress).for_each(|m| *m = self.natural_matrix(*m));
        for outline in &mut frame.outlines {
            outline.rest.iter_mut().chain(&mut outline.position).for_each(|x| *x = self.natural_point(*x));
            outline.velocity.iter_mut().for_each(|v| *v = self.natural_vector(*v));
            if self.mirror {
                outline.rest.reverse();
                outline.position.reverse();
                outline.velocity.reverse();
            }
        }
        frame.cracks.iter_mut().for_each(|crack| self.restore_crack(crack));
        frame.tips.iter_mut().for_each(|tip| *tip = self.natural_tip(*tip));
        for pose in &mut frame.colliders {
            let Pose { position, angle } = *pose;
            *pose = Pose { position: self.natural_point(position), angle: self.handedness() * (angle - self.angle()) };
        }
        frame
    }

    fn restore_crack(&self, crack: &mut CrackFrame) {
        let CrackFrame { rest, above, below, above_velocity, below_velocity, .. } = crack;
        for points in [rest, &mut *above, &mut *below] {
            points.iter_mut().for_each(|x| *x = self.natural_point(*x));
        }
        for velocities in [&mut *above_velocity, &mut *below_velocity] {
            velocities.iter_mut().for_each(|v| *v = self.natural_vector(*v));
        }
        if self.mirror {
            std::mem::swap(above, below);
            std::mem::swap(above_velocity, below_velocity);
        }
    }
}

/// Takes the last body out of a frame.
fn remove_last_body(frame: &mut Frame) {
    let p = &mut frame.particles;
    let Some(&last) = p.body.iter().max() else { return };
    // Particles are sorted by body.
    let left = p.body.partition_point(|&body| body < last);
    p.id.truncate(left);
    p.body.truncate(left);
    p.piece.truncate(left);
    p.rest.truncate(left);
    p.position.truncate(left);
    p.velocity.truncate(left);
    p.deformation_gradient.truncate(left);
    p.cauchy_stress.truncate(left);
    frame.outlines.retain(|outline| outline.body != last);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::{Problem, linear_material, rectangle, stretch};
    use fissure_scene::{Curve, PlaneState};
    use fissure_sim::Simulation;

    fn plate() -> Problem {
        Problem::new("plate", rectangle((0.0, 0.0), (8.0, 12.0)), linear_material(), PlaneState::Strain, 1.0)
            .at_rest()
            .crack(&[(0.0, 6.0), (3.125, 6.3125)], [false, true])
            .load(stretch((0.0, 12.0), (0.0, 7.0)), LoadKind::Traction(Vector::new(-500.0, 0.0)), Curve::default())
            .load(stretch((8.0, 7.0), (8.0, 12.0)), LoadKind::Traction(Vector::new(500.0, 0.0)), Curve::default())
            .traction(BoxSide::Top, 0.0, 1e3)
            .traction(BoxSide::Bottom, 0.0, -1e3)
    }

    /// Truth: the scene itself. What is placed by right angles and brought back has the same signs, and on a lattice
    /// that is the same after them the same numbers, as far as the plate has come to rest.
    #[test]
    fn results_are_those_of_the_natural_place() -> Result<(), fissure_sim::SimulationError> {
        let problem = plate();
        let read = |placement: Placement| -> Result<_, fissure_sim::SimulationError> {
            let mut placed = crate::placed::Placed::new(&problem.scene, placement)?;
            placed.relax(1e-6, 10_000)?;
            Ok((placed.now().tips()[0], placed.now().frame()))
        };
        let (tip, frame) = read(Placement::NATURAL)?;
        assert!(tip.mode_1 > 0.0 && tip.mode_2.abs() > 0.01 * tip.mode_1, "{tip:?}");
        for quarters in 0..4 {
            for mirror in [false, true] {
                let turn = Turn::Quarters(quarters);
                let (again, placed) = read(Placement { mirror, turn, ..Placement::NATURAL })?;
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * tip.mode_1;
                assert!(close(again.mode_1, tip.mode_1) && close(again.mode_2, tip.mode_2), "{mirror} {quarters}");
                assert!((again.kink_angle - tip.kink_angle).abs() < 1e-6);
                assert!(
                    (again.position - tip.position).norm() < 1e-9 && (again.direction - tip.direction).abs() < 1e-9
                );
                let mouth = |f: &Frame| f.cracks[0].above[0] - f.cracks[0].below[0];
                assert!((mouth(&placed) - mouth(&frame)).norm() < 1e-6 * mouth(&frame).norm());
            }
        }
        Ok(())
    }

    /// Truth: geometry. Material stays to the left of what is selected, and the ballast puts the corner where it is
    /// asked for.
    #[test]
    fn scenes_keep_their_meaning_wherever_they_are() -> Result<(), fissure_sim::SimulationError> {
        let problem = plate();
        for index in 1..40 {
            let placement = Placement::draw(7, index).fitted(&problem.scene);
            let placed = placement.place(&problem.scene);
            let ballast = placed.bodies.len() - 1;
            assert!(placed.bodies[0].region.area() > 95.9);
            for load in &placed.loads {
                if let Selection::Outline(stretches) = &load.selection {
                    for s in stretches {
                        let way = s.to - s.from;
                        let inside = middle(s.from, s.to) + Vector::new(-way.y, way.x) * 1e-6;
                        assert!(placed.bodies[s.body].region.contains(inside), "{placement}");
                    }
                }
            }
            if placement.has_ballast() {
                let corner = box_around(&placed.bodies[..ballast]).0 - box_around(&placed.bodies).0;
                for axis in 0..2 {
                    let cells = corner[axis] / placed.cell_size;
                    assert!((cells - cells.floor() - placement.shift[axis]).abs() < 1e-9, "{placement}");
                }
            }
            // The solver finds every load and support.
            Simulation::new(&placed)?;
        }
        Ok(())
    }

    /// Truth: balanced forces. Whatever corner lies between grid lines, nothing of a square moves on under tension.
    #[test]
    fn a_square_comes_to_rest_at_any_turn() -> Result<(), fissure_sim::SimulationError> {
        let square = rectangle((0.0, 0.0), (16.0, 16.0));
        let problem = Problem::new("square", square, linear_material(), PlaneState::Strain, 1.0)
            .traction(BoxSide::Top, 0.0, 1e3)
            .traction(BoxSide::Bottom, 0.0, -1e3);
        for index in 0..36 {
            let placement = Placement::draw(1, index);
            let steps = crate::placed::Placed::new(&problem.scene, placement)?.relax(1e-8, 1000)?;
            assert!(steps < 200, "{steps} steps, {placement}");
        }
        Ok(())
    }

    fn middle(a: Point, b: Point) -> Point {
        a + (b - a) * 0.5
    }

    /// Places do not depend on how many there are or on the machine: numbers written down once.
    #[test]
    fn places_are_the_same_everywhere() {
        assert_eq!(Placement::draw(1, 0), Placement::NATURAL);
        let text: Vec<String> = (1..5).map(|index| Placement::draw(1, index).to_string()).collect();
        let expected = [
            "mirrored, turned by 201.5309°, corner at (0.6004, 0.0536) cells, spacing × 0.9210",
            "mirrored, turned by 296.4292°, corner at (0.0338, 0.9055) cells, spacing × 1.0080",
            "mirrored, turned by 90.0000°, corner at (0.2768, 0.6317) cells, spacing × 1.0381",
            "turned by 0.0000°, corner at (0.5000, 0.5000) cells, spacing × 1.0000",
        ];
        assert_eq!(text, expected);
    }
}
