//! What is to be seen of a drawing: as it is drawn, or with what is hidden.

use super::fonts::Fonts;
use crate::load::seating::Complaint;
use std::cell::OnceCell;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A way to look at a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum View {
    /// As a browser shows it.
    Drawn,
    /// With everything that is hidden, such as layers that are switched off.
    Revealed,
    /// With every path filled, painted or not.
    Filled,
}

impl View {
    /// All of them, those that change least first.
    pub(super) const ALL: [Self; 3] = [Self::Drawn, Self::Revealed, Self::Filled];

    /// Rules on top of the drawing's own. Markers are ornament; masks and filters are told of elsewhere.
    fn style_sheet(self) -> String {
        let mut rules = "marker: none !important; mask: none !important; filter: none !important;".to_owned();
        if self != Self::Drawn {
            rules += "display: inline !important; visibility: visible !important; opacity: 1 !important;";
        }
        if self == Self::Filled {
            rules += "fill: #000 !important; fill-opacity: 1 !important; stroke: none !important;";
        }
        format!("* {{ {rules} }}")
    }
}

/// Why a drawing cannot be resolved.
#[derive(Debug, thiserror::Error)]
enum Unresolved {
    /// Its text is not what SVG takes.
    #[error("not valid SVG: {0}")]
    NotSvg(usvg::Error),
    /// The library gave up.
    #[error("not valid SVG: its numbers or references make no sense together")]
    Senseless,
}

/// A drawing as text, and the trees it is resolved to.
pub(super) struct Views {
    text: String,
    fonts: Fonts,
    trees: [OnceCell<Result<usvg::Tree, Unresolved>>; 3],
}

impl Views {
    pub(super) fn new(text: String, fonts: Fonts) -> Self {
        Self { text, fonts, trees: Default::default() }
    }

    /// The drawing, seen in one way; resolved when it is first asked for.
    pub(super) fn tree(&self, view: View) -> Result<&usvg::Tree, Complaint> {
        let tree = self.trees[view as usize].get_or_init(|| resolve(&self.text, &self.fonts, view));
        tree.as_ref().map_err(|e| (e.to_string(), "open the drawing in an SVG editor and save it again".into()))
    }
}

/// Resolves styles, references, shapes and text. Nothing outside of the text and the fonts is opened: pictures are left
/// out.
fn resolve(text: &str, fonts: &Fonts, view: View) -> Result<usvg::Tree, Unresolved> {
    let mut options = usvg::Options {
        style_sheet: Some(view.style_sheet()),
        fontdb: fonts.database.clone(),
        image_href_resolver: usvg::ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        ..Default::default()
    };
    if let Some(family) = &fonts.fallback {
        options.font_family.clone_from(family);
    }
    // The known panics of usvg are guarded against before; an unknown one must not take the program along.
    match catch_unwind(AssertUnwindSafe(|| usvg::Tree::from_str(text, &options))) {
        Ok(tree) => tree.map_err(Unresolved::NotSvg),
        Err(_) => Err(Unresolved::Senseless),
    }
}
