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

use glam::Vec3;

use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::curve::along_curve;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::sample_surface;
use clouds::Sampling;
use normals::{Estimation, Orientation};
use observation::Observation;

/// Neighbours for the normal estimation of observed points.
pub const NORMAL_NEIGHBORS: usize = 30;

/// The observed points that have a normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// Those from which metrics measure.
    Measured,
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
    /// The points of each cloud from which metrics measure, evenly spread, in an order in which those that follow each other
    /// are close.
    pub measured: [Vec<u32>; 2],
    /// The search tree over P_obs.
    pub tree: KdTree,
    /// P_rec: points on the surface of the mesh (mesh frame), with normals.
    pub reconstructed: Cloud,
}

impl Evidence {
    /// The evidence of two clouds, with the normals that are needed, estimated from [`NORMAL_NEIGHBORS`] neighbours.
    pub fn new(observed: Cloud, reconstructed: Cloud, normals: Normals, measured: usize) -> Self {
        let tree = KdTree::new(&observed.points);
        let step = |cloud: &Cloud| cloud.len().div_ceil(measured).max(1);
        // Samples of a surface are in the order of its triangles, by area.
        let of_surface: Vec<u32> = (0..reconstructed.len() as u32).step_by(step(&reconstructed)).collect();
        let points: Vec<Vec3> = of_surface.iter().map(|index| reconstructed.points[*index as usize]).collect();
        let along = along_curve(&points).into_iter().map(|place| of_surface[place as usize]).collect();
        let measured = [tree.indices().step_by(step(&observed)).collect(), along];
        Self { observed, normals: Normals::Measured, measured, tree, reconstructed }.with_normals(normals)
    }

    fn with_normals(mut self, normals: Normals) -> Self {
        let points = &self.observed.points;
        let mut estimation = Estimation::new(points, &self.tree, NORMAL_NEIGHBORS, Orientation::TowardsCamera);
        match normals {
            Normals::All => self.tree.groups().for_each(|group| estimation.add(group)),
            Normals::Measured => {
                let measured = self.measured[0].iter().filter_map(|&index| Some((*points.get(index as usize)?, index)));
                measured.for_each(|point| estimation.add(&[point]));
            }
        }
        self.observed.normals = estimation.normals;
        Self { normals, ..self }
    }

    /// The evidence of an observation and a mesh.
    ///
    /// # Errors
    /// [`DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
    pub fn of(observation: &Observation, mesh: &Mesh, options: &Sampling) -> Result<Self> {
        let reconstructed = sample_surface(mesh, options.surface_samples, options.seed)?;
        let observed = observation.cloud(options.max_points, options.seed);
        Ok(Self::new(observed, reconstructed, Normals::Measured, options.measured))
    }
}
