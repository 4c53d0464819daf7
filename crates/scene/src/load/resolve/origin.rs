//! Which item of the document an item of the scene comes from.

use crate::fault::{Key, KeyPath, SceneFault};

/// Where the items of a scene come from.
#[derive(Debug, Default)]
pub(crate) struct Origin {
    /// For each body of the scene: which `[[body]]` it comes from.
    pub(super) bodies: Vec<usize>,
    /// For each material of the scene: which `[[material]]` it comes from; none: it comes with Fissure.
    pub(super) materials: Vec<Option<usize>>,
    /// For each patch of toughness of the scene: which `[[toughness]]` it comes from.
    pub(super) toughness: Vec<usize>,
    /// For each drawn crack of the scene: which `[[crack]]` it is a piece of; the cracks of the scene after these were
    /// scattered.
    pub(super) cracks: Vec<usize>,
    /// Whether the file has `frames.range` instead of `first` and `last`.
    pub(super) frames_by_range: bool,
}

impl Origin {
    /// A path that counts items as in the scene, as one that counts them as in the document.
    pub(crate) fn in_file(&self, mut path: KeyPath) -> KeyPath {
        if self.frames_by_range
            && [KeyPath::setting("frames", "first"), KeyPath::setting("frames", "last")].contains(&path)
        {
            return KeyPath::setting("frames", "range");
        }
        if let [Key::Name(array), Key::Index(index), ..] = path.0.as_mut_slice() {
            match array.as_str() {
                "body" => *index = self.bodies.get(*index).copied().unwrap_or(*index),
                "material" => *index = self.materials.get(*index).copied().flatten().unwrap_or(usize::MAX),
                "toughness" => *index = self.toughness.get(*index).copied().unwrap_or(*index),
                "crack" => match self.cracks.get(*index) {
                    Some(&drawn) => *index = drawn,
                    None => return KeyPath::top("flaws"),
                },
                _ => {}
            }
        }
        path
    }

    /// A fault with its path counted as in the document.
    pub(super) fn in_document(&self, fault: SceneFault) -> SceneFault {
        SceneFault { path: self.in_file(fault.path), other: fault.other.map(|path| self.in_file(path)), ..fault }
    }
}
