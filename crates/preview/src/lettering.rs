//! Text as outlines, in a font that comes with the program, so that pictures are the same on every machine.

use crate::picture::{Picture, paint};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, MetadataProvider};
use tiny_skia::{FillRule, LineJoin, PathBuilder, Stroke, Transform};

/// Tuffy Regular, in the public domain.
const FONT: &[u8] = include_bytes!("../../../assets/fonts/Tuffy.ttf");

/// Which point of a text lies at its place; the height is always that of the base line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// Its left end.
    Left,
    /// Its right end.
    Right,
}

/// A pen that draws glyphs one after the other, y down.
struct Pen {
    path: PathBuilder,
    x: f32,
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, -y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, -y);
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + cx, -cy, self.x + x, -y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + ax, -ay, self.x + bx, -by, self.x + x, -y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// Writes a line of text, `size` pixels to the em, where characters that the font lacks are left out.
pub(crate) fn write(picture: &mut Picture, text: &str, size: f64, at: [f64; 2], anchor: Anchor, color: [u8; 3]) {
    let Some((path, width)) = outline(text, size) else { return };
    let x = if anchor == Anchor::Right { at[0] - width } else { at[0] };
    let place = Transform::from_translate(x as f32, at[1] as f32);
    picture.pixels.fill_path(&path, &paint(color), FillRule::Winding, place, None);
}

/// The same around its letters, so that they can be read on any colour; from the left end on.
pub(crate) fn surround(picture: &mut Picture, text: &str, size: f64, at: [f64; 2], color: [u8; 3]) {
    let Some((path, _)) = outline(text, size) else { return };
    let place = Transform::from_translate(at[0] as f32, at[1] as f32);
    let stroke = Stroke { width: (0.3 * size) as f32, line_join: LineJoin::Round, ..Stroke::default() };
    picture.pixels.stroke_path(&path, &paint(color), &stroke, place, None);
}

/// Width of a line of text [pixels].
pub(crate) fn width(text: &str, size: f64) -> f64 {
    outline(text, size).map_or(0.0, |(_, width)| width)
}

/// The outline of a line of text from the origin to the right, and its width; none where nothing is to be seen.
fn outline(text: &str, size: f64) -> Option<(tiny_skia::Path, f64)> {
    let font = FontRef::new(FONT).ok()?;
    let (size, location) = (Size::new(size as f32), LocationRef::default());
    let (letters, glyphs, widths) = (font.charmap(), font.outline_glyphs(), font.glyph_metrics(size, location));
    let mut pen = Pen { path: PathBuilder::new(), x: 0.0 };
    for glyph in text.chars().filter_map(|letter| letters.map(letter)) {
        // A glyph that cannot be drawn leaves its room.
        let _ = glyphs.get(glyph).map(|glyph| glyph.draw(DrawSettings::unhinted(size, location), &mut pen));
        pen.x += widths.advance_width(glyph).unwrap_or(0.0);
    }
    let width = f64::from(pen.x);
    Some((pen.path.finish()?, width))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_is_written() {
        let font = FontRef::new(FONT);
        let letters = font.map(|font| font.charmap());
        for letter in "abcxyzABC0123456789.,-+/()[]=·µ√²₁ ".chars() {
            let has = letters.as_ref().is_ok_and(|letters| letters.map(letter).is_some());
            assert!(has, "{letter:?}");
        }
    }

    #[test]
    fn text_is_as_wide_as_its_letters() {
        let one = width("m", 20.0);
        assert!(one > 5.0 && (width("mmmm", 20.0) - 4.0 * one).abs() < 1e-4 && width("", 20.0) == 0.0);
        assert!((width("m", 40.0) - 2.0 * one).abs() < 1e-4);
    }
}
