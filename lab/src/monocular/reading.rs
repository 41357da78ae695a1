//! How a map is taken for metres by who does not estimate what is unknown: the baseline.

use super::calibration::Calibration;
use super::prediction::{GivenCamera, Prediction, guessed_range};
use crate::prelude::*;
use sim3align_geometry::depth_kind::DepthKind;

/// The horizontal field of view of an unknown camera.
const GUESSED_VIEW_DEG: f64 = 60.0;

/// Depth in metres as far as anybody can tell, and what was assumed.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Depth.
    pub depth: DepthMap,
    /// What was assumed of the map.
    pub assumed: Calibration,
}

impl Reading {
    /// Depth as it is, without shift, inverse depth between a guessed near and far; the camera as it is given or, without
    /// one, of 60° across.
    ///
    /// # Errors
    /// Those of [`Pinhole::new`] and of [`DepthMap::from_metres`].
    pub fn naive(prediction: &Prediction) -> Result<Self> {
        let (width, height) = (prediction.map.width(), prediction.map.height());
        let camera = match prediction.camera {
            GivenCamera::Known(camera) | GivenCamera::Doubted(camera, _) => camera,
            GivenCamera::Unknown => {
                let focal = 0.5 * width as f64 / libm::tan(0.5 * GUESSED_VIEW_DEG.to_radians());
                Pinhole::new(focal, focal, 0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0))?
            }
        };
        let as_is = Calibration::of_metres(camera);
        let assumed = match prediction.kind {
            DepthKind::AffineInvariantDisparity => guessed_range(&Calibration { is_inverse: true, ..as_is }),
            _ => as_is,
        };
        let metres = prediction.map.data().iter().map(|value| assumed.depth(f64::from(*value)) as f32).collect();
        Ok(Self { depth: DepthMap::from_metres(width, height, metres)?, assumed })
    }
}
