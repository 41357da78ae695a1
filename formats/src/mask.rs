//! Mask files.

use crate::guard::{beginning, unsupported};
use crate::npy::{self, NpyImage};
use crate::png::{self, PngInfo};
use sim3align_geometry::error::Result;
use sim3align_geometry::image::{Image, Mask};

/// Reads a mask; pixels of the object become 1, the others 0:
///
/// - PNG of any bit depth. If the alpha channel varies, the object has alpha above 0 (a cut-out). Otherwise, the
///   object has any colour channel above 0; in a palette image, a colour other than that of index 0.
/// - `.npy` array (H×W, H×W×1, 1×H×W) of booleans or numbers: values other than 0 and NaN are the object.
///
/// # Errors
/// [`UnsupportedFormat`](sim3align_geometry::error::ErrorCode::UnsupportedFormat),
/// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile),
/// [`FileTooLarge`](sim3align_geometry::error::ErrorCode::FileTooLarge),
/// [`EmptyImage`](sim3align_geometry::error::ErrorCode::EmptyImage).
pub fn read_mask(bytes: &[u8]) -> Result<Mask> {
    if bytes.starts_with(png::MAGIC) {
        return read_png(bytes);
    }
    if bytes.starts_with(npy::MAGIC) {
        let array = NpyImage::read("mask", bytes)?;
        let object = array.values().map(|value| u8::from(value != 0.0 && !value.is_nan())).collect();
        return Image::new("mask", array.width, array.height, object);
    }
    Err(unsupported(
        "mask",
        beginning(bytes),
        "a PNG, a .npy array or COCO RLE in JSON",
        "Save the mask as PNG: lossy formats blur its edge.",
    ))
}

fn read_png(bytes: &[u8]) -> Result<Mask> {
    let info = PngInfo::read("mask", bytes)?;
    let pixels = info.decode("mask", bytes)?;
    let channels = pixels.channels.max(1);
    let colours = if pixels.has_alpha() { channels - 1 } else { channels };
    let alpha = |pixel: &[u16]| pixel.last().copied().unwrap_or_default();
    let first_alpha = pixels.samples.get(..channels).map(alpha);
    let is_cut_out = pixels.has_alpha() && pixels.samples.chunks_exact(channels).any(|p| Some(alpha(p)) != first_alpha);
    let background = info.first_palette_colour.unwrap_or_default().map(u16::from);
    let is_object = |pixel: &[u16]| {
        if is_cut_out {
            return alpha(pixel) > 0;
        }
        pixel.iter().take(colours).zip(background).any(|(&sample, background)| sample != background)
    };
    let object = pixels.samples.chunks_exact(channels).map(|pixel| u8::from(is_object(pixel))).collect();
    Image::new("mask", info.width, info.height, object)
}
