//! The rotation about the axis that a frame determines least, filtered over frames.

use glam::DVec3;

use super::motion::Motion;
use crate::views::world_pose::WorldPose;

/// Standard deviation of a frame's rotation about its least determined axis, radians, up to which the frame alone counts.
const TIGHT: f64 = 0.02;
/// Standard deviation of the motion about the axis that a frame adds, radians, and relative to the motion.
const DRIFT: f64 = 0.01;
const UNSTEADY: f64 = 0.5;

/// A Kalman filter of one angle. Long thin objects and almost round ones leave a turn about their axis to noise; the motion
/// so far predicts it better than one frame tells it.
#[derive(Debug, Clone, Copy, Default)]
pub struct OpenAxis {
    /// Variance of the angle, radians²; `None` before the first frame.
    variance: Option<f64>,
}

impl OpenAxis {
    /// The angle about `axis`, radians, by which the pose of a frame should turn towards the `predicted` one. `deviation`
    /// is the standard deviation of the frame's rotation about that axis, camera frame.
    pub fn correction(
        &mut self,
        predicted: &WorldPose,
        found: &WorldPose,
        motion: &Motion,
        (deviation, axis): (f64, DVec3),
    ) -> f64 {
        let measured = deviation * deviation;
        let Some(before) = self.variance.filter(|_| deviation > TIGHT) else {
            self.variance = Some(measured);
            return 0.0;
        };
        let step = DRIFT + UNSTEADY * motion.turn().length();
        let variance = before + step * step;
        let gain = variance / (variance + measured);
        self.variance = Some((1.0 - gain) * variance);
        -(1.0 - gain) * Motion::between(predicted, found).turn().dot(axis)
    }

    /// Forgets the frames before.
    pub fn reset(&mut self) {
        self.variance = None;
    }
}
