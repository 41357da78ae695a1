//! PNG images; the header is checked before pixels are decoded.

use std::io;

use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder, Limits};

use crate::cursor::Cursor;
use crate::guard::{corrupt, pixel_count};
use sim3align_geometry::error::Result;

pub(crate) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Maximum compression ratio of DEFLATE, 1032:1; a file that would need more is incomplete.
const MAX_RATIO: usize = 1032;

/// The header of a PNG file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PngInfo {
    pub width: usize,
    pub height: usize,
    /// Bits per sample: 1, 2, 4, 8 or 16.
    pub bit_depth: u8,
    /// Whether the image is greyscale without alpha channel.
    pub is_grey: bool,
    /// The colour of index 0 of a palette image.
    pub first_palette_colour: Option<[u8; 3]>,
}

/// A decoded PNG: interleaved samples of 8 or 16 bits, palettes and small bit depths expanded.
#[derive(Debug)]
pub(crate) struct PngPixels {
    pub channels: usize,
    pub has_alpha: bool,
    pub samples: Vec<u16>,
}

impl PngInfo {
    /// Reads all chunks, so that truncation is detected even after the pixels.
    pub fn read(argument: &'static str, bytes: &[u8]) -> Result<Self> {
        let mut cursor = Cursor::new(argument, bytes);
        if cursor.take(MAGIC.len())? != MAGIC {
            return Err(corrupt(argument, "no PNG signature", "a PNG image"));
        }
        let mut header = None;
        let mut first_palette_colour = None;
        let mut compressed_bytes = 0_usize;
        loop {
            let length = cursor.u32_be()? as usize;
            let kind: [u8; 4] = cursor.array()?;
            let data = cursor.take(length)?;
            cursor.take(4)?;
            match (&kind, data) {
                // The decoder, which stops reading headers at the pixels, would take another one than this.
                (b"IHDR", _) if header.is_some() => return Err(corrupt(argument, "a PNG with two headers", "one")),
                (b"IHDR", &[a, b, c, d, e, f, g, h, bit_depth, colour, ..]) => {
                    let width = u32::from_be_bytes([a, b, c, d]) as usize;
                    let height = u32::from_be_bytes([e, f, g, h]) as usize;
                    header = Some((width, height, bit_depth, colour));
                }
                // The decoder panics at a colour that is not whole.
                (b"PLTE", _) if data.len() % 3 != 0 => {
                    return Err(corrupt(argument, format!("a palette of {} bytes", data.len()), "3 bytes per colour"));
                }
                (b"PLTE", &[r, g, b, ..]) => first_palette_colour = Some([r, g, b]),
                (b"IDAT", _) => compressed_bytes += length,
                (b"IEND", _) => break,
                _ => {}
            }
        }
        let Some((width, height, bit_depth, colour)) = header else {
            return Err(corrupt(argument, "a PNG without header", "a PNG image"));
        };
        let count = pixel_count(argument, width, height)?;
        let samples: usize = match colour {
            0 | 3 => 1,
            2 => 3,
            4 => 2,
            6 => 4,
            _ => return Err(corrupt(argument, format!("PNG colour type {colour}"), "0, 2, 3, 4 or 6")),
        };
        let pixel_bytes = count / 8 * samples * usize::from(bit_depth);
        if pixel_bytes / MAX_RATIO > compressed_bytes {
            let found = format!("{width} × {height} pixels in {compressed_bytes} compressed bytes");
            return Err(corrupt(argument, found, "enough bytes for the pixels"));
        }
        let first_palette_colour = first_palette_colour.filter(|_| colour == 3);
        Ok(Self { width, height, bit_depth, is_grey: colour == 0, first_palette_colour })
    }

    /// Decodes the pixels of the file with this header.
    pub fn decode(&self, argument: &'static str, bytes: &[u8]) -> Result<PngPixels> {
        let broken = |error: image::ImageError| {
            corrupt(argument, format!("a PNG that can't be decoded: {error}"), "a PNG image")
        };
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(1 << 30);
        let decoder = PngDecoder::with_limits(io::Cursor::new(bytes), limits).map_err(broken)?;
        let colour = decoder.color_type();
        let mut data = vec![0; usize::try_from(decoder.total_bytes()).unwrap_or_default()];
        decoder.read_image(&mut data).map_err(broken)?;
        let is_16_bit = matches!(colour, ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16);
        let samples = if is_16_bit {
            data.as_chunks::<2>().0.iter().map(|&pair| u16::from_ne_bytes(pair)).collect()
        } else {
            data.into_iter().map(u16::from).collect()
        };
        Ok(PngPixels { channels: usize::from(colour.channel_count()), has_alpha: colour.has_alpha(), samples })
    }
}
