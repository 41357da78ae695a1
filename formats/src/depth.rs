//! Depth map files.

use crate::guard::{beginning, unsupported};
use crate::npy::{self, Kind, NpyImage};
use crate::png::{self, PngInfo};
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::image::DepthMap;

/// Default unit of integer depth in metres: millimetres, as most sensors write them.
pub const DEFAULT_DEPTH_SCALE: f64 = 0.001;

/// Options of [`read_depth`].
#[derive(Debug, Clone, Copy, Default)]
pub struct DepthReadOptions {
    /// Metres per unit, for integers and floats; above 0.
    pub depth_scale: Option<f64>,
    /// Metres per unit of integer depth if `depth_scale` is `None`, for example from a camera file. If both are `None`,
    /// [`DEFAULT_DEPTH_SCALE`] applies. Floats are then in metres.
    pub integer_depth_scale: Option<f64>,
}

impl DepthReadOptions {
    fn scale(&self, is_integer: bool) -> Result<f64> {
        let scale = match (self.depth_scale, is_integer) {
            (Some(scale), _) => scale,
            (None, true) => self.integer_depth_scale.unwrap_or(DEFAULT_DEPTH_SCALE),
            (None, false) => 1.0,
        };
        if scale.is_finite() && scale > 0.0 {
            return Ok(scale);
        }
        Err(Error::new(
            ErrorCode::InvalidOption,
            "options.depthScale",
            format!("{scale}"),
            "a finite number above 0",
            "Pass metres per unit: 0.001 for millimetres, 0.0002 for TUM RGB-D.",
        ))
    }
}

/// Reads depth in metres: a 16-bit grey PNG, or a `.npy` array (H×W, H×W×1 or 1×H×W) of integers of 16 bits or
/// more, or floats. Zero, negative, NaN and infinite values become 0, "no reading".
///
/// # Errors
/// [`ErrorCode::EightBitDepth`], [`ErrorCode::UnsupportedFormat`], [`ErrorCode::CorruptFile`],
/// [`ErrorCode::FileTooLarge`], [`ErrorCode::EmptyImage`], [`ErrorCode::InvalidOption`].
pub fn read_depth(bytes: &[u8], options: &DepthReadOptions) -> Result<DepthMap> {
    if bytes.starts_with(png::MAGIC) {
        return read_png(bytes, options.scale(true)?);
    }
    if bytes.starts_with(npy::MAGIC) {
        return read_npy(bytes, options);
    }
    Err(unsupported(
        "depth",
        beginning(bytes),
        "a 16-bit grey PNG or a .npy array",
        "Save the depth with numpy.save, or as 16-bit PNG in millimetres.",
    ))
}

fn read_png(bytes: &[u8], depth_scale: f64) -> Result<DepthMap> {
    let info = PngInfo::read("depth", bytes)?;
    if info.bit_depth < 16 {
        let article = if info.bit_depth == 8 { "an" } else { "a" };
        return Err(eight_bit(format!("{article} {}-bit PNG", info.bit_depth)));
    }
    if !info.is_grey {
        return Err(unsupported(
            "depth",
            "a 16-bit PNG with colour or alpha",
            "one grey channel",
            "Pass the raw depth map, not a rendering of it.",
        ));
    }
    let pixels = info.decode("depth", bytes)?;
    let samples = pixels.samples.chunks_exact(pixels.channels.max(1));
    let metres = samples.map(|pixel| pixel.first().map_or(0.0, |&z| (f64::from(z) * depth_scale) as f32)).collect();
    DepthMap::from_metres(info.width, info.height, metres)
}

fn read_npy(bytes: &[u8], options: &DepthReadOptions) -> Result<DepthMap> {
    let array = NpyImage::read("depth", bytes)?;
    if array.size == 1 {
        return Err(eight_bit("an array of 8-bit elements".into()));
    }
    let scale = options.scale(array.kind != Kind::Float)?;
    DepthMap::from_metres(array.width, array.height, array.values().map(|z| (z * scale) as f32).collect())
}

fn eight_bit(found: String) -> Error {
    Error::new(
        ErrorCode::EightBitDepth,
        "depth",
        found,
        "16 bits or more a pixel",
        "256 steps are a picture of the depth (mostly normalised or inverted), not metres: \
         save the depth itself, with numpy.save or as 16-bit PNG in millimetres.",
    )
}
