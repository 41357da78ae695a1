//! A depth map from a file: its values, their unit, and the camera in the file.

use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::image::{DepthMap, Image};
use sim3align_geometry::pinhole::Pinhole;
use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::number;

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
    /// Whether an 8-bit PNG of three or four channels has the bytes of one number per pixel.
    pub is_packed: bool,
}

/// A depth map from a file.
#[derive(Debug, Clone)]
pub struct DepthImage {
    /// The values: metres for [`DepthKind::Metric`], otherwise as in the file. "No reading" is 0 for metric and
    /// scale-invariant depth, and NaN for the affine-invariant kinds, whose values may be zero or negative.
    pub values: Image<f32>,
    /// The camera in the file, in pixels of the depth map.
    pub camera: Option<Pinhole>,
    /// The unit of the values in the file.
    pub unit: DepthUnit,
    /// Content of the file that its reader does not know.
    pub unread: Vec<String>,
}

/// The unit of the values of a depth map.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthUnit {
    /// Metres per unit; `None` for values whose unit is unknown, or that are no lengths.
    pub metres: Option<f64>,
    /// Where the unit comes from: `depthScale`, `camera file`, `16-bit integers`; the kind of depth without metres.
    pub source: String,
    /// Whether nothing states the unit.
    pub is_assumed: bool,
}

impl DepthUnit {
    fn known(metres: f64, source: &str) -> Self {
        Self { metres: Some(metres), source: source.into(), is_assumed: false }
    }

    fn assumed(metres: f64, source: String) -> Self {
        Self { metres: Some(metres), source, is_assumed: true }
    }

    fn unknown(kind: DepthKind) -> Self {
        Self { metres: None, source: kind.name().into(), is_assumed: false }
    }
}

/// Writes the values from an index on, row-major, over those of a slice.
pub(crate) type Fill<'a> = &'a dyn Fn(usize, &mut [f64]);

/// Calls `visit` with the values of each row of an image of this width and height.
pub(crate) fn each_row([width, height]: [usize; 2], fill: Fill<'_>, visit: &mut dyn FnMut(&[f64])) {
    let mut row = vec![0.0; width];
    for v in 0..height {
        fill(v * width, &mut row);
        visit(&row);
    }
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
    /// [`Self::read_rows`] of values by their index, row-major.
    pub fn read(
        &self,
        options: &DepthReadOptions,
        kind: DepthKind,
        value: &dyn Fn(usize) -> f64,
    ) -> Result<DepthImage> {
        self.read_rows(options, kind, &|start, row| {
            row.iter_mut().enumerate().for_each(|(u, to)| *to = value(start + u));
        })
    }

    /// The depth map of values of which each row is filled, and its unit.
    #[inline(never)]
    pub fn read_rows(&self, options: &DepthReadOptions, kind: DepthKind, fill: Fill<'_>) -> Result<DepthImage> {
        let (scale, unit) = self.unit(options, kind)?;
        let (width, height) = (self.width, self.height);
        let mut values = Vec::with_capacity(width * height);
        each_row([width, height], fill, &mut |row| values.extend(row.iter().map(|value| (value * scale) as f32)));
        let values = match kind {
            DepthKind::Metric | DepthKind::ScaleInvariant => DepthMap::from_metres(width, height, values)?,
            DepthKind::AffineInvariant | DepthKind::AffineInvariantDisparity => {
                let values = values.into_iter().map(|z| if z.is_finite() { z } else { f32::NAN });
                Image::new("depth", width, height, values.collect())?
            }
        };
        Ok(DepthImage { values, camera: None, unit, unread: Vec::new() })
    }

    /// The factor of a value, and its unit. The values of affine-invariant kinds have no factor.
    fn unit(&self, options: &DepthReadOptions, kind: DepthKind) -> Result<(f64, DepthUnit)> {
        let checked = |scale: f64| {
            if scale.is_finite() && scale > 0.0 {
                return Ok(scale);
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
            (DepthKind::AffineInvariant | DepthKind::AffineInvariantDisparity, _)
            | (DepthKind::ScaleInvariant, None) => Ok((1.0, DepthUnit::unknown(kind))),
            (DepthKind::ScaleInvariant, Some(scale)) => Ok((checked(scale)?, DepthUnit::unknown(kind))),
            (DepthKind::Metric, Some(scale)) => Ok((checked(scale)?, DepthUnit::known(scale, "depthScale"))),
            (DepthKind::Metric, None) if !is_integer => Ok((1.0, DepthUnit::assumed(1.0, "float values".into()))),
            (DepthKind::Metric, None) => match options.integer_depth_scale {
                Some(scale) => Ok((checked(scale)?, DepthUnit::known(scale, "camera file"))),
                None => {
                    Ok((DEFAULT_DEPTH_SCALE, DepthUnit::assumed(DEFAULT_DEPTH_SCALE, format!("{bits}-bit integers"))))
                }
            },
        }
    }

    /// Rejects values of 8 bits or less, except for the kinds whose values are often written so.
    #[inline(never)]
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
