//! The impulses of all meetings together, with Coulomb's friction.
//!
//! A vertex v above an edge (a, b) at s has the velocity w = v_v − (1 − s) v_a − s v_b relative to it, in terms of the
//! fields that carry them w = Σ_f J_f v_f. Its normal part n·w is to be at least what uses up the gap g in one step,
//! −g/Δt, and an impulse λ ≥ 0 sees to that: Δv_f = J_f n λ/m_f. Along the surface an impulse of at most μ λ stops the
//! sliding. All meetings are gone through again and again, each with what the others have done (Gauss–Seidel with
//! projection: Jean 1999; Moreau 1988); they begin with the impulses of the step before, scaled by the length of the
//! step, without which what rests would sink a little in every step.

use super::friction::{borne_by_friction, left_of};
use fissure_plane::Vector;
use serde::{Deserialize, Serialize};

/// Rounds through all meetings in a step, at most.
const ROUNDS: usize = 32;

/// No more rounds are needed when no impulse changes by more than this part of the largest.
const CONVERGED: f64 = 1e-4;

/// What lies inside comes out by this part of its depth in a step ...
const RECOVERY: f64 = 0.1;
/// ... but as if it were no deeper than this, in cells: a push that is stronger would add energy.
const DEEPEST: f64 = 3e-4;
/// What lies deeper than this, in cells, was found inside when it was first looked at: the splinter of a crack that no
/// particle stands for, or faces that have slid by what they match over. It goes no deeper, and comes out when it
/// comes out; to push it out against all that presses on it would make energy of nothing.
const FOUND_INSIDE: f64 = 3e-3;

/// A field that takes part in a meeting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Share {
    /// The field.
    pub(crate) field: u32,
    /// J_f [–].
    pub(crate) weight: f64,
    /// One over its mass along each axis [m/kg]; zero where a support holds it.
    pub(crate) mobility: [f64; 2],
}

/// The impulse of a vertex, kept for the next step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Impulse {
    /// The vertex.
    pub(crate) vertex: u32,
    /// Along the normal [N s/m].
    pub(crate) normal: f64,
    /// Along the surface, to the left of the normal [N s/m].
    pub(crate) tangential: f64,
}

/// A vertex that is kept out of an edge.
#[derive(Debug, Clone)]
struct Row {
    normal: Vector,
    /// Least normal velocity [m/s].
    allowed: f64,
    friction: f64,
    /// Effective masses along the normal and along the surface [kg/m].
    masses: [f64; 2],
    first: u32,
    impulse: Impulse,
}

/// All meetings of a step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Meetings {
    rows: Vec<Row>,
    shares: Vec<Share>,
}

/// Velocities of all fields, x and y apart [m/s].
pub(crate) type Velocities = [Vec<f64>; 2];

/// The normal velocity up to which a `gap` [m] may close within a step of `time_step` [s]; positive where what is
/// inside has to come out.
pub(crate) fn allowed(gap: f64, cell_size: f64, time_step: f64) -> f64 {
    if gap > 0.0 {
        -gap / time_step
    } else if -gap > FOUND_INSIDE * cell_size {
        0.0
    } else {
        RECOVERY * (-gap).min(DEEPEST * cell_size) / time_step
    }
}

impl Meetings {
    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.shares.clear();
    }

    /// Whether there is none.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Adds a meeting: `shares` of all fields, which may come several times; `before`: the impulse it begins with.
    pub(crate) fn push(
        &mut self,
        normal: Vector,
        allowed: f64,
        friction: f64,
        shares: &mut Vec<Share>,
        before: Impulse,
    ) {
        shares.sort_unstable_by_key(|share| share.field);
        let first = self.shares.len();
        for share in shares.drain(..) {
            match self.shares[first..].last_mut() {
                Some(last) if last.field == share.field => last.weight += share.weight,
                _ => self.shares.push(share),
            }
        }
        let along = |direction: Vector| {
            let compliance = |s: &Share| {
                s.weight * s.weight * (direction.x.powi(2) * s.mobility[0] + direction.y.powi(2) * s.mobility[1])
            };
            let sum: f64 = self.shares[first..].iter().map(compliance).sum();
            if sum > 0.0 { 1.0 / sum } else { 0.0 }
        };
        let masses = [along(normal), along(left_of(normal))];
        let impulse = Impulse { tangential: borne_by_friction(before.tangential, friction, before.normal), ..before };
        self.rows.push(Row { normal, allowed, friction, masses, first: first as u32, impulse });
    }

    fn shares_of(&self, row: usize) -> &[Share] {
        let end = self.rows.get(row + 1).map_or(self.shares.len(), |next| next.first as usize);
        &self.shares[self.rows[row].first as usize..end]
    }

    /// Gives the velocities the impulses that all begin with.
    pub(crate) fn begin(&self, velocity: &mut Velocities) {
        for (index, row) in self.rows.iter().enumerate() {
            apply(self.shares_of(index), row.normal * row.impulse.normal, velocity);
            apply(self.shares_of(index), left_of(row.normal) * row.impulse.tangential, velocity);
        }
    }

    /// Goes through all until nothing approaches more than it may, or often enough.
    pub(crate) fn solve(&mut self, velocity: &mut Velocities) {
        let count = self.rows.len();
        for round in 0..ROUNDS {
            let (mut change, mut largest) = (0.0_f64, 0.0_f64);
            for k in 0..count {
                // To and fro, so that neither end of a row of meetings comes first.
                let index = if round.is_multiple_of(2) { k } else { count - 1 - k };
                let changed = self.relax(index, velocity);
                change = change.max(changed);
                largest = largest.max(self.rows[index].impulse.normal);
            }
            if change <= CONVERGED * largest {
                break;
            }
        }
    }

    /// Lets one meeting have its way. Returns by how much its impulse has changed.
    fn relax(&mut self, index: usize, velocity: &mut Velocities) -> f64 {
        let row = &self.rows[index];
        let shares = self.shares_of(index);
        let mut impulse = row.impulse;
        let speed = relative(shares, velocity).dot(&row.normal);
        impulse.normal = (impulse.normal + (row.allowed - speed) * row.masses[0]).max(0.0);
        let change = impulse.normal - row.impulse.normal;
        if change != 0.0 {
            apply(shares, row.normal * change, velocity);
        }
        if row.friction > 0.0 {
            let tangent = left_of(row.normal);
            let sticking = impulse.tangential - relative(shares, velocity).dot(&tangent) * row.masses[1];
            impulse.tangential = borne_by_friction(sticking, row.friction, impulse.normal);
            apply(shares, tangent * (impulse.tangential - row.impulse.tangential), velocity);
        }
        self.rows[index].impulse = impulse;
        change.abs()
    }

    /// The impulse of a meeting along its normal [N s/m].
    pub(crate) fn along_normal(&self, meeting: usize) -> Vector {
        let row = &self.rows[meeting];
        row.normal * row.impulse.normal
    }

    /// The impulses, vertices rising; those of meetings that did nothing are left out.
    pub(crate) fn impulses(&self) -> impl Iterator<Item = Impulse> {
        self.rows.iter().map(|row| row.impulse).filter(|impulse| impulse.normal > 0.0)
    }

    /// What fields that a support holds have been pushed by, over the velocities they are held at: work that the
    /// support does, to be counted with the opposite sign [J/m].
    pub(crate) fn work_on_held(&self, velocity: &Velocities) -> f64 {
        let mut work = 0.0;
        for (index, row) in self.rows.iter().enumerate() {
            let impulse = row.normal * row.impulse.normal + left_of(row.normal) * row.impulse.tangential;
            for share in self.shares_of(index) {
                for axis in (0..2).filter(|&axis| share.mobility[axis] == 0.0) {
                    work += share.weight * impulse[axis] * velocity[axis][share.field as usize];
                }
            }
        }
        work
    }
}

fn relative(shares: &[Share], velocity: &Velocities) -> Vector {
    shares.iter().fold(Vector::zeros(), |sum, s| {
        sum + Vector::new(velocity[0][s.field as usize], velocity[1][s.field as usize]) * s.weight
    })
}

fn apply(shares: &[Share], impulse: Vector, velocity: &mut Velocities) {
    for s in shares {
        for axis in 0..2 {
            velocity[axis][s.field as usize] += s.weight * impulse[axis] * s.mobility[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Impulse = Impulse { vertex: 0, normal: 0.0, tangential: 0.0 };

    /// A mass of 2 kg/m on a wall that nothing moves, pressed at it at 3 m/s and sliding at 4 m/s.
    fn against_wall(friction: f64) -> [f64; 2] {
        let mut velocity = [vec![0.0, 4.0], vec![0.0, -3.0]];
        let mut meetings = Meetings::default();
        let share = |field, weight, mobility| Share { field, weight, mobility: [mobility; 2] };
        meetings.push(Vector::y(), 0.0, friction, &mut vec![share(1, 1.0, 0.5), share(0, -1.0, 0.0)], NONE);
        meetings.begin(&mut velocity);
        meetings.solve(&mut velocity);
        [velocity[0][1], velocity[1][1]]
    }

    /// Truth: Coulomb's law.
    #[test]
    fn friction_takes_its_part_of_the_normal_impulse() {
        assert_eq!(against_wall(0.0), [4.0, 0.0]);
        assert_eq!(against_wall(0.5), [2.5, 0.0]);
        assert_eq!(against_wall(2.0), [0.0, 0.0]);
        assert_eq!(against_wall(f64::INFINITY), [0.0, 0.0]);
    }

    /// Truth: the first law. What lies a little inside may come out; what was found deep inside stays so, because to
    /// push it out costs what presses on it times its depth.
    #[test]
    fn what_is_found_deep_inside_is_not_driven_out() {
        assert_eq!(allowed(0.5, 2.0, 0.1), -5.0);
        assert!(allowed(-1e-3, 2.0, 0.1) > 0.0);
        assert_eq!(allowed(-0.1, 2.0, 0.1), 0.0);
    }

    /// Truth: a row of equal balls that touch: the momentum of all, and none goes into the next.
    #[test]
    fn a_row_of_masses_stops_together() {
        let count = 12;
        let mut velocity = [vec![0.0; count], vec![0.0; count]];
        velocity[0][0] = 1.0;
        let mut meetings = Meetings::default();
        let share = |field: usize, weight| Share { field: field as u32, weight, mobility: [1.0; 2] };
        for k in 1..count {
            meetings.push(Vector::x(), 0.0, 0.0, &mut vec![share(k, 1.0), share(k - 1, -1.0)], NONE);
        }
        (0..200).for_each(|_| meetings.solve(&mut velocity));
        let momentum: f64 = velocity[0].iter().sum();
        assert!((momentum - 1.0).abs() < 1e-14);
        assert!(velocity[0].windows(2).all(|w| w[1] - w[0] > -1e-4), "{velocity:?}");
    }
}
