//! Conditioning: which directions the observation holds, and how firmly.

use glam::{DMat3, DVec3};

use super::pose::CropPose;
use crate::geometry::normal_equations::NormalEquations;
use crate::geometry::symmetric_eigen::SymmetricEigen;

/// The drop of the score that counts as one standard deviation: on generated cases, errors of right poses are then
/// as large as they are said to be.
const DROP: f64 = 0.01;
/// Keeps directions that nothing holds from being infinite.
const DAMPING: f64 = 1e-9;

/// How far a pose could move, to one standard deviation, before the observation would contradict it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditioning {
    /// Of the scale, relative.
    pub scale: f64,
    /// Of the rotation about the axis that is held least, radians, and that axis in the camera's frame.
    pub rotation: (f64, DVec3),
    /// Of the position across the line of sight, metres.
    pub lateral_m: f64,
    /// Of the distance, metres.
    pub distance_m: f64,
}

impl Conditioning {
    /// From the quadratic at a refined pose; `None` where it holds nothing.
    pub fn of(equations: &NormalEquations, pose: &CropPose) -> Option<Self> {
        let covariance = equations.inverse(DAMPING)?.map(|row| row.map(|x| 2.0 * DROP * x));
        let (scale, translation) = pose.scale_translation();
        let size = libm::exp(pose.size);
        let turns =
            DMat3::from_cols_array_2d(&[0, 1, 2].map(|i| [covariance[i][0], covariance[i][1], covariance[i][2]]));
        let eigen = SymmetricEigen::of(turns);
        // log s = size + distance; distance is counted in units of the size.
        let log_scale = covariance[3][3] + 2.0 * size * covariance[3][6] + size * size * covariance[6][6];
        let root = |x: f64| x.max(0.0).sqrt();
        Some(Self {
            scale: root(log_scale),
            rotation: (root(eigen.values[2]), eigen.vectors[2]),
            lateral_m: scale * root(covariance[4][4].max(covariance[5][5])),
            distance_m: translation.z * size * root(covariance[6][6]),
        })
    }
}
