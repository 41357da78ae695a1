//! What turns a map of a model into depth in a camera.

use serde::Serialize;

use crate::prelude::*;

/// Scale, shift and focal length: those of the truth, or those that somebody assumed or estimated.
///
/// Depth is scale · (value + shift), or its inverse is, for disparity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Calibration {
    /// Whether values are inverse depth.
    pub is_inverse: bool,
    /// Metres, or 1/metres, per unit of the map.
    pub scale: f64,
    /// In units of the map.
    pub shift: f64,
    /// The camera.
    pub camera: Pinhole,
}

impl Calibration {
    /// Depth as it is, in a camera.
    pub fn of_metres(camera: Pinhole) -> Self {
        Self { is_inverse: false, scale: 1.0, shift: 0.0, camera }
    }

    /// The depth of a value of the map, metres.
    pub fn depth(&self, value: f64) -> f64 {
        let line = self.scale * (value + self.shift);
        if self.is_inverse { 1.0 / line } else { line }
    }

    /// The value of the map at a depth, metres.
    pub fn value(&self, depth: f64) -> f64 {
        let line = if self.is_inverse { 1.0 / depth } else { depth };
        line / self.scale - self.shift
    }

    /// The error of the shift at a depth, as a share of the distance from there to where the map is 0 in truth; for
    /// depth, to the camera. It is the share by which the relief of an object at that depth is wrong.
    pub fn shift_error(&self, truth: &Self, depth: f64) -> f64 {
        (self.shift - truth.shift) / (truth.value(depth) + truth.shift)
    }

    /// The error of the focal length, as a share.
    pub fn focal_error(&self, truth: &Self) -> f64 {
        self.camera.fx / truth.camera.fx - 1.0
    }
}
