//! Conditioning: how well the observation constrains each direction of the pose.

use glam::{DMat3, DVec3};

use super::pose::CropPose;
use crate::geometry::normal_equations::NormalEquations;
use crate::geometry::symmetric_eigen::SymmetricEigen;

/// Score decrease at one standard deviation, calibrated so that the errors of correct poses on generated cases have the
/// reported size.
pub const DROP: f64 = 0.01;
/// Regularisation, so that unconstrained directions remain finite.
const DAMPING: f64 = 1e-9;

/// Standard deviations of a pose, given the observation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditioning {
    /// Of the scale, relative.
    pub scale: f64,
    /// Of the rotation about the least constrained axis, radians, and that axis in the camera frame.
    pub rotation: (f64, DVec3),
    /// Of the position across the line of sight, metres.
    pub lateral_m: f64,
    /// Of the distance, metres.
    pub distance_m: f64,
}

impl Conditioning {
    /// From the quadratic at a refined pose; `None` if it constrains nothing.
    pub fn of(equations: &NormalEquations, pose: &CropPose) -> Option<Self> {
        let covariance = equations.inverse(DAMPING)?.map(|row| row.map(|x| 2.0 * DROP * x));
        let (scale, translation) = pose.scale_translation();
        let size = libm::exp(pose.size);
        let turns =
            DMat3::from_cols_array_2d(&[0, 1, 2].map(|i| [covariance[i][0], covariance[i][1], covariance[i][2]]));
        let eigen = SymmetricEigen::of(turns);
        // log s = size + distance; distance is in units of the size.
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
