//! The results of a tracker.

use serde::Serialize;

use crate::metrics::Metrics;
use crate::options::choices;
use crate::report::{FoundSymmetry, ScoreTerms, Sim3};

choices! {
    /// The state of a tracker after a frame.
    pub enum TrackState {
        /// The object was followed, or found again.
        #[default]
        Tracking = "tracking",
        /// The object is mostly hidden, or fits less well than before: check the pose.
        Uncertain = "uncertain",
        /// The object was not found. The pose is where its motion would have brought it.
        Lost = "lost",
    }
}

/// The pose in a frame: camera from mesh, x_cam = s·R·p_mesh + t (OpenCV camera: x right, y down, z forward; metres).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct TrackedFrame {
    /// The transform.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// The number of the frame: 0 for the first.
    pub frame: usize,
    /// The state of the tracker.
    pub state: TrackState,
    /// Probability that the pose is right; see `Alignment.confidence`. 0 while the object is lost.
    pub confidence: f64,
    /// The same up to the symmetry of the shape; see `Alignment.shapeConfidence`.
    pub shape_confidence: f64,
    /// The probability of the turn in which the object was found, which is kept while it is tracked; see `Alignment.turnConfidence`.
    pub turn_confidence: Option<f64>,
    /// The symmetry of the shape; see `Alignment.symmetry`.
    pub symmetry: Vec<FoundSymmetry>,
    /// Standard deviation of the size, relative: 0.01 is one per cent. It includes errors that all frames share. 0 for a given
    /// scale.
    pub scale_sd: f64,
    /// Whether the size is settled: later frames keep it.
    pub is_scale_settled: bool,
    /// Whether the pose was searched for anew, without the frame before.
    pub is_detected: bool,
    /// The score of the pose, as of `align`.
    pub score: f64,
    /// The terms of the score.
    pub terms: ScoreTerms,
    /// Agreement of the posed mesh with the frame, if it was asked for and the frame has a mask.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metrics: Option<Metrics>,
}

/// The pose of a frame after a correction of another one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct CorrectedFrame {
    /// The transform.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// The number of the frame.
    pub frame: usize,
}
