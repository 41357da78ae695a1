//! Clouds on a voxel grid, prepared for descriptors: with normals at the scale of the grid, and a search tree.

use glam::Vec3;

use crate::evidence::normals::{Orientation, paused_normals};
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::voxel_grid::paused_downsample;
use crate::scheduler::Scheduler;

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
    /// Downsamples a cloud with normals to voxels of edge `voxel_size`. If more than `count` are occupied, the grid is
    /// coarser, unless its voxels are larger than 1: the diagonal of the box of a normalised cloud.
    pub async fn of_at_most(count: usize, full: &Cloud, voxel_size: f32, scheduler: &Scheduler) -> Self {
        let mut cloud = paused_downsample(full, voxel_size, scheduler).await;
        // Doubling the voxels quarters the cells of a surface, so that few rounds suffice.
        let mut size = voxel_size;
        while cloud.len() > count && size < 1.0 {
            size *= 1.25;
            cloud = paused_downsample(full, size, scheduler).await;
        }
        Self::with_smooth_normals(cloud, scheduler).await
    }

    /// Estimates normals from the points of the grid, so that both clouds have normals at the same scale, independent
    /// of density and noise. The mean normals of the cells determine the orientation.
    async fn with_smooth_normals(mut cloud: Cloud, scheduler: &Scheduler) -> Self {
        let tree = KdTree::paused(&cloud.points, scheduler).await;
        let normals =
            paused_normals(&cloud.points, &tree, NORMAL_NEIGHBORS, Orientation::TowardsCamera, scheduler).await;
        for (own, smooth) in cloud.normals.iter_mut().zip(normals) {
            if smooth != Vec3::ZERO {
                *own = if own.dot(smooth) < 0.0 { -smooth } else { smooth };
            }
        }
        Self { cloud, tree }
    }
}
