//! The result of `alignViews`.

use serde::Serialize;

use crate::metrics::Metrics;
use crate::options::choices;
use crate::progress::Timings;
use crate::report::{Alternative, ColorReport, Effort, FoundSymmetry, ScoreTerms, Sim3, Stretch, Warning};

choices! {
    /// The world of a result.
    pub enum WorldFrame {
        /// That of the given camera poses.
        #[default]
        Given = "given",
        /// The camera of the first view that was used, because no camera poses were given.
        Camera = "camera",
    }
}

choices! {
    /// The part of a view in the result.
    pub enum ViewRole {
        /// Its evidence counts.
        #[default]
        Used = "used",
        /// Its evidence contradicts that of the others, and does not count.
        Contradicting = "contradicting",
        /// It shows nothing of the object: its mask cannot be used, or has too few readings, or there are too few where the
        /// object should be. Without given camera poses, the pose in it is unknown: it has a confidence of 0.
        Unusable = "unusable",
    }
}

/// Standard deviations of the pose in the world, as all views together determine them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct WorldUncertainty {
    /// Of the scale, relative: 0.01 is one per cent.
    pub scale: f64,
    /// Of the rotation about the least determined axis, in degrees, up to the symmetry of the mesh.
    pub rotation_deg: f64,
    /// That axis: a unit vector in the world frame.
    pub rotation_axis: [f64; 3],
    /// The axis of revolution of the mesh, a unit vector in the world frame: any turn about it leaves its shape as it is, and
    /// does not count as uncertain. `null` if it has none.
    pub free_axis: Option<[f64; 3]>,
    /// Of the mesh centre's position along the least determined direction, in metres.
    pub position_m: f64,
}

/// The pose of a camera in the world.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct CameraPose {
    /// World from camera: a transform of scale 1.
    #[serde(flatten)]
    pub world_from_camera: Sim3,
    /// Standard deviation of its rotation, in degrees; 0 for given camera poses and for the camera that is the world, `null`
    /// where the views do not determine it.
    pub rotation_sd_deg: Option<f64>,
    /// Standard deviation of its position, in metres; 0 and `null` as above.
    pub position_sd_m: Option<f64>,
}

/// The object in one of the views.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ViewPose {
    /// Camera from mesh.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Probability that this pose is right; see `Alignment.confidence`.
    pub confidence: f64,
    /// The part of the view in the result.
    pub role: ViewRole,
    /// The pose of its camera.
    pub camera: CameraPose,
    /// The score of the pose in this view; it compares with that of `align` for the same view.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// What the colours of photo and mesh contributed; with given camera poses, those of all views together. Present where
    /// the view has a photo and the mesh has colours.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color: Option<ColorReport>,
    /// Agreement of the posed mesh with the view.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(as = "Metrics"))]
    pub metrics: Option<Metrics>,
    /// Conditions of this view that the caller should know about.
    pub warnings: Vec<Warning>,
}

/// Diagnostics of `alignViews`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ViewsDiagnostics {
    /// The seed it ran with.
    pub seed: u32,
    /// The effort of the searches that found the pose.
    pub effort: Effort,
    /// The sum of the scores of all views.
    pub score: f64,
    /// Whether the refinement converged.
    pub converged: bool,
    /// Images that the searches drew.
    pub renders: usize,
    /// Milliseconds per stage, and their total.
    #[cfg_attr(feature = "types", ts(type = "Timings"))]
    pub timings_ms: Timings,
}

/// The result of `alignViews`: world from mesh, x_world = s·R·p_mesh + t, in metres.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct ViewsAlignment {
    /// The transform.
    #[serde(flatten)]
    pub world_from_mesh: Sim3,
    /// The world.
    pub world: WorldFrame,
    /// Probability that the pose is right; see `Alignment.confidence`. Without given camera poses, that of the least certain view.
    pub confidence: f64,
    /// The same up to the symmetry of the shape; see `Alignment.shapeConfidence`.
    pub shape_confidence: f64,
    /// The probability of the turn; see `Alignment.turnConfidence`.
    pub turn_confidence: Option<f64>,
    /// The symmetry of the shape by which poses counted as one: that of the option, or what was found on the mesh. Empty without one.
    pub symmetry: Vec<FoundSymmetry>,
    /// Other poses that explain all views nearly as well, world from mesh, best first. Empty without given camera poses.
    pub alternatives: Vec<Alternative>,
    /// How well the views together determine the pose; `null` where they do not.
    pub uncertainty: Option<WorldUncertainty>,
    /// The mesh in its true proportions, world from stretched mesh; present where they were asked for, and fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub proportions: Option<Stretch>,
    /// The object in each view, in the order of the input.
    pub views: Vec<ViewPose>,
    /// Conditions that the caller should know about; the result stands.
    pub warnings: Vec<Warning>,
    /// Everything else.
    pub diagnostics: ViewsDiagnostics,
}
