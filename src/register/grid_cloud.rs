//! A cloud on its voxel grid, with what descriptors need: normals at the grid's own scale, and a tree.

use glam::Vec3;

use crate::evidence::normals::{Neighborhood, Orientation, estimate_normals};
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::voxel_grid::voxel_downsample;

/// Neighbours on the voxel grid from which a normal is estimated: about two voxels around.
const NORMAL_NEIGHBORS: usize = 16;

/// The means of a cloud's occupied voxels.
#[derive(Debug, Clone)]
pub struct GridCloud {
    /// The points, with normals.
    pub cloud: Cloud,
    /// The tree over these points.
    pub tree: KdTree,
}

impl GridCloud {
    /// A cloud with normals on a grid of `voxel_size`.
    pub fn new(full: &Cloud, voxel_size: f32) -> Self {
        Self::with_smooth_normals(voxel_downsample(full, voxel_size))
    }

    /// As [`GridCloud::new`], for a cloud with a box diagonal of 1: on a coarser grid where more than `count` voxels
    /// are occupied.
    pub fn of_at_most(count: usize, full: &Cloud, voxel_size: f32) -> Self {
        let mut cloud = voxel_downsample(full, voxel_size);
        // A surface has a quarter of the cells when they are twice as large: a few rounds at most.
        let mut size = voxel_size;
        while cloud.len() > count && size < 1.0 {
            size *= 1.25;
            cloud = voxel_downsample(full, size);
        }
        Self::with_smooth_normals(cloud)
    }

    /// Normals for the descriptors, from the grid's own points: both clouds then have them at one scale, whatever
    /// their density and noise. The mean normals of the cells say which side is outside.
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
