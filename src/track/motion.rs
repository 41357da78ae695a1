//! The motion of a tracked object between frames.

use glam::DVec3;

use crate::geometry::rotations::{angle_between, exp};
use crate::views::world_pose::WorldPose;

/// Share of the last motion that is expected of the next frame.
const DAMPING: f64 = 0.9;
/// Rotation, radians, beyond which a motion is not carried on: the object was found anew.
pub const MAX_TURN_RAD: f64 = 0.8;

/// The motion from one frame to the next, about the centre of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Rotation vector, radians.
    turn: DVec3,
    /// Metres.
    shift: DVec3,
}

impl Motion {
    /// No motion.
    pub const REST: Self = Self { turn: DVec3::ZERO, shift: DVec3::ZERO };

    /// The motion between two poses.
    pub fn between(before: &WorldPose, after: &WorldPose) -> Self {
        let angle = angle_between(before.rotation, after.rotation);
        if angle > MAX_TURN_RAD {
            return Self::REST;
        }
        let turn = after.rotation * before.rotation.conjugate();
        let axis = DVec3::new(turn.x, turn.y, turn.z).normalize_or_zero();
        let signed = if turn.w < 0.0 { -angle } else { angle };
        Self { turn: axis * signed, shift: after.center - before.center }
    }

    /// The pose to expect after `pose`.
    pub fn carried(&self, pose: &WorldPose) -> WorldPose {
        let rotation = (exp(self.turn * DAMPING) * pose.rotation).normalize();
        WorldPose { rotation, center: pose.center + self.shift * DAMPING, ..*pose }
    }
}
