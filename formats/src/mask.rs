//! Mask files.

use crate::depth_image::{Fill, each_row};
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
///   channel; in a palette image, the largest difference to the colour of index 0. Regions of several colours are labels.
/// - `.npy` array (H×W, H×W×1, 1×H×W) of booleans or numbers. NaN is not the object.
///
/// The object is at the only value other than 0, if there is one. A mask with soft edges has its outline at half of the range:
/// the object has half of the largest value or more, and probabilities (floats from 0 to 1) of 0.5 or more. In a map of labels,
/// where values lie in flat regions, all of them above 0 are the object. Of floats below and above 0, which are logits, too; of
/// none above 0, which are logarithms of probabilities, those of ½ or more.
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
        let fill = |start: usize, row: &mut [f64]| {
            let pixels = image.data().get(start..).unwrap_or_default();
            row.iter_mut().zip(pixels).for_each(|(to, [r, g, b])| *to = (*r.max(g).max(b)).into());
        };
        return outlined(image.width(), image.height(), &Values::of(&fill, false));
    }
    if bytes.starts_with(npy::MAGIC) {
        let array = NpyImage::read("mask", bytes)?;
        let is_float = array.header().kind == Kind::Float;
        return outlined(array.width, array.height, &Values::of(&|start, row| array.fill(start, row), is_float));
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
    // The largest difference to the background, and all of them as one number of three digits.
    let color = |pixel: &[u16]| {
        let differences =
            pixel.iter().take(pixels.colours()).zip(background).map(|(sample, zero)| sample.abs_diff(zero));
        differences.fold((0, 0.0), |(most, key), sample| (most.max(sample), 65536.0 * key + f64::from(sample)))
    };
    let levels: Vec<u16> = (pixels.samples.chunks_exact(channels))
        .map(|pixel| if is_cut_out { alpha(pixel) } else { color(pixel).0 })
        .collect();
    let fill = |start: usize, row: &mut [f64]| {
        let levels = levels.get(start..).unwrap_or_default();
        row.iter_mut().zip(levels).for_each(|(to, &level)| *to = level.into());
    };
    // Of a cut-out, the colours may be those of a photo.
    let key = |pixel: &[u16]| if is_cut_out && alpha(pixel) == 0 { 0.0 } else { color(pixel).1 };
    let fill_keys = |start: usize, row: &mut [f64]| {
        let pixels = pixels.samples.get(start * channels..).unwrap_or_default();
        row.iter_mut().zip(pixels.chunks_exact(channels)).for_each(|(to, pixel)| *to = key(pixel));
    };
    let keys: Option<Fill<'_>> = if channels > 1 { Some(&fill_keys) } else { None };
    outlined(info.width, info.height, &Values { fill: &fill, keys, is_float: false, is_cut_out })
}

/// The values of a mask.
struct Values<'a> {
    fill: Fill<'a>,
    /// Numbers that differ between labels that have the same value, such as colours; `None` where there are no such labels.
    keys: Option<Fill<'a>>,
    is_float: bool,
    is_cut_out: bool,
}

impl<'a> Values<'a> {
    /// Values of one channel.
    fn of(fill: Fill<'a>, is_float: bool) -> Self {
        Self { fill, keys: None, is_float, is_cut_out: false }
    }
}

/// Values above the logarithm of ½ are the object if they are logarithms of probabilities.
const HALF_LOGARITHM: f64 = -core::f64::consts::LN_2;

#[inline(never)]
fn outlined(
    width: usize,
    height: usize,
    &Values { fill, keys, is_float, is_cut_out }: &Values<'_>,
) -> Result<MaskImage> {
    let size = [width, height];
    let (mut first, mut low, mut high, mut is_binary) = (None, 0.0_f64, 0.0_f64, true);
    let mut last = 0.0;
    each_row(size, fill, &mut |row| {
        for &value in row {
            // Most values are those of the pixels before.
            if value == last || value == 0.0 || value.is_nan() {
                continue;
            }
            last = value;
            (low, high, is_binary) =
                (low.min(value), high.max(value), is_binary && value == *first.get_or_insert(value));
        }
    });
    // −1 may be true; −6 is no object.
    is_binary &= !is_float || low >= 0.0;
    let first = first.unwrap_or(1.0);
    let half = match (is_float, high) {
        (true, 0.0) if low < 0.0 => HALF_LOGARITHM,
        (true, ..=1.0) if low >= 0.0 => 0.5,
        _ => 0.5 * high,
    };
    // One value is one label, unless labels differ by more than their values.
    let may_have_labels = if is_binary { keys.is_some() } else { !is_cut_out };
    let (lowest, kind) = if may_have_labels && low >= 0.0 && has_labels(width, height, keys.unwrap_or(fill)) {
        (f64::MIN_POSITIVE, ": labels")
    } else if is_binary {
        (first, "")
    } else if low < 0.0 && half != HALF_LOGARITHM {
        (f64::MIN_POSITIVE, ": logits")
    } else {
        (half, "")
    };
    let range = format!("of {} to {}", number(low), number(high));
    let reading = match (is_binary, kind) {
        (true, "") => format!("values of {}", number(first)),
        (_, "") => format!("values of {} or more, {range}", number(half)),
        _ => format!("values above 0, {range}{kind}"),
    };
    let is_object = |value: f64| if is_binary && kind.is_empty() { value == lowest } else { value >= lowest };
    let mut object = Vec::with_capacity(width * height);
    each_row(size, fill, &mut |row| object.extend(row.iter().map(|&value| u8::from(is_object(value)))));
    Ok(MaskImage { object: Image::new("mask", width, height, object)?, reading })
}

/// Levels of a mask with soft edges are more than these.
const FEW: usize = 8;

/// Whether the image is a map of labels: most values between 0 and the largest equal their neighbours above and to the left.
/// Values of soft edges and network outputs rarely do, unless the image was enlarged: then rows repeat, and along a row most
/// are between their neighbours.
#[inline(never)]
fn has_labels(width: usize, height: usize, fill: Fill<'_>) -> bool {
    let (mut labels, mut high, mut is_few) = ([0.0; FEW], 0.0_f64, true);
    each_row([width, height], fill, &mut |row| {
        for &level in row.iter().filter(|level| **level > 0.0) {
            high = high.max(level);
            match labels.iter_mut().find(|label| **label == level || **label == 0.0) {
                Some(label) => *label = level,
                None => is_few = false,
            }
        }
    });
    if labels[1] == 0.0 {
        return false;
    }
    let range = if is_few { [0.0, 1.0] } else { [0.05, 0.95] }.map(|share| share * high);
    let is_between = |level: f64| level > range[0] && level < range[1];
    let [mut between, mut flat, mut rows, mut repeated, mut steps, mut ordered] = [0_usize; 6];
    let [mut row, mut above] = [0, 1].map(|_| vec![0.0; width]);
    fill(0, &mut row);
    for v in 1..height {
        core::mem::swap(&mut above, &mut row);
        // The last pixel of the row above is beside the first one.
        let mut beside = above.last().copied().unwrap_or_default();
        fill(v * width, &mut row);
        let mut runs = [0.0; 2];
        let (mut is_full, mut is_like) = (false, true);
        for (&level, &above) in row.iter().zip(&above) {
            is_full |= level != 0.0;
            is_like &= level == above;
            if is_between(level) {
                between += 1;
                flat += usize::from(level == above && level == beside);
            }
            beside = level;
            let [before, last] = runs;
            if level != last {
                steps += usize::from(is_between(last));
                ordered += usize::from(is_between(last) && (before < last) == (last < level));
                runs = [last, level];
            }
        }
        rows += usize::from(is_full);
        repeated += usize::from(is_full && is_like);
    }
    // Enlarged by four, three rows of four repeat the one before.
    let is_enlarged = 5 * repeated > 3 * rows;
    // Two values are no edge that was enlarged.
    2 * flat > between && !(labels[2] > 0.0 && is_enlarged && 2 * ordered > steps)
}
