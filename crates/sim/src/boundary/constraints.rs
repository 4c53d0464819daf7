//! Weighted means of velocities that are held at what is prescribed, by impulses that take the least kinetic energy.
//!
//! A constraint Σ w_f v_f = V acts on its fields by impulses λ w_f: the motion stays that of the lattice with as many
//! fewer degrees of freedom (Lagrange multipliers). There is no stiffness to choose, and no frequency rises. λ comes
//! from a Cholesky decomposition of G = W M⁻¹ Wᵀ within its envelope: constraints are in the order of their places
//! along an edge, so that each is tied to few before it.
//!
//! Around a corner constraints may say the same but for rounding, and impulses would be anything: what is held would
//! gain energy with every step. So the diagonal D of G is raised by a part ε, and what that leaves is held by further
//! rounds (iterated regularization of Tikhonov, three terms of it): λ = Σ_k ((G + ε D)⁻¹ ε D)^k (G + ε D)⁻¹ r. A motion
//! that constraints know of by a part μ keeps (ε/(μ + ε))³ of itself, so that none grows; what they know of by more
//! than a thousandth is held to rounding.

use super::edges::EdgeMean;
use super::supports::contradiction;
use fissure_scene::Support;
use std::collections::{BTreeMap, BTreeSet};

/// A mean of velocities along one axis that is prescribed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Constraint {
    /// Who prescribes it.
    pub(crate) support: u32,
    /// (field, weight); weights add up to 1.
    pub(crate) entries: Vec<(u32, f64)>,
}

/// What one support holds.
#[derive(Debug, Default)]
pub(crate) struct Held {
    /// Means of the velocity along its edges.
    pub(crate) means: Vec<EdgeMean>,
    /// Fields that it holds as a whole.
    pub(crate) fields: Vec<u32>,
}

/// How fields answer impulses.
pub(crate) trait Inertia {
    /// Tells of each field that an impulse on `field` moves, itself among them, by how much one of 1 does [m/kg].
    fn response(&self, field: u32, each: &mut dyn FnMut(u32, f64));
}

/// Inverse masses of fields [m/kg], each of which moves by itself.
impl Inertia for [f64] {
    fn response(&self, field: u32, each: &mut dyn FnMut(u32, f64)) {
        each(field, self[field as usize]);
    }
}

/// The part ε by which the diagonal is raised. Rounding is 1e-8 of that.
const RAISED: f64 = 1e-8;
/// The rounds in which all is held.
const ROUNDS: u32 = 3;

/// Constraints along one axis.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConstraintSystem {
    /// Those of a single field each.
    fixed: Vec<Constraint>,
    /// The others. Fields that are fixed stand in them as if they had no end of mass.
    means: Vec<Constraint>,
    /// What an impulse of 1 on each of the means moves, by how much [m/kg].
    responses: Vec<Vec<(u32, f64)>>,
    /// Sum of the weights of each of the means on fields that are not fixed.
    parts: Vec<f64>,
    /// ε D of each of the means [1/kg].
    raised: Vec<f64>,
    /// Cholesky factor of the means, row by row.
    rows: Vec<EnvelopeRow>,
}

/// A row of a lower triangle from its first entry that is not zero to the diagonal.
#[derive(Debug, Clone)]
struct EnvelopeRow {
    first: usize,
    values: Vec<f64>,
}

impl EnvelopeRow {
    fn diagonal(&self) -> f64 {
        self.values[self.values.len() - 1]
    }

    /// Σ L_k x_k over the entries before column `end`.
    fn dot(&self, x: &[f64], end: usize) -> f64 {
        (self.first..end).zip(&self.values).map(|(k, l)| l * x[k]).sum()
    }
}

impl ConstraintSystem {
    /// Prepares `constraints` for fields of this `inertia`. Of several of the same single field the first one is kept;
    /// other constraints that say the same share what it takes.
    pub(crate) fn new(constraints: Vec<Constraint>, inertia: &(impl Inertia + ?Sized)) -> Self {
        let mut system = Self::default();
        let singles: BTreeSet<u32> =
            constraints.iter().filter(|c| c.entries.len() == 1).map(|c| c.entries[0].0).collect();
        // What moves others that are not held is held as a mean is: they feel how it is.
        let stands_alone = |field: u32| {
            let mut alone = true;
            inertia.response(field, &mut |other, _| alone &= singles.contains(&other));
            alone
        };
        let mut is_fixed = BTreeMap::new();
        let mut means = Vec::new();
        for constraint in constraints {
            match constraint.entries[..] {
                [(field, _)] if is_fixed.contains_key(&field) => (),
                [(field, _)] => {
                    let alone = stands_alone(field);
                    is_fixed.insert(field, alone);
                    if alone { system.fixed.push(constraint) } else { means.push(constraint) }
                }
                _ => means.push(constraint),
            }
        }
        is_fixed.retain(|_, alone| *alone);
        let mut of_field: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for constraint in means {
            let free = || constraint.entries.iter().filter(|(field, _)| !is_fixed.contains_key(field));
            let mut responses: Vec<(u32, f64)> = Vec::with_capacity(constraint.entries.len());
            for &(field, w) in free() {
                inertia.response(field, &mut |moved, response| match responses.iter_mut().find(|(f, _)| *f == moved) {
                    Some((_, sum)) => *sum += w * response,
                    None => responses.push((moved, w * response)),
                });
            }
            let response = |field: u32| responses.iter().find(|(f, _)| *f == field).map_or(0.0, |&(_, r)| r);
            let own: f64 = constraint.entries.iter().map(|&(field, w)| w * response(field)).sum();
            // Fields that are fixed, all of them: there is nothing to hold.
            if own <= 0.0 {
                continue;
            }
            let row = system.row(&responses, own, &of_field);
            for &(field, _) in &constraint.entries {
                of_field.entry(field).or_default().push(system.means.len());
            }
            system.rows.push(row);
            system.parts.push(free().map(|(_, w)| w).sum());
            system.means.push(constraint);
            system.responses.push(responses);
            system.raised.push(RAISED * own);
        }
        system
    }

    /// The row of one more constraint of these `responses`, with its `own` entry on the diagonal of G. `of_field`:
    /// which of those before have each field.
    fn row(&self, responses: &[(u32, f64)], own: f64, of_field: &BTreeMap<u32, Vec<usize>>) -> EnvelopeRow {
        let count = self.means.len();
        let tied = responses.iter().filter_map(|(field, _)| of_field.get(field)?.first());
        let first = tied.min().copied().unwrap_or(count);
        // What an impulse of it does to the means before it, from the first one on that it does anything to.
        let mut values = Vec::with_capacity(count - first + 1);
        values.resize(count - first, 0.0);
        for &(field, response) in responses {
            for &other in of_field.get(&field).into_iter().flatten() {
                let entry = self.means[other].entries.iter().find(|&&(f, _)| f == field);
                values[other - first] += entry.map_or(0.0, |&(_, w)| w * response);
            }
        }
        for k in first..count {
            let row = &self.rows[k];
            let begin = row.first.max(first);
            let before = values[begin - first..k - first].iter().zip(&row.values[begin - row.first..]);
            let known: f64 = before.map(|(x, l)| l * x).sum();
            values[k - first] = (values[k - first] - known) / row.diagonal();
        }
        let left = own - values.iter().map(|l| l * l).sum::<f64>();
        values.push((left.max(0.0) + RAISED * own).sqrt());
        EnvelopeRow { first, values }
    }

    /// Whether nothing is held.
    pub(crate) fn is_empty(&self) -> bool {
        self.fixed.is_empty() && self.means.is_empty()
    }

    /// The fields that it is about; some several times.
    pub(crate) fn fields(&self) -> impl Iterator<Item = u32> {
        self.fixed.iter().chain(&self.means).flat_map(|c| c.entries.iter().map(|&(field, _)| field))
    }

    /// Makes the means what `prescribed` gives of each support [m/s]. Calls `acted` with each constraint and its
    /// impulse [N s/m].
    pub(crate) fn apply(
        &self,
        prescribed: impl Fn(u32) -> f64,
        mass: &[f64],
        velocity: &mut [f64],
        mut acted: impl FnMut(&Constraint, f64),
    ) {
        for constraint in &self.fixed {
            let field = constraint.entries[0].0 as usize;
            let wanted = prescribed(constraint.support);
            acted(constraint, mass[field] * (wanted - velocity[field]));
            velocity[field] = wanted;
        }
        let missing = |c: &Constraint| {
            prescribed(c.support) - c.entries.iter().map(|&(field, w)| w * velocity[field as usize]).sum::<f64>()
        };
        let mut impulses: Vec<f64> = self.means.iter().map(missing).collect();
        self.solve(&mut impulses);
        let mut left = impulses.clone();
        for _ in 1..ROUNDS {
            left.iter_mut().zip(&self.raised).for_each(|(left, raised)| *left *= raised);
            self.solve(&mut left);
            impulses.iter_mut().zip(&left).for_each(|(impulse, left)| *impulse += left);
        }
        let means = self.means.iter().zip(&self.responses).zip(&self.parts);
        for (((constraint, responses), part), &impulse) in means.zip(&impulses) {
            for &(field, response) in responses {
                velocity[field as usize] += impulse * response;
            }
            // On a field that is fixed nothing acts.
            acted(constraint, impulse * part);
        }
    }

    /// What each of the means is.
    #[cfg(test)]
    pub(crate) fn speeds(&self, velocity: &[f64]) -> impl Iterator<Item = f64> {
        self.means.iter().map(|c| c.entries.iter().map(|&(field, w)| w * velocity[field as usize]).sum())
    }

    /// Solves (G + ε D) x = b in place.
    fn solve(&self, x: &mut [f64]) {
        for (k, row) in self.rows.iter().enumerate() {
            x[k] = (x[k] - row.dot(x, k)) / row.diagonal();
        }
        for (k, row) in self.rows.iter().enumerate().rev() {
            x[k] /= row.diagonal();
            let of_row = x[k];
            for (m, l) in (row.first..k).zip(&row.values) {
                x[m] -= l * of_row;
            }
        }
    }
}

/// What is held along each axis. Where two supports want different velocities of a field, the later one has it.
pub(crate) fn systems(
    supports: &[Support],
    of_support: &[Held],
    inertia: &(impl Inertia + ?Sized),
) -> [ConstraintSystem; 2] {
    [0, 1].map(|axis| {
        let mut constraints = Vec::new();
        // The last supports that have each field.
        let mut holders: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (index, held) in of_support.iter().enumerate().rev().filter(|(i, _)| supports[*i].velocity[axis].is_some())
        {
            let (support, start) = (index as u32, constraints.len());
            let later: Vec<u32> = (support + 1..supports.len() as u32)
                .filter(|&other| contradiction(&supports[index], &supports[other as usize], axis).is_some())
                .collect();
            let is_taken = |&(field, _): &(u32, f64)| {
                holders.get(&field).is_some_and(|of| of.iter().any(|other| later.contains(other)))
            };
            let fields = held.fields.iter().map(|&field| vec![(field, 1.0)]);
            for entries in held.means.iter().cloned().chain(fields) {
                if !entries.iter().any(is_taken) {
                    constraints.push(Constraint { support, entries });
                }
            }
            for (field, _) in constraints[start..].iter().flat_map(|c| &c.entries) {
                let of = holders.entry(*field).or_default();
                if of.last() != Some(&support) {
                    of.push(support);
                }
            }
        }
        ConstraintSystem::new(constraints, inertia)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: Gauss' principle. The velocities are those that fulfil all constraints, one of them given twice, and
        /// any further change that keeps them is orthogonal to the change made, weighted with the masses.
        #[test]
        fn the_least_change_fulfils_all_constraints(
            masses in prop::collection::vec(0.5..2.0_f64, 12..13),
            before in prop::collection::vec(-1.0..1.0_f64, 12..13),
            weights in prop::collection::vec(0.05..0.95_f64, 8..9),
            trial in prop::collection::vec(-1.0..1.0_f64, 12..13),
            speed in -1.0..1.0_f64,
        ) {
            // Chains that share fields, two fixed fields, and one constraint twice.
            let mut constraints: Vec<Constraint> = weights
                .iter()
                .enumerate()
                .map(|(k, &w)| Constraint { support: 0, entries: vec![(k as u32, w), (k as u32 + 2, 1.0 - w)] })
                .collect();
            constraints.push(constraints[3].clone());
            for field in [5, 11] {
                constraints.push(Constraint { support: 0, entries: vec![(field, 1.0)] });
            }
            let inverse: Vec<f64> = masses.iter().map(|m| 1.0 / m).collect();
            let system = ConstraintSystem::new(constraints.clone(), &inverse[..]);
            let mut after = before.clone();
            let mut momentum = 0.0;
            system.apply(|_| speed, &masses, &mut after, |_, impulse| momentum += impulse);
            let mean = |c: &Constraint, v: &[f64]| c.entries.iter().map(|&(f, w)| w * v[f as usize]).sum::<f64>();
            for constraint in &constraints {
                prop_assert!((mean(constraint, &after) - speed).abs() < 1e-9);
            }
            // The trial, brought to zero by the same constraints.
            let mut kept = trial.clone();
            system.apply(|_| 0.0, &masses, &mut kept, |_, _| ());
            let product: f64 = (0..12).map(|f| masses[f] * (after[f] - before[f]) * kept[f]).sum();
            prop_assert!(product.abs() < 1e-9, "{product}");
            let gained: f64 = (0..12).map(|f| masses[f] * (after[f] - before[f])).sum();
            prop_assert!((gained - momentum).abs() < 1e-9);
        }
    }
}
