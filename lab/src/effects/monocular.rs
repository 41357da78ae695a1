//! Depth maps as depth models give them for a photo, made from exact depth.

use super::noise::{convolved, gaussian};
use crate::numbers::median;
use crate::prelude::*;
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align_geometry::depth_kind::DepthKind;

/// Deviation of the blur of edges, as a share of the width of an image.
const BLUR: f64 = 0.002;
/// Affine maps: a range of factors, and what is added, as a share of the distance of the objects.
const FACTOR: [f64; 2] = [0.3, 3.0];
const SHIFT: f64 = 0.12;
/// The horizontal field of view of an unknown camera, degrees, and the standard deviation of the logarithm of its focal
/// length.
const GUESSED_VIEW: (f64, f64) = (60.0, 0.25);

named! {
    /// A kind of depth model.
    pub enum DepthModel {
        /// Depth in an unknown unit, with an unknown shift.
        Affine = "affine",
        /// Inverse depth from 0 to 1.
        Disparity = "disparity",
        /// Metric depth, without the camera.
        NoCamera = "no-camera",
        /// Inverse depth, without the camera.
        DisparityNoCamera = "disparity-no-camera",
    }
}

impl DepthModel {
    /// The map of an image with an object in this mask. The draws follow from the name of the image.
    pub fn predict(self, name: &str, depth: &DepthMap, mask: &Mask, camera: Pinhole) -> Result<RawView> {
        let random = &mut Random::new(u64::from(crc32fast::hash(name.as_bytes())), 0);
        let [width, height] = [depth.width(), depth.height()];
        // Models give depth everywhere.
        let farthest = depth.data().iter().copied().fold(0.0, f32::max);
        let filled = |&z: &f32| f64::from(if z > 0.0 { z } else { farthest });
        let mut values: Vec<f64> = depth.data().iter().map(filled).collect();
        let kind = match self {
            Self::NoCamera => DepthKind::Metric,
            Self::Affine => {
                let object = values.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(z, _)| *z);
                let shift = sign(random) * SHIFT * median(object.collect()).unwrap_or_default();
                let factor = libm::exp(between(random, libm::log(FACTOR[0]), libm::log(FACTOR[1])));
                values.iter_mut().for_each(|z| *z = factor * (*z + shift).max(0.0));
                DepthKind::AffineInvariant
            }
            Self::Disparity | Self::DisparityNoCamera => {
                let inverse: Vec<f64> = values.iter().map(|z| 1.0 / z).collect();
                values = convolved(&inverse, width, &gaussian(BLUR * width as f64));
                let (low, high) = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
                values.iter_mut().for_each(|x| *x = (*x - low) / (high - low).max(1e-6 * high));
                DepthKind::AffineInvariantDisparity
            }
        };
        let (camera, focal) = if matches!(self, Self::Affine | Self::Disparity) {
            (camera, Focal::Known)
        } else {
            let (degrees, deviation) = GUESSED_VIEW;
            let [width, height] = [width, height].map(|side| side as f64);
            let focal = 0.5 * width / libm::tan(0.5 * degrees.to_radians());
            (Pinhole::new(focal, focal, 0.5 * (width - 1.0), 0.5 * (height - 1.0))?, Focal::Guessed(deviation))
        };
        let values = Image::new("depth", width, height, values.into_iter().map(|x| x as f32).collect())?;
        Ok(RawView { values, kind, camera, focal })
    }
}
