//! Diagnostics: what happened on the way to a result.

use serde::Serialize;

use super::preset::{Effort, Preset};
use crate::options::choices;
use crate::progress::Timings;

/// Sizes of the problem and events during the run. `precise` counts points and renders, the other methods everything
/// but renders; what a method does not count is 0.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Counts {
    /// Source points: of the mesh surface, or of the source cloud.
    pub source_points: usize,
    /// Target points: observed, or of the target cloud.
    pub target_points: usize,
    /// Source points left on the voxel grid.
    pub source_voxels: usize,
    /// Target points left on the voxel grid.
    pub target_voxels: usize,
    /// Correspondences that went into RANSAC.
    pub matches: usize,
    /// Correspondences that agree with the consensus.
    pub inliers: usize,
    /// Source points that the target supported in the last iteration of the refinement.
    pub supported: usize,
    /// Minimal sets that RANSAC drew.
    pub iterations: usize,
    /// Minimal sets dropped by the edge-length check.
    pub inconsistent: usize,
    /// Hypotheses dropped because their scale left the guard.
    pub rejected: usize,
    /// Hypotheses whose scale was projected back into the guard.
    pub clamped: usize,
    /// ICP iterations.
    pub icp_iterations: usize,
}

/// Sizes of the problem and of the search.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct SearchCounts {
    /// Source points, of the mesh surface.
    pub source_points: usize,
    /// Target points, observed.
    pub target_points: usize,
    /// Images that the search drew.
    pub renders: usize,
}

/// The terms of the search's score: agreements from 0 to 1, measured on the search's own grid of the cleaned
/// observation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ScoreTerms {
    /// Overlap of mask and silhouette; parts hidden by an occluder or by the image border hardly count.
    pub overlap: f64,
    /// Share of the mask that the mesh covers.
    pub coverage: f64,
    /// Agreement of the depths, where both have one.
    pub depth: f64,
    /// Agreement of the normals, where both have one.
    pub normals: f64,
    /// Agreement of the outlines.
    pub outline: f64,
    /// Share of the silhouette that is hidden.
    pub hidden: f64,
}

choices! {
    /// The outcome of the comparison of colours.
    pub enum ColorVerdict {
        /// Too little of the mesh is in the mask for a comparison.
        #[default]
        Hidden = "hidden",
        /// No other pose that shape allows looks different.
        Uniform = "uniform",
        /// No pose that shape allows agrees with the photo: the colours of the mesh are not those of the object, or its
        /// print is invisible. Shape decided.
        Unmatched = "unmatched",
        /// The best pose by shape agrees best with the photo, too.
        Agreed = "agreed",
        /// Of the poses that shape allows, another one agrees best with the photo, and is the result.
        Decided = "decided",
    }
}

/// The part of the colours of photo and mesh in an alignment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ColorReport {
    /// The outcome of the comparison.
    pub verdict: ColorVerdict,
    /// Correlation of the colours of mesh and photo at the resulting pose, without the shading that normals explain,
    /// −1 to 1.
    pub agreement: f64,
    /// Lead over the next pose that shape allows and that looks different, in units of the correlation; `null` where there
    /// is none.
    pub margin: Option<f64>,
}

/// The report of all presets besides the pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Diagnostics {
    /// The method that ran.
    pub preset: Preset,
    /// The seed it ran with.
    pub seed: u32,
    /// s_init: the ratio of the bounding boxes' diagonals, observation to mesh (§3.1).
    pub initial_scale: f64,
    /// The scale divided by the initial scale.
    pub scale_ratio: f64,
    /// Whether the scale collapsed: `scaleRatio` is below 0.3.
    pub collapsed: bool,
    /// Whether the scale was held at a bound.
    pub clamped: bool,
    /// Whether the refinement converged.
    pub converged: bool,
    /// Root mean square residual of the refinement, in metres.
    pub residual_m: f64,
    /// Milliseconds per stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Timings"))]
    pub timings_ms: Timings,
}

/// Diagnostics of the preset `paper`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct PaperDiagnostics {
    /// The report of all presets.
    #[serde(flatten)]
    pub common: Diagnostics,
    /// Sizes of the problem and events during the run.
    pub counts: Counts,
}

/// Diagnostics of the preset `precise`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct PreciseDiagnostics {
    /// The report of all presets.
    #[serde(flatten)]
    pub common: Diagnostics,
    /// Sizes of the problem and of the search.
    pub counts: SearchCounts,
    /// The effort of the search that found the pose; it follows from `quality`.
    pub effort: Effort,
    /// The search's objective, 0 to about 2. It compares poses of one input; scores of different inputs do not compare. Unless
    /// the scale is fixed, it is that of the mesh in the proportions that fit the image best.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// What colour contributed; present where photo and mesh have colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color: Option<ColorReport>,
}

/// The paper's definition of a collapsed scale.
pub fn is_collapsed(scale_ratio: f64) -> bool {
    scale_ratio < 0.3
}
