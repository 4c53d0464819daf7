//! Mass for fields that are too light for their stiffness.
//!
//! Around a tip a field may consist of small shares b of a few particles. Its mass goes with b, but its stiffness also with w²|∇b|², which does not
//! vanish with b: the field would be stiffer for its mass than any other place of the lattice, and the time step would have to follow. Such
//! a field borrows mass from the field of its own node with the most mass. The node's mass and momentum stay what they are; only how it is
//! lumped between two fields a fraction of a cell apart changes, and statics not at all.

use super::Total;

/// Largest stiffness over mass of a field, in units of (λ+2μ)/(ρ h²), that is left alone. A field of one particle of any weight without partial
/// shares has at most 10/3 (|∇w|²/w of the bilinear kernel at a quarter point); a field of a full node has 2.5.
const LARGEST_RATIO: f64 = 3.4;
/// A lender keeps at least this part of its mass.
const LENDER_KEEPS: f64 = 0.5;

impl Total {
    /// Gives all borrowed mass back, with the velocity it has now.
    pub(super) fn give_back(&mut self) {
        for (field, lender, mass) in std::mem::take(&mut self.state.borrowed) {
            self.move_mass(field as usize, lender as usize, mass);
        }
    }

    /// Lets light fields borrow.
    pub(super) fn borrow_mass(&mut self) {
        if self.state.fields.len() == self.grid.len() {
            return;
        }
        // Of base fields only the part from particles on the general path; the rest comes with its own mass.
        let mut stiffness = vec![0.0; self.state.fields.len()];
        let mut speed_squared = 0.0_f64;
        for e in &self.elastic {
            speed_squared = speed_squared.max(e.dilatational_wave_speed().powi(2));
        }
        self.state.cut.for_each(|particle, entries| {
            let e = &self.elastic[self.particles.material[particle] as usize];
            let modulus = (e.lambda + 2.0 * e.mu) * self.particles.volume[particle];
            for entry in entries {
                let g = entry.gradient;
                stiffness[entry.field as usize] += modulus * (g[0] * g[0] + g[1] * g[1]);
            }
        });
        self.add_tie_stiffness(&mut stiffness);
        let most = LARGEST_RATIO * speed_squared / (self.grid.cell_size * self.grid.cell_size);
        let mut loans = Vec::new();
        for (node, further) in self.state.fields.divided_nodes() {
            // The node's own field can be the light one: ahead of a tip that runs through the node it holds but the shares 1 − b.
            let fields = || std::iter::once(node as u32).chain(further.iter().map(|f| f.1));
            let mass = |field: u32| self.state.mass[field as usize];
            let richest = fields().max_by(|&a, &b| mass(a).total_cmp(&mass(b)).then(b.cmp(&a)));
            let Some(lender) = richest else { continue };
            let mut left = (1.0 - LENDER_KEEPS) * mass(lender);
            for field in fields() {
                let missing = (stiffness[field as usize] / most - mass(field)).min(left);
                if field != lender && mass(field) > 0.0 && missing > 0.0 {
                    left -= missing;
                    loans.push((field, lender, missing));
                }
            }
        }
        for &(field, lender, mass) in &loans {
            self.move_mass(lender as usize, field as usize, mass);
        }
        self.state.borrowed = loans;
        // Where many fields share a node there may not be enough to lend.
        let stiffest = |(s, m): (&f64, &f64)| if *m > 0.0 { s / m } else { 0.0 };
        self.state.stiffest = stiffness.iter().zip(&self.state.mass).map(stiffest).fold(0.0, f64::max);
    }

    /// Moves mass with its momentum from one field to another of the same node.
    fn move_mass(&mut self, from: usize, to: usize, mass: f64) {
        let total = self.state.mass[to] + mass;
        for axis in 0..2 {
            let v = &mut self.state.velocity[axis];
            v[to] = (self.state.mass[to] * v[to] + mass * v[from]) / total;
        }
        self.state.mass[to] = total;
        self.state.mass[from] -= mass;
    }
}
