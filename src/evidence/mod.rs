//! The evidence for a pose: observed points with normals, and points on the surface of the mesh.
//!
//! In: a depth map, a mask, a camera and, if there is one, a photo. Out: an
//! [`observation::Observation`], validated once for all that follows, and the clouds of the paper's method and of
//! the metrics. Depths without a reading are 0 from here on.

pub mod clouds;
pub mod extents;
pub mod frame;
pub mod normals;
pub mod observation;
pub mod photo;
pub mod sample;

use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::sample_surface;
use normals::{Neighborhood, Orientation, estimate_some_normals};
use observation::Observation;
use sample::Sampling;

/// Neighbours for the normal estimation of observed points.
pub const NORMAL_NEIGHBORS: usize = 30;

/// Number of normals, about, from which on more would not change the first three digits of a mean over them.
const ENOUGH_NORMALS: usize = 4096;

/// The observed points that have a normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// Enough for metrics.
    Some,
    /// All.
    All,
}

/// Both clouds; independent of the pose, so that they are computed once.
#[derive(Debug, Clone)]
pub struct Evidence {
    /// P_obs (camera frame, metres), with normals towards the camera, which are zero where they are not needed.
    pub observed: Cloud,
    /// The points with a normal.
    pub normals: Normals,
    /// The search tree over P_obs.
    pub tree: KdTree,
    /// P_rec: points on the surface of the mesh (mesh frame), with normals.
    pub reconstructed: Cloud,
}

impl Evidence {
    /// The evidence of two clouds. Estimates the normals of the observed points from [`NORMAL_NEIGHBORS`] neighbours.
    pub fn new(observed: Cloud, reconstructed: Cloud, normals: Normals) -> Self {
        let tree = KdTree::new(&observed.points);
        Self { observed, normals: Normals::Some, tree, reconstructed }.with_normals(normals)
    }

    /// The evidence with the normals that are needed.
    fn with_normals(mut self, normals: Normals) -> Self {
        let points = &self.observed.points;
        let stride = match normals {
            Normals::Some => points.len().div_ceil(ENOUGH_NORMALS).max(1),
            Normals::All => 1,
        };
        let neighborhood = Neighborhood::nearest(NORMAL_NEIGHBORS);
        let estimated = estimate_some_normals(points, &self.tree, neighborhood, Orientation::TowardsCamera, stride);
        self.observed.normals = estimated;
        Self { normals, ..self }
    }

    /// The evidence of an observation and a mesh.
    ///
    /// # Errors
    /// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
    pub fn of(observation: &Observation, mesh: &Mesh, options: &Sampling) -> Result<Self> {
        let reconstructed = sample_surface(mesh, options.surface_samples, options.seed)?;
        Ok(Self::new(observation.cloud(options.max_points, options.seed), reconstructed, Normals::Some))
    }
}
