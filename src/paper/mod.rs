//! Preset `paper`: the method of the paper (§3.1 to §3.3): descriptors, guarded RANSAC, hallucination filter,
//! scale-locked ICP.
//!
//! In: the clouds of an observation and a mesh. Out: a [`Solution`] and the counts of its stages. It is the baseline, and stays
//! as published: improvements belong into `precise`.

pub mod options;

use crate::error::Result;
use crate::evidence::Normals;
use crate::evidence::clouds::Clouds;
use crate::evidence::extents::target_from_source;
use crate::geometry::angle::sin_cos;
use crate::paper::options::PaperOptions;
use crate::progress::{Stage, Stopwatch};
use crate::register::feature_registration::FeatureRegistration;
use crate::register::ransac::{Guard, RansacSettings};
use crate::register::settings::{RegistrationSettings, icp_metric};
use crate::register::support::SupportSettings;
use crate::register::umeyama::ScaleMode;
use crate::report::{Counts, Solution};
use crate::scheduler::{Scheduler, finished};

/// Progress at the start of each stage, 0 to 1; from profiles of real cases.
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

/// Estimates the pose of the mesh.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus).
pub fn estimate(clouds: &mut Clouds, options: &PaperOptions, stages: &mut Stopwatch<'_>) -> Result<(Solution, Counts)> {
    let (evidence, [observed, reconstructed]) = clouds.evidence(Normals::All, stages);
    // §3.1: both clouds are centred, and scaled to a box diagonal of 1.
    let target = observed.normalized(&evidence.observed);
    let source = reconstructed.normalized(&evidence.reconstructed);
    let settings = settings_of(options);
    let scheduler = Scheduler::unbounded();
    let estimate = finished(async {
        let registration = FeatureRegistration::new(&source, &target, &settings, stages, &scheduler).await;
        registration.solve(&settings, stages, &scheduler).await
    })?;
    let solution = Solution {
        clamped: estimate.clamped,
        converged: estimate.converged,
        residual_m: estimate.rms * observed.diagonal(),
        ..Solution::of_pose(target_from_source(observed, &estimate.target_from_source, reconstructed))
    };
    Ok((solution, estimate.counts))
}

fn settings_of(options: &PaperOptions) -> RegistrationSettings {
    let voxel_size = 1.0 / options.voxel_divisions;
    RegistrationSettings {
        voxel_size: voxel_size as f32,
        fpfh_radius_voxels: options.fpfh_radius_voxels as f32,
        ransac: RansacSettings {
            inlier_distance: options.inlier_distance_voxels * voxel_size,
            edge_similarity: options.edge_similarity,
            max_iterations: options.ransac_iterations as usize,
            confidence: options.ransac_confidence,
            scale_mode: ScaleMode::Free,
            guard: options.guard.map(|[min, max]| Guard { min, max, mode: options.guard_mode }),
            seed: u64::from(options.seed),
        },
        support: if options.hallucination_filter {
            SupportSettings {
                max_distance: (options.support_distance_voxels * voxel_size) as f32,
                min_cosine: sin_cos(options.support_angle_deg.to_radians()).1 as f32,
            }
        } else {
            SupportSettings::EVERYTHING
        },
        icp: icp_metric(options.icp),
        lock_scale: options.lock_scale,
        icp_iterations: options.icp_iterations as usize,
    }
}
