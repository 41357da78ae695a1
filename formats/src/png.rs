//! PNG images; the header is checked before pixels are decoded.

use std::io;

use png::{BitDepth, Decoder, DecodingError, Limits, Transformations};

use crate::cursor::Cursor;
use crate::exif;
use crate::guard::{corrupt, pixel_count};
use crate::orientation::Orientation;
use crate::reducer::{Reducer, reduced_size};
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::Result;

pub(crate) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Maximum compression ratio of DEFLATE, 1032:1; a file that would need more is incomplete.
const MAX_RATIO: usize = 1032;

/// Maximum memory of the decoder beside the pixels.
const MAX_DECODER_BYTES: usize = 1 << 28;

/// First column and row, and distances of columns and rows, of the passes of an interlaced image (PNG 3, 8.2).
const PASSES: [[usize; 4]; 7] =
    [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];

/// The header of a PNG file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PngInfo<'a> {
    pub width: usize,
    pub height: usize,
    /// Bits per sample: 1, 2, 4, 8 or 16.
    pub bit_depth: u8,
    /// The colour of index 0 of a palette image.
    pub first_palette_colour: Option<[u8; 3]>,
    /// The EXIF data, from their TIFF header.
    pub exif: Option<&'a [u8]>,
}

/// A decoded PNG: interleaved samples of 8 or 16 bits, palettes and small bit depths expanded.
#[derive(Debug)]
pub(crate) struct PngPixels {
    pub channels: usize,
    pub samples: Vec<u16>,
}

impl PngPixels {
    /// Whether the last channel is alpha.
    pub fn has_alpha(&self) -> bool {
        matches!(self.channels, 2 | 4)
    }

    /// The number of channels without alpha.
    pub fn colours(&self) -> usize {
        if self.has_alpha() { self.channels - 1 } else { self.channels }
    }
}

impl<'a> PngInfo<'a> {
    /// Reads all chunks, so that truncation is detected even after the pixels.
    pub fn read(argument: &'static str, bytes: &'a [u8]) -> Result<Self> {
        let mut cursor = Cursor::new(argument, bytes);
        if cursor.take(MAGIC.len())? != MAGIC {
            return Err(corrupt(argument, "no PNG signature", "a PNG image"));
        }
        let mut header = None;
        let mut first_palette_colour = None;
        let mut compressed_bytes = 0_usize;
        let mut exif = None;
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
                (b"eXIf", _) => exif = exif.or(Some(data)),
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
        Ok(Self { width, height, bit_depth, first_palette_colour, exif })
    }

    /// Decodes the pixels of the file with this header.
    pub fn decode(&self, argument: &'static str, bytes: &[u8]) -> Result<PngPixels> {
        let mut pixels = PngPixels { channels: 0, samples: Vec::new() };
        self.each_row(argument, bytes, Transformations::EXPAND, &mut |row| {
            if pixels.samples.is_empty() {
                let samples = vec![0; self.width * self.height * row.channels];
                pixels = PngPixels { channels: row.channels, samples };
            }
            let start = (row.row * self.width + row.first) * row.channels;
            let slots = pixels.samples.get_mut(start..).unwrap_or_default();
            // Without interlacing, all samples of a row are beside one another.
            let (run, step) = if row.step == 1 { (slots.len().max(1), 1) } else { (row.channels, row.step) };
            let runs = slots.chunks_mut(run * step).zip(row.samples.chunks(run * row.bytes));
            for (slots, samples) in runs {
                match row.bytes {
                    1 => slots.iter_mut().zip(samples).for_each(|(slot, &byte)| *slot = u16::from(byte)),
                    _ => {
                        let (samples, _) = samples.as_chunks();
                        slots.iter_mut().zip(samples).for_each(|(slot, bytes)| *slot = u16::from_be_bytes(*bytes));
                    }
                }
            }
        })?;
        Ok(pixels)
    }

    /// Calls `visit` with each decoded row, or with each row of a pass if the image is interlaced.
    fn each_row(
        &self,
        argument: &'static str,
        bytes: &[u8],
        transformations: Transformations,
        visit: &mut dyn FnMut(PngRow<'_>),
    ) -> Result<()> {
        let broken =
            |error: DecodingError| corrupt(argument, format!("a PNG that can't be decoded: {error}"), "a PNG image");
        let mut decoder = Decoder::new_with_limits(io::Cursor::new(bytes), Limits { bytes: MAX_DECODER_BYTES });
        decoder.set_transformations(transformations);
        decoder.set_ignore_text_chunk(true);
        decoder.set_ignore_iccp_chunk(true);
        let mut reader = decoder.read_info().map_err(broken)?;
        let (color, depth) = reader.output_color_type();
        let (channels, bytes) = (color.samples(), if depth == BitDepth::Sixteen { 2 } else { 1 });
        let passes = if reader.info().interlaced { &PASSES[..] } else { &[[0, 0, 1, 1]] };
        for &[first, first_row, step, row_step] in passes.iter().filter(|pass| pass[0] < self.width) {
            for row in (first_row..self.height).step_by(row_step) {
                let Some(samples) = reader.next_row().map_err(broken)? else {
                    return Err(corrupt(argument, "a PNG with too few rows", "a PNG image"));
                };
                visit(PngRow { row, first, step, channels, bytes, samples: samples.data() });
            }
        }
        Ok(())
    }
}

/// A row, or every `step`th pixel of it from the `first`, as interleaved big-endian samples.
struct PngRow<'a> {
    row: usize,
    first: usize,
    step: usize,
    channels: usize,
    /// Bytes per sample, 1 or 2.
    bytes: usize,
    samples: &'a [u8],
}

/// Reads a PNG as colours, of at most `max_pixels` pixels; larger ones are reduced. Also returns the EXIF orientation,
/// which is not applied. Alpha is ignored.
pub(crate) fn read_rgb(argument: &'static str, bytes: &[u8], max_pixels: usize) -> Result<(Image<Rgb>, Orientation)> {
    let info = PngInfo::read(argument, bytes)?;
    let full = [info.width, info.height];
    let mut reducer = Reducer::new(full, 1, reduced_size(full, max_pixels));
    let transformations = Transformations::EXPAND | Transformations::STRIP_16;
    info.each_row(argument, bytes, transformations, &mut |row| {
        let color = |pixel: &[u8]| match *pixel {
            [grey] | [grey, _] => [grey; 3],
            [r, g, b, ..] => [r, g, b],
            [] => [0; 3],
        };
        reducer.add_row(row.row, row.first, row.step, row.samples.chunks_exact(row.channels).map(color));
    })?;
    Ok((reducer.finish(argument)?, info.exif.map(exif::orientation).unwrap_or_default()))
}
