//! TIFF images of one channel: floats, or integers.

use std::io;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::{ColorType, TiffError};

use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::guard::{MAX_PIXELS, corrupt, pixel_count, too_large, unsupported};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_runtime::error::{Error, Result};

/// Maximum compression ratio, that of LZW on one value; a file that would need more is incomplete.
const MAX_RATIO: usize = 4096;

/// Maximum size of an entry of the directory, which lists the strips or tiles: several per row.
const MAX_ENTRY_BYTES: usize = 1 << 22;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let mut decoder = Decoder::new(io::Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions().map_err(broken)?;
    let (width, height) = (width as usize, height as usize);
    let count = pixel_count("depth", width, height)?;
    let bits = match decoder.colortype().map_err(broken)? {
        ColorType::Gray(bits) => usize::from(bits),
        other => {
            return Err(unsupported(
                "depth",
                format!("a TIFF of {}", words(other)),
                "one grey channel",
                "Pass the raw depth map, not a rendering of it.",
            ));
        }
    };
    let (chunk_width, chunk_height) = decoder.chunk_dimensions();
    let chunk = (chunk_width as usize).saturating_mul(chunk_height as usize);
    // A strip may be as high as it says, but has no more rows than the image; a tile reaches beyond the image.
    if chunk > MAX_PIXELS && chunk_width as usize > width {
        let found = format!("tiles of {chunk_width} × {chunk_height} pixels");
        return Err(too_large("depth", found, format!("at most {MAX_PIXELS} pixels")));
    }
    if count / 8 * bits / MAX_RATIO > bytes.len() {
        let found = format!("{width} × {height} pixels in {} bytes", bytes.len());
        return Err(corrupt("depth", found, "enough bytes for the pixels"));
    }
    let pixel_bytes = count * bits.div_ceil(8);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = pixel_bytes;
    // The stated size of a strip or tile, which it does not exceed.
    limits.intermediate_buffer_size = pixel_bytes.max(bytes.len());
    limits.ifd_value_size = MAX_ENTRY_BYTES;
    let mut decoder = decoder.with_limits(limits);
    let mut stored = Stored { width, height, bits, is_integer: true };
    stored.check_bits(kind, || format!("a TIFF of {bits} bits a pixel"))?;
    let pixels = decoder.read_image().map_err(broken)?;
    stored.is_integer = !matches!(pixels, DecodingResult::F16(_) | DecodingResult::F32(_) | DecodingResult::F64(_));
    let read = |values: &mut dyn Iterator<Item = f64>| stored.read(options, kind, values);
    match pixels {
        DecodingResult::U8(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::U16(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::U32(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::U64(values) => read(&mut values.into_iter().map(|z| z as f64)),
        DecodingResult::I8(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::I16(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::I32(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::I64(values) => read(&mut values.into_iter().map(|z| z as f64)),
        DecodingResult::F16(values) => read(&mut values.into_iter().map(|z| z.to_f64())),
        DecodingResult::F32(values) => read(&mut values.into_iter().map(f64::from)),
        DecodingResult::F64(values) => read(&mut values.into_iter()),
    }
}

fn words(color: ColorType) -> &'static str {
    match color {
        ColorType::GrayA(_) => "grey and alpha",
        ColorType::RGB(_) => "red, green and blue",
        ColorType::RGBA(_) => "red, green, blue and alpha",
        ColorType::Palette(_) => "a palette",
        _ => "several channels",
    }
}

fn broken(error: TiffError) -> Error {
    match error {
        TiffError::UnsupportedError(feature) => unsupported(
            "depth",
            format!("a TIFF with {feature}"),
            "strips or tiles, uncompressed or with deflate or LZW",
            "Save it again without compression, for example with tifffile.imwrite.",
        ),
        TiffError::LimitsExceeded => {
            too_large("depth", "a TIFF whose parts are larger than their image", "strips or tiles of the image")
        }
        error => corrupt("depth", format!("a TIFF that can't be decoded: {error}"), "a TIFF image"),
    }
}
