//! Poses parametrised by what the image determines: apparent size and position of the mesh, and separately its
//! distance.

use glam::{DQuat, DVec2, DVec3};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::{exp, matrix_of, quaternion_of};
use crate::geometry::similarity::Similarity;

/// The normalised frame of a mesh: the centre of its box is the origin, and the diagonal is 1.
#[derive(Debug, Clone, Copy)]
pub struct MeshFrame {
    /// Centre of the box, mesh units.
    pub center: DVec3,
    /// Diagonal of the box, mesh units.
    pub diagonal: f64,
}

impl MeshFrame {
    /// The frame of a mesh that is normalised already.
    pub const NORMALIZED: Self = Self { center: DVec3::ZERO, diagonal: 1.0 };

    /// The frame of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let bounds = Bounds::of(mesh.positions());
        let (center, diagonal) = bounds.map_or((glam::Vec3::ZERO, 1.0), |b| (b.center(), b.diagonal()));
        Self { center: center.as_dvec3(), diagonal: f64::from(diagonal) }
    }

    /// The mesh in this frame.
    pub fn normalized(&self, mesh: &Mesh) -> Option<Mesh> {
        let positions = mesh.positions().iter().map(|p| ((p.as_dvec3() - self.center) / self.diagonal).as_vec3());
        Mesh::new(positions.collect(), mesh.triangles().to_vec()).ok()
    }
}

/// x = s·R·p + t for p in the [`MeshFrame`], with s = e^size·z, t = z·(place, 1), z = e^distance.
///
/// The mask determines size and place, the depth determines the distance. A change of the distance alone does not
/// change the silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CropPose {
    /// R.
    pub rotation: DQuat,
    /// log(s/z): the logarithm of the size in the image, the tangent of the angle that the diagonal of the box
    /// subtends.
    pub size: f64,
    /// Position of the centre of the mesh in the image: x/z and y/z.
    pub place: DVec2,
    /// log z, z in metres.
    pub distance: f64,
}

/// The parameters of the refinement: rotation (3, radians, about the centre of the mesh), size, place (2, in units of
/// the size in the image), and distance (in units of the size over the distance, so that a unit of each moves the
/// surface by about the same amount).
pub type Step = [f64; 7];

impl CropPose {
    /// The pose with the scale s and the translation t, metres, whose z is above 0.
    pub fn new(rotation: DQuat, scale: f64, t: DVec3) -> Self {
        Self { rotation, size: libm::log(scale / t.z), place: t.truncate() / t.z, distance: libm::log(t.z) }
    }

    /// s and t, metres.
    pub fn scale_translation(&self) -> (f64, DVec3) {
        let z = libm::exp(self.distance);
        (libm::exp(self.size) * z, self.place.extend(1.0) * z)
    }

    /// Converts the pose to a similarity.
    #[inline(never)]
    pub fn similarity(&self, frame: &MeshFrame) -> Similarity {
        let (scale, translation) = self.scale_translation();
        let scale = scale / frame.diagonal;
        let translation = translation - self.rotation * frame.center * scale;
        Similarity { scale, rotation: matrix_of(self.rotation), translation: Vector3::from(translation.to_array()) }
    }

    /// The inverse conversion; `None` if the centre of the mesh is not in front of the camera.
    pub fn of_similarity(similarity: &Similarity, frame: &MeshFrame) -> Option<Self> {
        let rotation = quaternion_of(similarity);
        let t = DVec3::from_slice(similarity.translation.as_slice());
        let t = t + rotation * frame.center * similarity.scale;
        let pose = Self::new(rotation, similarity.scale * frame.diagonal, t);
        (t.z > 0.0 && pose.is_finite()).then_some(pose)
    }

    /// The pose after a step.
    pub fn moved(&self, step: &Step) -> Self {
        let size = libm::exp(self.size);
        Self {
            rotation: (exp(DVec3::new(step[0], step[1], step[2])) * self.rotation).normalize(),
            size: self.size + step[3],
            place: self.place + DVec2::new(step[4], step[5]) * size,
            distance: self.distance + step[6] * size,
        }
    }

    /// The step to a pose nearby, to first order in its rotation.
    pub fn step_to(&self, other: &Self) -> Step {
        let turn = other.rotation * self.rotation.conjugate();
        let turn = turn.xyz() * (2.0 * turn.w.signum());
        let size = libm::exp(self.size);
        let place = (other.place - self.place) / size;
        let distance = (other.distance - self.distance) / size;
        [turn.x, turn.y, turn.z, other.size - self.size, place.x, place.y, distance]
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.place.is_finite() && self.size.is_finite() && self.distance.is_finite()
    }
}
