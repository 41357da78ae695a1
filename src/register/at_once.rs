//! The long parts of registration as functions without pauses.

use glam::Vec3;

use super::fpfh::Descriptor;
use super::grid_cloud::GridCloud;
use super::icp::{IcpSettings, Refined};
use super::matching::{Match, Nearest};
use super::ransac::{Consensus, RansacSettings};
use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::Similarity;
use crate::pauses::{Pauses, finished};

/// See [`super::density::dense_points`].
pub fn dense_points(points: &[Vec3]) -> Vec<usize> {
    finished(super::density::dense_points(points, &Pauses::none()))
}

/// See [`GridCloud::of_at_most`].
pub fn grid_cloud(count: usize, full: &Cloud, voxel_size: f32) -> GridCloud {
    finished(GridCloud::of_at_most(count, full, voxel_size, &Pauses::none()))
}

/// See [`super::fpfh::fpfh`].
pub fn fpfh(cloud: &Cloud, tree: &KdTree, radius: f32) -> Vec<Descriptor> {
    finished(super::fpfh::fpfh(cloud, tree, radius, &Pauses::none()))
}

/// See [`super::matching::Nearest`].
pub fn nearest(source: &[Descriptor], target: &[Descriptor]) -> Nearest {
    finished(Nearest::of(source, target, &Pauses::none()))
}

/// See [`super::ransac::ransac`].
///
/// # Errors
/// As there.
pub fn ransac(source: &[Vec3], target: &[Vec3], matches: &[Match], settings: &RansacSettings) -> Result<Consensus> {
    finished(super::ransac::ransac(source, target, matches, settings, &Pauses::none()))
}

/// See [`super::icp::refine`].
pub fn refine(
    source: &Cloud,
    target: &Cloud,
    target_tree: &KdTree,
    initial: &Similarity,
    settings: &IcpSettings,
) -> Refined {
    finished(super::icp::refine(source, target, target_tree, initial, settings, &Pauses::none()))
}
