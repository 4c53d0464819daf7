//! Whether any crack has moved in a run, and how near it came if none has.

use fissure_scene::{Scene, TipRecord, TipState};

/// What the tips of all frames so far have felt.
#[derive(Debug, Default)]
pub(crate) struct Moved {
    any: bool,
    /// The crack that came nearest to its toughness, and K_eq / K_Ic of it.
    nearest: Option<(u32, f64)>,
}

impl Moved {
    /// Takes up the tips of a frame.
    pub(crate) fn frame(&mut self, tips: &[TipRecord]) {
        for tip in tips {
            self.any |= tip.state != TipState::Resting;
            let load = tip.equivalent / tip.fracture_toughness;
            if load.is_finite() && self.nearest.is_none_or(|(_, most)| load > most) {
                self.nearest = Some((tip.crack, load));
            }
        }
    }

    /// What to say at the end of a run in which cracks could grow and none did.
    pub(crate) fn verdict(&self, scene: &Scene) -> Option<String> {
        let (crack, load) = self.nearest.filter(|_| !self.any && scene.growth.enabled)?;
        let name = scene.cracks.get(crack as usize).map_or("", |crack| crack.name.as_str());
        Some(format!(
            "no crack moved: at most {:.0} % of the toughness at the frames (crack `{name}`); load it more, or longer, or take a lower `fracture_toughness`",
            100.0 * load
        ))
    }
}
