//! Pictures that paint values.

use super::error::{IMAGE, LoadError};
use png::{BitDepth, Transformations};
use std::io::Cursor;
use std::path::Path;

/// A picture in shades of grey.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    /// Pixels along x.
    pub(crate) columns: usize,
    /// Pixels along y.
    pub(crate) rows: usize,
    /// Black 0, white 1, row by row from the lowest, in each row from the left.
    pub(crate) light: Vec<f64>,
}

/// What the images of a scene may take together.
#[derive(Debug)]
pub(crate) struct Budget {
    pixels: u64,
    bytes: u64,
}

impl Budget {
    /// Pixels of all images: two of 4096 x 4096. A picture takes 8 bytes for each, and about three times as much on its
    /// way there.
    const PIXELS: u64 = 1 << 25;
    /// Pixels of one image.
    const PIXELS_OF_ONE: u64 = 1 << 24;
    /// Bytes of all files.
    const BYTES: u64 = 256 << 20;

    /// The budget of one scene.
    pub(crate) fn of_a_scene() -> Self {
        Self { pixels: Self::PIXELS, bytes: Self::BYTES }
    }
}

impl Picture {
    /// Reads a PNG of any kind. Colours become their luminance as encoded; what is transparent is white.
    pub(crate) fn read(path: &Path, budget: &mut Budget) -> Result<Self, LoadError> {
        let bytes = IMAGE.at_most(budget.bytes).read(path)?;
        budget.bytes -= bytes.len() as u64;
        let most = budget.pixels.min(Budget::PIXELS_OF_ONE);
        let (columns, light) = decode(&bytes, most).map_err(|refusal| match refusal {
            Refusal::Malformed(cause) => {
                LoadError::file(path, format!("not a PNG image: {cause}"), "save it as PNG, whole")
            }
            Refusal::TooLarge { columns, rows } => LoadError::file(
                path,
                format!("it has {columns} x {rows} pixels, at most {most} can be read"),
                format!(
                    "scale it down: pixels finer than particles are averaged. One image may have {} pixels, all together {}",
                    Budget::PIXELS_OF_ONE,
                    Budget::PIXELS
                ),
            ),
        })?;
        budget.pixels -= light.len() as u64;
        Ok(Self { columns, rows: light.len() / columns, light })
    }

    /// Light of the picture with at most `columns` × `rows` pixels (each at least 1): means over the larger pixels.
    /// Gives columns, rows and light.
    pub(crate) fn averaged(&self, columns: usize, rows: usize) -> (usize, usize, Vec<f64>) {
        let (columns, rows) = (columns.min(self.columns), rows.min(self.rows));
        let narrow = means(&self.light, self.columns, columns);
        let upright = means(&transposed(&narrow, columns), self.rows, rows);
        (columns, rows, transposed(&upright, rows))
    }
}

/// Why an image cannot be read.
enum Refusal {
    Malformed(String),
    TooLarge { columns: u32, rows: u32 },
}

impl From<png::DecodingError> for Refusal {
    fn from(cause: png::DecodingError) -> Self {
        Self::Malformed(cause.to_string())
    }
}

/// Columns and light of a PNG, row by row from the lowest. Its size is looked at before any pixel is.
fn decode(bytes: &[u8], most_pixels: u64) -> Result<(usize, Vec<f64>), Refusal> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::ALPHA);
    // Texts and colour profiles are compressed too, and may unfold to any size.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let (columns, rows) = {
        let header = decoder.read_header_info()?;
        (header.width, header.height)
    };
    let mut reader = match u64::from(columns) * u64::from(rows) {
        pixels if pixels <= most_pixels => decoder.read_info()?,
        _ => return Err(Refusal::TooLarge { columns, rows }),
    };
    // The decoder relies on whole entries, of which there are at most 256.
    let palette = reader.info().palette.as_ref().map_or(0, |palette| palette.len());
    if !palette.is_multiple_of(3) || palette > 3 * 256 {
        return Err(Refusal::Malformed(format!("its palette has {palette} bytes")));
    }
    let mut samples = vec![0; reader.output_buffer_size().ok_or(Refusal::TooLarge { columns, rows })?];
    let frame = reader.next_frame(&mut samples)?;
    let mut light = Vec::with_capacity(frame.width as usize * frame.height as usize);
    for row in samples[..frame.buffer_size()].chunks_exact(frame.line_size).rev() {
        match (frame.color_type.samples(), frame.bit_depth) {
            (2, BitDepth::Sixteen) => light.extend(row.as_chunks::<4>().0.iter().map(|p| grey(wide(p)))),
            (2, _) => light.extend(row.as_chunks::<2>().0.iter().map(|p| grey(p.map(widened)))),
            (_, BitDepth::Sixteen) => light.extend(row.as_chunks::<8>().0.iter().map(|p| luminance(wide(p)))),
            _ => light.extend(row.as_chunks::<4>().0.iter().map(|p| luminance(p.map(widened)))),
        }
    }
    Ok((frame.width as usize, light))
}

/// Samples of 16 bits from their bytes, `BYTES` = 2 `SAMPLES`.
fn wide<const BYTES: usize, const SAMPLES: usize>(bytes: &[u8; BYTES]) -> [u16; SAMPLES] {
    std::array::from_fn(|i| u16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]]))
}

/// A sample of 8 bits in 16: 255 is as white as 65535.
fn widened(sample: u8) -> u16 {
    u16::from(sample) * 257
}

/// Light of a grey pixel and its opacity.
fn grey([value, opacity]: [u16; 2]) -> f64 {
    luminance([value, value, value, opacity])
}

/// Light of a pixel: red, green, blue and opacity.
fn luminance([r, g, b, opacity]: [u16; 4]) -> f64 {
    // The weights of Rec. 709, in integers so that grey keeps its value exactly.
    let full = f64::from(u16::MAX);
    let luminance = 2126 * u64::from(r) + 7152 * u64::from(g) + 722 * u64::from(b);
    let (luminance, opacity) = (luminance as f64 / (10_000.0 * full), f64::from(opacity) / full);
    opacity * luminance + (1.0 - opacity)
}

/// Means over `count` equal parts of each line of `length` values.
fn means(values: &[f64], length: usize, count: usize) -> Vec<f64> {
    if count == length {
        return values.to_vec();
    }
    let part = |line: &[f64], i: usize| {
        let (from, to) = ((i * length) as f64 / count as f64, ((i + 1) * length) as f64 / count as f64);
        let (mut sum, mut weight) = (0.0, 0.0);
        for k in from.floor() as usize..(to.ceil() as usize).min(length) {
            let share = to.min((k + 1) as f64) - from.max(k as f64);
            sum += share * line[k];
            weight += share;
        }
        sum / weight
    };
    values.chunks(length).flat_map(|line| (0..count).map(move |i| part(line, i))).collect()
}

/// Lines of `length` values as columns.
fn transposed(values: &[f64], length: usize) -> Vec<f64> {
    let lines = values.len() / length;
    (0..values.len()).map(|i| values[(i % lines) * length + i / lines]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Truth: the mean of the picture, and of an affine picture its value at the centre of each larger pixel.
        #[test]
        fn averaging_keeps_means_and_slopes(columns in 1_usize..12, rows in 1_usize..12, fewer in 1_usize..12, lower in 1_usize..12) {
            let at = |i: f64, j: f64| 0.1 + 0.03 * i / columns as f64 + 0.2 * j / rows as f64;
            let light: Vec<f64> =
                (0..rows).flat_map(|j| (0..columns).map(move |i| at(i as f64 + 0.5, j as f64 + 0.5))).collect();
            let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let picture = Picture { columns, rows, light };
            let (m, n, averaged) = picture.averaged(fewer, lower);
            prop_assert_eq!((m, n, averaged.len()), (fewer.min(columns), lower.min(rows), m * n));
            prop_assert!((mean(&averaged) - mean(&picture.light)).abs() < 1e-14);
            for (k, value) in averaged.iter().enumerate() {
                let (i, j) = ((k % m) as f64 + 0.5, (k / m) as f64 + 0.5);
                let expected = at(i * columns as f64 / m as f64, j * rows as f64 / n as f64);
                // A part of a pixel counts with the mean of the whole pixel.
                let tolerance = 1e-12 + 0.03 / columns as f64 + 0.2 / rows as f64;
                prop_assert!((value - expected).abs() < tolerance, "{} {} {}", k, value, expected);
            }
        }
    }
}
