//! Calibrations: the numbers of a view that were unknown.

use serde::Serialize;

use crate::geometry::depth_kind::DepthKind;
use crate::geometry::pinhole::Pinhole;

/// Largest depth that a disparity stands for, in the unit of the result: a shift may put what is far behind infinity.
const FARTHEST: f64 = 1e3;

/// The numbers that make a depth map and a camera of a raw view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// s: see [`DepthKind`].
    pub scale: f64,
    /// t, in the unit of the values.
    pub shift: f64,
    /// The focal length relative to that of the view's camera.
    pub focal: f64,
}

impl Default for Calibration {
    fn default() -> Self {
        Self { scale: 1.0, shift: 0.0, focal: 1.0 }
    }
}

impl Calibration {
    /// The depth of a value; not a number for one that is no reading.
    pub fn depth(&self, kind: DepthKind, value: f64) -> f64 {
        let Self { scale, shift, .. } = *self;
        match kind {
            // `f64::max` below would ignore it.
            _ if !value.is_finite() => f64::NAN,
            DepthKind::Metric | DepthKind::ScaleInvariant => value * scale,
            DepthKind::AffineInvariant => (value + shift) * scale,
            DepthKind::AffineInvariantDisparity => scale / (value + shift).max(scale / FARTHEST),
        }
    }
}

/// What a depth map and its lens were taken to be. With d for a value of the depth map, the depth z is s·d for metric and
/// scale-invariant depth, s·(d + t) for affine-invariant depth, s / (d + t) for affine-invariant disparity.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct DepthCalibration {
    /// The kind of the values.
    #[cfg_attr(
        feature = "types",
        ts(type = "\"metric\" | \"scale-invariant\" | \"affine-invariant\" | \"affine-invariant-disparity\"")
    )]
    pub depth_kind: DepthKind,
    /// Whether z is in metres: the depth is, or a known length of an object has made it so. Otherwise, all lengths of the
    /// result are in a unit of their own: that of the values of scale-invariant depth, else the distance of the objects.
    pub is_metric: bool,
    /// s.
    pub scale: f64,
    /// t, in the unit of the values.
    pub shift: f64,
    /// The intrinsics, in pixels of the depth map.
    #[cfg_attr(feature = "types", ts(type = "{ fx: number; fy: number; cx: number; cy: number }"))]
    pub camera: Pinhole,
    /// Whether the focal length was estimated.
    pub is_focal_estimated: bool,
    /// How well these numbers are determined.
    pub uncertainty: CalibrationUncertainty,
}

/// Standard deviations of what was estimated; 0 for what was known.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct CalibrationUncertainty {
    /// Of the distance of the objects that the shift leaves, relative to it: 0.01 is one per cent.
    pub shift: f64,
    /// Of the focal length, relative to it.
    pub focal: f64,
}

impl CalibrationUncertainty {
    /// Of the relief of the objects beside their width, relative to it: the shift determines it together with the focal
    /// length, and where the shift is known, that alone.
    pub fn relief(&self) -> f64 {
        let Self { shift, focal } = *self;
        if shift > 0.0 { libm::sqrt((shift * shift - focal * focal).max(0.0)) } else { focal }
    }
}

impl DepthCalibration {
    /// The calibration of a view.
    pub fn new(
        depth_kind: DepthKind,
        calibration: Calibration,
        camera: Pinhole,
        uncertainty: CalibrationUncertainty,
        is_metric: bool,
    ) -> Self {
        let Calibration { scale, shift, .. } = calibration;
        let is_focal_estimated = uncertainty.focal > 0.0;
        Self { depth_kind, is_metric, scale, shift, camera, is_focal_estimated, uncertainty }
    }
}
