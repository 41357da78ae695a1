//! Bodies: convex parts, mass, and a pose.

use glam::{DMat3, DQuat, DVec3};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

use super::columns::Columns;
use super::mass::Mass;
use super::part::{ConvexPart, convex_parts, wall_count};
use super::solid::Solid;

/// A rigid body.
#[derive(Debug, Clone)]
pub struct Body {
    /// Its parts, in its frame: that of the mesh, in metres.
    pub parts: Vec<ConvexPart>,
    /// The number of its walls without thickness, if its parts are fewer: these then close its openings.
    pub walls_joined: Option<usize>,
    /// Its mass, in its frame.
    pub mass: Mass,
    /// World from body.
    pub pose: Pose,
}

/// A rotation and a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// The rotation.
    pub rotation: DQuat,
    /// The translation, metres.
    pub translation: DVec3,
}

impl Pose {
    /// Maps a point.
    pub fn apply(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }
}

impl Body {
    /// The body of a mesh at a pose. A mesh without extent has no parts.
    pub fn new(mesh: &Mesh, world_from_mesh: &Similarity, most_parts: usize, density: f64) -> Self {
        let scale = world_from_mesh.scale;
        let solid = Solid::of(mesh);
        let volume = solid.as_ref().map(|solid| solid.volume);
        let parts: Vec<ConvexPart> =
            convex_parts(mesh, volume, most_parts).iter().map(|part| part.mapped(|p| scale * p)).collect();
        let is_full = solid.is_none() && parts.len() == most_parts;
        let walls_joined = is_full.then(|| wall_count(mesh)).filter(|walls| *walls > most_parts);
        // The parts of a mesh that encloses a volume only approximate it.
        let mass = match &solid {
            Some(solid) => Mass::inside(solid.corners.iter().map(|corners| corners.map(|p| scale * p)), density),
            None => Mass::of(&parts, density),
        };
        let rotation = DMat3::from_cols_slice(world_from_mesh.rotation.matrix().as_slice());
        let translation = DVec3::from_slice(world_from_mesh.translation.as_slice());
        let pose = Pose { rotation: DQuat::from_mat3(&rotation).normalize(), translation };
        Self { mass, parts, walls_joined, pose }
    }

    /// The vertices of its parts at a pose.
    pub fn points(&self, pose: Pose) -> impl Iterator<Item = DVec3> + '_ {
        self.parts.iter().flat_map(|part| &part.positions).map(move |p| pose.apply(*p))
    }

    /// The columns of its parts at a pose.
    pub fn columns(&self, pose: Pose, cell: f64) -> Vec<Columns> {
        self.parts.iter().map(|part| Columns::of(&part.mapped(|p| pose.apply(p)), cell)).collect()
    }
}
