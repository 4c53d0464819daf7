//! What a crack tip feels: from the material around it to J, K_I and K_II.

use crate::StressIntensity;
use crate::crack::cracks::{Cracks, TipId};
use crate::crack::crossing::{Side, apart};
use crate::crack::is_kink;
use crate::grid::kernel::axis_stencil;
use crate::material::elastic::Elastic;
use crate::solver::Observed;
use crate::tip::contour::{Contour, ContourHalf, ContourSample};
use crate::tip::contours::KERNEL_REACH;
use crate::tip::domain::domain_integrals;
use crate::tip::reciprocal::{Setting, reciprocal_integrals};
use crate::tip::side_by_side::Wanted;
use crate::tip::zone::{Opening, QuadraturePoint, TipZone};
use fissure_scene::{JMethod, Matrix, ModeSplit, Point, Scene, Vector};
use std::convert::Infallible;
use std::f64::consts::PI;

/// The radius is not made smaller than this, in cells: within it lie too few particles for an integral.
const SMALLEST_RADIUS: f64 = 2.0;
/// A tip nearer to an outline than this, in cells, has no domain of its own.
const NECK: f64 = 1.5;
/// A domain without a radius of its own reaches over this part of the way to what would spoil it ...
const PART_OF_ROOM: f64 = 0.375;
/// ... but over so many cells at least, ...
const NARROW_RADIUS: f64 = 4.0;
/// ... and at most: its error falls with their number. K_I of edge cracks of 16 and 32 cells is off by 0.16 and 0.16 %
/// (rms) with four cells, by 0.08 and 0.05 % with six.
const WIDE_RADIUS: f64 = 6.0;
/// Within so many cells beyond the radius a kink spoils what integrals over a straight crack say.
const KINK_MARGIN: f64 = 1.0;
/// A branch has a field of its own from this length on, in cells: growth by a quarter of a cell, but for round-off.
const SHORTEST_BRANCH: f64 = 0.24;

/// K_eq of a tip is at most so many times √(E'J): of all ratios of the modes K_II = √3 K_I has the largest hoop stress,
/// 3√3/4 times that of mode I alone.
const MOST_EQUIVALENT: f64 = 1.3;

/// K_eq of a tip is less than so many times the K that a cell behind it would part the faces by as much as any node
/// around the tip has parted. At 1,800 looks at tips at rest of seven examples with K_eq above a tenth of the toughness
/// it was at most 11 times as much, as a wave came in, and 1.0 to 1.4 times at rest.
const MOST_OVER_OPENING: f64 = 25.0;

/// What the integrals around a tip give. What it means for growth is said by [`crate::growth::assess`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Reading {
    /// J along the crack [J/m²].
    pub(crate) j_integral: f64,
    /// K_I and K_II.
    pub(crate) modes: StressIntensity,
    /// The stress intensities that decide on growth: those that what is released amounts to, shared out as the modes
    /// are.
    pub(crate) decisive: StressIntensity,
    /// What of J drives growth [J/m²].
    pub(crate) released: f64,
    /// Radius of the domain or contour [m].
    pub(crate) contour_radius: f64,
    /// Whether it is smaller than asked for.
    pub(crate) radius_shrunk: bool,
}

/// Everything the measurement needs besides the solver.
#[derive(Debug)]
pub(crate) struct Gauge<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) elastic: &'a [Elastic],
}

impl Gauge<'_> {
    /// Measures one tip.
    pub(crate) fn read(&self, moment: &dyn Observed, cracks: &Cracks, id: TipId) -> Reading {
        let settings = &self.scene.solver;
        let h = self.scene.cell_size;
        let (radius, radius_shrunk, kink) = match settings.j_method {
            JMethod::Domain => self.domain_radius(moment, cracks, id),
            JMethod::Contour => (settings.j_radius.unwrap_or(NARROW_RADIUS) * h, false, None),
        };
        let is_plain = settings.j_method == JMethod::Domain && settings.mode_split == ModeSplit::Interaction;
        if is_plain
            && kink.is_none()
            && let Some(mut zone) = moment.free_zone(cracks, id, radius, true)
        {
            let Some(elastic) = zone.material_at_tip(self.elastic) else { return Reading::default() };
            let found = zone.integrals(&Wanted::new(elastic, h, radius, settings.area_term));
            let split = StressIntensity { mode_1: found.mode_1, mode_2: found.mode_2 };
            return self.reading(
                (cracks, id),
                elastic,
                (found.j_integral, split, found.closed),
                (radius, radius_shrunk),
            );
        }
        let reach = if settings.j_method == JMethod::Contour { radius + KERNEL_REACH * h } else { radius };
        let mut zone = moment.tip_zone(cracks, id, reach);
        if kink.is_none() {
            zone.center_on_crack(h);
        }
        zone.take_off_mean_velocity();
        let Some(elastic) = self.material_at_tip(&zone) else { return Reading::default() };
        let domain = |outer: f64| domain_integrals(&zone, self.elastic, elastic, h, outer, settings.area_term);
        let (j_integral, found) = match settings.j_method {
            JMethod::Domain => {
                let found = match (kink, &zone.bend) {
                    (Some(way), Some(bend)) => {
                        let setting =
                            Setting { elastic: self.elastic, tip: elastic, cell_size: h, dynamic: settings.area_term };
                        reciprocal_integrals(&zone, bend, way, &setting, radius)
                    }
                    _ => domain(radius),
                };
                (found.j_integral, found)
            }
            JMethod::Contour => {
                let j = self.contour_j(&zone, moment.opening(cracks, id, zone.into), radius);
                let found =
                    if settings.mode_split == ModeSplit::Interaction { domain(reach) } else { Default::default() };
                (j, found)
            }
        };
        let split = match settings.mode_split {
            ModeSplit::OpeningDisplacement => {
                let opening = moment.opening(cracks, id, zone.into);
                StressIntensity::from_opening(j_integral, opening.apart, elastic.effective_modulus)
            }
            ModeSplit::Interaction => StressIntensity { mode_1: found.mode_1, mode_2: found.mode_2 },
        };
        self.reading((cracks, id), elastic, (j_integral, split, found.closed), (radius, radius_shrunk))
    }

    /// What the J and the modes found at a tip in the material `elastic` mean, and whether its faces press on each
    /// other; the radius [m] they were found over, and whether that is smaller than asked for.
    fn reading(
        &self,
        (cracks, id): (&Cracks, TipId),
        elastic: &Elastic,
        (j_integral, mut split, closed): (f64, StressIntensity, bool),
        (radius, radius_shrunk): (f64, bool),
    ) -> Reading {
        if self.scene.solver.crack_contact {
            split = without_overlap(split, closed);
        }
        let known = if j_integral <= 0.0 && self.is_in_neck(cracks, id) {
            split.energy_release_rate(elastic.effective_modulus)
        } else {
            j_integral
        };
        let decisive = decisive(known, split, elastic.effective_modulus);
        Reading {
            j_integral,
            modes: split,
            decisive,
            released: decisive.energy_release_rate(elastic.effective_modulus),
            contour_radius: radius,
            radius_shrunk,
        }
    }

    /// Whether K_eq of a tip is known to be below `limit` [Pa·√m] without a look.
    pub(crate) fn is_below(&self, moment: &dyn Observed, cracks: &Cracks, id: TipId, limit: f64) -> bool {
        if self.scene.solver.j_method != JMethod::Domain {
            return false;
        }
        let material = self.scene.bodies[cracks.of(id).body as usize].material_at(cracks.position(id));
        let modulus = self.elastic[material].effective_modulus;
        // Behind a tip with K faces are apart by (8/E') K √(r/2π), in mode I as in mode II (Williams 1957).
        let of_opening = |parted: f64| parted * modulus / 8.0 * (2.0 * PI / self.scene.cell_size).sqrt();
        let is_shut = |parted: f64| MOST_OVER_OPENING * of_opening(parted) < limit;
        moment.parted_at_tip(id).is_some_and(is_shut) || self.highest_equivalent(moment, cracks, id) < limit
    }

    /// The highest K_eq that a tip can have with the J that a look would find, be its modes what they are [Pa·√m];
    /// infinite where that is not known without a look.
    fn highest_equivalent(&self, moment: &dyn Observed, cracks: &Cracks, id: TipId) -> f64 {
        let (radius, _, kink) = self.domain_radius(moment, cracks, id);
        if kink.is_some() {
            return f64::INFINITY;
        }
        let Some(mut zone) = moment.free_zone(cracks, id, radius, false) else { return f64::INFINITY };
        let Some(elastic) = zone.material_at_tip(self.elastic) else { return f64::INFINITY };
        let wanted = Wanted::new(elastic, self.scene.cell_size, radius, self.scene.solver.area_term);
        let j = zone.integrals(&Wanted { modes: false, ..wanted }).j_integral;
        // A NaN stays one: the square root of the larger of two numbers would be that of 0.
        if j <= 0.0 && self.is_in_neck(cracks, id) {
            return f64::INFINITY;
        }
        let released = if j < 0.0 { 0.0 } else { j };
        MOST_EQUIVALENT * (elastic.effective_modulus * released).sqrt()
    }

    /// Whether an outline passes so near to a tip that J, which counts it, may be below zero while the tip opens. A
    /// body that hangs by half a cell would do so for ever; K, however inexact there, knows that it is torn.
    fn is_in_neck(&self, cracks: &Cracks, id: TipId) -> bool {
        let region = &self.scene.bodies[cracks.of(id).body as usize].region;
        region.distance_to_rings(cracks.position(id)) < NECK * self.scene.cell_size
    }

    /// The material of the particle nearest to a tip; none: there are no particles.
    pub(super) fn material_at_tip(&self, zone: &TipZone) -> Option<&Elastic> {
        let by_distance =
            |a: &&QuadraturePoint, b: &&QuadraturePoint| a.place.norm_squared().total_cmp(&b.place.norm_squared());
        zone.points.iter().min_by(by_distance).map(|nearest| &self.elastic[nearest.material as usize])
    }

    /// Radius of the domain around a tip [m], whether it is smaller than asked for, and, where the integrals have to
    /// cope with a kink, the way to that [m].
    fn domain_radius(&self, moment: &dyn Observed, cracks: &Cracks, id: TipId) -> (f64, bool, Option<f64>) {
        let h = self.scene.cell_size;
        let given = self.scene.solver.j_radius;
        let enough = given.unwrap_or(0.0).max(WIDE_RADIUS / PART_OF_ROOM);
        let [passing_bends, up_to_bends] = self.free_radii(cracks, id, enough * h);
        let radius = |free: f64| {
            let room = free / h;
            let wanted = given.unwrap_or((PART_OF_ROOM * room).clamp(NARROW_RADIUS, WIDE_RADIUS));
            (wanted.min(room).max(SMALLEST_RADIUS) * h, wanted > room)
        };
        if moment.tells_bends() && self.scene.solver.mode_split == ModeSplit::Interaction {
            let (passing, is_shrunk) = radius(passing_bends);
            let kink = cracks.way_to_kink(id, passing + KINK_MARGIN * h);
            if let Some(way) = kink.filter(|&way| way > SHORTEST_BRANCH * h) {
                return (passing, is_shrunk, Some(way));
            }
        }
        let (radius, is_shrunk) = radius(up_to_bends);
        (radius, is_shrunk, None)
    }

    /// Distance from a tip to the nearest thing that would spoil the integral: a ring, a crack that does not lead to
    /// it, the other end of those that do, and then a bend of theirs too [m]; what is farther than `enough` [m] is not
    /// looked at.
    pub(super) fn free_radii(&self, cracks: &Cracks, id: TipId, enough: f64) -> [f64; 2] {
        let line = cracks.of(id);
        let tip = cracks.position(id);
        let body = &self.scene.bodies[line.body as usize];
        let mut free = enough.min(body.region.distance_to_rings(tip));
        for inclusion in &body.inclusions {
            // The integrals hold for one material; across an interface they would count its image forces.
            free = free.min(inclusion.region.distance_to_rings(tip));
        }
        let trail = cracks.trail(id);
        for (index, other) in cracks.iter().enumerate().filter(|(_, other)| other.body == line.body) {
            if other.least_distance(tip) > free {
                continue;
            }
            let of_trail = trail.iter().filter(|stretch| stretch.crack == index);
            if of_trail.clone().any(|stretch| stretch.is_all_of(other.points.len())) {
                continue;
            }
            for (k, w) in other.points.windows(2).enumerate() {
                let by = Vector::repeat(free);
                if !apart(tip - by, tip + by, w[0], w[1]) && !of_trail.clone().any(|stretch| stretch.has_segment(k)) {
                    free = free.min(fissure_plane::distance_to_segment(tip, w[0], w[1]));
                }
            }
        }
        let ahead = cracks.ahead(id, crate::crack::DIRECTION_LENGTH * self.scene.cell_size);
        // A crack goes straight away from its tip, or it is followed on.
        let mut over = (2.0 * free).max(self.scene.cell_size);
        let points = loop {
            let points = cracks.behind(id, over);
            if points.iter().any(|p| (p - tip).norm() > free) || fissure_plane::polyline_length(&points) < over {
                break points;
            }
            over *= 2.0;
        };
        let mut bend = f64::INFINITY;
        for w in points.windows(3) {
            let distance = (w[1] - tip).norm();
            if distance > free {
                break;
            }
            // Both the turn at one point and what small turns have added up to since the tip.
            let (a, b) = (w[1] - w[0], w[2] - w[1]);
            if is_kink(a, b) || is_kink(-ahead, b) {
                bend = distance;
                break;
            }
        }
        let far = trail.last().map_or(tip, |stretch| cracks[stretch.crack].points[stretch.to]);
        let far = (far - tip).norm();
        [free.min(far), free.min(bend).min(far)]
    }

    /// J along the crack by a contour, with the inertia within it where the scene asks for that.
    fn contour_j(&self, zone: &TipZone, opening: Opening, radius: f64) -> f64 {
        let j = self.circle_j(zone, opening, radius);
        if self.scene.solver.area_term { j + area_term(zone, radius) } else { j }
    }

    /// J along the crack by the thesis' contour: 16 segments, values by kernel averages of the particles on the same
    /// side (its eq. 25 to 28).
    pub(super) fn circle_j(&self, zone: &TipZone, opening: Opening, radius: f64) -> f64 {
        let Opening { apart, distance } = opening;
        let opening = if distance > 0.0 { apart.y.max(0.0) * (radius / distance).sqrt() } else { 0.0 };
        let lower = Point::new(-radius, -0.5 * opening);
        let upper = Point::new(-radius, 0.5 * opening);
        let contour = Contour::new(Point::origin(), radius, lower, upper);
        let reach = KERNEL_REACH * self.scene.cell_size;
        let is_near = |p: &&QuadraturePoint| (p.place.norm() - radius).abs() < std::f64::consts::SQRT_2 * reach;
        let near: Vec<QuadraturePoint> = zone.points.iter().filter(is_near).copied().collect();
        let sampled = contour.j_integral(|place, half| Ok::<_, Infallible>(self.contour_sample(&near, place, half)));
        let j = match sampled {
            Ok(j) => j.x,
            Err(never) => match never {},
        };
        j - zone.work_of_face_loads(radius)
    }

    fn contour_sample(&self, points: &[QuadraturePoint], place: Point, half: ContourHalf) -> ContourSample {
        let h = self.scene.cell_size;
        let half_size = 0.5 * self.scene.particle_spacing / h;
        let weight_of = |offset: f64| {
            // The kernel of a node at 0, seen from a particle at `offset`.
            let stencil = axis_stencil(self.scene.solver.kernel, half_size, offset);
            usize::try_from(-stencil.first).ok().and_then(|k| stencil.weight.get(k)).copied().unwrap_or(0.0)
        };
        let side = match half {
            ContourHalf::Above => Side::Above,
            ContourHalf::Below => Side::Below,
        };
        let mut mass = 0.0;
        let mut sample = ContourSample {
            strain_energy_density: 0.0,
            kinetic_energy_density: 0.0,
            cauchy_stress: Matrix::zeros(),
            displacement_gradient: Matrix::zeros(),
        };
        let mut velocity = Vector::zeros();
        let mut density = 0.0;
        for p in points {
            let w = weight_of((p.place.x - place.x) / h) * weight_of((p.place.y - place.y) / h);
            if w <= 0.0 || is_across(p, place, side) {
                continue;
            }
            let m = w * p.density * p.volume;
            mass += m;
            sample.strain_energy_density += m * p.energy;
            sample.cauchy_stress += m * p.stress;
            sample.displacement_gradient += m * p.gradient;
            velocity += m * p.velocity;
            density += m * p.density;
        }
        if mass > 0.0 {
            sample.strain_energy_density /= mass;
            sample.cauchy_stress /= mass;
            sample.displacement_gradient /= mass;
            sample.kinetic_energy_density = 0.5 * (density / mass) * (velocity / mass).norm_squared();
        }
        sample
    }
}

/// The modes of a crack whose faces cannot overlap: no K_I below zero, and none at all where they press on each other
/// at the tip. What the integral leaves there is the error of the pressure's part: one per cent of the K_I that the
/// pressure would have without contact.
pub(super) fn without_overlap(split: StressIntensity, closed: bool) -> StressIntensity {
    StressIntensity { mode_1: if closed { 0.0 } else { split.mode_1.max(0.0) }, ..split }
}

/// The stress intensities that decide on growth. When: by the energy release rate, J. Where to: by the ratio of the
/// modes.
///
/// Of a crack that is closed, only what its K_II accounts for counts: a crack gains nothing from the energy of
/// compression.
fn decisive(j_integral: f64, split: StressIntensity, effective_modulus: f64) -> StressIntensity {
    if split.mode_1 > 0.0 {
        return StressIntensity::from_opening(j_integral, Vector::new(split.mode_2, split.mode_1), effective_modulus);
    }
    let shear = StressIntensity { mode_1: 0.0, ..split };
    let released = shear.energy_release_rate(effective_modulus);
    // A NaN stays one: nothing known, no growth.
    let available = if released < j_integral { released } else { j_integral };
    StressIntensity::from_opening(available, Vector::new(split.mode_2, 0.0), effective_modulus)
}

/// Inertia within the contour, ∫ ρ (a_i u_i,1 − v_i v_i,1) dA [J/m²]: what makes J independent of the contour in
/// dynamics. Source: Nakamura, Shih & Freund 1985; the thesis leaves it out.
pub(super) fn area_term(zone: &TipZone, radius: f64) -> f64 {
    zone.points
        .iter()
        .filter(|p| p.place.norm() < radius)
        .map(|p| {
            let u_1 = p.gradient.column(0);
            p.volume * p.density * (p.acceleration.dot(&u_1) - p.velocity.dot(&p.velocity_slope))
        })
        .sum()
}

/// Whether the crack, straight behind the tip, lies between a particle and a point of the contour.
fn is_across(particle: &QuadraturePoint, place: Point, side: Side) -> bool {
    let sides_differ =
        if particle.place.x < 0.0 { particle.side != side } else { particle.place.y * side.sign() < 0.0 };
    if !sides_differ || place.x >= 0.0 && particle.place.x >= 0.0 {
        return false;
    }
    let span = particle.place.y - place.y;
    if span == 0.0 {
        return place.x < 0.0;
    }
    let t = -place.y / span;
    place.x + t * (particle.place.x - place.x) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn k(mode_1: f64, mode_2: f64) -> StressIntensity {
        StressIntensity { mode_1, mode_2 }
    }

    /// Truth: Irwin. K_I = 3, K_II = 4 and E' = 5 have J = 5; whatever J says, it is shared out as the modes are.
    #[test]
    fn an_open_crack_has_the_amplitude_of_j() {
        let found = decisive(5.0, k(3.0, 4.0), 5.0);
        assert!((found.mode_1 - 3.0).abs() < 1e-14 && (found.mode_2 - 4.0).abs() < 1e-14);
        let found = decisive(20.0, k(3.0, -4.0), 5.0);
        assert!((found.mode_1 - 6.0).abs() < 1e-14 && (found.mode_2 + 8.0).abs() < 1e-14);
    }

    /// Without J, or below zero, nothing is known and nothing grows; what compression stores is not released by shear.
    #[test]
    fn states_that_release_nothing_are_quiet() {
        for j in [0.0, -7.0, f64::NAN] {
            for modes in [k(3.0, 4.0), k(-3.0, 4.0), k(0.0, 0.0)] {
                assert_eq!(decisive(j, modes, 5.0), k(0.0, 0.0), "{j} {modes:?}");
            }
        }
        assert_eq!(decisive(7.0, k(0.0, 0.0), 5.0), k(0.0, 0.0));
        assert_eq!(decisive(7.0, k(-6.0, 0.0), 5.0), k(0.0, 0.0));
        // Pure shear, J = K_II²/E', and the same pressed together without contact, J = (K_I² + K_II²)/E'.
        for (j, mode_1) in [(0.8, 0.0), (5.8, -5.0)] {
            let found = decisive(j, k(mode_1, -2.0), 5.0);
            assert!(found.mode_1 == 0.0 && (found.mode_2 + 2.0).abs() < 1e-14, "{found:?}");
        }
        assert_eq!(without_overlap(k(-3.0, 4.0), false), k(0.0, 4.0));
        assert_eq!(without_overlap(k(3.0, 4.0), false), k(3.0, 4.0));
        assert_eq!(without_overlap(k(3.0, 4.0), true), k(0.0, 4.0));
    }
}
