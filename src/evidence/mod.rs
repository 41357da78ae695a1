//! What a pose is scored against: the observed points with their normals, and points on the mesh's surface.

pub mod clouds;
pub mod extents;
pub mod normals;
pub mod observation;
pub mod sample;

use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::mesh::Mesh;
use clouds::Sampling;
use normals::{Neighborhood, Orientation, estimate_normals};
use observation::Observation;
use sample::sample_surface;

/// Neighbours from which an observed point's normal is estimated.
pub const NORMAL_NEIGHBORS: usize = 30;

/// Both clouds, made once for however many poses.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// P_obs (camera frame, metres), with normals towards the camera.
    pub observed: Cloud,
    /// The tree over P_obs.
    pub tree: KdTree,
    /// P_rec: points on the mesh's surface (mesh frame), with its normals.
    pub reconstructed: Cloud,
}

impl Evidence {
    /// The evidence of two clouds: adds the observed points' normals, from their [`NORMAL_NEIGHBORS`] nearest.
    pub fn new(mut observed: Cloud, reconstructed: Cloud) -> Self {
        let tree = KdTree::new(&observed.points);
        let neighborhood = Neighborhood::nearest(NORMAL_NEIGHBORS);
        observed.normals = estimate_normals(&observed.points, &tree, neighborhood, Orientation::TowardsCamera);
        Self { observed, tree, reconstructed }
    }

    /// The evidence of an observation and a mesh.
    ///
    /// # Errors
    /// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
    pub fn of(observation: &Observation, mesh: &Mesh, options: &Sampling) -> Result<Self> {
        let reconstructed = sample_surface(mesh, options.surface_samples, options.seed)?;
        Ok(Self::new(observation.cloud(options.max_points, options.seed), reconstructed))
    }
}
