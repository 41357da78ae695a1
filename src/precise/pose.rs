//! A pose by what the image fixes: apparent size and place of the mesh, and, apart from these, its distance.

use glam::{DMat3, DQuat, DVec2, DVec3};
use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::exp;
use crate::geometry::similarity::Similarity;

/// The mesh's own frame: its box's middle is the origin and its box's diagonal is 1.
#[derive(Debug, Clone, Copy)]
pub struct MeshFrame {
    /// Middle of the box, mesh units.
    pub center: DVec3,
    /// Diagonal of the box, mesh units.
    pub diagonal: f64,
}

impl MeshFrame {
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
/// The mask fixes size and place, which thereby keep apart from distance, which the depth fixes: a change of
/// distance alone leaves the silhouette exactly as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CropPose {
    /// R.
    pub rotation: DQuat,
    /// log(s/z): the logarithm of the size in the image, as the tangent of the angle that the box's diagonal fills.
    pub size: f64,
    /// Where the middle of the mesh is in the image: x/z and y/z.
    pub place: DVec2,
    /// log z, z in metres.
    pub distance: f64,
}

/// What refinement moves: turn (3, radians, about the middle of the mesh), size, place (2, in units of the size in
/// the image), distance (in units of the size over the distance, so that a unit of each moves the surface alike).
pub type Step = [f64; 7];

impl CropPose {
    /// s and t, metres.
    pub fn scale_translation(&self) -> (f64, DVec3) {
        let z = libm::exp(self.distance);
        (libm::exp(self.size) * z, self.place.extend(1.0) * z)
    }

    /// The pose as the caller gets it.
    pub fn similarity(&self, frame: &MeshFrame) -> Similarity {
        let (scale, translation) = self.scale_translation();
        let scale = scale / frame.diagonal;
        let translation = translation - self.rotation * frame.center * scale;
        let matrix = DMat3::from_quat(self.rotation).to_cols_array();
        Similarity {
            scale,
            rotation: Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&matrix)),
            translation: Vector3::from(translation.to_array()),
        }
    }

    /// The other way; `None` where the middle of the mesh is not before the camera.
    pub fn of_similarity(similarity: &Similarity, frame: &MeshFrame) -> Option<Self> {
        let rotation = DQuat::from_array(similarity.quaternion_xyzw()).normalize();
        let t = DVec3::from_slice(similarity.translation.as_slice());
        let t = t + rotation * frame.center * similarity.scale;
        let pose = Self {
            rotation,
            size: libm::log(similarity.scale * frame.diagonal / t.z),
            place: t.truncate() / t.z,
            distance: libm::log(t.z),
        };
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

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.place.is_finite() && self.size.is_finite() && self.distance.is_finite()
    }
}
