//! What a tip's surroundings look like, in the middle of a step and between steps.

use super::Updated;
use super::points::Motion;
use super::tracer::SIDES;
use crate::crack::cracks::{Cracks, TipId};
use crate::solver::Observed;
use crate::tip::frame::{LineAround, tip_of, turn};
use crate::tip::zone::{FaceContact, FaceLoad, Opening, QuadraturePoint, TipZone};
use fissure_scene::{End, Matrix, Point, Vector};

/// The solver in the middle of a step: positions, deformations and accelerations of the step's beginning; velocities on
/// the grid are half a step ahead and taken back by half the acceleration.
#[derive(Debug)]
pub(super) struct MidStep<'a> {
    pub(super) solver: &'a Updated,
    pub(super) time_step: f64,
}

/// Behind a tip, in cells, where the opening is taken. 1 to 3 cells: nearer, the tip's own discretisation shows;
/// farther, the next term of the series.
const OPENING_DISTANCE: f64 = 1.5;

impl Observed for MidStep<'_> {
    fn tells_bends(&self) -> bool {
        false
    }

    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.solver.zone(cracks, id, radius, Some(self.time_step))
    }

    fn opening(&self, _: &Cracks, id: TipId, into: Matrix) -> Opening {
        self.solver.opening_of(id, into)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        self.solver.tip_now(cracks, id)
    }
}

/// Between steps there is no grid: velocities are those of the particles, accelerations those of the last step.
impl Observed for Updated {
    fn tells_bends(&self) -> bool {
        false
    }

    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        self.zone(cracks, id, radius, None)
    }

    fn opening(&self, _: &Cracks, id: TipId, into: Matrix) -> Opening {
        self.opening_of(id, into)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        tip_of(cracks, id, &self.faces.cracks[id.crack].position, self.setup.scene.cell_size)
    }
}

/// The axes of a tip.
#[derive(Debug, Clone)]
struct TipAxes {
    id: TipId,
    /// [m].
    tip: Point,
    /// [m].
    tip_at_rest: Point,
    /// Unit vector.
    ahead: Vector,
    /// From the world into the frame of the tip.
    frame: Matrix,
    /// The crack around the tip as it is now [m].
    line: LineAround,
}

impl Updated {
    /// The current configuration around a tip. The displacement is measured from the rest configuration turned as the
    /// surroundings of the tip are: a turn of the whole body then leaves no gradient.
    fn zone(&self, cracks: &Cracks, id: TipId, radius: f64, time_step: Option<f64>) -> TipZone {
        let (tip, ahead) = self.tip_now(cracks, id);
        let tip_at_rest = cracks.position(id);
        let frame = Matrix::new(ahead.x, ahead.y, -ahead.y, ahead.x);
        let line = LineAround::new(cracks, id, ahead, radius, |crack, point| self.faces.cracks[crack].position[point]);
        let axes = TipAxes { id, tip, tip_at_rest, ahead, frame, line };
        let mut found: Vec<(usize, Matrix)> = Vec::new();
        let mut mean = Matrix::zeros();
        for (p, point) in self.points.point.iter().enumerate() {
            let is_near = (point.position - tip).norm_squared() < radius * radius;
            if is_near && self.setup.particles.body[p] == cracks.of(id).body {
                let h = self.points.total_gradient(p);
                mean += h;
                found.push((p, h));
            }
        }
        let mean = mean / found.len().max(1) as f64;
        let turned = turn(2.0 + mean.m11 + mean.m22, mean.m21 - mean.m12);
        let point = |(p, h)| self.quadrature_point(&axes, p, h, turned, time_step);
        let points = found.into_iter().map(point).collect();
        let contacts = self.contacts_around(&axes, radius);
        let face_loads = self.face_loads(&axes, cracks, radius, turned.0);
        TipZone { points, contacts, face_loads, bend: None, into: axes.frame, follows_line: false }
    }

    fn opening_of(&self, id: TipId, into: Matrix) -> Opening {
        let wanted = OPENING_DISTANCE * self.setup.scene.cell_size;
        let (apart, distance) = self.faces.cracks[id.crack].opening(id.end, wanted);
        Opening { apart: into * apart, distance }
    }

    /// A particle with H = `h` in the frame of a tip whose surroundings have `turned` by (R, R − I).
    fn quadrature_point(
        &self,
        axes: &TipAxes,
        particle: usize,
        h: Matrix,
        turned: (Matrix, Matrix),
        time_step: Option<f64>,
    ) -> QuadraturePoint {
        let (particles, point, frame) = (&self.setup.particles, &self.points.point[particle], axes.frame);
        let into = |m: Matrix| frame * m * frame.transpose();
        let (mu, lambda) = self.points.moduli(&self.setup, particle);
        let ratio = 1.0 + crate::volume_change(&h);
        // I − F⁻¹ = F⁻¹ H, so that small strains keep their digits; then R: I − R F⁻¹ = R (I − F⁻¹) − (R − I).
        let inverse = Matrix::new(1.0 + h.m22, -h.m12, -h.m21, 1.0 + h.m11) / ratio;
        let gradient = turned.0 * (inverse * h) - turned.1;
        let (velocity, motion) = self.velocity_and_motion(particle, time_step);
        let elastic = &point.elastic_gradient;
        QuadraturePoint {
            place: frame * (point.position - axes.tip),
            displacement: frame
                * (point.position - axes.tip - turned.0 * (particles.rest[particle] - axes.tip_at_rest)),
            side: axes.line.side_of(point.position),
            volume: particles.volume[particle] * ratio,
            stress: into(crate::kirchhoff_stress(elastic, mu, lambda) / ratio),
            gradient: into(gradient),
            energy: crate::energy_density(elastic, mu, lambda) / ratio,
            density: self.setup.elastic_of(particle).density / ratio,
            velocity: frame * velocity,
            velocity_slope: frame * (motion.velocity_gradient * axes.ahead),
            acceleration: frame * motion.acceleration,
            material: particles.material[particle],
        }
    }

    /// Velocity [m/s] and motion of a particle, between steps or in the middle of one of length `time_step` [s].
    fn velocity_and_motion(&self, particle: usize, time_step: Option<f64>) -> (Vector, Motion) {
        let point = &self.points.point[particle];
        match time_step {
            None => (point.velocity, self.points.motion.get(particle).copied().unwrap_or_default()),
            Some(time_step) => {
                let g = self.source().gather_one(particle, point);
                ((g.velocity + g.before) * 0.5, g.motion(time_step))
            }
        }
    }

    /// What presses on the faces of the crack around a tip whose surroundings have turned by `turned`.
    fn face_loads(&self, axes: &TipAxes, cracks: &Cracks, radius: f64, turned: Matrix) -> Vec<FaceLoad> {
        let pressure = self.loads.pressure_on_faces(axes.id.crack);
        let (now, rest) = (&self.faces.cracks[axes.id.crack], &cracks.of(axes.id).points);
        let mut found = Vec::new();
        if pressure == 0.0 {
            return found;
        }
        let beyond = radius + 2.0 * self.setup.scene.cell_size;
        for (face, side) in SIDES.into_iter().enumerate() {
            // Walked towards the tip, material on the +e2 side lies to the left.
            let side = if axes.id.end == End::End { side } else { side.opposite() };
            for k in 1..rest.len() {
                let [far, near] = if axes.id.end == End::End { [k - 1, k] } else { [k, k - 1] };
                let place = [far, near].map(|k| axes.frame * (now.faces[face][k] - axes.tip));
                let was = [far, near].map(|k| axes.frame * (turned * (rest[k] - axes.tip_at_rest)));
                if place[1].norm() > beyond {
                    continue;
                }
                let way = place[1] - place[0];
                let force = Vector::new(-way.y, way.x) * (pressure * side.sign());
                found.push(FaceLoad { ends: place, side, force, stretch: way - (was[1] - was[0]) });
            }
        }
        found
    }

    /// What the faces of the crack do to each other around a tip.
    fn contacts_around(&self, axes: &TipAxes, radius: f64) -> Vec<FaceContact> {
        // Above is the left side for one who walks to the end of the crack. Friction only: around a tip in pure shear
        // the smooth kernels find overlaps that are not there, and a pressure that would be a K_I of 4 % of K_II.
        let sign = if axes.id.end == End::End { 1.0 } else { -1.0 };
        self.contacts
            .face_forces(&self.lattice, axes.id.crack)
            // Elsewhere the crack may have come back behind the tip.
            .filter(|(place, _)| (place - axes.tip).norm() < radius + 2.0 * self.setup.scene.cell_size)
            .map(|(place, force)| {
                let place = axes.frame * (place - axes.tip);
                FaceContact { place, behind: -place.x, force: Vector::new((axes.frame * force).x * sign, 0.0) }
            })
            .collect()
    }
}
