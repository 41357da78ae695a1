//! Two clouds with a known transform, and when an estimate of it counts as right.

use std::path::PathBuf;

use nalgebra::Matrix6;
use serde::Serialize;

use super::information::mean_squared_error;
use sim3align_geometry::similarity::Similarity;

/// Largest root mean squared error of a success on 3DMatch and 3DLoMatch, in metres.
pub const RMSE_M: f64 = 0.2;

/// Largest rotation error of a success on KITTI, in degrees.
pub const ROTATION_DEG: f64 = 5.0;

/// Largest translation error of a success on KITTI, in metres.
pub const TRANSLATION_M: f64 = 2.0;

/// What makes an estimate right.
#[derive(Debug, Clone, PartialEq)]
pub enum Criterion {
    /// 3DMatch: the root mean squared distance of corresponding points, by this information matrix, below 0.2 m.
    Rmse(Box<Matrix6<f64>>),
    /// KITTI: rotation within 5°, translation within 2 m.
    Errors,
}

/// Two clouds.
#[derive(Debug, Clone)]
pub struct Pair {
    /// A name fit for a file.
    pub id: String,
    /// The scene or sequence that it belongs to.
    pub group: String,
    /// The cloud that is moved.
    pub source: PathBuf,
    /// The cloud that stays.
    pub target: PathBuf,
    /// The truth.
    pub target_from_source: Similarity,
    /// When an estimate is right.
    pub criterion: Criterion,
    /// The voxel size that baselines are run with.
    pub voxel_size_m: f64,
    /// Share of the points of both that the other has, where it is known.
    pub overlap: Option<f64>,
}

/// How far an estimate is off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Errors {
    /// Angle of the rotation error (RRE).
    pub rotation_deg: f64,
    /// Length of the translation error (RTE).
    pub translation_m: f64,
    /// Root mean squared distance of corresponding points; `None` where no information matrix is known.
    pub rmse_m: Option<f64>,
    /// Whether it is right.
    pub success: bool,
}

impl Pair {
    /// How far an estimate is off.
    pub fn errors(&self, estimate: &Similarity) -> Errors {
        let truth = &self.target_from_source;
        let rotation_deg = truth.rotation_angle_to(estimate).to_degrees();
        let translation_m = (truth.translation - estimate.translation).norm();
        let (rmse_m, success) = match &self.criterion {
            Criterion::Rmse(information) => {
                let squared = mean_squared_error(estimate, truth, information);
                (Some(squared.max(0.0).sqrt()), squared <= RMSE_M * RMSE_M)
            }
            Criterion::Errors => (None, rotation_deg < ROTATION_DEG && translation_m < TRANSLATION_M),
        };
        Errors { rotation_deg, translation_m, rmse_m, success }
    }

    /// How far apart the clouds' origins are, in metres: the way that the sensor went.
    pub fn distance_m(&self) -> f64 {
        self.target_from_source.translation.norm()
    }
}
