//! Raw views: values of a depth map of any kind, and a camera whose focal length may be a guess.

use super::calibration::Calibration;
use crate::error::Result;
use crate::geometry::depth_kind::DepthKind;
use crate::geometry::image::{DepthMap, Image};
use crate::geometry::pinhole::Pinhole;

/// The knowledge of a focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Focal {
    /// It is known.
    Known,
    /// It is a guess with this standard deviation of its logarithm.
    Guessed(f64),
}

/// A view as it was given.
#[derive(Debug, Clone)]
pub struct RawView {
    /// The values; those that are not finite are no readings.
    pub values: Image<f32>,
    /// Their kind.
    pub kind: DepthKind,
    /// The camera, of which only the focal length may be a guess.
    pub camera: Pinhole,
    /// The knowledge of its focal length.
    pub focal: Focal,
}

impl RawView {
    /// The depth map of a calibration. Depths that are not positive are no readings.
    ///
    /// # Errors
    /// Those of [`DepthMap::from_metres`].
    pub fn depth(&self, calibration: &Calibration) -> Result<DepthMap> {
        let depth = |d: &f32| calibration.depth(self.kind, f64::from(*d)) as f32;
        let (width, height) = (self.values.width(), self.values.height());
        DepthMap::from_metres(width, height, self.values.data().iter().map(depth).collect())
    }

    /// The camera of a calibration.
    pub fn camera(&self, calibration: &Calibration) -> Pinhole {
        let Pinhole { fx, fy, .. } = self.camera;
        Pinhole { fx: fx * calibration.focal, fy: fy * calibration.focal, ..self.camera }
    }
}
