//! What the entry points return.

use serde::Serialize;

use super::options::Preset;
use crate::geometry::similarity::Similarity;
use crate::metrics::Metrics;
use crate::precise::score::Score;
use crate::progress::Timings;

/// A similarity y = s·R·x + t in every form that callers ask for.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Sim3 {
    /// s, target units per source unit; for `align`, metres per mesh unit.
    pub scale: f64,
    /// R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
    pub rotation: [f64; 4],
    /// R as three rows of three.
    pub rotation_matrix: [[f64; 3]; 3],
    /// t, in target units; for `align`, metres.
    pub translation: [f64; 3],
    /// The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
    pub matrix: [f64; 16],
}

impl From<&Similarity> for Sim3 {
    fn from(similarity: &Similarity) -> Self {
        let row = |i: usize| similarity.rotation.matrix().row(i).transpose().into();
        Self {
            scale: similarity.scale,
            rotation: similarity.quaternion_xyzw(),
            rotation_matrix: [row(0), row(1), row(2)],
            translation: similarity.translation.into(),
            matrix: similarity.to_column_major(),
        }
    }
}

/// Something about the input that the caller should know; the result stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct Warning {
    /// A stable name.
    pub code: WarningCode,
    /// What was found and what to do about it.
    pub message: String,
}

/// The kinds of warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[non_exhaustive]
pub enum WarningCode {
    /// Depths so large that they look like millimetres passed as metres.
    DepthLooksLikeMillimetres,
    /// The mask touches the image border: part of the object is outside the view.
    MaskTouchesBorder,
    /// Less than half of the mask has a depth reading.
    SparseDepth,
    /// The scale stands at a bound of the guard.
    ScaleClamped,
    /// The scale fell below 0.3 of the initial one.
    ScaleCollapsed,
    /// The refinement ended before it came to rest.
    NotConverged,
}

/// How much went in and how much of it counted. `precise` counts the points of both and the renders, every other method
/// all but the renders; the rest is 0.
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
    /// Images that the search drew.
    pub renders: usize,
}

/// What the search's score is made of: agreements from 0 to 1, on the search's own grid of the cleaned observation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ScoreTerms {
    /// Of mask and silhouette; what an occluder or the image border hides hardly counts.
    pub overlap: f64,
    /// Share of the mask that the mesh covers.
    pub coverage: f64,
    /// Of depths, where both have one.
    pub depth: f64,
    /// Of normals, where both have one.
    pub normals: f64,
    /// Of outlines.
    pub outline: f64,
    /// Share of the silhouette that is hidden.
    pub hidden: f64,
}

impl From<&Score> for ScoreTerms {
    fn from(score: &Score) -> Self {
        Self {
            overlap: score.overlap.into(),
            coverage: score.coverage.into(),
            depth: score.depth.into(),
            normals: score.normals.into(),
            outline: score.outline.into(),
            hidden: score.hidden.into(),
        }
    }
}

/// Another pose that explains the observation, as a transform like the alignment's own.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alternative {
    /// The transform from the mesh's frame to the camera's.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Its score, to be compared with the alignment's own.
    pub score: f64,
    /// The angle between its rotation and the alignment's, in degrees, 0 to 180.
    pub turn_deg: f64,
}

/// How far the pose could move, to one standard deviation, before the observation would contradict it: what a single
/// view of a symmetric or flat object leaves free is large.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Uncertainty {
    /// Of the scale, as a share of it: 0.01 is one per cent.
    pub scale: f64,
    /// Of the rotation about the axis that is determined worst, in degrees.
    pub rotation_deg: f64,
    /// That axis: a direction of length 1 in the camera's frame.
    pub rotation_axis: [f64; 3],
    /// Of the position of the mesh's middle across the line of sight, in metres.
    pub lateral_m: f64,
    /// Of its distance from the camera, in metres.
    pub distance_m: f64,
}

/// What `align` found: camera from mesh, x_cam = s·R·p + t.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alignment {
    /// The transform from the mesh's frame to the camera's (OpenCV: x right, y down, z forward; metres).
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// The method that ran.
    pub preset: Preset,
    /// The seed it ran with.
    pub seed: u32,
    /// s_init: the ratio of the box diagonals of P_obs and P_rec (§3.1).
    pub initial_scale: f64,
    /// s / s_init.
    pub scale_ratio: f64,
    /// Whether the scale collapsed: scaleRatio below 0.3.
    pub collapsed: bool,
    /// Whether the scale was projected to a bound of the guard.
    pub clamped: bool,
    /// Whether the refinement came to rest.
    pub converged: bool,
    /// Root mean square residual of the refinement, in metres.
    pub residual_m: f64,
    /// `precise`: how likely the pose is right (scale within 5 %, rotation within 10° up to symmetry, translation
    /// within 5 % of the diameter), 0 to 1, calibrated on generated cases; `null` for `paper`.
    pub confidence: Option<f64>,
    /// `precise`: what the search maximised, 0 to about 2, which says how two poses of one input compare and nothing
    /// about different inputs. `null` for `paper`.
    pub score: Option<f64>,
    /// `precise`: what the score is made of; `null` for `paper`.
    pub terms: Option<ScoreTerms>,
    /// `precise`: other poses that explain the observation nearly as well, best first: flips, and symmetries that the
    /// object has and the mesh has not. Empty where none comes near, and for `paper`.
    pub alternatives: Vec<Alternative>,
    /// `precise`: how well each part of the pose is determined; `null` for `paper`.
    pub uncertainty: Option<Uncertainty>,
    /// The eight metrics of the pose.
    pub metrics: Metrics,
    /// The counts.
    pub counts: Counts,
    /// Milliseconds by stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Partial<Record<Stage, number>> & { total: number }"))]
    pub timings_ms: Timings,
    /// What the caller should know about the input.
    pub warnings: Vec<Warning>,
}

/// What `register` and `estimateSim3` found: target from source, y = s·R·x + t.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Registration {
    /// The transform from the source's frame to the target's.
    #[serde(flatten)]
    pub target_from_source: Sim3,
    /// The seed it ran with.
    pub seed: u32,
    /// The ratio of the clouds' box diagonals, around which a free scale is sought.
    pub initial_scale: f64,
    /// s / s_init.
    pub scale_ratio: f64,
    /// Whether the refinement came to rest; `true` where none was asked for.
    pub converged: bool,
    /// Root mean square distance of the inliers (or of the refinement's residuals), in target units.
    pub residual: f64,
    /// Share of the source points that land within the inlier distance of a target point, 0 to 1; for
    /// `estimateSim3`, share of the correspondences that are inliers.
    pub fitness: f64,
    /// The counts.
    pub counts: Counts,
    /// Milliseconds by stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Partial<Record<Stage, number>> & { total: number }"))]
    pub timings_ms: Timings,
}

/// The paper's definition of a collapsed scale.
pub fn is_collapsed(scale_ratio: f64) -> bool {
    scale_ratio < 0.3
}
