//! Mask files.

use crate::guard::{MAX_PIXELS, beginning, unsupported};
use crate::jpeg;
use crate::npy::{self, Kind, NpyImage};
use crate::png::{self, PngInfo};
use sim3align_geometry::image::{Image, Mask};
use sim3align_runtime::error::Result;
use sim3align_runtime::number::number;

/// A mask from a file.
#[derive(Debug, Clone)]
pub struct MaskImage {
    /// 1 for the pixels of the object, 0 for the others.
    pub object: Mask,
    /// Which values of the file are the object, for people: `values of 127.5 or more, of 0 to 255`.
    pub reading: String,
}

/// Reads a mask:
///
/// - PNG of any bit depth, or JPEG. A pixel's value is its alpha, if alpha varies (a cut-out); otherwise its largest
///   channel; in a palette image, the largest difference to the colour of index 0.
/// - `.npy` array (H×W, H×W×1, 1×H×W) of booleans or numbers. NaN is not the object.
///
/// The object is at the only value other than 0, if there is one. A mask with soft edges has its outline at half of the range:
/// the object has half of the largest value or more, and probabilities (floats from 0 to 1) of 0.5 or more. In a map of labels,
/// where values lie in flat regions, all of them above 0 are the object. With values below 0, which are logits, too.
///
/// # Errors
/// [`UnsupportedFormat`](sim3align_runtime::error::ErrorCode::UnsupportedFormat),
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile),
/// [`FileTooLarge`](sim3align_runtime::error::ErrorCode::FileTooLarge),
/// [`EmptyImage`](sim3align_runtime::error::ErrorCode::EmptyImage).
pub fn read_mask(bytes: &[u8]) -> Result<MaskImage> {
    if bytes.starts_with(png::MAGIC) {
        return read_png(bytes);
    }
    if bytes.starts_with(jpeg::MAGIC) {
        let (image, _) = jpeg::read("mask", bytes, MAX_PIXELS)?;
        let level = |i: usize| image.data().get(i).and_then(|rgb| rgb.iter().max()).map_or(0.0, |&level| level.into());
        return outlined(image.width(), image.height(), false, &level);
    }
    if bytes.starts_with(npy::MAGIC) {
        let array = NpyImage::read("mask", bytes)?;
        let is_float = array.header().kind == Kind::Float;
        return outlined(array.width, array.height, is_float, &|i| array.value(i));
    }
    Err(unsupported(
        "mask",
        beginning(bytes),
        "a PNG, a JPEG, a .npy array or COCO RLE in JSON",
        "Save the mask as PNG.",
    ))
}

fn read_png(bytes: &[u8]) -> Result<MaskImage> {
    let info = PngInfo::read("mask", bytes)?;
    let pixels = info.decode("mask", bytes)?;
    let channels = pixels.channels.max(1);
    let alpha = |pixel: &[u16]| pixel.last().copied().unwrap_or_default();
    let first_alpha = pixels.samples.get(..channels).map(alpha);
    let is_cut_out = pixels.has_alpha() && pixels.samples.chunks_exact(channels).any(|p| Some(alpha(p)) != first_alpha);
    let background = info.first_palette_colour.unwrap_or_default().map(u16::from);
    let level = |pixel: &[u16]| {
        if is_cut_out {
            return alpha(pixel);
        }
        let differences =
            pixel.iter().take(pixels.colours()).zip(background).map(|(sample, zero)| sample.abs_diff(zero));
        differences.max().unwrap_or_default()
    };
    let level_of = |i: usize| pixels.samples.get(i * channels..).and_then(|rest| rest.get(..channels)).map_or(0, level);
    outlined(info.width, info.height, false, &|i| level_of(i).into())
}

/// The mask of these values by their index, row-major.
fn outlined(width: usize, height: usize, is_float: bool, value: &dyn Fn(usize) -> f64) -> Result<MaskImage> {
    let count = width * height;
    let others = (0..count).map(value).filter(|&value| value != 0.0 && !value.is_nan());
    let (mut first, mut low, mut high, mut is_binary) = (None, 0.0_f64, 0.0_f64, true);
    for value in others {
        (low, high, is_binary) = (low.min(value), high.max(value), is_binary && value == *first.get_or_insert(value));
    }
    let first = first.unwrap_or(1.0);
    let half = if is_float && high <= 1.0 { 0.5 } else { 0.5 * high };
    let (lowest, kind) = if is_binary {
        (first, "")
    } else if low < 0.0 {
        (f64::MIN_POSITIVE, ": logits")
    } else if has_labels(width, count, high, value) {
        (f64::MIN_POSITIVE, ": labels")
    } else {
        (half, "")
    };
    let range = format!("of {} to {}", number(low), number(high));
    let reading = match (is_binary, kind) {
        (true, _) => format!("values of {}", number(first)),
        (_, "") => format!("values of {} or more, {range}", number(half)),
        _ => format!("values above 0, {range}{kind}"),
    };
    let is_object = |value: f64| if is_binary { value == lowest } else { value >= lowest };
    let object = (0..count).map(|i| u8::from(is_object(value(i)))).collect();
    Ok(MaskImage { object: Image::new("mask", width, height, object)?, reading })
}

/// Whether the image is a map of labels: most values between 0 and the largest equal their neighbours above and to the left.
/// Values of soft edges and network outputs rarely do.
fn has_labels(width: usize, count: usize, high: f64, value: &dyn Fn(usize) -> f64) -> bool {
    let (mut between, mut flat) = (0_usize, 0_usize);
    for i in (width + 1)..count {
        let level = value(i);
        if level >= 0.05 * high && level <= 0.95 * high {
            between += 1;
            flat += usize::from(level == value(i - 1) && level == value(i - width));
        }
    }
    2 * flat > between
}
