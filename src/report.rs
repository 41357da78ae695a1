//! The results of the entry points.

use serde::Serialize;

use crate::geometry::similarity::Similarity;
use crate::metrics::Metrics;
use crate::options::{Choice, choices};
use crate::progress::Timings;

choices! {
    /// The method of an alignment.
    pub enum Preset {
        /// Search by rendering: finds the pose whose rendering best explains mask, free space and depth.
        #[default]
        Precise = "precise",
        /// The paper's method: FPFH, guarded Sim(3) RANSAC, hallucination filtering, scale-locked ICP.
        Paper = "paper",
    }
}

choices! {
    /// The work of one search.
    pub enum Effort {
        /// Few rotations and candidates.
        Fast = "fast",
        /// Between the others.
        #[default]
        Balanced = "balanced",
        /// Many rotations and candidates.
        Best = "best",
    }
}

impl Preset {
    /// The name in JavaScript.
    pub fn as_str(self) -> &'static str {
        self.name()
    }
}

/// A similarity y = s·R·x + t in the forms that applications use.
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
    #[cfg_attr(feature = "types", ts(type = "number[]"))]
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

/// A condition that the caller should know about; the result stands.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct Warning {
    /// The kind of warning, stable across releases.
    pub code: WarningCode,
    /// What was found, and what to do about it.
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
    /// Depths so small that they look like metres taken as millimetres.
    DepthLooksTooSmall,
    /// The mask covers the whole image: it is probably inverted, or no mask.
    MaskCoversImage,
    /// The mask touches the image border: part of the object is outside the view.
    MaskTouchesBorder,
    /// Less than half of the mask has a depth reading.
    SparseDepth,
    /// The scale was held at a bound of `scale` or of the guard.
    ScaleClamped,
    /// The scale fell below 0.3 of the initial scale.
    ScaleCollapsed,
    /// The refinement ended before it converged.
    NotConverged,
    /// Even the best pose explains the observation poorly: the mesh may be of another object.
    MeshDoubtful,
    /// A view contradicts the others and does not count (`alignViews`).
    ViewContradicts,
    /// A view shows too little where the object should be, and does not count (`alignViews`).
    ViewShowsNothing,
    /// The camera file has lens distortion, which the pinhole model leaves out. The package's camera reader warns of
    /// it.
    CameraNotPinhole,
    /// The colours of the mesh file cannot be read, such as a texture in an unsupported format: the mesh is aligned by its
    /// shape alone. The package's mesh reader warns of it.
    ColorsNotRead,
}

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

/// Another pose that explains the observation: a transform like the alignment's own.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alternative {
    /// The transform from the mesh's frame to the camera's.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Its score, which compares with the alignment's `diagnostics.score`.
    pub score: f64,
    /// The angle between its rotation and the alignment's, in degrees, 0 to 180.
    pub turn_deg: f64,
    /// By how much its colours agree less with the photo than the alignment's, as a difference of correlations; present
    /// where colours were compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color_margin: Option<f64>,
}

choices! {
    /// What the comparison of colours came to.
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

/// What the colours of photo and mesh contributed to an alignment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ColorReport {
    /// What the comparison came to.
    pub verdict: ColorVerdict,
    /// Correlation of the colours of mesh and photo at the resulting pose, without the shading that normals explain,
    /// −1 to 1.
    pub agreement: f64,
    /// Lead over the next pose that shape allows and that looks different, in units of the correlation; `null` where there
    /// is none.
    pub margin: Option<f64>,
}

/// Standard deviations of the pose's parts, as the observation determines them. Parts that a single view leaves open,
/// such as the turn of a round object about its axis, have large ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Uncertainty {
    /// Of the scale, relative: 0.01 is one per cent.
    pub scale: f64,
    /// Of the rotation about the least determined axis, in degrees.
    pub rotation_deg: f64,
    /// That axis: a unit vector in the camera's frame.
    pub rotation_axis: [f64; 3],
    /// Of the mesh centre's position across the line of sight, in metres.
    pub lateral_m: f64,
    /// Of the mesh centre's distance from the camera, in metres.
    pub distance_m: f64,
}

/// What all presets report of an alignment besides the pose.
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
    /// Sizes of the problem and events during the run.
    pub counts: Counts,
    /// Milliseconds per stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Timings"))]
    pub timings_ms: Timings,
}

/// Diagnostics of the preset `precise`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct PreciseDiagnostics {
    /// What all presets report.
    #[serde(flatten)]
    pub common: Diagnostics,
    /// The effort of the search that found the pose; it follows from `quality`.
    pub effort: Effort,
    /// The search's objective, 0 to about 2. It compares poses of one input; scores of different inputs do not compare.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// What colour contributed; present where photo and mesh have colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color: Option<ColorReport>,
}

/// The result of `align`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y down, z forward; metres).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alignment {
    /// The transform.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Probability that the pose is right (scale within 5 %, rotation within 10° up to symmetry, translation within 5 %
    /// of the diameter), calibrated on generated cases. It assumes that the mesh is the object's.
    pub confidence: f64,
    /// Other poses that explain the observation nearly as well, best first: flips, and turns under which the object
    /// looks alike though the mesh does not.
    pub alternatives: Vec<Alternative>,
    /// How well the observation determines each part of the pose; `null` where the search could not tell.
    pub uncertainty: Option<Uncertainty>,
    /// Agreement of the posed mesh with the observation.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(as = "Metrics"))]
    pub metrics: Option<Metrics>,
    /// Conditions that the caller should know about; the result stands.
    pub warnings: Vec<Warning>,
    /// Everything else: initial scale, score, counts, timings.
    pub diagnostics: PreciseDiagnostics,
}

/// The result of `align` with `preset: "paper"`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y
/// down, z forward; metres).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct PaperAlignment {
    /// The transform.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Agreement of the posed mesh with the observation.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(as = "Metrics"))]
    pub metrics: Option<Metrics>,
    /// Conditions that the caller should know about; the result stands.
    pub warnings: Vec<Warning>,
    /// Everything else: initial scale, counts, timings.
    pub diagnostics: Diagnostics,
}

/// The result of an alignment by either preset.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AnyAlignment {
    /// Of the preset `precise`.
    Precise(Box<Alignment>),
    /// Of the preset `paper`.
    Paper(Box<PaperAlignment>),
}

impl AnyAlignment {
    /// The transform.
    pub fn camera_from_mesh(&self) -> &Sim3 {
        match self {
            Self::Precise(found) => &found.camera_from_mesh,
            Self::Paper(found) => &found.camera_from_mesh,
        }
    }

    /// Alternative poses; only `precise` has them.
    pub fn alternatives(&self) -> &[Alternative] {
        match self {
            Self::Precise(found) => &found.alternatives,
            Self::Paper(_) => &[],
        }
    }

    /// The metrics, unless they were not asked for.
    pub fn metrics(&self) -> Option<Metrics> {
        match self {
            Self::Precise(found) => found.metrics,
            Self::Paper(found) => found.metrics,
        }
    }

    /// What all presets report.
    pub fn diagnostics(&self) -> &Diagnostics {
        match self {
            Self::Precise(found) => &found.diagnostics.common,
            Self::Paper(found) => &found.diagnostics,
        }
    }
}

impl From<Alignment> for AnyAlignment {
    fn from(alignment: Alignment) -> Self {
        Self::Precise(Box::new(alignment))
    }
}

impl From<PaperAlignment> for AnyAlignment {
    fn from(alignment: PaperAlignment) -> Self {
        Self::Paper(Box::new(alignment))
    }
}

/// The paper's definition of a collapsed scale.
pub fn is_collapsed(scale_ratio: f64) -> bool {
    scale_ratio < 0.3
}

/// The pose that a method found.
#[derive(Debug, Clone, Copy)]
pub struct Solution {
    /// The pose.
    pub camera_from_mesh: Similarity,
    /// Whether the scale was held at a bound.
    pub clamped: bool,
    /// Whether the refinement converged.
    pub converged: bool,
    /// Root mean square residual of the refinement, in metres.
    pub residual_m: f64,
    /// Sizes of the problem and events during the run.
    pub counts: Counts,
}

impl Solution {
    /// A pose of which nothing else is known.
    pub fn of_pose(camera_from_mesh: Similarity) -> Self {
        Self { camera_from_mesh, clamped: false, converged: true, residual_m: 0.0, counts: Counts::default() }
    }
}
