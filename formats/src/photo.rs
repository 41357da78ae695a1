//! Image files as photos and textures.

use crate::exif::Exif;
use crate::guard::{beginning, unsupported};
use crate::jpeg;
use crate::orientation::Orientation;
use crate::png::{self, PngInfo};
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::Result;

/// Maximum number of pixels of a photo after reading, a little more than those of full HD: the comparison of colours
/// uses fewer.
pub const MAX_PHOTO_PIXELS: usize = 1 << 21;

/// Reads a photo: a PNG (any bit depth, grey, palette, interlaced) or a JPEG (baseline and progressive; grey, RGB, CMYK),
/// as sRGB colours. The EXIF orientation is applied. Alpha, colour profiles and gamma are ignored. A photo of more than
/// [`MAX_PHOTO_PIXELS`] is reduced by a whole number while it is read.
///
/// # Errors
/// [`UnsupportedFormat`](sim3align_runtime::error::ErrorCode::UnsupportedFormat),
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile),
/// [`FileTooLarge`](sim3align_runtime::error::ErrorCode::FileTooLarge),
/// [`EmptyImage`](sim3align_runtime::error::ErrorCode::EmptyImage).
pub fn read_photo(bytes: &[u8]) -> Result<Image<Rgb>> {
    let (image, orientation) = decode("image", bytes, MAX_PHOTO_PIXELS)?;
    orientation.apply("image", image)
}

/// Reads a photo without applying its EXIF orientation.
///
/// # Errors
/// Those of [`read_photo`].
pub fn read_stored_photo(bytes: &[u8]) -> Result<Image<Rgb>> {
    decode("image", bytes, MAX_PHOTO_PIXELS).map(|(image, _)| image)
}

/// Reads the EXIF data of a JPEG or a PNG, or of bytes that begin with their TIFF header. Fields that are damaged or missing are left out; a photo without EXIF data has
/// none.
///
/// # Errors
/// [`UnsupportedFormat`](sim3align_runtime::error::ErrorCode::UnsupportedFormat) for other files,
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile).
pub fn read_exif(bytes: &[u8]) -> Result<Exif> {
    if bytes.starts_with(b"II*\0") || bytes.starts_with(b"MM\0*") {
        return Ok(Exif::parse(bytes.to_vec()));
    }
    let tiff = match Format::of("image", bytes, "Pass the bytes of the photo as the camera wrote them.")? {
        Format::Png => PngInfo::read("image", bytes)?.exif.map(<[u8]>::to_vec),
        Format::Jpeg => jpeg::exif("image", bytes)?,
    };
    Ok(tiff.map(Exif::parse).unwrap_or_default())
}

/// Width and height of an image, from its header.
pub(crate) fn size(argument: &'static str, bytes: &[u8]) -> Result<[usize; 2]> {
    match Format::of(argument, bytes, CONVERT)? {
        Format::Png => PngInfo::read(argument, bytes).map(|info| [info.width, info.height]),
        Format::Jpeg => jpeg::size(argument, bytes),
    }
}

/// Reads an image of at most `max_pixels` pixels, as stored; larger ones are reduced.
pub(crate) fn decode(argument: &'static str, bytes: &[u8], max_pixels: usize) -> Result<(Image<Rgb>, Orientation)> {
    match Format::of(argument, bytes, CONVERT)? {
        Format::Png => png::read_rgb(argument, bytes, max_pixels),
        Format::Jpeg => jpeg::read(argument, bytes, max_pixels),
    }
}

/// Remedy for an image of another format.
const CONVERT: &str = "Convert the image to PNG or JPEG.";

enum Format {
    Png,
    Jpeg,
}

impl Format {
    fn of(argument: &'static str, bytes: &[u8], remedy: &'static str) -> Result<Self> {
        if bytes.starts_with(png::MAGIC) {
            return Ok(Self::Png);
        }
        if bytes.starts_with(jpeg::MAGIC) {
            return Ok(Self::Jpeg);
        }
        Err(unsupported(argument, beginning(bytes), "a PNG or a JPEG", remedy))
    }
}
