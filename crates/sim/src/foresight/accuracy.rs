//! How right K will be, from what a scene has few cells for.

use super::drawn_tip::DrawnTip;
use crate::material::elastic::Elastic;
use fissure_plane::{Point, distance_to_segment, polyline_length};
use fissure_scene::{Curve, Formulation, LoadKind, Scene, Vector};

/// What resolution makes of K at the tip for which it makes most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Error of the highest K, at the worst place on the grid [–].
    pub error: f64,
    /// What most of it is due to.
    pub limit: Limit,
    /// Index of the crack in the scene.
    pub crack: usize,
    /// Cells that there are of that.
    pub cells: f64,
}

/// What K is not righter for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// The length of the crack: half of it where both of its ends are tips.
    Crack,
    /// The way between its tip and the nearest outline, hole or other crack.
    Room,
    /// The length of the crack, because loads come at once: their waves ring in cells that are not much smaller.
    Waves,
}

/// (Cells of the crack, error of K). Edge cracks at rest at ten angles and at five heights within a cell are within
/// three quarters of it. Of 320 random plates with cracks, holes and loads, at once or gradually, that were held
/// against the same in much smaller cells, 2 % are beyond what is said here in all; half of them within a third of it.
const TOTAL: [(f64, f64); 7] =
    [(1.0, 0.2), (2.0, 0.15), (3.0, 0.045), (4.0, 0.033), (6.0, 0.02), (8.0, 0.017), (16.0, 0.01)];
/// The same of the updated formulation, at fewer places.
const UPDATED: [(f64, f64); 4] = [(1.0, 0.4), (3.0, 0.1), (4.0, 0.1), (6.0, 0.04)];
/// (Cells between a tip and what is nearest to it, error of K), in the same plates; at four and five cells it is that
/// of two tips that face each other.
const ROOM: [(f64, f64); 8] =
    [(1.0, 0.7), (2.0, 0.35), (3.0, 0.11), (4.0, 0.075), (5.0, 0.075), (7.0, 0.02), (10.0, 0.0125), (16.0, 0.01)];
/// What loads that come at once add, times the square of the number of cells of the crack: waves that are shorter than
/// the crack ring on the grid.
const AT_ONCE: f64 = 0.5;
/// Loads come gradually when a wave goes so many lengths of the crack meanwhile.
const GRADUAL: f64 = 2.0;

/// The accuracy at the tip that has the least, of those that wait for their K; none: no tip does.
pub(crate) fn accuracy(scene: &Scene, elastic: &[Elastic], formulation: Formulation) -> Option<Accuracy> {
    let rise = rise_time(scene);
    let waiting = DrawnTip::all(scene).filter(|tip| !tip.is_scheduled());
    let accuracies = waiting.map(|tip| at_tip(scene, elastic, formulation, rise, &tip));
    accuracies.max_by(|a, b| a.error.total_cmp(&b.error))
}

fn at_tip(scene: &Scene, elastic: &[Elastic], formulation: Formulation, rise: f64, tip: &DrawnTip<'_>) -> Accuracy {
    let h = scene.cell_size;
    // An edge crack of length a and a crack of 2a in the middle of a body have about the same field at their tips.
    let tips = f64::from(u8::from(tip.crack.start_live) + u8::from(tip.crack.end_live));
    let crack_cells = polyline_length(&tip.crack.points) / tips / h;
    let room_cells = room(scene, tip) / h;
    let material = scene.bodies[tip.crack.body].material_at(tip.place());
    let rise_cells = rise * elastic[material].dilatational_wave_speed() / h;
    let by_crack = error(if formulation == Formulation::Updated { &UPDATED } else { &TOTAL }, crack_cells);
    let by_room = error(&ROOM, room_cells);
    let at_once = (1.0 - rise_cells / (GRADUAL * crack_cells)).max(0.0);
    let by_waves = AT_ONCE / (crack_cells * crack_cells) * at_once;
    let (limit, cells) = if by_waves > by_crack.max(by_room) {
        (Limit::Waves, crack_cells)
    } else if by_room > by_crack {
        (Limit::Room, room_cells)
    } else {
        (Limit::Crack, crack_cells)
    };
    Accuracy { error: by_crack.max(by_room) + by_waves, limit, crack: tip.index, cells }
}

/// Way from a tip to the nearest ring of its body or other crack [m].
fn room(scene: &Scene, tip: &DrawnTip<'_>) -> f64 {
    let at = tip.place();
    let to_line =
        |points: &[Point]| points.windows(2).map(|w| distance_to_segment(at, w[0], w[1])).fold(f64::INFINITY, f64::min);
    let others = scene.cracks.iter().enumerate().filter(|(k, c)| *k != tip.index && c.body == tip.crack.body);
    let to_cracks = others.map(|(_, crack)| to_line(&crack.points)).fold(f64::INFINITY, f64::min);
    scene.bodies[tip.crack.body].region.distance_to_rings(at).min(to_cracks)
}

/// Time in which what acts on a scene rises from nothing to its greatest [s]: of what does so fastest. Supports load a
/// body by the way that they go, over all of the time.
pub(super) fn rise_time(scene: &Scene) -> f64 {
    let end = scene.frames.time(scene.frames.last);
    let acts = |kind: &LoadKind| match kind {
        LoadKind::Force(f) | LoadKind::Traction(f) => *f != Vector::zeros(),
        LoadKind::Pressure(p) | LoadKind::FacePressure(_, p) => *p != 0.0,
        LoadKind::PerPoint(forces) => forces.iter().any(|f| f.1 != Vector::zeros()),
    };
    let loads = scene.loads.iter().filter(|load| acts(&load.kind)).map(|load| rise_of(&load.curve));
    let moves = scene.bodies.iter().any(|body| !body.velocities.is_empty());
    let at_once = moves || scene.gravity != Vector::zeros() || !scene.colliders.is_empty();
    let own = if at_once { 0.0 } else { end };
    loads.fold(own, f64::min)
}

/// Time in which a curve would go from 0 to its greatest at its steepest [s].
fn rise_of(curve: &Curve) -> f64 {
    let greatest = curve.points.iter().map(|p| p.1.abs()).fold(0.0, f64::max);
    match curve.points.first() {
        // A load that is there from the start has come at once.
        Some(&(_, 0.0)) => {}
        _ => return 0.0,
    }
    let slopes = curve.points.windows(2).map(|w| (w[1].1 - w[0].1).abs() / (w[1].0 - w[0].0));
    greatest / slopes.fold(f64::MIN_POSITIVE, f64::max)
}

/// Between two entries errors go with a power of the number of cells; beyond the table they are those of its ends.
fn error(table: &[(f64, f64)], cells: f64) -> f64 {
    let next = table.partition_point(|entry| entry.0 <= cells);
    match (next.checked_sub(1).map(|last| table[last]), table.get(next)) {
        (Some((c0, e0)), Some(&(c1, e1))) => e0 * (e1 / e0).powf((cells / c0).ln() / (c1 / c0).ln()),
        (Some((_, last)), None) => last,
        (None, Some(&(_, first))) => first,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the entries themselves, the geometric mean in the geometric middle, the ends.
    #[test]
    fn errors_are_those_of_the_table() {
        for (cells, expected) in [(0.3, 0.2), (4.0, 0.033), (16.0, 0.01), (99.0, 0.01)] {
            let found = error(&TOTAL, cells);
            assert!((found - expected).abs() < 1e-12, "{cells}: {found}");
        }
        let between = error(&TOTAL, (8.0_f64 * 16.0).sqrt());
        assert!((between - (0.017_f64 * 0.01).sqrt()).abs() < 1e-12, "{between}");
    }
    /// Truth: the areas of a ramp by hand; a factor that does not begin at nothing has come at once.
    #[test]
    fn loads_rise_as_their_steepest_part_does() {
        let of = |points: &[(f64, f64)]| rise_of(&Curve { points: points.to_vec() });
        assert_eq!(of(&[]), 0.0);
        assert_eq!(of(&[(0.0, 0.5), (9.0, 1.0)]), 0.0);
        assert!((of(&[(1.0, 0.0), (3.0, 4.0)]) - 2.0).abs() < 1e-12);
        assert!((of(&[(0.0, 0.0), (1.0, 1.0), (2.0, -4.0)]) - 0.8).abs() < 1e-12);
    }
}
