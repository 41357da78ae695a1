//! Hallucination filtering (paper §3.1): generators hallucinate the side that the camera did not see. Only source
//! points are used that the observation supports under the current pose, by position and normal.

use glam::Vec3;

use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::Similarity;

/// Conditions of support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportSettings {
    /// Maximum distance to the nearest target point, in the target frame; may be infinite.
    pub max_distance: f32,
    /// Minimum cosine between the two normals; −1 disables the check. Unknown normals (zero) pass.
    pub min_cosine: f32,
}

impl SupportSettings {
    /// No filter: every source point is supported by its nearest target point.
    pub const EVERYTHING: Self = Self { max_distance: f32::INFINITY, min_cosine: -1.0 };
}

/// A supported source point and the target point that supports it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Index into the source cloud.
    pub source: u32,
    /// Index into the target cloud, the nearest to the transformed source point.
    pub target: u32,
    /// The transformed source point, in the target frame.
    pub landed: Vec3,
}

/// The source points that the target supports under a pose, in the order of the source.
pub fn supported(
    source: &Cloud,
    target: &Cloud,
    target_tree: &KdTree,
    target_from_source: &Similarity,
    settings: &SupportSettings,
) -> Vec<Support> {
    let transform = target_from_source.to_f32();
    let support = |(i, &point): (usize, &Vec3)| {
        let landed = transform.apply(point);
        let nearest = target_tree.nearest_within(landed, settings.max_distance)?;
        if let (Some(&n), Some(&m)) = (source.normals.get(i), target.normals.get(nearest.index as usize))
            && settings.min_cosine > -1.0
            && n != Vec3::ZERO
            && m != Vec3::ZERO
            && transform.rotate(n).dot(m) < settings.min_cosine
        {
            return None;
        }
        Some(Support { source: i as u32, target: nearest.index, landed })
    };
    source.points.iter().enumerate().filter_map(support).collect()
}
