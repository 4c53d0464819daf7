//! Looking at a moment of the solver: what is around a tip, and where it is.

use super::contact::Contacts;
use super::disc::particles_of_disc;
use super::lattice::Lattice;
use super::loads::Loads;
use super::motion::Motion;
use super::pressure::Pressed;
use super::probe::Probe;
use super::probes::Probes;
use super::reader::ParticleRates;
use super::ties::Ties;
use crate::crack::DIRECTION_LENGTH;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::Side;
use crate::solver::Observed;
use crate::tip::bend::Bend;
use crate::tip::frame::{LineAround, tip_of, turn};
use crate::tip::side_by_side::FreeZone;
use crate::tip::zone::{FaceContact, FaceLoad, Opening, QuadraturePoint, TipZone};
use fissure_plane::{Matrix, Point, Vector};
use fissure_scene::End;

/// A moment to be looked at, between two steps or in the middle of one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a> {
    /// The lattice.
    pub(super) lattice: &'a Lattice,
    /// In the middle of a step: displacements and accelerations of its beginning, velocities half a step later.
    pub(super) motion: &'a Motion,
    /// Outlines and faces.
    pub(super) probes: &'a Probes,
    /// What holds nodes around tips together.
    pub(super) ties: &'a Ties,
    /// What faces do to each other.
    pub(super) contacts: &'a Contacts,
    /// What presses on faces.
    pub(super) loads: &'a Loads,
    /// Time by which velocities are ahead of the rest [s].
    pub(super) half_step: f64,
}

impl Observed for Look<'_> {
    fn tells_bends(&self) -> bool {
        true
    }

    fn tip_zone(&self, cracks: &Cracks, id: TipId, radius: f64) -> TipZone {
        let Self { lattice, motion, .. } = *self;
        let tip = cracks.position(id);
        let ahead = self.ahead(cracks, id);
        let around = LineAround::new(cracks, id, ahead, radius, |crack, point| cracks[crack].points[point]);
        let side_of = |place: Point| around.side_of(place);
        let (points, frame, [back, back_minus_one]) = self.points_around(cracks, (id, ahead), radius, side_of);
        let into = frame * back;
        let turned = |of: FaceContact| FaceContact { force: into * of.force, ..of };
        let contacts = self.contacts_around(cracks, (id, frame), radius).into_iter().map(turned).collect();
        let beyond = radius + 2.0 * lattice.grid.cell_size;
        let left = left_of_tip(id.end);
        let on_face = |(pressure, pressed): (f64, &Pressed)| {
            let (_, side) = pressed.piece.face?;
            // From the end farther along the crack from the tip to the nearer one.
            let is_forward = (side == Side::Above) == (id.end == End::End);
            let order = if is_forward { [0, 1] } else { [1, 0] };
            let probe = order.map(|k| &pressed.ends[k]);
            let moved = probe
                .map(|probe| frame * (back * probe.value(&motion.displacement) + back_minus_one * (probe.rest - tip)));
            Some(FaceLoad {
                ends: probe.map(|probe| frame * (probe.rest - tip)),
                side: if side == left { Side::Above } else { Side::Below },
                force: into * pressed.normal(&motion.displacement) * pressure,
                stretch: moved[1] - moved[0],
            })
        };
        let is_near = |(_, pressed): &(f64, &Pressed)| (pressed.piece.middle() - tip).norm() < beyond;
        let face_loads = self.loads.on_faces(id.crack).filter(is_near).filter_map(on_face).collect();
        let has_kink = cracks.way_to_kink(id, beyond).is_some();
        let bend = has_kink.then(|| {
            let behind = cracks.behind(id, beyond);
            Bend::new(behind.into_iter().rev().map(|place| Point::from(frame * (place - tip))).collect())
        });
        TipZone { points, contacts, face_loads, bend, into, follows_line: lattice.has_ties() }
    }

    fn opening(&self, cracks: &Cracks, id: TipId, into: Matrix) -> Opening {
        let line = cracks.of(id);
        // 1 to 3 cells behind the tip: nearer, the tip's own discretisation shows; farther, the next term of the
        // series.
        let wanted = 1.5 * self.lattice.grid.cell_size;
        let n = line.points.len();
        let mut distance = 0.0;
        let from_tip = |k: usize| if id.end == End::End { n - 1 - k } else { k };
        for w in (0..n - 1).map(|k| [from_tip(k), from_tip(k + 1)]) {
            let (from, to) = (line.points[w[0]], line.points[w[1]]);
            let length = (to - from).norm();
            if distance + length >= wanted {
                let t = (wanted - distance) / length;
                let jump = |k: usize| {
                    let [above, below] = &self.probes.faces[id.crack];
                    above[k].value(&self.motion.displacement) - below[k].value(&self.motion.displacement)
                };
                // The probe between two crack points, a hair beside the crack.
                let place = from + (to - from) * t;
                let tangent = (to - from) / length;
                let hair = Vector::new(-tangent.y, tangent.x) * (1e-6 * self.lattice.grid.cell_size);
                // Seen from the tip looking ahead, left and right are the other way round.
                let [left, right] = [-hair, hair];
                let value = |offset: Vector| -> Option<Vector> {
                    let probe = self.lattice.probe(line.body, place, place + offset);
                    (!probe.entries.is_empty()).then(|| probe.value(&self.motion.displacement))
                };
                if let (Some(a), Some(b)) = (value(left), value(right)) {
                    return Opening { apart: into * (a - b), distance: wanted };
                }
                let sign = left_of_tip(id.end).sign();
                return Opening { apart: into * (jump(w[1]) * sign), distance: distance + length };
            }
            distance += length;
        }
        Opening::default()
    }

    fn free_zone(&self, cracks: &Cracks, id: TipId, radius: f64, with_contacts: bool) -> Option<FreeZone> {
        let is_pressed = || cracks.trail(id).iter().any(|&stretch| self.contacts.forces(stretch).next().is_some());
        let is_loaded = self.loads.on_faces(id.crack).next().is_some();
        if is_loaded || !self.lattice.has_ties() || !with_contacts && is_pressed() {
            return None;
        }
        Some(self.free_zone_around(cracks, id, radius))
    }

    fn parted_at_tip(&self, id: TipId) -> Option<f64> {
        self.ties.parted(&self.motion.displacement, id)
    }

    fn tip_now(&self, cracks: &Cracks, id: TipId) -> (Point, Vector) {
        let faces = &self.probes.faces[id.crack];
        let u = &self.motion.displacement;
        let middle = |(above, below): (&Probe, &Probe)| nalgebra::center(&above.moved(u), &below.moved(u));
        let now: Vec<Point> = faces[0].iter().zip(&faces[1]).map(middle).collect();
        tip_of(cracks, id, &now, self.lattice.grid.cell_size)
    }
}

impl Look<'_> {
    /// What the faces behind a tip do to each other near it, with forces of the world; `frame`: from that into that of
    /// the tip.
    pub(super) fn contacts_around(
        &self,
        cracks: &Cracks,
        (id, frame): (TipId, Matrix),
        radius: f64,
    ) -> Vec<FaceContact> {
        let tip = cracks.position(id);
        let mut near = Vec::new();
        for stretch in cracks.trail(id) {
            let sign = if stretch.is_backwards() { 1.0 } else { -1.0 };
            // Elsewhere the crack may have come back behind the tip.
            let is_near = |of: &(Point, Vector)| (of.0 - tip).norm() < radius + 2.0 * self.lattice.grid.cell_size;
            near.extend(self.contacts.forces(stretch).filter(is_near).map(|(place, force)| {
                let place = frame * (place - tip);
                FaceContact { place, behind: -place.x, force: force * sign }
            }));
        }
        near
    }

    /// Unit vector ahead of a tip at rest.
    pub(super) fn ahead(&self, cracks: &Cracks, id: TipId) -> Vector {
        cracks.ahead(id, DIRECTION_LENGTH * self.lattice.grid.cell_size)
    }

    /// The points around a tip in its frame (`ahead`: e1), the frame, and the turn of its surroundings taken back, less
    /// 1 too.
    fn points_around(
        &self,
        cracks: &Cracks,
        (id, ahead): (TipId, Vector),
        radius: f64,
        side_of: impl Fn(Point) -> Side,
    ) -> (Vec<QuadraturePoint>, Matrix, [Matrix; 2]) {
        let Self { lattice, motion, .. } = *self;
        let particles = &lattice.particles;
        let tip = cracks.position(id);
        let found = particles_of_disc(lattice, motion, cracks.of(id).body, (tip, radius));
        let mean = found.iter().fold(Matrix::zeros(), |sum, (_, strain, _)| sum + strain);
        let mean = mean / found.len().max(1) as f64;
        // Rigid turn R of the surroundings (polar decomposition of the mean F), then into the tip frame.
        let (rotation, _) = turn(2.0 + mean.m11 + mean.m22, mean.m21 - mean.m12);
        let back = rotation.transpose();
        let (_, back_minus_one) = turn(2.0 + mean.m11 + mean.m22, mean.m12 - mean.m21);
        let frame = Matrix::new(ahead.x, ahead.y, -ahead.y, ahead.x);
        let reader = lattice.reader();
        let mut points = Vec::with_capacity(found.len() + found.len() / 4);
        for (p, h, rates) in found {
            let e = lattice.material(p);
            let into = |m: Matrix| frame * m * frame.transpose();
            let part = |h: Matrix, rates: ParticleRates, (share, way): (f64, Vector)| {
                let place = particles.rest[p] + way;
                let arm = place - tip;
                let ParticleRates { displacement, velocity, velocity_gradient, acceleration } = rates;
                let velocity = velocity - acceleration * self.half_step;
                QuadraturePoint {
                    place: frame * arm,
                    displacement: frame * (back * (displacement + h * way) + back_minus_one * arm),
                    side: side_of(place),
                    volume: particles.volume[p] * share,
                    stress: into(back * crate::first_piola_stress(&h, e.mu, e.lambda)),
                    gradient: into(back * h + back_minus_one),
                    energy: crate::energy_density(&h, e.mu, e.lambda),
                    density: e.density,
                    velocity: frame * (back * velocity),
                    velocity_slope: frame * (back * (velocity_gradient * ahead)),
                    acceleration: frame * (back * acceleration),
                    material: particles.material[p],
                }
            };
            let whole = (1.0, Vector::zeros());
            let own = lattice.layout.cut.part_of(p);
            points.push(part(h, rates, own.unwrap_or(whole)));
            // What no crack cuts has nothing across one.
            if own.is_none() {
                continue;
            }
            if let (Some(h), Some(rates)) = (reader.far_strain(p, &motion.displacement), reader.far_rates(p, motion)) {
                points.push(part(h, rates, lattice.layout.far.part_of(p).unwrap_or(whole)));
            }
        }
        (points, frame, [back, back_minus_one])
    }
}

/// The side of the tip frame's e2 for one end of a crack, as a side of the crack.
fn left_of_tip(end: End) -> Side {
    match end {
        End::Start => Side::Below,
        End::End => Side::Above,
    }
}
