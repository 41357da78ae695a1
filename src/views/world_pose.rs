//! Poses in the world, and the cameras that see them.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::Vector3;

use crate::geometry::normal_equations::PARAMETERS;
use crate::geometry::rotations::{exp, matrix_of, quaternion_of};
use crate::geometry::similarity::Similarity;
use crate::precise::drawing::pose::{CropPose, MeshFrame, Step};
use crate::precise::search::ranking::Posed;

/// x_world = e^`log_scale`·R·p + `center`, for p in the [`MeshFrame`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldPose {
    /// R.
    pub rotation: DQuat,
    /// Logarithm of the scale, metres per unit of the mesh frame.
    pub log_scale: f64,
    /// Position of the centre of the mesh, metres.
    pub center: DVec3,
}

/// The change of the logarithm of the scale with each component of a step.
pub const OF_SCALE: Step = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];

impl WorldPose {
    /// The pose after a step: a rotation vector (world frame, radians), a change of the logarithm of the scale, and a
    /// translation of the centre in units of the scale.
    pub fn moved(&self, step: &Step) -> Self {
        Self {
            rotation: (exp(DVec3::new(step[0], step[1], step[2])) * self.rotation).normalize(),
            log_scale: self.log_scale + step[3],
            center: self.center + DVec3::new(step[4], step[5], step[6]) * libm::exp(self.log_scale),
        }
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.log_scale.is_finite() && self.center.is_finite()
    }

    /// The similarity, world from mesh.
    #[inline(never)]
    pub fn similarity(&self, frame: &MeshFrame) -> Similarity {
        let scale = libm::exp(self.log_scale) / frame.diagonal;
        let translation = self.center - self.rotation * frame.center * scale;
        Similarity { scale, rotation: matrix_of(self.rotation), translation: Vector3::from(translation.to_array()) }
    }
}

impl Posed for WorldPose {
    fn rotation(&self) -> DQuat {
        self.rotation
    }
}

/// A camera in the world: x_camera = R·x_world + t.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedCamera {
    rotation: DQuat,
    translation: DVec3,
}

impl PlacedCamera {
    /// The camera whose frame is that of the world.
    pub const AT_ORIGIN: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// From world-from-camera, whose scale is not used.
    #[inline(never)]
    pub fn of(world_from_camera: &Similarity) -> Self {
        let rotation = quaternion_of(world_from_camera).conjugate();
        let position = DVec3::from_slice(world_from_camera.translation.as_slice());
        Self { rotation, translation: -(rotation * position) }
    }

    /// World from camera, of scale 1.
    #[inline(never)]
    pub fn world_from_camera(&self) -> Similarity {
        let rotation = self.rotation.conjugate();
        Similarity {
            scale: 1.0,
            rotation: matrix_of(rotation),
            translation: Vector3::from((-(rotation * self.translation)).to_array()),
        }
    }

    /// A world pose as seen by the camera; `None` if the centre of the mesh is not in front of it.
    #[inline(never)]
    pub fn see(&self, pose: &WorldPose) -> Option<CropPose> {
        let center = self.rotation * pose.center + self.translation;
        if center.z <= 0.0 {
            return None;
        }
        let seen = CropPose::new(self.rotation * pose.rotation, libm::exp(pose.log_scale), center);
        seen.is_finite().then_some(seen)
    }

    /// The world pose that the camera sees as `pose`.
    #[inline(never)]
    pub fn place(&self, pose: &CropPose) -> WorldPose {
        let (scale, center) = pose.scale_translation();
        let back = self.rotation.conjugate();
        WorldPose {
            rotation: (back * pose.rotation).normalize(),
            log_scale: libm::log(scale),
            center: back * (center - self.translation),
        }
    }

    /// The matrix A by rows: a small step y of a world pose is the step A·y of the pose that the camera sees.
    pub fn step_map(&self, seen: &CropPose) -> [[f64; PARAMETERS]; PARAMETERS] {
        let turn = DMat3::from_quat(self.rotation);
        let row = |axis: usize| turn.row(axis);
        let size = libm::exp(seen.size);
        let mut map = [[0.0; PARAMETERS]; PARAMETERS];
        for (axis, turned) in map.iter_mut().take(3).enumerate() {
            turned[..3].copy_from_slice(&row(axis).to_array());
        }
        // log z grows by e^size times the step along the line of sight.
        let along = row(2);
        map[3][3] = 1.0;
        map[3][4..].copy_from_slice(&(-along * size).to_array());
        map[4][4..].copy_from_slice(&(row(0) - along * seen.place.x).to_array());
        map[5][4..].copy_from_slice(&(row(1) - along * seen.place.y).to_array());
        map[6][4..].copy_from_slice(&along.to_array());
        map
    }
}
