//! Preset `paper`: the paper's method, faithfully (§3.1 to §3.3).

pub mod options;

use crate::error::Result;
use crate::evidence::clouds::Clouds;
use crate::evidence::extents::target_from_source;
use crate::paper::options::PaperOptions;
use crate::progress::{Stage, Stopwatch};
use crate::register::global::{Problem, Settings};
use crate::report::Solution;

/// When each stage begins, as a share of the whole; from profiles of real cases.
pub const PLAN: &[(Stage, f64)] = &[
    (Stage::Observe, 0.0),
    (Stage::Sample, 0.02),
    (Stage::Normals, 0.05),
    (Stage::Features, 0.2),
    (Stage::Matching, 0.25),
    (Stage::Ransac, 0.35),
    (Stage::Filter, 0.5),
    (Stage::Icp, 0.5),
    (Stage::Metrics, 0.7),
];

/// Descriptors, guarded RANSAC, hallucination filter, scale-locked ICP.
pub fn estimate(clouds: &mut Clouds, options: &PaperOptions, stages: &mut Stopwatch<'_>) -> Result<Solution> {
    let (evidence, [observed, reconstructed]) = clouds.evidence(stages);
    // §3.1: from here both clouds are centred, with a box diagonal of 1.
    let target = observed.normalized(&evidence.observed);
    let source = reconstructed.normalized(&evidence.reconstructed);
    let settings = Settings::of(options);
    let estimate = Problem::new(&source, &target, &settings, stages).solve(&settings, stages)?;
    Ok(Solution {
        clamped: estimate.clamped,
        converged: estimate.converged,
        residual_m: estimate.rms * observed.diagonal(),
        counts: estimate.counts,
        ..Solution::of_pose(target_from_source(observed, &estimate.target_from_source, reconstructed))
    })
}
