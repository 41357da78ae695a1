//! Other methods under the paper's preprocessing: the same clouds, the same initial scale, the same voxel grid.

use nalgebra::Vector3;

use super::baseline::Baseline;
use super::clouds::{Clouds, UnitSettings};
use sim3align::align::options::AlignOptions;
use sim3align::align::report::{Alignment, Counts};
use sim3align::align::{Estimated, align_by};
use sim3align::evidence::extents::target_from_source;
use sim3align::evidence::observation::Observation;
use sim3align::progress::{Host, Stage};
use sim3align::register::global::{MAX_FEATURES, icp_metric};
use sim3align::register::grid_cloud::GridCloud;
use sim3align_geometry::error::Result;
use sim3align_geometry::mesh::Mesh;

/// When each stage begins, as a share of the whole.
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
/// boxes' diagonals, both on a grid of `voxelDivisions`.
///
/// The scale stays there, but for TEASER, which estimates its own unless `lockScale` is `true`. Local methods begin at
/// the centred, unrotated pose. RANSAC's pose is refined by plain ICP unless `icp` is `"none"`; the others stand as they
/// are published. Quatro needs `cameraUp` and `meshUp`. `inlierDistanceVoxels` is RANSAC's, and the noise bound of TEASER
/// and Quatro; `supportDistanceVoxels` bounds the correspondences of local methods and of the refinement. The options of
/// RANSAC, descriptors and clouds are as under the preset `paper`; `preset` itself is only repeated in the report.
///
/// # Errors
/// As [`align`](sim3align::align::align); [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) where the method has no answer.
pub fn align_baseline(
    observation: &Observation,
    mesh: &Mesh,
    baseline: Baseline,
    options: &AlignOptions,
    host: &mut dyn Host,
) -> Result<Alignment> {
    align_by(observation, mesh, options, PLAN, host, |evidence, [observed, reconstructed], stages| {
        let settings = unit_settings(options, baseline);
        let voxel_size = (1.0 / options.voxel_divisions) as f32;
        let clouds = Clouds {
            source: GridCloud::of_at_most(MAX_FEATURES, &reconstructed.normalized(&evidence.reconstructed), voxel_size),
            target: GridCloud::of_at_most(MAX_FEATURES, &observed.normalized(&evidence.observed), voxel_size),
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
        Ok(Estimated {
            converged: refined.is_none_or(|refined| refined.converged),
            residual_m: refined.map_or(0.0, |refined| refined.rms * observed.diagonal()),
            counts: Counts {
                source_voxels: clouds.source.cloud.len(),
                target_voxels: clouds.target.cloud.len(),
                matches: found.matches,
                inliers: found.inliers,
                supported: refined.map_or(0, |refined| refined.supported),
                iterations: found.ransac_iterations,
                icp_iterations: refined.map_or(0, |refined| refined.iterations),
                ..Counts::default()
            },
            ..Estimated::of_pose(target_from_source(observed, &found.target_from_source, reconstructed))
        })
    })
}

fn unit_settings(options: &AlignOptions, baseline: Baseline) -> UnitSettings {
    let voxel_size = 1.0 / options.voxel_divisions;
    UnitSettings {
        fpfh_radius: (options.fpfh_radius_voxels * voxel_size) as f32,
        max_features: MAX_FEATURES,
        inlier_distance: options.inlier_distance_voxels * voxel_size,
        edge_similarity: options.edge_similarity,
        ransac_iterations: options.ransac_iterations as usize,
        ransac_confidence: options.ransac_confidence,
        icp: icp_metric(options.icp),
        max_correspondence_distance: (options.support_distance_voxels * voxel_size) as f32,
        icp_iterations: options.icp_iterations as usize,
        estimates_scale: baseline == Baseline::Teaser && options.lock_scale != Some(true),
        up: options.mesh_up.zip(options.camera_up).map(|(mesh, camera)| [Vector3::from(mesh), Vector3::from(camera)]),
        seed: u64::from(options.seed),
    }
}
