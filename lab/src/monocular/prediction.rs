//! What a model gives for an image, and what is true.

use super::calibration::Calibration;
use super::faults::{FocalFault, Output};
use super::filling::filled;
use super::picture::Picture;
use super::row::{GUESSED_RANGE_M, Row};
use super::smoothing::{blurred, ramped};
use crate::bench::statistics::median;
use crate::prelude::*;
use sim3align_geometry::depth_kind::DepthKind;

/// The longer side of the images that networks take, pixels.
const NETWORK_PX: f64 = 500.0;
/// The nearest depth that a model gives, as a share of the distance of the objects.
const NEAREST: f64 = 0.02;
/// Share of the pixels that an export leaves beyond each end of its range.
const BEYOND: f64 = 2e-4;
/// The relative standard deviation of a focal length that is doubted.
pub const FOCAL_DOUBT: f64 = 0.1;

/// The focal length as it is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GivenCamera {
    /// Calibrated.
    Known(Pinhole),
    /// Its focal lengths are off by an unknown factor of this relative standard deviation.
    Doubted(Pinhole, f64),
    /// None.
    Unknown,
}

/// An image as a model sees it.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// What is said of the map.
    pub kind: DepthKind,
    /// The map, row-major, in its own unit.
    pub map: Image<f32>,
    /// The camera as it is given.
    pub camera: GivenCamera,
    /// What turns the map into metres, but for bends and blur.
    pub truth: Calibration,
    /// Median depth of the objects, metres.
    pub distance: f64,
}

impl Prediction {
    /// What a model with the errors of a row gives. Images with other names or seeds get other errors.
    ///
    /// # Errors
    /// Those of [`filled`], and [`ErrorCode::InvalidArgument`] for an image without objects.
    pub fn new(picture: &Picture, row: Row, seed: u64) -> Result<Self> {
        let masks: Vec<&Mask> = picture.objects.iter().map(|object| &object.mask).collect();
        Self::of_filled(picture, filled(&picture.depth, &masks)?, row, seed)
    }

    /// The same for a picture whose depth has been [`filled`].
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for an image without objects.
    pub fn of_filled(picture: &Picture, mut depth: Vec<f64>, row: Row, seed: u64) -> Result<Self> {
        let (width, height) = (picture.depth.width(), picture.depth.height());
        let faults = row.faults(mixed([seed, u64::from(crc32fast::hash(picture.name.as_bytes()))]));
        let (distance, object_width_px) = extent(picture, &depth)?;

        if let Some(bend) = &faults.bend {
            bend.apply(&mut depth, width, object_width_px);
        }
        let is_disparity = !matches!(faults.output, Output::Depth);
        let network_px = width.max(height) as f64 / NETWORK_PX;
        let soften = |values: &[f64]| {
            let ramp = if picture.has_steps { faults.ramp * network_px } else { 0.0 };
            ramped(&blurred(values, width, faults.blur * object_width_px), width, ramp)
        };
        let inverse = |values: &[f64]| -> Vec<f64> { values.iter().map(|z| 1.0 / z).collect() };
        // A network blurs its own output.
        depth = if is_disparity || faults.is_inverse { inverse(&soften(&inverse(&depth))) } else { soften(&depth) };

        let (map, truth) = match faults.output {
            Output::Depth => {
                let shift = faults.shift * distance;
                let nearest = NEAREST * distance;
                let map: Vec<f64> = depth.iter().map(|z| faults.factor * (z + shift).max(nearest)).collect();
                let factor = faults.factor;
                let truth = Calibration {
                    is_inverse: false,
                    scale: 1.0 / factor,
                    shift: -factor * shift,
                    camera: picture.camera,
                };
                (map, truth)
            }
            Output::Disparity { bits } => exported(&inverse(&depth), bits, picture.camera),
            Output::GuessedDepth { bits } => {
                let (map, truth) = exported(&inverse(&depth), bits, picture.camera);
                let guess = guessed_range(&truth);
                (map.iter().map(|value| guess.depth(*value)).collect(), truth)
            }
        };
        let camera = match faults.focal {
            FocalFault::None => GivenCamera::Known(picture.camera),
            FocalFault::Wrong(factor) => {
                let Pinhole { fx, fy, .. } = picture.camera;
                let wrong = Pinhole { fx: factor * fx, fy: factor * fy, ..picture.camera };
                GivenCamera::Doubted(wrong, FOCAL_DOUBT)
            }
            FocalFault::Unknown => GivenCamera::Unknown,
        };
        let map = Image::new("depth", width, height, map.into_iter().map(|x| x as f32).collect())?;
        Ok(Self { kind: row.kind(), map, camera, truth, distance })
    }
}

/// The calibration of an export from 0 to 1 by a guess of near and far.
pub(super) fn guessed_range(export: &Calibration) -> Calibration {
    let [near, far] = GUESSED_RANGE_M.map(|z| 1.0 / z);
    Calibration { scale: near - far, shift: far / (near - far), ..*export }
}

/// Inverse depth as exports have it: from 0 to 1 over the image, in steps.
fn exported(inverse: &[f64], bits: u32, camera: Pinhole) -> (Vec<f64>, Calibration) {
    let mut sorted = inverse.to_vec();
    sorted.sort_by(f64::total_cmp);
    let beyond = (BEYOND * sorted.len() as f64) as usize;
    let (low, high) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
    let range = (high - low).max(1e-6 * high);
    let steps = f64::from((1u32 << bits) - 1);
    let map = inverse.iter().map(|x| (((x - low) / range).clamp(0.0, 1.0) * steps).round() / steps).collect();
    (map, Calibration { is_inverse: true, scale: range, shift: low / range, camera })
}

/// Median distance of the objects, metres, and their median width, pixels.
fn extent(picture: &Picture, depth: &[f64]) -> Result<(f64, f64)> {
    let of = |mask: &Mask| -> Option<f64> {
        median(depth.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(z, _)| *z).collect())
    };
    let distances = picture.objects.iter().filter_map(|object| of(&object.mask)).collect();
    let widths = picture.objects.iter().map(|object| object.width_px()).collect();
    median(distances).zip(median(widths)).ok_or_else(|| {
        let remedy = "Leave this image out.";
        Error::new(ErrorCode::InvalidArgument, "objects", "no pixel of an object", "at least one mask", remedy)
    })
}
