//! Depth map files: PNG and `.npy`, and those that depth models and renderers write: `.npz`, `.exr`, `.tiff` and `.pfm`.

use crate::cursor::Cursor;
use crate::depth_image::Stored;
pub use crate::depth_image::{DEFAULT_DEPTH_SCALE, DepthImage, DepthReadOptions, DepthUnit};
use crate::guard::{beginning, unsupported};
use crate::npy::{self, Kind, NpyImage, NpyPoints};
use crate::png::{self, PngInfo, PngPixels};
use crate::{exr, npz, pfm, point_map, tiff};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::image::DepthMap;
use sim3align_runtime::error::Result;

/// The formats of depth models, by their signatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    /// NumPy's archive of arrays, a ZIP.
    Npz,
    /// OpenEXR.
    Exr,
    /// TIFF, of either byte order.
    Tiff,
    /// Portable float map, one channel (`Pf`) or three (`PF`).
    Pfm,
    /// NumPy's array, of depth or of points.
    Npy,
}

/// The first bytes of each format.
const SIGNATURES: [(&[u8], Format); 14] = [
    (b"PK\x03\x04", Format::Npz),
    // An archive without entries.
    (b"PK\x05\x06", Format::Npz),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"II*\0", Format::Tiff),
    (b"MM\0*", Format::Tiff),
    // BigTIFF.
    (b"II+\0", Format::Tiff),
    (b"MM\0+", Format::Tiff),
    (b"Pf\n", Format::Pfm),
    (b"PF\n", Format::Pfm),
    (b"Pf\r", Format::Pfm),
    (b"PF\r", Format::Pfm),
    (b"Pf ", Format::Pfm),
    (b"PF ", Format::Pfm),
    (npy::MAGIC, Format::Npy),
];

impl Format {
    /// The format of a file that begins like this.
    fn of(bytes: &[u8]) -> Option<Self> {
        SIGNATURES.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|&(_, format)| format)
    }
}

/// Reads metric depth in metres from any supported file: those of [`read_depth_image`] and of
/// [`read_depth_file`]. Zero, negative, NaN and infinite values become 0, "no reading".
///
/// # Errors
/// Those of [`read_depth_image`] and of [`read_depth_file`].
pub fn read_depth(bytes: &[u8], options: &DepthReadOptions) -> Result<DepthMap> {
    let read = if Format::of(bytes).is_some() { read_depth_file } else { read_depth_image };
    Ok(read(bytes, options, DepthKind::Metric)?.values)
}

/// Reads depth from a grey PNG, or from a `.npy` array (H×W, also with further axes of length 1) of integers or floats.
/// For the affine-invariant kinds, they may have 8 bits; otherwise, they need 16 or more.
///
/// # Errors
/// [`ErrorCode::EightBitDepth`], [`ErrorCode::UnsupportedFormat`], [`ErrorCode::CorruptFile`],
/// [`ErrorCode::FileTooLarge`], [`ErrorCode::EmptyImage`], [`ErrorCode::InvalidOption`].
pub fn read_depth_image(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    if bytes.starts_with(png::MAGIC) {
        return read_png(bytes, options, kind);
    }
    if bytes.starts_with(npy::MAGIC) {
        return read_npy(bytes, options, kind);
    }
    if bytes.get(ROS_HEADER_BYTES..).is_some_and(|rest| rest.starts_with(png::MAGIC)) {
        return Err(unsupported(
            "depth",
            "a PNG behind 12 bytes: the data of a compressedDepth message of ROS",
            "the PNG alone",
            "Pass the bytes from the 13th on for 16UC1. For 32FC1, decode them: a / (v - b), a and b being the floats at the bytes 4 and 8.",
        ));
    }
    if is_rvl(bytes) {
        return Err(unsupported(
            "depth",
            "RVL: the data of a compressedDepth message of ROS",
            "a PNG, or the decoded pixels",
            "Decode it, and save the depth with numpy.save; or set the format of compressed_depth_image_transport to png.",
        ));
    }
    if RECORDINGS.iter().any(|magic| bytes.starts_with(magic)) {
        return Err(unsupported(
            "depth",
            "a recording of ROS (MCAP, bag or SQLite)",
            "one depth image",
            "Save the image of one message with numpy.save: the Python packages mcap and rosbags read recordings.",
        ));
    }
    Err(unsupported(
        "depth",
        beginning(bytes),
        "a 16-bit grey PNG, a .npy array, or a .npz, .exr, .tiff or .pfm file",
        "Save the depth with numpy.save, or as 16-bit PNG in millimetres.",
    ))
}

/// The configuration that compressed_depth_image_transport puts before the image; whether its numbers are used, it doesn't say.
const ROS_HEADER_BYTES: usize = 12;

/// The beginnings of recordings.
const RECORDINGS: [&[u8]; 3] = [b"\x89MCAP0\r\n", b"#ROSBAG V", b"SQLite format 3\0"];

/// Whether an RVL image may follow that configuration: width, height, then 32-bit words, at most one per pixel.
fn is_rvl(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new("depth", bytes);
    let sides = cursor.take(ROS_HEADER_BYTES).and_then(|_| Ok([cursor.u32_le()?, cursor.u32_le()?]));
    let Ok(sides) = sides.map(|sides| sides.map(|side| side as usize)) else { return false };
    let (words, rest) = (cursor.remaining().len() / 4, cursor.remaining().len() % 4);
    let is_size = sides.iter().all(|side| (8..=16_384).contains(side));
    is_size && rest == 0 && (1..=sides[0] * sides[1]).contains(&words)
}

fn read_png(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let info = PngInfo::read("depth", bytes)?;
    let bits = usize::from(info.bit_depth);
    let stored = Stored { width: info.width, height: info.height, bits, is_integer: true };
    let article = if bits == 8 { "an" } else { "a" };
    if !options.is_packed {
        stored.check_bits(kind, || format!("{article} {bits}-bit PNG"))?;
    }
    let pixels = info.decode("depth", bytes)?;
    let channels = pixels.channels.max(1);
    if options.is_packed && bits == 8 && channels > 2 && info.first_palette_colour.is_none() {
        return stored.read(options, kind, &|i| packed(&pixels, i));
    }
    // Some programs repeat the depth in three channels.
    let is_grey = |pixel: &[u16]| pixel.iter().take(pixels.colours()).all(|sample| Some(sample) == pixel.first());
    if info.first_palette_colour.is_some() || !pixels.samples.chunks_exact(channels).all(is_grey) {
        return Err(unsupported(
            "depth",
            format!("{article} {bits}-bit PNG with colours"),
            "one grey channel, or three equal ones",
            "Pass the raw depth map, not a rendering of it.",
        ));
    }
    stored.read_rows(options, kind, &|start, row| {
        let samples = pixels.samples.get(start * channels..).unwrap_or_default();
        row.iter_mut().zip(samples.iter().step_by(channels)).for_each(|(to, &z)| *to = z.into());
    })
}

/// Of a pixel: red + 256 · green + 65536 · blue; or, with an alpha below 255, the 32-bit float with the bytes blue, green, red
/// and alpha.
fn packed(pixels: &PngPixels, index: usize) -> f64 {
    match pixels.samples.get(index * pixels.channels..) {
        Some(&[r, g, b, a, ..]) if pixels.has_alpha() && a < 255 => {
            f32::from_le_bytes([b, g, r, a].map(|x| x as u8)).into()
        }
        Some(&[r, g, b, ..]) => f64::from(r) + 256.0 * f64::from(g) + 65536.0 * f64::from(b),
        _ => 0.0,
    }
}

fn read_npy(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let array = NpyImage::read("depth", bytes)?;
    let bits = 8 * array.header().size;
    let is_integer = array.header().kind != Kind::Float;
    let stored = Stored { width: array.width, height: array.height, bits, is_integer };
    stored.check_bits(kind, || "an array of 8-bit elements".into())?;
    stored.read_rows(options, kind, &|start, row| array.fill(start, row))
}

/// Reads depth from an `.npz`, `.exr`, `.tiff`, `.pfm` or `.npy` file, with the camera in it. Three values per pixel are a point
/// map (H×W×3, in arrays also 3×H×W), whose camera is fitted.
///
/// - `.npz`: an array with one of the usual names of depth (`depth`, `pred_depth`, …) or of a point map, or the only
///   two-dimensional array of floats; pixels that are false in `mask` or `valid` have no reading; intrinsics in pixels
///   or, as MoGe writes them, in image sizes; a focal length in pixels or a field of view in degrees.
/// - `.exr`: a channel that is named as depth, the only one, or X, Y and Z.
/// - `.tiff`, `.pfm`: one channel of floats or of integers, or three.
///
/// # Errors
/// [`ErrorCode`](sim3align_runtime::error::ErrorCode)`::EightBitDepth`, `UnsupportedFormat`, `CorruptFile`,
/// `FileTooLarge`, `EmptyImage`, `SizeMismatch` for a mask of another size, `InvalidCamera`, `InvalidOption`.
pub fn read_depth_file(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    match Format::of(bytes) {
        Some(Format::Npz) => npz::read_depth(bytes, options, kind),
        Some(Format::Exr) => exr::read_depth(bytes, options, kind),
        Some(Format::Tiff) => tiff::read_depth(bytes, options, kind),
        Some(Format::Pfm) => pfm::read_depth(bytes, options, kind),
        Some(Format::Npy) => match NpyPoints::read(bytes)? {
            None => read_npy(bytes, options, kind),
            Some(map) => point_map::read(&map.stored(), options, kind, &|i| map.point(i)),
        },
        None => Err(unsupported(
            "depth",
            beginning(bytes),
            "a .npz, .exr, .tiff or .pfm file",
            "Save the depth with numpy.savez, or as 16-bit PNG in millimetres.",
        )),
    }
}
