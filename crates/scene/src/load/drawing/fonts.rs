//! The fonts that text in a drawing is set in.

use crate::load::error::LoadError;
use std::path::Path;
use std::sync::Arc;
use usvg::fontdb::Database;

/// The font that stands in for families that are not there; public domain, see `assets/fonts`.
const FALLBACK_FONT: &[u8] = include_bytes!("../../../../../assets/fonts/Tuffy.ttf");

/// Fonts, and the family that stands in for those that are not there.
#[derive(Clone, Default)]
pub(super) struct Fonts {
    pub(super) database: Arc<Database>,
    pub(super) fallback: Option<String>,
}

impl Fonts {
    /// Loads fonts: the user's own in front, then the one that comes with Fissure, then the installed ones.
    ///
    /// The first stands in for families that are not there and for the generic ones, so that a drawing that names no
    /// installed font looks the same on every machine.
    pub(super) fn load(own: Option<(&Path, &[u8])>) -> Result<Self, LoadError> {
        let mut fonts = Database::new();
        if let Some((path, bytes)) = own {
            fonts.load_font_data(bytes.to_vec());
            if fonts.is_empty() {
                return Err(LoadError::file(path, "not a font", "name a TrueType or OpenType file (.ttf, .otf)"));
            }
        }
        fonts.load_font_data(FALLBACK_FONT.to_vec());
        let fallback = fonts.faces().next().and_then(|face| face.families.first()).map(|(name, _)| name.clone());
        fonts.load_system_fonts();
        if let Some(family) = &fallback {
            fonts.set_serif_family(family);
            fonts.set_sans_serif_family(family);
            fonts.set_monospace_family(family);
            fonts.set_cursive_family(family);
            fonts.set_fantasy_family(family);
        }
        Ok(Self { database: Arc::new(fonts), fallback })
    }
}
