//! Classical ICP: equal weights for all pairs within a constant maximum distance.

use crate::prelude::*;
use sim3align::register::at_once::refine;
use sim3align::register::icp::{IcpMetric, IcpSettings, Refined};
use sim3align::register::support::SupportSettings;

/// Settings for which [`refine`] is the ICP of Besl & McKay or Chen & Medioni with a maximum correspondence distance,
/// like `registration_icp` of Open3D: without weights, decreasing distance, and check of the normals.
pub fn classical(metric: IcpMetric, max_correspondence_distance: f32, max_iterations: usize) -> IcpSettings {
    IcpSettings {
        metric,
        robust: false,
        lock_scale: true,
        scale_bounds: None,
        max_iterations,
        support: SupportSettings { max_distance: max_correspondence_distance, min_cosine: -1.0 },
        final_distance: max_correspondence_distance,
        tolerance: TOLERANCE,
    }
}

/// Converged if no corner of the unit box moves further than this in an iteration. Open3D stops if fitness and residual
/// change by less than 10⁻⁶, which is earlier for a flat objective.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Rigid ICP, the scale that of `initial`.
///
/// # Errors
/// [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) where fewer than six source points have a target
/// point within reach: `initial` would be no answer.
pub fn solve(
    source: &Cloud,
    target: &Cloud,
    target_tree: &KdTree,
    initial: &Similarity,
    settings: &IcpSettings,
) -> Result<Refined> {
    let refined = refine(source, target, target_tree, initial, settings);
    if refined.iterations == 0 { Err(no_overlap(refined.supported)) } else { Ok(refined) }
}

/// Error of local methods if the clouds do not overlap at the initial pose.
pub(super) fn no_overlap(pairs: usize) -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "source",
        format!("{pairs} points within reach of the target"),
        "six at least",
        "Start nearer, or widen the largest distance of correspondences.",
    )
}
