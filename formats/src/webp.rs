//! WebP images, decoded by a module of their own.

use std::io::Cursor;

use image_webp::{DecodingError, WebPDecoder};

use crate::exif;
use crate::guard::{corrupt, pixel_count};
use crate::photo::MAX_PHOTO_PIXELS;
use crate::reducer::{Reducer, reduced_size};
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, Result};

/// Maximum memory of one allocation of the decoder.
const MAX_DECODER_BYTES: usize = 1 << 28;

/// A WebP that has been decoded.
#[derive(Debug, Clone)]
pub struct WebpImage {
    /// Of an animation, the first frame. Alpha is ignored.
    pub pixels: Image<Rgb>,
    /// The EXIF data, from their TIFF header.
    pub exif: Option<Vec<u8>>,
}

/// Reads a WebP, lossy or lossless, turned as its EXIF data say, unless it is wanted `as_stored`. One of more than [`MAX_PHOTO_PIXELS`] is reduced by a whole number.
///
/// # Errors
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile),
/// [`FileTooLarge`](sim3align_runtime::error::ErrorCode::FileTooLarge),
/// [`EmptyImage`](sim3align_runtime::error::ErrorCode::EmptyImage).
pub fn read_webp(bytes: &[u8], as_stored: bool) -> Result<WebpImage> {
    let mut decoder = open(bytes)?;
    let full = {
        let (width, height) = decoder.dimensions();
        pixel_count("image", width as usize, height as usize)?;
        [width as usize, height as usize]
    };
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut pixels = vec![0; full[0] * full[1] * channels];
    decoder.read_image(&mut pixels).map_err(|error| broken(&error))?;
    let mut reducer = Reducer::new(full, 1, reduced_size(full, MAX_PHOTO_PIXELS));
    for (v, row) in pixels.chunks_exact(full[0] * channels).enumerate() {
        reducer.add_row(v, 0, 1, row.chunks_exact(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]));
    }
    // Some programs write the signature of JPEG's segment before the data.
    let bare = |data: Vec<u8>| data.strip_prefix(b"Exif\0\0").map(<[u8]>::to_vec).unwrap_or(data);
    let exif = decoder.exif_metadata().ok().flatten().map(bare);
    let pixels = reducer.finish("image")?;
    let orientation = exif.as_deref().filter(|_| !as_stored).map(exif::orientation).unwrap_or_default();
    Ok(WebpImage { pixels: orientation.apply("image", pixels)?, exif })
}

fn open(bytes: &[u8]) -> Result<WebPDecoder<Cursor<&[u8]>>> {
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    decoder.set_memory_limit(MAX_DECODER_BYTES);
    Ok(decoder)
}

fn broken(error: &DecodingError) -> Error {
    corrupt("image", format!("a WebP that can't be decoded: {error}"), "a WebP image")
}
