//! Depth maps as depth models give them for a photo, made from depth with a known truth.

use super::noise::convolved;
use crate::numbers::median;
use crate::prelude::*;
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align_geometry::depth_kind::DepthKind;

/// The longer side of the images that networks take, and the width of the ramps that they make of edges, pixels.
const NETWORK_PX: f64 = 500.0;
const RAMP_PX: f64 = 3.0;
/// Share of the pixels that an export leaves beyond each end of its range, and its largest value.
const BEYOND: f64 = 2e-4;
const STEPS: f64 = 65535.0;
/// What is added to depth, and the nearest depth of a map, as shares of the distance of the objects.
const SHIFT: f64 = 0.12;
const NEAREST: f64 = 0.02;
/// Range of the factors of maps in an unknown unit.
const ANY_FACTOR: [f64; 2] = [0.3, 3.0];
/// The horizontal field of view of an unknown camera, degrees, and the standard deviation of the logarithm of its focal
/// length.
const GUESSED_VIEW: (f64, f64) = (60.0, 0.25);

named! {
    /// A kind of depth model.
    pub enum DepthModel {
        /// Depth in an unknown unit, with an unknown shift.
        Affine = "affine",
        /// Inverse depth from 0 to 1, in 16 bits.
        Disparity = "disparity",
        /// Metric depth, without the camera.
        NoCamera = "no-camera",
        /// Inverse depth, without the camera.
        DisparityNoCamera = "disparity-no-camera",
    }
}

impl DepthModel {
    /// The map of an image with objects in these masks. Images with other names get other errors.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for an image without objects or readings.
    pub fn predict(self, name: &str, depth: &DepthMap, masks: &[&Mask], camera: Pinhole) -> Result<RawView> {
        let random = &mut Random::new(u64::from(crc32fast::hash(name.as_bytes())), 0);
        let [width, height] = [depth.width(), depth.height()];
        // Models give depth everywhere.
        let farthest = depth.data().iter().copied().fold(0.0, f32::max);
        let filled = |&z: &f32| f64::from(if z > 0.0 { z } else { farthest });
        let z: Vec<f64> = depth.data().iter().map(filled).collect();
        let (kind, values) = match self {
            Self::NoCamera => (DepthKind::Metric, z),
            Self::Affine => {
                let factor = libm::exp(between(random, libm::log(ANY_FACTOR[0]), libm::log(ANY_FACTOR[1])));
                let distance = distance(&z, masks).ok_or_else(|| {
                    let remedy = "Leave this image out.";
                    let found = "no pixel of an object";
                    Error::new(ErrorCode::InvalidArgument, "objects", found, "at least one mask", remedy)
                })?;
                let shift = sign(random) * SHIFT * distance;
                let moved = z.iter().map(|z| factor * (z + shift).max(NEAREST * distance));
                (DepthKind::AffineInvariant, moved.collect())
            }
            Self::Disparity | Self::DisparityNoCamera => {
                let inverse: Vec<f64> = z.iter().map(|z| 1.0 / z).collect();
                let ramp = box_kernel(RAMP_PX * width.max(height) as f64 / NETWORK_PX);
                (DepthKind::AffineInvariantDisparity, exported(&convolved(&inverse, width, &ramp)))
            }
        };
        let values = Image::new("depth", width, height, values.into_iter().map(|x| x as f32).collect())?;
        let (camera, focal) = match self {
            Self::Affine | Self::Disparity => (camera, Focal::Known),
            Self::NoCamera | Self::DisparityNoCamera => {
                let (degrees, deviation) = GUESSED_VIEW;
                let [width, height] = [width, height].map(|side| side as f64);
                let focal = 0.5 * width / libm::tan(0.5 * degrees.to_radians());
                (Pinhole::new(focal, focal, 0.5 * (width - 1.0), 0.5 * (height - 1.0))?, Focal::Guessed(deviation))
            }
        };
        Ok(RawView { values, kind, camera, focal })
    }
}

/// Median distance of the objects.
fn distance(depth: &[f64], masks: &[&Mask]) -> Option<f64> {
    let of = |mask: &&Mask| median(depth.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(z, _)| *z).collect());
    median(masks.iter().filter_map(of).collect())
}

/// Inverse depth as exports have it: from 0 to 1 over the image, in steps.
fn exported(inverse: &[f64]) -> Vec<f64> {
    let mut sorted = inverse.to_vec();
    sorted.sort_by(f64::total_cmp);
    let beyond = (BEYOND * sorted.len() as f64) as usize;
    let (low, high) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
    let range = (high - low).max(1e-6 * high);
    inverse.iter().map(|x| (((x - low) / range).clamp(0.0, 1.0) * STEPS).round() / STEPS).collect()
}

/// The middle and one side of a box kernel, whose width in pixels need not be whole.
fn box_kernel(width: f64) -> Vec<f64> {
    let half = 0.5 * width.max(1.0);
    (0..=half.ceil() as usize).map(|i| (half + 0.5 - i as f64).clamp(0.0, 1.0)).collect()
}
