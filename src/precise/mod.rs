//! Preset `precise`: search by rendering for the pose whose image best explains mask, free space and depth.
//!
//! The search runs coarse to fine on a crop around the mask: a grid of rotations, each with size, position and distance
//! in closed form; refinement of the best distinct ones over all seven parameters; and another refinement of the best
//! of these at full resolution.
//!
//! A room uses only those above it:
//!
//! | room | what is in it |
//! |---|---|
//! | [`observation`] | the evidence: what the depth map and the mask reliably show, on grids of cells |
//! | [`drawing`] | the mesh at several resolutions, its poses and symmetry, and the rasteriser |
//! | [`scoring`] | the score: how well an image that was drawn explains the evidence, and what else is known |
//! | [`search`] | the search: its recipe, its rounds, and the refinement of poses |
//! | [`verdict`] | the verdict: confidence, alternatives, uncertainty, and the choice by colour |

pub mod drawing;
pub mod observation;
pub mod options;
pub mod scoring;
pub mod search;
pub mod verdict;

use crate::error::{Error, ErrorCode};
use crate::progress::Stage;

/// Progress at the start of each stage, 0 to 1; from profiles of real cases.
pub const PLAN: &[(Stage, f64)] = &[
    (Stage::Inspect, 0.0),
    (Stage::Observe, 0.05),
    (Stage::Sample, 0.06),
    (Stage::Normals, 0.07),
    (Stage::Prepare, 0.12),
    (Stage::Search, 0.2),
    (Stage::Metrics, 0.85),
];

pub(crate) fn no_candidate() -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "mesh",
        "no pose whose silhouette overlaps the mask",
        "a mesh and a mask of the same object",
        "Check that mesh and mask show the same object, and that the camera belongs to the depth map.",
    )
}
