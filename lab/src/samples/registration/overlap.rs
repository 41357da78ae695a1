//! How much of two clouds is the same surface.

use glam::Vec3;

use sim3align_geometry::kd_tree::KdTree;
use sim3align_geometry::similarity::Similarity;

/// Indices of the source's points that land within `distance` of a target point.
pub fn covered(source: &[Vec3], target: &KdTree, target_from_source: &Similarity, distance: f32) -> Vec<usize> {
    let transform = target_from_source.to_f32();
    let is_near = |(_, point): &(usize, &Vec3)| target.nearest_within(transform.apply(**point), distance).is_some();
    source.iter().enumerate().filter(is_near).map(|(i, _)| i).collect()
}

/// The share of the points of both clouds that have a point of the other within `distance`, 0 to 1.
pub fn overlap(source: &[Vec3], target: &[Vec3], target_from_source: &Similarity, distance: f32) -> f64 {
    let there = covered(source, &KdTree::new(target), target_from_source, distance).len();
    let back = covered(target, &KdTree::new(source), &target_from_source.inverse(), distance).len();
    (there + back) as f64 / (source.len() + target.len()).max(1) as f64
}
