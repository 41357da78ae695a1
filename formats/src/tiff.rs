//! TIFF images of one channel: floats, or integers.

use std::io;
use std::ops::RangeInclusive;

use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffUnsupportedError};

use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::guard::{MAX_PIXELS, corrupt, pixel_count, too_large, unsupported};
use crate::point_map;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_runtime::error::{Error, Result};

/// Maximum compression ratio, that of LZW on one value; a file that would need more is incomplete.
const MAX_RATIO: usize = 4096;

/// Pages that are counted.
const MAX_PAGES: usize = 255;

/// Bits of the subfile type of a page that is a smaller copy of another one, or its mask.
const NO_PAGE: u32 = 0b101;

/// Maximum size of an entry of the directory, which lists the strips or tiles: several per row.
const MAX_ENTRY_BYTES: usize = 1 << 22;

/// Tags that say how the samples are stored, which the decoder knows, or that do not matter here: sizes and descriptions of the
/// picture, its place on Earth, and what cameras and programs add. Others are `unread`.
const TAGS: [RangeInclusive<u16>; 21] = [
    // Subfile types to SampleFormat, without Orientation.
    254..=273,
    277..=347,
    // XMP.
    700..=700,
    32_781..=32_781,
    32_995..=32_998,
    // Model, IPTC, ImageJ, Photoshop, EXIF, colour profile.
    33_432..=33_432,
    33_550..=33_550,
    33_723..=33_723,
    33_922..=33_922,
    34_264..=34_264,
    34_377..=34_377,
    34_665..=34_665,
    34_675..=34_675,
    34_735..=34_737,
    34_853..=34_853,
    36_864..=37_888,
    40_960..=42_037,
    42_112..=42_113,
    50_838..=50_839,
    65_000..=65_000,
    65_420..=65_420,
];

/// What is said of the tag that turns the picture.
const ORIENTATION: u16 = 274;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let mut decoder = Decoder::new(io::Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions().map_err(broken)?;
    let (width, height) = (width as usize, height as usize);
    let count = pixel_count("depth", width, height)?;
    let color = decoder.colortype().map_err(broken)?;
    let (bits, channels) = match color {
        ColorType::Gray(bits) => (usize::from(bits), 1),
        // Points, or depth three times.
        ColorType::RGB(bits @ 16..) | ColorType::Multiband { bit_depth: bits @ 16.., num_samples: 3 } => {
            (usize::from(bits), 3)
        }
        other => {
            return Err(unsupported(
                "depth",
                format!("a TIFF of {}", words(other)),
                "one grey channel, or the points x, y, z of a map",
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
    let pixel_bytes = count * channels * bits.div_ceil(8);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = pixel_bytes;
    // The stated size of a strip or tile, which it does not exceed.
    limits.intermediate_buffer_size = pixel_bytes.max(bytes.len());
    limits.ifd_value_size = MAX_ENTRY_BYTES;
    let mut decoder = decoder.with_limits(limits);
    let mut stored = Stored { width, height, bits, is_integer: true };
    stored.check_bits(kind, || format!("a TIFF of {bits} bits a pixel"))?;
    let pixels = decoder.read_image().map_err(broken)?;
    let (values, is_integer) = numbers(pixels);
    stored.is_integer = is_integer;
    if values.len() < count * channels {
        let remedy =
            "Save one image of three, or the points x, y, z of each pixel beside one another (planar configuration 1).";
        return Err(unsupported(
            "depth",
            "a TIFF of three planes: images, or coordinates of points",
            "one plane",
            remedy,
        ));
    }
    // The decoder inverts such samples, which other readers return as they are stored.
    let is_inverted = tag(&mut decoder, Tag::PhotometricInterpretation) == Some(0);
    let most = if is_integer { libm::ldexp(1.0, bits as i32) - 1.0 } else { 1.0 };
    let empty = decoder.get_tag_ascii_string(Tag::GdalNodata).ok().and_then(|text| text.trim().parse::<f64>().ok());
    let value = |z: f64| {
        let z = if is_inverted { most - z } else { z };
        if Some(z) == empty { f64::NAN } else { z }
    };
    let unread = unread(&mut decoder)?;
    check_pages(&mut decoder, [width, height])?;
    let image = if channels == 3 {
        point_map::read(&stored, options, kind, &|i| {
            [0, 1, 2].map(|axis| values.get(3 * i + axis).map_or(f64::NAN, |z| value(*z)))
        })?
    } else {
        stored.read(options, kind, &|i| values.get(i).map_or(f64::NAN, |z| value(*z)))?
    };
    Ok(DepthImage { unread, ..image })
}

type Pages<'a> = Decoder<io::Cursor<&'a [u8]>>;

fn tag(decoder: &mut Pages<'_>, tag: Tag) -> Option<u32> {
    decoder.find_tag_unsigned(tag).ok().flatten()
}

/// The tags that are not known.
fn unread(decoder: &mut Pages<'_>) -> Result<Vec<String>> {
    let is_turned = tag(decoder, Tag::Orientation).is_some_and(|orientation| orientation > 1);
    let tags = decoder.image_ifd();
    let numbers = tags.directory().iter().map(|(tag, _)| tag.to_u16());
    let is_known =
        |number: &u16| TAGS.iter().any(|range| range.contains(number)) || (*number == ORIENTATION && !is_turned);
    Ok(numbers.filter(|number| !is_known(number)).map(|number| format!("tag {number} of the TIFF")).collect())
}

/// Rejects a second page, except for a smaller copy or a mask of the first one.
fn check_pages(decoder: &mut Pages<'_>, size: [usize; 2]) -> Result<()> {
    let mut others = 0_usize;
    let mut first = None;
    while decoder.more_images() && others < MAX_PAGES {
        decoder.next_image().map_err(broken)?;
        if tag(decoder, Tag::NewSubfileType).unwrap_or_default() & NO_PAGE != 0 {
            continue;
        }
        others += 1;
        let (width, height) = decoder.dimensions().map_err(broken)?;
        first.get_or_insert([width as usize, height as usize]);
    }
    let Some([width, height]) = first else { return Ok(()) };
    let pages = if others == MAX_PAGES { "more than 256".to_owned() } else { (others + 1).to_string() };
    Err(unsupported(
        "depth",
        format!("a TIFF of {pages} pages: {} × {}, then {width} × {height} pixels", size[0], size[1]),
        "one page",
        "Save one page: tifffile.imwrite(path, tifffile.imread(stack)[0]).",
    ))
}

/// The samples, and whether they are whole numbers.
fn numbers(pixels: DecodingResult) -> (Vec<f64>, bool) {
    fn of<T: Copy>(values: &[T], number: impl Fn(T) -> f64) -> Vec<f64> {
        values.iter().map(|value| number(*value)).collect()
    }
    match pixels {
        DecodingResult::U8(values) => (of(&values, f64::from), true),
        DecodingResult::U16(values) => (of(&values, f64::from), true),
        DecodingResult::U32(values) => (of(&values, f64::from), true),
        DecodingResult::U64(values) => (of(&values, |z| z as f64), true),
        DecodingResult::I8(values) => (of(&values, f64::from), true),
        DecodingResult::I16(values) => (of(&values, f64::from), true),
        DecodingResult::I32(values) => (of(&values, f64::from), true),
        DecodingResult::I64(values) => (of(&values, |z| z as f64), true),
        DecodingResult::F16(values) => (of(&values, |z| z.to_f64()), false),
        DecodingResult::F32(values) => (of(&values, f64::from), false),
        DecodingResult::F64(values) => (values, false),
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
        TiffError::UnsupportedError(TiffUnsupportedError::UnknownInterpretation) => unsupported(
            "depth",
            "a TIFF with an unknown photometric interpretation, such as LogLuv, which OpenCV 4 turns three floats a pixel into",
            "the numbers as they are",
            "Save the array again with numpy.save or tifffile.imwrite: LogLuv has lost what is negative.",
        ),
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
