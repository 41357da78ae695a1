//! Preset `precise`: search by rendering.

use super::Estimated;
use super::options::{AlignOptions, Quality};
use super::progress::{Stage, Stopwatch};
use super::report::{Alternative, Counts};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::mesh::Mesh;
use crate::geometry::rotations::angle_between;
use crate::stages::observe::Observation;
use crate::stages::search::{Search, SearchSettings};

/// When each stage begins, as a share of the whole; from profiles of real cases.
pub(super) const PLAN: &[(Stage, f64)] = &[
    (Stage::Observe, 0.0),
    (Stage::Sample, 0.01),
    (Stage::Normals, 0.02),
    (Stage::Prepare, 0.15),
    (Stage::Search, 0.2),
    (Stage::Refine, 0.6),
    (Stage::Metrics, 0.85),
];

/// Grid of rotations, refinement, choice.
pub(super) fn estimate(
    observation: &Observation,
    mesh: &Mesh,
    settings: &SearchSettings,
    stages: &mut Stopwatch<'_>,
) -> Result<Estimated> {
    stages.enter(Stage::Prepare);
    let mut search = Search::new(observation, mesh, *settings).ok_or_else(no_candidate)?;
    stages.enter(Stage::Search);
    let candidates = search.coarse();
    stages.enter(Stage::Refine);
    let found = search.refine(candidates);
    let (best, others) = found.split_first().ok_or_else(no_candidate)?;
    let alternatives = others
        .iter()
        .map(|other| Alternative {
            camera_from_mesh: (&other.pose.similarity(&search.frame)).into(),
            score: f64::from(other.score.total),
            turn_deg: angle_between(best.pose.rotation, other.pose.rotation).to_degrees(),
        })
        .collect();
    Ok(Estimated {
        camera_from_mesh: best.pose.similarity(&search.frame),
        clamped: false,
        converged: true,
        residual_m: 0.0,
        confidence: None,
        score: Some(f64::from(best.score.total)),
        alternatives,
        uncertainty: None,
        counts: Counts { renders: search.renders, ..Counts::default() },
    })
}

/// The search that the options ask for.
pub fn search_settings(options: &AlignOptions) -> SearchSettings {
    match options.quality {
        Quality::Fast => SearchSettings::fast(),
        Quality::Balanced => SearchSettings::default(),
        Quality::Best => SearchSettings::best(),
    }
}

fn no_candidate() -> Error {
    Error::new(
        ErrorCode::NoConsensus,
        "mesh",
        "no pose whose picture overlaps the mask",
        "a mesh and a mask of one object",
        "Check that mesh and mask show the same object, and that the camera belongs to the depth map.",
    )
}
