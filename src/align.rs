//! The pipeline ("Robust 3D Alignment of Generative Reconstructions via Partial Monocular Observations"):
//! depth, mask and mesh in, the similarity x_cam = s·R·p + t and its metrics out.

mod estimate;
pub mod estimate_sim3;
pub mod evaluate;
pub mod field;
mod frames;
mod judge;
pub mod options;
pub mod progress;
pub mod register;
pub mod report;
pub mod warnings;

use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::metrics;
use crate::metrics::evidence::Evidence;
use crate::stages::extents::{Extents, initial_scale, target_from_source};
use crate::stages::observe::Observation;
use crate::stages::sample::{check_shape, sample_surface};

use estimate::{Problem, Settings};
use field::Options;
use options::AlignOptions;
use progress::{Host, Stage, Stopwatch};
use report::Alignment;

/// When each stage of [`align`] begins, as a share of the whole; from profiles of real cases.
const PLAN: &[(Stage, f64)] = &[
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

/// Aligns a mesh to an observation: preset `paper`, §3.1 to §3.3.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh),
/// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus): never an identity in place of an answer.
pub fn align(observation: &Observation, mesh: &Mesh, options: &AlignOptions, host: &mut dyn Host) -> Result<Alignment> {
    options.validate()?;
    check_shape(mesh)?;
    let seed = u64::from(options.seed);
    let mut stages = Stopwatch::new(host, PLAN);

    // §3.1: the partial cloud P_obs from depth and mask, the complete cloud P_rec from the mesh.
    stages.enter(Stage::Observe);
    let observed = observation.cloud(options.max_observed_points as usize, seed);
    stages.enter(Stage::Sample);
    let reconstructed = sample_surface(mesh, options.surface_samples as usize, seed)?;

    // §3.1: s_init from the boxes. From here both clouds are centred, with a box diagonal of 1.
    stages.enter(Stage::Normals);
    let evidence = Evidence::new(observed, reconstructed);
    let extents_obs = Extents::of("depth", &evidence.observed.points)?;
    let extents_rec = Extents::of("mesh", &evidence.reconstructed.points)?;
    let target = extents_obs.normalized(&evidence.observed);
    let source = extents_rec.normalized(&evidence.reconstructed);

    // §3.2 and §3.3: descriptors, guarded RANSAC, hallucination filter, scale-locked ICP.
    let settings = Settings::of(options);
    let estimated = Problem::new(&source, &target, &settings, &mut stages).solve(&settings, &mut stages)?;
    let camera_from_mesh = target_from_source(&extents_obs, &estimated.target_from_source, &extents_rec);

    stages.enter(Stage::Metrics);
    let metrics = metrics::score(observation, mesh, &camera_from_mesh, &evidence)?;
    let timings_ms = stages.finish();

    let initial_scale = initial_scale(&extents_obs, &extents_rec);
    let scale_ratio = camera_from_mesh.scale / initial_scale;
    let mut warnings = warnings::about_observation(observation);
    warnings.extend(warnings::about_scale(scale_ratio, estimated.clamped));
    warnings.extend(warnings::about_convergence(estimated.converged, estimated.counts.icp_iterations));
    Ok(Alignment {
        camera_from_mesh: (&camera_from_mesh).into(),
        preset: options.preset,
        seed: options.seed,
        initial_scale,
        scale_ratio,
        collapsed: report::is_collapsed(scale_ratio),
        clamped: estimated.clamped,
        converged: estimated.converged,
        residual_m: estimated.rms * extents_obs.diagonal(),
        metrics,
        counts: estimated.counts,
        timings_ms,
        warnings,
    })
}
