//! Other methods with the preprocessing of the paper: the same clouds, initial scale and voxel grid.

use super::baseline::Baseline;
use super::clouds::{Clouds, Settings};
use crate::prelude::*;
use sim3align::align::{Setup, align_by};
use sim3align::evidence::Normals;
use sim3align::evidence::extents::target_from_source;
use sim3align::progress::{Host, Stage};
use sim3align::register::at_once::grid_cloud;
use sim3align::register::cloud_pair::MAX_FEATURES;
use sim3align::report::{Counts, PaperAlignment, Solution};

/// Progress at the start of each stage, 0 to 1.
const PLAN: &[(Stage, f64)] = &[
    (Stage::Observe, 0.0),
    (Stage::Sample, 0.02),
    (Stage::Normals, 0.05),
    (Stage::Features, 0.2),
    (Stage::Matching, 0.25),
    (Stage::Ransac, 0.35),
    (Stage::Icp, 0.5),
    (Stage::Metrics, 0.7),
];

/// Aligns a mesh to an observation by another method: the mask's cloud, centred, the mesh scaled by the ratio of the
/// boxes' diagonals, both on a grid of `voxel_divisions`.
///
/// Local methods begin at the centred, unrotated pose. RANSAC's pose is refined by plain ICP unless `icp` is `None`;
/// the others stand as they are published. All but TEASER keep the initial scale; with `lock_scale`, TEASER as well.
///
/// # Errors
/// As [`align`](sim3align::align::align); [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) where the
/// method has no answer.
pub fn align_baseline(
    observation: &Observation,
    mesh: &Mesh,
    baseline: Baseline,
    paper: &PaperOptions,
    lock_scale: bool,
    host: &mut dyn Host,
) -> Result<PaperAlignment> {
    align_by(observation, mesh, &Setup::of_paper(paper)?, PLAN, host, |clouds, stages| {
        let (evidence, [observed, reconstructed]) = clouds.evidence(Normals::All, stages);
        let voxel_size = 1.0 / paper.voxel_divisions;
        let estimates_scale = baseline == Baseline::Teaser && !lock_scale;
        let settings = Settings { paper, voxel_size, estimates_scale, is_upright: false };
        let grid = |cloud: &Cloud| grid_cloud(MAX_FEATURES, cloud, voxel_size as f32);
        let clouds = Clouds {
            source: grid(&reconstructed.normalized(&evidence.reconstructed)),
            target: grid(&observed.normalized(&evidence.observed)),
        };
        let mut matches = Vec::new();
        if baseline.is_local() {
            stages.enter(Stage::Icp);
        } else {
            stages.enter(Stage::Features);
            matches = clouds.matches(&settings);
            stages.enter(Stage::Ransac);
        }
        let found = clouds.solve(baseline, &matches, &settings)?;
        let refined = found.refined;
        let solution = Solution {
            converged: refined.is_none_or(|refined| refined.converged),
            residual_m: refined.map_or(0.0, |refined| refined.rms * observed.diagonal()),
            ..Solution::of_pose(target_from_source(observed, &found.target_from_source, reconstructed))
        };
        let counts = Counts {
            source_voxels: clouds.source.cloud.len(),
            target_voxels: clouds.target.cloud.len(),
            matches: found.matches,
            inliers: found.inliers,
            supported: refined.map_or(0, |refined| refined.supported),
            iterations: found.ransac_iterations,
            icp_iterations: refined.map_or(0, |refined| refined.iterations),
            ..Counts::default()
        };
        Ok((solution, counts))
    })
}
