//! Other methods with the preprocessing of the paper: the same clouds, initial scale and voxel grid.

use nalgebra::Vector3;

use super::baseline::Baseline;
use super::clouds::{Clouds, UnitSettings};
use sim3align::align::{Setup, align_by};
use sim3align::evidence::Normals;
use sim3align::evidence::extents::target_from_source;
use sim3align::evidence::observation::Observation;
use sim3align::paper::options::PaperOptions;
use sim3align::progress::{Host, Stage};
use sim3align::register::at_once::grid_cloud;
use sim3align::register::cloud_pair::MAX_FEATURES;
use sim3align::register::settings::icp_metric;
use sim3align::report::{Counts, PaperAlignment, Solution};
use sim3align_geometry::error::Result;
use sim3align_geometry::mesh::Mesh;

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

/// Options of a baseline.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BaselineOptions {
    /// Clouds, descriptors, RANSAC and ICP, as in the paper's method. `inlier_distance_voxels` is also the noise bound
    /// of TEASER and Quatro; `support_distance_voxels` bounds the correspondences of local methods and of the
    /// refinement.
    pub paper: PaperOptions,
    /// Keeps the initial scale under TEASER, which estimates its own otherwise. All other methods always keep it.
    pub lock_scale: bool,
    /// The up direction in the frames of mesh and camera, which Quatro needs.
    pub up: Option<[[f64; 3]; 2]>,
}

/// Aligns a mesh to an observation by another method: the mask's cloud, centred, the mesh scaled by the ratio of the
/// boxes' diagonals, both on a grid of `voxel_divisions`.
///
/// Local methods begin at the centred, unrotated pose. RANSAC's pose is refined by plain ICP unless `icp` is `None`;
/// the others stand as they are published.
///
/// # Errors
/// As [`align`](sim3align::align::align); [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) where the
/// method has no answer.
pub fn align_baseline(
    observation: &Observation,
    mesh: &Mesh,
    baseline: Baseline,
    options: &BaselineOptions,
    host: &mut dyn Host,
) -> Result<PaperAlignment> {
    let paper = &options.paper;
    align_by(observation, mesh, &Setup::of_paper(paper)?, PLAN, host, |clouds, stages| {
        let (evidence, [observed, reconstructed]) = clouds.evidence(Normals::All, stages);
        let settings = unit_settings(options, baseline);
        let voxel_size = (1.0 / paper.voxel_divisions) as f32;
        let clouds = Clouds {
            source: grid_cloud(MAX_FEATURES, &reconstructed.normalized(&evidence.reconstructed), voxel_size),
            target: grid_cloud(MAX_FEATURES, &observed.normalized(&evidence.observed), voxel_size),
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

fn unit_settings(options: &BaselineOptions, baseline: Baseline) -> UnitSettings {
    let BaselineOptions { paper, lock_scale, up } = options;
    let voxel_size = 1.0 / paper.voxel_divisions;
    UnitSettings {
        fpfh_radius: (paper.fpfh_radius_voxels * voxel_size) as f32,
        max_features: MAX_FEATURES,
        inlier_distance: paper.inlier_distance_voxels * voxel_size,
        edge_similarity: paper.edge_similarity,
        ransac_iterations: paper.ransac_iterations as usize,
        ransac_confidence: paper.ransac_confidence,
        icp: icp_metric(paper.icp),
        max_correspondence_distance: (paper.support_distance_voxels * voxel_size) as f32,
        icp_iterations: paper.icp_iterations as usize,
        estimates_scale: baseline == Baseline::Teaser && !lock_scale,
        up: up.map(|up| up.map(Vector3::from)),
        seed: u64::from(paper.seed),
    }
}
