//! A contact sheet: some frames of a sequence side by side.

use crate::draw::Detail;
use crate::layout::Layout;
use crate::legend;
use crate::options::{PreviewOptions, SIZES};
use crate::picture::{EncodeError, Picture};
use crate::survey::Survey;
use fissure_scene::Scene;
use tiny_skia::{PixmapPaint, Transform};

/// Frames on a sheet at most.
pub const SHEET_FRAMES: usize = 12;

/// The frames of a sheet: all of `numbers` if there are few, else [`SHEET_FRAMES`] at equal distances, the first and
/// the last among them.
pub fn sheet_frames(numbers: &[i64]) -> Vec<i64> {
    let last = numbers.len().saturating_sub(1);
    if last < SHEET_FRAMES {
        return numbers.to_vec();
    }
    // Halves are rounded up.
    let steps = SHEET_FRAMES - 1;
    (0..SHEET_FRAMES).map(|i| numbers[(2 * i * last + steps) / (2 * steps)]).collect()
}

/// Options of the tiles of a sheet of `count` frames that is as wide as a picture.
pub fn tile_options(options: &PreviewOptions, count: usize) -> PreviewOptions {
    let width = (options.width / columns(count) as u32).max(*SIZES.start());
    PreviewOptions { width, ..*options }
}

/// Tiles in a row.
fn columns(count: usize) -> usize {
    count.clamp(1, if count == 4 || count > 6 { 4 } else { 3 })
}

/// Lays pictures of one size, drawn with [`tile_options`] and [`Detail::Tile`], side by side and writes a legend below.
///
/// # Errors
/// When there is no memory for so many pixels.
pub fn contact_sheet(
    scene: &Scene,
    tiles: &[Picture],
    survey: &Survey,
    options: &PreviewOptions,
) -> Result<Picture, EncodeError> {
    let columns = columns(tiles.len());
    let tile_options = tile_options(options, tiles.len());
    let tile = Layout::new(survey, scene.output.thickness, &tile_options, Detail::Tile);
    // The legend is that of a picture as wide as the sheet, in the scale of a tile.
    let width = tile.width * columns as u32;
    let full = Layout::new(survey, scene.output.thickness, &PreviewOptions { width, ..*options }, Detail::Full);
    let rows = tiles.len().div_ceil(columns).max(1) as u32;
    let height = rows * tile.height + full.footer.ceil() as u32;
    let mut sheet = Picture::new(width, height, options.theme.background())?;
    for (i, picture) in tiles.iter().enumerate() {
        let place = [(i % columns) as u32 * tile.width, (i / columns) as u32 * tile.height];
        let (paint, still) = (PixmapPaint::default(), Transform::identity());
        sheet.pixels.draw_pixmap(place[0] as i32, place[1] as i32, picture.pixels.as_ref(), &paint, still, None);
    }
    let mut legend = Layout { width, height, ..full };
    legend.projection.scale = tile.projection.scale;
    legend::footer(&mut sheet, survey, &legend, options, None, false);
    Ok(sheet)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_has_the_first_and_the_last_frame() {
        assert_eq!(sheet_frames(&[3, 5]), [3, 5]);
        assert_eq!(sheet_frames(&[]), [0_i64; 0]);
        for count in [12_i64, 13, 48, 1000] {
            let numbers: Vec<i64> = (1..=count).collect();
            let chosen = sheet_frames(&numbers);
            assert_eq!((chosen.len(), chosen[0], chosen[11]), (12, 1, count));
            let steps: Vec<i64> = chosen.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps.iter().max() <= steps.iter().min().map(|step| step + 1).as_ref(), "{steps:?}");
        }
    }
}
