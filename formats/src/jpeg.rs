//! JPEG images; reduced while they are decoded.

use jpeg_decoder::{CodingProcess, Decoder, ImageInfo, PixelFormat};

use crate::exif;
use crate::guard::{corrupt, pixel_count, too_large, unsupported};
use crate::orientation::Orientation;
use crate::reducer::{Reducer, reduced_size};
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, Result};

pub(crate) const MAGIC: &[u8] = b"\xff\xd8\xff";

/// Maximum number of pixels of a progressive image: all its coefficients are in memory, up to six bytes per pixel.
const MAX_PROGRESSIVE_PIXELS: usize = 1 << 25;

/// Maximum number of pixels per byte: a block of 64 pixels takes at least a bit. The decoder fills missing data,
/// so a short file could otherwise claim any size.
const PIXELS_PER_BYTE: usize = 8 * 64;

/// Smallest side of an image that the decoder reduces itself.
const MIN_SCALED_SIDE: usize = 64;

/// Reads a JPEG of at most `max_pixels` pixels; larger ones are reduced. Also returns the EXIF orientation, which is not
/// applied. CMYK is converted multiplicatively, channel × black; colour profiles are ignored.
pub(crate) fn read(argument: &'static str, bytes: &[u8], max_pixels: usize) -> Result<(Image<Rgb>, Orientation)> {
    let mut decoder = Decoder::new(bytes);
    let info = read_header(argument, &mut decoder)?;
    let full = [usize::from(info.width), usize::from(info.height)];
    let count = pixel_count(argument, full[0], full[1])?;
    if bytes.len() < count / PIXELS_PER_BYTE {
        let found = format!("{} × {} pixels in {} bytes", full[0], full[1], bytes.len());
        return Err(corrupt(argument, found, "enough bytes for the pixels"));
    }
    if info.coding_process == CodingProcess::DctProgressive && count > MAX_PROGRESSIVE_PIXELS {
        let found = format!("a progressive JPEG of {} × {} pixels", full[0], full[1]);
        return Err(too_large(argument, found, format!("at most {MAX_PROGRESSIVE_PIXELS} pixels")));
    }
    if info.coding_process == CodingProcess::Lossless {
        let remedy = "Save it as PNG, or as usual JPEG.";
        return Err(unsupported(argument, "a lossless JPEG", "a baseline or progressive JPEG, or a PNG", remedy));
    }
    let size = reduced_size(full, max_pixels);
    let factor = (full[0] / size[0]).min(full[1] / size[1]);
    // The decoder can reduce blocks of 8 × 8 pixels to 4 × 4, 2 × 2 and 1 × 1.
    let is_large = full.iter().all(|&side| side >= MIN_SCALED_SIDE);
    let scale = if is_large { [8, 4, 2, 1].into_iter().find(|&scale| scale <= factor).unwrap_or(1) } else { 1 };
    let [width, height] = full.map(|side| side.div_ceil(scale));
    let decoded = decoder.scale(width as u16, height as u16).map_err(|error| broken(argument, error))?;
    let pixels = decoder.decode().map_err(|error| broken(argument, error))?;
    let channels = match info.pixel_format {
        PixelFormat::L8 => 1,
        PixelFormat::RGB24 => 3,
        PixelFormat::CMYK32 => 4,
        PixelFormat::L16 => return Err(corrupt(argument, "a JPEG of 16 bits", "8 bits per channel")),
    };
    if decoded != (width as u16, height as u16) || pixels.len() != width * height * channels {
        return Err(corrupt(argument, "a JPEG with fewer pixels than its header says", "a JPEG image"));
    }
    let mut reducer = Reducer::new(full, scale, size);
    for (v, row) in pixels.chunks_exact(width * channels).enumerate() {
        reducer.add_row(v, 0, 1, row.chunks_exact(channels).map(to_rgb));
    }
    let orientation = decoder.exif_data().map(exif::orientation).unwrap_or_default();
    Ok((reducer.finish(argument)?, orientation))
}

/// The EXIF data, from their TIFF header.
pub(crate) fn exif(argument: &'static str, bytes: &[u8]) -> Result<Option<Vec<u8>>> {
    let mut decoder = Decoder::new(bytes);
    read_header(argument, &mut decoder)?;
    Ok(decoder.exif_data().map(<[u8]>::to_vec))
}

/// Width and height.
pub(crate) fn size(argument: &'static str, bytes: &[u8]) -> Result<[usize; 2]> {
    let info = read_header(argument, &mut Decoder::new(bytes))?;
    Ok([info.width, info.height].map(usize::from))
}

fn read_header(argument: &'static str, decoder: &mut Decoder<&[u8]>) -> Result<ImageInfo> {
    decoder.read_info().map_err(|error| broken(argument, error))?;
    decoder.info().ok_or_else(|| corrupt(argument, "a JPEG without header", "a JPEG image"))
}

fn to_rgb(pixel: &[u8]) -> Rgb {
    let behind = |ink: u8, black: u8| {
        let light = u32::from(255 - ink) * u32::from(255 - black);
        ((light + 127) / 255) as u8
    };
    match *pixel {
        [grey] => [grey; 3],
        [r, g, b] => [r, g, b],
        [c, m, y, k] => [c, m, y].map(|ink| behind(ink, k)),
        _ => [0; 3],
    }
}

fn broken(argument: &str, error: jpeg_decoder::Error) -> Error {
    match error {
        jpeg_decoder::Error::Unsupported(feature) => unsupported(
            argument,
            format!("a JPEG with {feature:?}"),
            "a baseline or progressive JPEG of 8 bits, or a PNG",
            "Save it as PNG, or as usual JPEG.",
        ),
        error => corrupt(argument, format!("a JPEG that can't be decoded: {error}"), "a JPEG image"),
    }
}
