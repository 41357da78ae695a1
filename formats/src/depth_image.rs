//! A depth map from a file: its values, their unit, and the camera in the file.

use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::image::{DepthMap, Image};
use sim3align_geometry::number::number;
use sim3align_geometry::pinhole::Pinhole;

/// Default unit of integer depth in metres: millimetres, as most sensors write them.
pub const DEFAULT_DEPTH_SCALE: f64 = 0.001;

/// Options of the readers of depth.
#[derive(Debug, Clone, Copy, Default)]
pub struct DepthReadOptions {
    /// Metres per unit, for integers and floats; above 0.
    pub depth_scale: Option<f64>,
    /// Metres per unit of integer depth if `depth_scale` is `None`, for example from a camera file. If both are `None`,
    /// [`DEFAULT_DEPTH_SCALE`] applies. Floats are then in metres.
    pub integer_depth_scale: Option<f64>,
}

/// A depth map from a file.
#[derive(Debug, Clone)]
pub struct DepthImage {
    /// The values: metres for [`DepthKind::Metric`], otherwise as in the file. "No reading" is 0 for metric and
    /// scale-invariant depth, and NaN for the affine-invariant kinds, whose values may be zero or negative.
    pub values: Image<f32>,
    /// The camera in the file, in pixels of the depth map.
    pub camera: Option<Pinhole>,
    /// The unit of the values in the file and why it was taken: `metres (float values, assumed)`, `0.0002 m (depthScale)`.
    pub unit: String,
}

/// The numbers of a depth file, as its reader passes them on.
pub(crate) struct Stored {
    pub width: usize,
    pub height: usize,
    /// Bits per value.
    pub bits: usize,
    pub is_integer: bool,
}

impl Stored {
    /// The depth map of these values, row-major, and its unit.
    pub fn read(
        &self,
        options: &DepthReadOptions,
        kind: DepthKind,
        values: impl Iterator<Item = f64>,
    ) -> Result<DepthImage> {
        let (scale, unit) = self.unit(options, kind)?;
        let values = values.map(|z| (z * scale) as f32);
        let (width, height) = (self.width, self.height);
        let values = match kind {
            DepthKind::Metric | DepthKind::ScaleInvariant => DepthMap::from_metres(width, height, values.collect())?,
            DepthKind::AffineInvariant | DepthKind::AffineInvariantDisparity => {
                let values = values.map(|z| if z.is_finite() { z } else { f32::NAN });
                Image::new("depth", width, height, values.collect())?
            }
        };
        Ok(DepthImage { values, camera: None, unit })
    }

    /// The factor of a value, and its unit for people. The values of affine-invariant kinds have no unit.
    fn unit(&self, options: &DepthReadOptions, kind: DepthKind) -> Result<(f64, String)> {
        let checked = |scale: f64, source: &str| {
            if scale.is_finite() && scale > 0.0 {
                return Ok((scale, format!("{} m ({source})", number(scale))));
            }
            Err(Error::new(
                ErrorCode::InvalidOption,
                "options.depthScale",
                number(scale),
                "a finite number above 0",
                "Pass metres per unit: 0.001 for millimetres, 0.0002 for TUM RGB-D.",
            ))
        };
        let Self { bits, is_integer, .. } = *self;
        match (kind, options.depth_scale) {
            (DepthKind::AffineInvariant | DepthKind::AffineInvariantDisparity, _) => {
                Ok((1.0, format!("none ({})", kind.name())))
            }
            (_, Some(scale)) => checked(scale, "depthScale"),
            (DepthKind::ScaleInvariant, None) => Ok((1.0, format!("unknown ({})", kind.name()))),
            (DepthKind::Metric, None) if !is_integer => Ok((1.0, "metres (float values, assumed)".into())),
            (DepthKind::Metric, None) => match options.integer_depth_scale {
                Some(scale) => checked(scale, "camera file"),
                None => checked(DEFAULT_DEPTH_SCALE, &format!("{bits}-bit integers, assumed")),
            },
        }
    }

    /// Rejects values of 8 bits or less, except for the kinds whose values are often written so.
    pub fn check_bits(&self, kind: DepthKind, found: impl FnOnce() -> String) -> Result<()> {
        let is_affine = matches!(kind, DepthKind::AffineInvariant | DepthKind::AffineInvariantDisparity);
        if self.bits > 8 || is_affine {
            return Ok(());
        }
        Err(Error::new(
            ErrorCode::EightBitDepth,
            "depth",
            found(),
            "16 bits or more a pixel",
            "256 steps are a picture of the depth (mostly normalised or inverted), not metres: \
             save the depth itself, with numpy.save or as 16-bit PNG in millimetres. If it is the picture that a \
             relative model draws, near is bright: pass depthKind \"affine-invariant-disparity\".",
        ))
    }
}
