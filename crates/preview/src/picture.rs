//! A finished picture and its file.

use crate::origin::TOOL;
use crate::raster::Raster;
use tiny_skia::{Color, Paint, Pixmap};

/// A picture of opaque pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub(crate) pixels: Pixmap,
}

/// Why a picture or an animation cannot be encoded.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// As PNG.
    #[error("the picture cannot be written as PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// As GIF.
    #[error("the animation cannot be written as GIF: {0}")]
    Gif(#[from] gif::EncodingError),
    /// More pixels than there may be.
    #[error("a picture of {width} x {height} pixels is too large for {format}; make it smaller")]
    TooLarge {
        /// Pixels across.
        width: u32,
        /// Pixels upright.
        height: u32,
        /// The format.
        format: &'static str,
    },
}

impl Picture {
    /// All of one colour.
    ///
    /// # Errors
    /// When it has no pixels, or more than memory can hold.
    pub(crate) fn new(width: u32, height: u32, color: [u8; 3]) -> Result<Self, EncodeError> {
        let mut pixels = Pixmap::new(width, height).ok_or(EncodeError::TooLarge { width, height, format: "memory" })?;
        pixels.fill(opaque(color));
        Ok(Self { pixels })
    }

    /// The means of blocks of `factor` by `factor` pixels of a raster.
    ///
    /// # Errors
    /// As [`Picture::new`].
    pub(crate) fn reduced(raster: &Raster, factor: usize) -> Result<Self, EncodeError> {
        let (width, height) = (raster.width / factor, raster.height / factor);
        let mut picture = Self::new(width as u32, height as u32, [0; 3])?;
        let count = (factor * factor) as u32;
        for (at, pixel) in picture.pixels.data_mut().as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let (column, row) = (factor * (at % width), factor * (at / width));
            let mut sum = [0; 3];
            for y in row..row + factor {
                for color in &raster.colors[y * raster.width + column..][..factor] {
                    (0..3).for_each(|channel| sum[channel] += u32::from(color[channel]));
                }
            }
            (0..3).for_each(|channel| pixel[channel] = ((sum[channel] + count / 2) / count) as u8);
        }
        Ok(picture)
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.pixels.width()
    }

    /// Pixels upright.
    pub fn height(&self) -> u32 {
        self.pixels.height()
    }

    /// Red, green and blue of all pixels, row by row from the top.
    pub fn rgb(&self) -> Vec<u8> {
        self.pixels.data().as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
    }

    /// The bytes of a PNG file with all colours, which says where it comes from.
    ///
    /// # Errors
    /// When it is too large.
    pub fn to_png(&self, scene_hash: &str) -> Result<Vec<u8>, EncodeError> {
        let mut bytes = Vec::new();
        let mut encoder = encoder(&mut bytes, self, scene_hash)?;
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(&self.rgb())?;
        Ok(bytes)
    }

    /// The bytes of a PNG file of at most 256 colours: a third or so as long.
    ///
    /// # Errors
    /// When it is too large.
    pub fn to_small_png(&self, scene_hash: &str) -> Result<Vec<u8>, EncodeError> {
        let indexed = self.indexed("indexed PNG")?;
        let mut bytes = Vec::new();
        let mut encoder = encoder(&mut bytes, self, scene_hash)?;
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_compression(png::Compression::High);
        // Neighbouring numbers of a palette are no neighbouring colours.
        encoder.set_filter(png::Filter::NoFilter);
        encoder.set_palette(indexed.palette.unwrap_or_default());
        encoder.write_header()?.write_image_data(&indexed.buffer)?;
        Ok(bytes)
    }

    /// The same in at most 256 colours, as numbers of a palette.
    ///
    /// # Errors
    /// When it is too large.
    pub(crate) fn indexed(&self, format: &'static str) -> Result<gif::Frame<'static>, EncodeError> {
        /// Which share of the pixels the palette is made of: one in so many.
        const SAMPLING: i32 = 10;
        let (width, height) = (self.width(), self.height());
        let (Ok(w), Ok(h)) = (u16::try_from(width), u16::try_from(height)) else {
            return Err(EncodeError::TooLarge { width, height, format });
        };
        Ok(gif::Frame::from_rgb_speed(w, h, &self.rgb(), SAMPLING))
    }
}

/// An encoder with the size and the origin of a picture.
fn encoder<'a>(
    bytes: &'a mut Vec<u8>,
    picture: &Picture,
    scene_hash: &str,
) -> Result<png::Encoder<'a, &'a mut Vec<u8>>, EncodeError> {
    let mut encoder = png::Encoder::new(bytes, picture.width(), picture.height());
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_text_chunk("Software".to_owned(), TOOL.to_owned())?;
    encoder.add_text_chunk("Source".to_owned(), format!("scene {scene_hash}"))?;
    Ok(encoder)
}

/// An opaque colour.
pub(crate) fn opaque([r, g, b]: [u8; 3]) -> Color {
    Color::from_rgba8(r, g, b, 255)
}

/// Paint of one colour, smooth at its edges.
pub(crate) fn paint(color: [u8; 3]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(opaque(color));
    paint.anti_alias = true;
    paint
}
