//! The evidence for a pose: observed points with normals, and points on the surface of the mesh.

pub mod clouds;
pub mod extents;
pub mod normals;
pub mod observation;
pub mod sample;

use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::mesh::Mesh;
use normals::{Neighborhood, Orientation, estimate_normals};
use observation::Observation;
use sample::{Sampling, sample_surface};

/// Neighbours for the normal estimation of observed points.
pub const NORMAL_NEIGHBORS: usize = 30;

/// Both clouds; independent of the pose, so that they are computed once.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// P_obs (camera frame, metres), with normals towards the camera.
    pub observed: Cloud,
    /// The search tree over P_obs.
    pub tree: KdTree,
    /// P_rec: points on the surface of the mesh (mesh frame), with normals.
    pub reconstructed: Cloud,
}

impl Evidence {
    /// The evidence of two clouds. Estimates the normals of the observed points from [`NORMAL_NEIGHBORS`] neighbours.
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
