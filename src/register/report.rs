//! The result of `register` and `estimateSim3`.

use serde::Serialize;

use crate::progress::Timings;
use crate::report::{Counts, Sim3};

/// The result of `register` and `estimateSim3`: target from source, y = s·R·x + t.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Registration {
    /// The transform.
    #[serde(flatten)]
    pub target_from_source: Sim3,
    /// Share of the source points that land within the inlier distance of a target point, 0 to 1; for `estimateSim3`,
    /// the share of the correspondences that are inliers.
    pub fitness: f64,
    /// Root mean square distance of the inliers (or residual of the refinement), in target units.
    pub residual: f64,
    /// Everything else: initial scale, counts, timings.
    pub diagnostics: RegistrationDiagnostics,
}

/// Diagnostics of `register` and `estimateSim3`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct RegistrationDiagnostics {
    /// The seed it ran with.
    pub seed: u32,
    /// The ratio of the bounding boxes' diagonals, target to source, around which a free scale is sought.
    pub initial_scale: f64,
    /// The scale divided by the initial scale.
    pub scale_ratio: f64,
    /// Whether the refinement converged; `true` where there was none.
    pub converged: bool,
    /// Number of source points that `register` skipped, because a coordinate is NaN or infinite.
    pub skipped_source_points: usize,
    /// Number of target points that `register` skipped.
    pub skipped_target_points: usize,
    /// Sizes of the problem and events during the run.
    pub counts: Counts,
    /// Milliseconds per stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Timings"))]
    pub timings_ms: Timings,
}
