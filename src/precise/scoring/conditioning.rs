//! Conditioning: how well the observation constrains each direction of the pose.

use glam::{DMat3, DVec3};

use crate::geometry::normal_equations::{NormalEquationsOf, PARAMETERS};
use crate::geometry::symmetric_eigen::SymmetricEigen;
use crate::precise::drawing::pose::CropPose;
use crate::precise::scoring::score::Score;

/// Score decrease at one standard deviation, calibrated so that the errors of correct poses on generated cases have the
/// reported size.
pub const DROP: f64 = 0.01;
/// Regularisation, so that unconstrained directions remain finite.
pub const DAMPING: f64 = 1e-9;
/// Deviation of a size, relative to that of the curvature, per unit of what depths and outline miss together, and what they always
/// miss. Of right poses on fresh seeds, 90 and 91 % of the sizes of single objects are within 1.645 deviations, and 85 and 86 % of
/// those in scenes, generated or real; the median error is 0.4 to 0.8 of one.
const MISFIT: f64 = 5.5;
const MIN_MISFIT: f64 = 0.01;
/// Standard deviation of a roll that a symmetry makes meaningless, radians.
const FIXED: f64 = 1e-3;

/// The covariance of the parameters of a pose.
pub type Covariance = [[f64; PARAMETERS]; PARAMETERS];

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
    /// Of the position in the least constrained direction, metres.
    pub position_m: f64,
}

impl Conditioning {
    /// From the covariance at a refined pose.
    pub fn new(covariance: &Covariance, pose: &CropPose) -> Self {
        let (scale, _) = pose.scale_translation();
        let size = libm::exp(pose.size);
        let log_scale = covariance[3][3] + 2.0 * size * covariance[3][6] + size * size * covariance[6][6];
        let [across, down] = [covariance[4][4], covariance[5][5]];
        let lateral = 0.5 * (across + down) + libm::hypot(0.5 * (across - down), covariance[4][5]);
        Self {
            scale: deviation(log_scale),
            rotation: widest(covariance, 0),
            lateral_m: scale * deviation(lateral),
            distance_m: scale * deviation(covariance[6][6]),
            position_m: scale * widest(covariance, 4).0,
        }
    }

    /// With the size as uncertain as the fit is inexact: wrong proportions of the mesh and biases of the sensor cause what depths
    /// and outlines miss, and change the size, too.
    pub fn with_misfit(self, score: &Score) -> Self {
        let missing = 2.0 - f64::from(score.depth) - f64::from(score.outline);
        let factor = MISFIT * (missing + MIN_MISFIT);
        Self { scale: factor * self.scale, distance_m: factor * self.distance_m, ..self }
    }
}

/// The change of log s with each parameter of a pose: log s = size + distance, and distance is in units of the size.
pub fn gradient_of_scale(pose: &CropPose) -> [f64; PARAMETERS] {
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, libm::exp(pose.size)]
}

/// The covariance where the number that changes by `gradient` with the parameters is known.
pub fn at_known(covariance: &Covariance, gradient: &[f64; PARAMETERS]) -> Covariance {
    let dot = |row: &[f64; PARAMETERS]| row.iter().zip(gradient).map(|(a, b)| a * b).sum::<f64>();
    let along = covariance.each_ref().map(dot);
    let variance = dot(&along).max(f64::MIN_POSITIVE);
    let mut left = *covariance;
    for (row, x) in left.iter_mut().zip(along) {
        row.iter_mut().zip(along).for_each(|(entry, y)| *entry -= x * y / variance);
    }
    left
}

/// The covariance of the parameters; `None` if the quadratic constrains nothing.
pub fn covariance<const N: usize>(equations: &NormalEquationsOf<N>) -> Option<[[f64; N]; N]> {
    Some(equations.inverse(DAMPING)?.map(|row| row.map(|x| 2.0 * DROP * x)))
}

/// Holds the roll about an axis, in the camera frame, of a pose whose first three parameters are its rotation.
pub fn fix_roll<const N: usize>(equations: &mut NormalEquationsOf<N>, axis: DVec3) {
    let weight = 2.0 * DROP / (FIXED * FIXED);
    let row = |x: f64| (axis * (x * weight)).to_array();
    equations.add_block(&[row(axis.x), row(axis.y), row(axis.z)], [0.0; 3]);
}

/// The standard deviation of three parameters, from the one with this index, in the direction in which it is largest, and
/// that direction.
pub fn widest(covariance: &Covariance, from: usize) -> (f64, DVec3) {
    let row = |i: usize| [0, 1, 2].map(|j| covariance[from + i][from + j]);
    let eigen = SymmetricEigen::of(DMat3::from_cols_array_2d(&[row(0), row(1), row(2)]));
    (deviation(eigen.values[2]), eigen.vectors[2])
}

/// The standard deviation of a variance, which rounding may have made negative.
pub fn deviation(variance: f64) -> f64 {
    variance.max(0.0).sqrt()
}
