//! Clouds on a voxel grid, prepared for descriptors: with normals at the scale of the grid, and a search tree.

use glam::Vec3;

use crate::evidence::normals::{Neighborhood, Orientation, estimate_normals};
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::voxel_grid::voxel_downsample;

/// Neighbours on the voxel grid for normal estimation: about those within two voxels.
const NORMAL_NEIGHBORS: usize = 16;

/// The means of the occupied voxels of a cloud.
#[derive(Debug, Clone)]
pub struct GridCloud {
    /// The points, with normals.
    pub cloud: Cloud,
    /// The search tree over the points.
    pub tree: KdTree,
}

impl GridCloud {
    /// Downsamples a cloud with normals to voxels of edge `voxel_size`.
    pub fn new(full: &Cloud, voxel_size: f32) -> Self {
        Self::with_smooth_normals(voxel_downsample(full, voxel_size))
    }

    /// Like [`GridCloud::new`], for a cloud with a box diagonal of 1. If more than `count` voxels are occupied, the
    /// grid is coarser.
    pub fn of_at_most(count: usize, full: &Cloud, voxel_size: f32) -> Self {
        let mut cloud = voxel_downsample(full, voxel_size);
        // Doubling the voxels quarters the cells of a surface, so that few rounds suffice.
        let mut size = voxel_size;
        while cloud.len() > count && size < 1.0 {
            size *= 1.25;
            cloud = voxel_downsample(full, size);
        }
        Self::with_smooth_normals(cloud)
    }

    /// Estimates normals from the points of the grid, so that both clouds have normals at the same scale, independent
    /// of density and noise. The mean normals of the cells determine the orientation.
    fn with_smooth_normals(mut cloud: Cloud) -> Self {
        let tree = KdTree::new(&cloud.points);
        let neighborhood = Neighborhood::nearest(NORMAL_NEIGHBORS);
        let normals = estimate_normals(&cloud.points, &tree, neighborhood, Orientation::TowardsCamera);
        for (own, smooth) in cloud.normals.iter_mut().zip(normals) {
            if smooth != Vec3::ZERO {
                *own = if own.dot(smooth) < 0.0 { -smooth } else { smooth };
            }
        }
        Self { cloud, tree }
    }
}
