//! Prior: what is known of size and attitude before anything is seen.

use glam::DVec3;

use super::pose::CropPose;
use crate::geometry::angle::sin_cos;

/// Score that a pose upside down loses, and the angle at which half of it is lost.
const TILT: f64 = 0.3;
const HALF_TILT_DEG: f64 = 20.0;

/// What is known beforehand; by default nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Prior {
    /// Bounds of the scale, metres per unit of the mesh frame.
    pub scale: Option<[f64; 2]>,
    /// Unit vectors that are up: in the camera's frame, and in the mesh's.
    pub up: Option<[DVec3; 2]>,
}

impl Prior {
    /// The pose with its scale within the bounds, at the same distance.
    pub fn held(&self, pose: CropPose) -> CropPose {
        let Some(bounds) = self.scale else { return pose };
        let [low, high] = bounds.map(libm::log);
        let scale = pose.size + pose.distance;
        // As it is within them: the sum would not come back to the bit.
        if scale >= low && scale <= high {
            return pose;
        }
        CropPose { size: scale.max(low).min(high) - pose.distance, ..pose }
    }

    /// Whether a pose stands at a bound that leaves a choice.
    pub fn holds(&self, pose: &CropPose) -> bool {
        let scale = pose.size + pose.distance;
        self.scale.is_some_and(|[low, high]| {
            low < high && [low, high].iter().any(|bound| (libm::log(*bound) - scale).abs() < 1e-9)
        })
    }

    /// What the attitude adds to a pose's score: 0 upright, less the more it leans.
    pub fn score(&self, pose: &CropPose) -> f32 {
        let Some([camera, mesh]) = self.up else { return 0.0 };
        // 1 − cos θ grows as θ², and needs no arc.
        let lean = 1.0 - camera.dot(pose.rotation * mesh);
        let half = 1.0 - sin_cos(HALF_TILT_DEG.to_radians()).1;
        (-TILT * lean / (lean + half)) as f32
    }
}
