//! Plain materials to be replaced by the artist: a pale smooth skin, rougher and darker fracture surfaces.

use crate::slot::Slot;

/// Linear colour and roughness of a material.
pub(super) fn color_and_roughness(slot: Slot) -> ([f32; 3], f32) {
    match slot {
        Slot::Outside => ([0.75, 0.78, 0.8], 0.35),
        Slot::Inside => ([0.45, 0.5, 0.53], 0.7),
    }
}
