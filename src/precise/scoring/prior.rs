//! The prior on scale and orientation.

use glam::{DQuat, DVec3};

use crate::geometry::angle::sin_cos;
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::quaternion_of;
use crate::precise::drawing::equivalence::Equivalence;
use crate::precise::drawing::pose::{CropPose, MeshFrame};
use crate::precise::options::{AlignOptions, ExtentAxis};

/// Penalty of an upside-down pose, and the tilt at half of that penalty.
const TILT: f64 = 0.3;
const HALF_TILT_DEG: f64 = 20.0;

/// Penalty of a pose that is turned away from the initial one, the turn up to which there is none (generators' own
/// placements are that far off), and what is added to it at half of the penalty. The penalty decides between turns that the
/// image hardly tells apart: real objects with an initial pose the wrong way round are found as without it.
const TURN: f64 = 0.05;
const FREE_TURN_DEG: f64 = 25.0;
const HALF_TURN_DEG: f64 = 15.0;

/// The prior; empty by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Prior {
    /// Bounds of the scale, metres per unit of the mesh frame.
    pub scale: Option<[f64; 2]>,
    /// Unit up vectors in the camera frame and in the mesh frame.
    pub up: Option<[DVec3; 2]>,
    /// The rotation of the initial pose.
    pub initial: Option<DQuat>,
}

impl Prior {
    /// The prior that options state, of a mesh with this frame.
    pub fn of(options: &AlignOptions, mesh: &Mesh, frame: &MeshFrame) -> Self {
        let extent = Bounds::of(mesh.positions()).map_or(glam::Vec3::ONE, |b| b.extent());
        let side = f64::from(match options.known_extent_axis {
            ExtentAxis::Longest => extent.max_element(),
            ExtentAxis::X => extent.x,
            ExtentAxis::Y => extent.y,
            ExtentAxis::Z => extent.z,
        });
        let known = options.known_extent_m.map(|length| [length / side; 2]);
        let bounds = options.scale.bounds().or(known);
        let direction = |v: [f64; 3]| DVec3::from(v).normalize_or_zero();
        Self {
            scale: bounds.map(|b| b.map(|s| s * frame.diagonal)),
            up: options.camera_up.zip(options.mesh_up).map(|(camera, mesh)| [direction(camera), direction(mesh)]),
            initial: options.initial.map(|pose| quaternion_of(&pose)),
        }
    }

    /// The scale, if the options fix it.
    pub fn fixed_scale(&self) -> Option<f64> {
        self.scale.filter(|[low, high]| low == high).map(|[scale, _]| scale)
    }

    /// The pose with its scale within the bounds, at the same distance.
    pub fn bounded(&self, pose: CropPose) -> CropPose {
        let Some(bounds) = self.scale else { return pose };
        let [low, high] = bounds.map(libm::log);
        let scale = pose.size + pose.distance;
        // Unchanged within the bounds, because the sum would not be bit-identical.
        if scale >= low && scale <= high {
            return pose;
        }
        CropPose { size: scale.max(low).min(high) - pose.distance, ..pose }
    }

    /// Whether a pose is at a bound of a scale that is not fixed.
    pub fn is_at_bound(&self, pose: &CropPose) -> bool {
        let scale = pose.size + pose.distance;
        self.scale.is_some_and(|[low, high]| {
            low < high && [low, high].iter().any(|bound| (libm::log(*bound) - scale).abs() < 1e-9)
        })
    }

    /// The contribution of the orientation to the score: 0 if upright and near the initial one, otherwise negative.
    /// Equivalent poses are equally near.
    pub fn score(&self, pose: &CropPose, equivalence: &Equivalence) -> f32 {
        let tilt = self.up.map_or(0.0, |[camera, mesh]| {
            // 1 − cos θ grows like θ², and needs no arc cosine.
            TILT * saturated(1.0 - camera.dot(pose.rotation * mesh), HALF_TILT_DEG)
        });
        let turn = self.initial.map_or(0.0, |initial| {
            let angle = equivalence.angle(pose.rotation, initial) - FREE_TURN_DEG.to_radians();
            TURN * saturated(1.0 - sin_cos(angle.max(0.0)).1, HALF_TURN_DEG)
        });
        -(tilt + turn) as f32
    }
}

/// Grows with 1 − cos θ from 0 towards 1; one half at this angle.
fn saturated(lean: f64, half_deg: f64) -> f64 {
    lean / (lean + 1.0 - sin_cos(half_deg.to_radians()).1)
}
