//! The ways to solve that are held against each other, each a curve.

use fissure_scene::{Kernel, Transfer};
use fissure_verify::Scheme;

/// A curve.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) scheme: Scheme,
    pub(super) family: Family,
    pub(super) colour: usize,
    pub(super) dashes: &'static str,
}

/// What curves are compared for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    /// A formulation with a kernel: those of the first figure.
    Formulation,
    /// The updated formulation with a transfer that is not the default one.
    Transfer,
    /// How tips are measured; all else is the default.
    Measure,
}

/// The default, as `standard` has it for brittle bodies.
pub(super) const DEFAULT: &str = "total bilinear";
/// The domain of each particle lies in one cell there, and GIMP is the bilinear kernel.
pub(super) const SAME_AS_DEFAULT: &str = "total GIMP";
pub(super) const THESIS: &str = "thesis";
pub(super) const CONTOUR: &str = "total contour";
pub(super) const BARE_CONTOUR: &str = "total contour without area term";

/// Kernels by their names, with the dashes that tell them.
pub(super) const KERNELS: [(&str, Kernel, &str); 4] = [
    ("bilinear", Kernel::Bilinear, ""),
    ("GIMP", Kernel::Gimp, "6 3"),
    ("quadratic", Kernel::Quadratic, "2 2"),
    ("cubic", Kernel::Cubic, "8 2 2 2"),
];
/// The transfer of the updated formulation that is the default.
const DEFAULT_TRANSFER: &str = "AFLIP";
/// Transfers by their names, with their colours.
const TRANSFERS: [(&str, Transfer, usize); 5] = [
    (DEFAULT_TRANSFER, Transfer::Aflip, 2),
    ("APIC", Transfer::Apic, 3),
    ("FLIP", Transfer::Flip(1.0), 4),
    ("XPIC", Transfer::Xpic, 5),
    ("PIC", Transfer::Pic, 6),
];

impl Curve {
    /// Ringed, and measured in finer cells.
    pub(super) fn is_default(&self) -> bool {
        self.name == DEFAULT
    }

    /// Whether it is of the total formulation.
    pub(super) fn is_total(&self) -> bool {
        self.name.starts_with("total ")
    }

    /// Whether it is measured in the case that takes minutes a point: the total formulation, the thesis, and of the
    /// updated formulation all transfers with the quadratic kernel, and all kernels with the default transfer. `quick`:
    /// the default alone.
    pub(super) fn is_in_long_case(&self, quick: bool) -> bool {
        match self.family {
            Family::Measure => false,
            _ if quick => self.is_default(),
            Family::Formulation => true,
            Family::Transfer => self.is_updated_by("quadratic"),
        }
    }

    /// Whether it is of the updated formulation with this kernel.
    pub(super) fn is_updated_by(&self, kernel: &str) -> bool {
        self.name.starts_with("updated ") && self.name.ends_with(&format!(" {kernel}"))
    }
}

/// All curves.
pub(super) fn curves() -> Vec<Curve> {
    let curve =
        |name: &str, scheme, family, colour, dashes| Curve { name: name.into(), scheme, family, colour, dashes };
    let mut all = Vec::new();
    for (name, kernel, dashes) in KERNELS {
        all.push(curve(&format!("total {name}"), Scheme::total(kernel), Family::Formulation, 0, dashes));
    }
    all.push(curve(THESIS, Scheme::thesis(), Family::Formulation, 1, ""));
    for (transfer_name, transfer, colour) in TRANSFERS {
        let family = if transfer_name == DEFAULT_TRANSFER { Family::Formulation } else { Family::Transfer };
        for (name, kernel, dashes) in KERNELS {
            let name = format!("updated {transfer_name} {name}");
            all.push(curve(&name, Scheme::updated(transfer, kernel), family, colour, dashes));
        }
    }
    let total = Scheme::total(Kernel::Bilinear);
    all.push(curve(CONTOUR, total.with_contour(true), Family::Measure, 2, ""));
    all.push(curve(BARE_CONTOUR, total.with_contour(false), Family::Measure, 3, ""));
    all
}
