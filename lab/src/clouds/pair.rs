//! Pairs of clouds with a known transform: the list of a generated set, and the error of an estimate.

use nalgebra::Matrix6;
use serde::{Deserialize, Serialize};

use super::overlap::mean_squared_error;
use crate::files::{corrupt, read};
use crate::prelude::*;

/// Largest root mean squared error of a success on 3DMatch and 3DLoMatch, in metres.
const RMSE_M: f64 = 0.2;

/// Largest error of a free scale, relative: at 4 m, the range of a depth camera, as far as [`RMSE_M`].
const SCALE: f64 = 0.05;

/// Largest rotation error of a success on KITTI, in degrees.
const ROTATION_DEG: f64 = 5.0;

/// Largest translation error of a success on KITTI, in metres.
const TRANSLATION_M: f64 = 2.0;

/// Success criterion of an estimate.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// 3DMatch: the root mean squared distance of corresponding points, by this information matrix, below 0.2 m.
    Rmse(Box<Matrix6<f64>>),
    /// KITTI: rotation within 5°, translation within 2 m.
    Errors,
}

/// A pair of clouds with a known transform.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Name, valid as file name.
    pub id: String,
    /// Scene or sequence.
    pub group: String,
    /// File of the source cloud.
    pub source: PathBuf,
    /// File of the target cloud.
    pub target: PathBuf,
    /// The true transform.
    pub target_from_source: Similarity,
    /// Success criterion of an estimate.
    pub criterion: Criterion,
    /// Voxel size for other methods.
    pub voxel_size_m: f64,
    /// Overlap of both clouds, 0 to 1, if known.
    pub overlap: Option<f64>,
}

/// Errors of an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Errors {
    /// Angle of the rotation error (RRE).
    pub rotation_deg: f64,
    /// |s / s_true − 1|.
    pub scale: f64,
    /// Length of the translation error (RTE).
    pub translation_m: f64,
    /// Root mean squared distance of corresponding points; `None` where no information matrix is known.
    pub rmse_m: Option<f64>,
    /// Whether the estimate is a success.
    pub success: bool,
}

impl Pair {
    /// Errors of an estimate.
    pub fn errors(&self, estimate: &Similarity) -> Errors {
        let truth = &self.target_from_source;
        let rotation_deg = truth.rotation_angle_to(estimate).to_degrees();
        let translation_m = (truth.translation - estimate.translation).norm();
        let scale = (estimate.scale / truth.scale - 1.0).abs();
        let (rmse_m, success) = match &self.criterion {
            Criterion::Rmse(information) => {
                let squared = mean_squared_error(estimate, truth, information);
                (Some(squared.max(0.0).sqrt()), squared <= RMSE_M * RMSE_M)
            }
            Criterion::Errors => (None, rotation_deg < ROTATION_DEG && translation_m < TRANSLATION_M),
        };
        Errors { rotation_deg, scale, translation_m, rmse_m, success: success && scale <= SCALE }
    }

    /// Distance of the origins of the clouds, in metres: the motion of the sensor.
    pub fn distance_m(&self) -> f64 {
        self.target_from_source.translation.norm()
    }
}

/// Entry of the `pairs.json` of a generated set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Listed {
    /// Scene or sequence.
    pub group: String,
    /// Number of the source's file.
    pub source: u32,
    /// Number of the target's file.
    pub target: u32,
    /// Overlap of both clouds, 0 to 1.
    pub overlap: f64,
}

/// Reads `pairs.json` of a folder; `None` if it does not exist.
///
/// # Errors
/// [`CorruptFile`](sim3align_runtime::error::ErrorCode::CorruptFile).
pub fn read_list(root: &Path) -> Result<Option<Vec<Listed>>> {
    let path = root.join("pairs.json");
    if !path.is_file() {
        return Ok(None);
    }
    serde_json::from_slice(&read(&path)?)
        .map(Some)
        .map_err(|error| corrupt(&path, format!("{error}"), "an array of { group, source, target, overlap }"))
}
