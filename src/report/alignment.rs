//! Alignments.

use serde::Serialize;

use super::diagnostics::{PaperDiagnostics, PreciseDiagnostics};
use super::pose::{Alternative, FoundSymmetry, Sim3, Stretch, Uncertainty};
use super::warning::Warning;
use crate::geometry::similarity::Similarity;
use crate::metrics::Metrics;

/// The result of `align`: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y down, z forward; metres).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alignment {
    /// The transform.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Probability that the pose is right in everything that the input shows: `shapeConfidence` times `turnConfidence`, where that is
    /// not `null`. It assumes that the mesh is the object's.
    pub confidence: f64,
    /// Probability that the pose is right up to the symmetry of the shape (scale within 5 %, rotation within 10°, translation within
    /// 5 % of the diameter), calibrated on generated cases.
    pub shape_confidence: f64,
    /// Probability that the turn is right: that of the poses which a symmetry of the shape makes equal, this is the one
    /// whose colours are those of the photo. `null` where no other turn is possible: the shape has no symmetry, its turns look
    /// alike, or there are no colours to compare. Where no turn agrees with the photo, or the colours of the mesh could not be read,
    /// all are equally likely.
    pub turn_confidence: Option<f64>,
    /// The symmetry of the shape by which poses counted as one: that of the option, or what was found on the mesh. Empty without one.
    pub symmetry: Vec<FoundSymmetry>,
    /// Other poses that explain the observation nearly as well, best first. Poses that the symmetry of the shape makes equal
    /// are one, unless their colours differ.
    pub alternatives: Vec<Alternative>,
    /// How well the observation determines each part of the pose; `null` where it is unknown.
    pub uncertainty: Option<Uncertainty>,
    /// The mesh in its true proportions; present where they were asked for, and fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub proportions: Option<Stretch>,
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
    pub diagnostics: PaperDiagnostics,
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
}

impl Solution {
    /// A pose of which nothing else is known.
    pub fn of_pose(camera_from_mesh: Similarity) -> Self {
        Self { camera_from_mesh, clamped: false, converged: true, residual_m: 0.0 }
    }
}
