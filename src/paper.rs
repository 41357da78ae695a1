//! Preset `paper`: the paper's method, faithfully (§3.1 to §3.3).

use crate::align::Estimated;
use crate::align::options::AlignOptions;
use crate::error::Result;
use crate::evidence::Evidence;
use crate::evidence::extents::{Extents, target_from_source};
use crate::progress::{Stage, Stopwatch};
use crate::register::global::{Problem, Settings};

/// When each stage begins, as a share of the whole; from profiles of real cases.
pub(super) const PLAN: &[(Stage, f64)] = &[
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
pub(super) fn estimate(
    evidence: &Evidence,
    extents: [&Extents; 2],
    options: &AlignOptions,
    stages: &mut Stopwatch<'_>,
) -> Result<Estimated> {
    let [observed, reconstructed] = extents;
    // §3.1: from here both clouds are centred, with a box diagonal of 1.
    let target = observed.normalized(&evidence.observed);
    let source = reconstructed.normalized(&evidence.reconstructed);
    let settings = Settings::of(options);
    let estimated = Problem::new(&source, &target, &settings, stages).solve(&settings, stages)?;
    Ok(Estimated {
        clamped: estimated.clamped,
        converged: estimated.converged,
        residual_m: estimated.rms * observed.diagonal(),
        counts: estimated.counts,
        ..Estimated::of_pose(target_from_source(observed, &estimated.target_from_source, reconstructed))
    })
}
