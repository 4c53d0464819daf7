//! The points around a tip on whose faces nothing presses from outside, side by side.

use super::disc::{Disc, Taking, Whole};
use super::look::Look;
use super::reader::ParticleRates;
use crate::crack::cracks::{Cracks, TipId};
use crate::tip::frame::LineAround;
use crate::tip::side_by_side::{FreeZone, Moving, Standing};
use fissure_plane::{Matrix, Vector};

impl Taking for FreeZone {
    #[inline(always)]
    fn take(&mut self, slot: usize, strain: Matrix, rates: ParticleRates) {
        let ParticleRates { velocity, velocity_gradient: of, acceleration, .. } = rates;
        let ahead = self.ahead();
        let velocity_slope = Vector::new(of.m11 * ahead.x + of.m12 * ahead.y, of.m21 * ahead.x + of.m22 * ahead.y);
        self.set(slot, &Moving { strain, velocity, velocity_slope, acceleration });
    }
}

impl Look<'_> {
    /// What [`Look::points_around`] finds around a tip, side by side.
    pub(super) fn free_zone_around(&self, cracks: &Cracks, id: TipId, radius: f64) -> FreeZone {
        let Self { lattice, motion, .. } = *self;
        let (particles, layout) = (&lattice.particles, &lattice.layout);
        let (tip, ahead) = (cracks.position(id), self.ahead(cracks, id));
        let line = LineAround::new(cracks, id, ahead, radius, |crack, point| cracks[crack].points[point]);
        let disc = Disc::new(lattice, cracks.of(id).body, tip, radius);
        let mut zone = FreeZone::new(tip, ahead, self.half_step, disc.most());
        let mut whole: Vec<Whole> = Vec::with_capacity(disc.most());
        let mut reader = lattice.reader();
        let is_uniform = lattice.materials.len() == 1;
        disc.for_each(&mut |p, cell, stands| {
            let material = if is_uniform { 0 } else { particles.material[p] };
            let elastic = &lattice.materials[material as usize];
            let part = |(share, way): (f64, Vector), is_far: bool| {
                let (place, volume) = (stands + way, particles.volume[p] * share);
                Standing { place, side: line.side_of(place), volume, material, is_far }
            };
            let own = layout.cut.part_of(p);
            let slot = zone.add(&part(own.unwrap_or((1.0, Vector::zeros())), false), elastic);
            if own.is_none() {
                whole.push(Whole { slot, place: cell });
                return;
            }
            let (strain, rates) = reader.strain_and_rates(p, motion);
            zone.take(slot, strain, rates);
            if let (Some(strain), Some(rates)) =
                (reader.far_strain(p, &motion.displacement), reader.far_rates(p, motion))
            {
                let far = layout.far.part_of(p).unwrap_or((1.0, Vector::zeros()));
                let slot = zone.add(&part(far, true), elastic);
                zone.take(slot, strain, rates);
            }
        });
        disc.read(motion, &whole, &mut zone);
        zone.contacts = self.contacts_around(cracks, (id, zone.frame()), radius);
        zone
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use crate::crack::cracks::{Cracks, TipId};
    use crate::material::elastic::Elastic;
    use crate::particles::Particles;
    use crate::solver::Observed;
    use crate::test_scenes::{add_crack, free_body, rectangle};
    use crate::tip::domain::domain_integrals;
    use crate::tip::side_by_side::Wanted;
    use crate::total::Total;
    use fissure_plane::Vector;
    use fissure_scene::{End, Formulation, Kernel, PlaneState, TipDivision};
    use proptest::prelude::*;
    use std::sync::Arc;

    proptest! {
        /// Truth: the same integrals point by point. Cracks that are bent and run through particles, discs that reach
        /// beyond the body, all that moves by chance, faces that press and
        /// rub by chance or not, with and without inertia, and all instructions that there are.
        #[test]
        fn points_side_by_side_give_what_they_give_one_by_one(
            kernel in prop::sample::select(vec![Kernel::Bilinear, Kernel::Gimp]),
            bend in [0.2_f64..0.7, 0.3_f64..0.8], end in [0.75_f64..1.4, 0.2_f64..0.9], radius in 0.12_f64..0.7,
            turn in -3.0_f64..3.0, strain in 1e-9_f64..0.2, at_end in any::<bool>(), is_pressed in any::<bool>(), dynamic in any::<bool>(), seed in 0_u64..1000,
        ) {
            let mut scene = free_body(rectangle([0.0, 0.0], [1.7, 1.1]), 0.05);
            (scene.solver.formulation, scene.solver.kernel) = (Formulation::Total, kernel);
            scene.solver.tip_division = TipDivision::PartlyCut;
            add_crack(&mut scene, &[[0.1, 0.5], bend, end]);
            scene.cracks.iter_mut().for_each(|crack| (crack.start_live, crack.end_live) = (true, true));
            let cracks = Cracks::of_scene(&scene);
            let mut total = Total::new(&scene, Arc::new(Particles::fill(&scene).unwrap()), &cracks).unwrap();
            let mut state = seed;
            let mut number = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            };
            let spacing = total.lattice.grid.cell_size;
            for field in 0..total.lattice.field_count() {
                let place = total.lattice.grid.position(total.lattice.fields().node(field)).coords;
                let (sine, cosine) = turn.sin_cos();
                let turned = Vector::new(cosine * place.x - sine * place.y, sine * place.x + cosine * place.y);
                for axis in 0..2 {
                    total.motion.displacement[axis][field] = turned[axis] - place[axis] + strain * spacing * number();
                    total.motion.velocity[axis][field] = 10.0 * number();
                }
            }
            total.motion.kick(&total.lattice.inverse_mass, Vector::new(0.3, -1.0), 0.1, 1e-3);
            if is_pressed {
                let forces: Vec<_> = (0..1000).map(|k| (k, [1e3, -2e3].map(|size| size * number()), 0.5 - number())).collect();
                // As many as there are points.
                (1..=forces.len()).rev().find(|&count| total.contacts.set_forces(&forces[..count].to_vec()).is_ok());
                prop_assert!(!total.contacts.all_forces().is_empty());
            }
            let elastic = [Elastic::new(&scene.materials[0], PlaneState::Strain)];
            let look = total.look(2e-4);
            let id = TipId::new(0, if at_end { End::End } else { End::Start });
            let mut zone = look.tip_zone(&cracks, id, radius);
            zone.take_off_mean_velocity();
            let own = domain_integrals(&zone, &elastic, &elastic[0], spacing, radius, dynamic);
            prop_assert!(zone.contacts.is_empty() || look.free_zone(&cracks, id, radius, false).is_none());
            let mut free = look.free_zone(&cracks, id, radius, true).unwrap();
            prop_assert_eq!(free.material_at_tip(&elastic).map(|of| of.mu), Some(elastic[0].mu));
            let wanted = Wanted::new(&elastic[0], spacing, radius, dynamic);
            for (name, found) in free.integrals_in_all(&wanted) {
                prop_assert_eq!(found, own, "{}", name);
            }
            if !is_pressed {
                prop_assert_eq!(free.integrals(&Wanted { modes: false, ..wanted }).j_integral, own.j_integral);
            }
        }
    }
}
