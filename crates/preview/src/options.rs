//! How frames are drawn.

use crate::coloring::Coloring;
use crate::projection::View;
use crate::theme::Theme;
use std::ops::RangeInclusive;

/// Widths of a picture that can be drawn [pixels]: a legend needs some room, and a picture some memory.
pub const SIZES: RangeInclusive<u32> = 160..=4096;

/// How frames are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreviewOptions {
    /// Width of a picture [pixels], within [`SIZES`]; the height follows from what is in view.
    pub width: u32,
    /// What the colour of material stands for.
    pub coloring: Coloring,
    /// Light or dark.
    pub theme: Theme,
    /// From where it is seen.
    pub view: View,
}

impl Default for PreviewOptions {
    fn default() -> Self {
        Self { width: 960, coloring: Coloring::default(), theme: Theme::default(), view: View::default() }
    }
}
