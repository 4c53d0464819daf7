//! Pictures that paint values.

use super::error::{LoadError, read_bytes};
use png::{BitDepth, Transformations};
use std::io::Cursor;
use std::path::Path;

/// A picture in shades of grey.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    /// The file, for the hash of the scene.
    pub(crate) bytes: Vec<u8>,
    /// Pixels along x.
    pub(crate) columns: usize,
    /// Pixels along y.
    pub(crate) rows: usize,
    /// Black 0, white 1, row by row from the lowest, in each row from the left.
    pub(crate) light: Vec<f64>,
}

impl Picture {
    /// Reads a PNG of any kind. Colours become their luminance as encoded; what is transparent is white.
    pub(crate) fn read(path: &Path) -> Result<Self, LoadError> {
        let bytes = read_bytes(path, "the image")?;
        let (columns, pixels) = decode(&bytes)
            .map_err(|e| LoadError::file(path, format!("not a PNG image: {e}"), "save it as PNG"))?
            .ok_or_else(|| {
                let most = format!("its pixels take more than {} MiB", MOST_BYTES >> 20);
                LoadError::file(path, most, "scale it down: pixels finer than particles are averaged")
            })?;
        // The weights of Rec. 709, in integers so that grey keeps its value exactly.
        let light = |&[r, g, b, opacity]: &Pixel| {
            let full = f64::from(u16::MAX);
            let luminance = 2126 * u64::from(r) + 7152 * u64::from(g) + 722 * u64::from(b);
            let (luminance, opacity) = (luminance as f64 / (10_000.0 * full), f64::from(opacity) / full);
            opacity * luminance + (1.0 - opacity)
        };
        let light: Vec<f64> = pixels.chunks_exact(columns).rev().flatten().map(light).collect();
        Ok(Self { bytes, columns, rows: light.len() / columns, light })
    }

    /// Light of the picture with at most `columns` × `rows` pixels (each at least 1): means over the larger pixels. Gives
    /// columns, rows and light.
    pub(crate) fn averaged(&self, columns: usize, rows: usize) -> (usize, usize, Vec<f64>) {
        let (columns, rows) = (columns.min(self.columns), rows.min(self.rows));
        let narrow = means(&self.light, self.columns, columns);
        let upright = means(&transposed(&narrow, columns), self.rows, rows);
        (columns, rows, transposed(&upright, rows))
    }
}

/// Most bytes that the pixels of a picture may take.
const MOST_BYTES: usize = 1 << 30;

/// Red, green, blue and opacity, 16 bits each.
type Pixel = [u16; 4];

/// Columns and pixels of a PNG, row by row from the highest; none when it is too large.
fn decode(bytes: &[u8]) -> Result<Option<(usize, Vec<Pixel>)>, png::DecodingError> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::ALPHA);
    let mut reader = decoder.read_info()?;
    let Some(size) = reader.output_buffer_size().filter(|&size| size <= MOST_BYTES) else { return Ok(None) };
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples)?;
    let samples: Vec<u16> = match frame.bit_depth {
        BitDepth::Sixteen => samples.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
        // 255 is as white as 65535.
        _ => samples.iter().map(|&sample| u16::from(sample) * 257).collect(),
    };
    let pixels: Vec<Pixel> = match frame.color_type.samples() {
        2 => samples.chunks_exact(2).map(|p| [p[0], p[0], p[0], p[1]]).collect(),
        _ => samples.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect(),
    };
    Ok(Some((frame.width as usize, pixels)))
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
            let picture = Picture { bytes: Vec::new(), columns, rows, light };
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
