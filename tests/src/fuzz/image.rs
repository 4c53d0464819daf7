//! PNG files that are nearly right.

use super::random::Random;
use super::tree::mutate_bytes;
use png::{BitDepth, ColorType};

/// Small images of every kind.
#[allow(clippy::expect_used, reason = "without images there is nothing to run")]
pub(super) fn plain() -> Vec<Vec<u8>> {
    let kinds = [
        (ColorType::Grayscale, BitDepth::One),
        (ColorType::Grayscale, BitDepth::Eight),
        (ColorType::Grayscale, BitDepth::Sixteen),
        (ColorType::GrayscaleAlpha, BitDepth::Eight),
        (ColorType::Rgb, BitDepth::Eight),
        (ColorType::Rgba, BitDepth::Sixteen),
        (ColorType::Indexed, BitDepth::Four),
    ];
    let image = |(color, depth): (ColorType, BitDepth)| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 13, 7);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette((0..48).collect::<Vec<u8>>());
            encoder.set_trns(vec![0; 4]);
        }
        let row = (13 * color.samples() * depth as usize).div_ceil(8);
        let samples: Vec<u8> = (0..7 * row).map(|i| (i * 37 % 251) as u8).collect();
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&samples).expect("an image");
        writer.finish().expect("an image");
        bytes
    };
    kinds.into_iter().map(image).collect()
}

/// Changes an image: its header, chunks or pixels; checksums are made to fit most times.
pub(super) fn mutated(image: &[u8], random: &mut Random) -> Vec<u8> {
    const SIGNATURE: usize = 8;
    let mut chunks: Vec<(Vec<u8>, Vec<u8>)> = Vec::new();
    let mut rest = &image[SIGNATURE..];
    while let Some((head, after)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        chunks.push((head[4..].to_vec(), after[..length].to_vec()));
        rest = &after[length + 4..];
    }
    for _ in 0..1 + random.below(3) {
        let at = random.below(chunks.len());
        match random.below(8) {
            // Width, height, depth, colour, compression, filter, interlacing.
            0 | 1 => {
                let field = random.below(13);
                chunks[0].1[field] = *random.pick(&[0, 1, 2, 3, 4, 6, 8, 16, 0x7f, 0xff]);
            }
            2 => chunks[0].1[12] = 1,
            3 => mutate_bytes(&mut chunks[at].1, random),
            4 => {
                let copy = chunks[at].clone();
                chunks.insert(at, copy);
            }
            5 => {
                let name =
                    *random.pick(&[b"tRNS", b"PLTE", b"gAMA", b"iCCP", b"zTXt", b"acTL", b"fcTL", b"IDAT", b"sBIT"]);
                let data = (0..random.below(40)).map(|_| random.bits() as u8).collect();
                chunks.insert(at, (name.to_vec(), data));
            }
            6 if at > 0 => drop(chunks.remove(at)),
            _ => {
                let with = random.below(chunks.len());
                chunks.swap(at, with);
            }
        }
        if chunks[0].1.len() < 13 {
            break;
        }
    }
    let mut bytes = image[..SIGNATURE].to_vec();
    for (name, data) in chunks {
        bytes.extend((data.len() as u32).to_be_bytes());
        let start = bytes.len();
        bytes.extend(name);
        bytes.extend(data);
        let sum = crc32fast::hash(&bytes[start..]);
        bytes.extend(sum.to_be_bytes());
    }
    if random.once_in(10) {
        mutate_bytes(&mut bytes, random);
    }
    bytes
}
