//! Common steps of all methods: preprocessing, metrics and warnings.

use super::warnings;
use crate::error::Result;
use crate::evidence::Normals;
use crate::evidence::clouds::{Clouds, Sampling};
use crate::evidence::observation::Observation;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::check_shape;
use crate::metrics::{self, Metrics};
use crate::options::Options;
use crate::paper::options::PaperOptions;
use crate::precise::options::AlignOptions;
use crate::progress::{Host, Stage, Stopwatch};
use crate::report::{self, Counts, Diagnostics, PaperAlignment, PaperDiagnostics, Preset, Sim3, Solution, Warning};

/// The common options of all methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    preset: Preset,
    seed: u32,
    pub(super) sampling: Sampling,
    pub(super) metrics: bool,
}

impl Setup {
    /// The common options of the default method, validated.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
    pub fn of_precise(options: &AlignOptions) -> Result<Self> {
        options.validate()?;
        let &AlignOptions { seed, max_observed_points, surface_samples, metrics, .. } = options;
        Ok(Self::new(Preset::Precise, seed, [max_observed_points, surface_samples], metrics))
    }

    /// The common options of the method of the paper, validated.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
    pub fn of_paper(options: &PaperOptions) -> Result<Self> {
        options.validate()?;
        let &PaperOptions { seed, max_observed_points, surface_samples, metrics, .. } = options;
        Ok(Self::new(Preset::Paper, seed, [max_observed_points, surface_samples], metrics))
    }

    fn new(preset: Preset, seed: u32, points: [u32; 2], metrics: bool) -> Self {
        let [max_points, surface_samples] = points.map(|count| count as usize);
        let sampling = Sampling { max_points, surface_samples, seed: u64::from(seed), ..Sampling::default() };
        Self { preset, seed, sampling, metrics }
    }
}

/// Aligns by any method, for comparisons. `plan` is the progress at the start of each stage, 0 to 1.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh), and those of the method.
pub fn align_by(
    observation: &Observation,
    mesh: &Mesh,
    setup: &Setup,
    plan: &'static [(Stage, f64)],
    host: &mut dyn Host,
    method: impl FnOnce(&mut Clouds, &mut Stopwatch<'_>) -> Result<(Solution, Counts)>,
) -> Result<PaperAlignment> {
    let mut stages = Stopwatch::new(host, plan);
    check_shape(mesh)?;
    let mut clouds = Clouds::new(observation, mesh, &setup.sampling, &mut stages)?;
    if setup.metrics {
        clouds.evidence(Normals::All, &mut stages);
    }
    let (solution, counts) = method(&mut clouds, &mut stages)?;
    let metrics = score(observation, mesh, setup, &mut clouds, &solution, &mut stages)?;
    let Outcome { camera_from_mesh, metrics, mut warnings, diagnostics: common, points } =
        outcome(observation, setup, &clouds, &solution, metrics, stages);
    if setup.preset == Preset::Paper {
        warnings.extend(warnings::about_icp(solution.converged, counts.icp_iterations));
    }
    let [target_points, source_points] = points;
    let diagnostics = PaperDiagnostics { common, counts: Counts { source_points, target_points, ..counts } };
    Ok(PaperAlignment { camera_from_mesh, metrics, warnings, diagnostics })
}

/// The metrics of a solution, if requested.
pub(super) fn score(
    observation: &Observation,
    mesh: &Mesh,
    setup: &Setup,
    clouds: &mut Clouds,
    solution: &Solution,
    stages: &mut Stopwatch<'_>,
) -> Result<Option<Metrics>> {
    if !setup.metrics {
        return Ok(None);
    }
    let (evidence, _) = clouds.evidence(Normals::Measured, stages);
    stages.enter(Stage::Metrics);
    metrics::score(observation, mesh, &solution.camera_from_mesh, evidence).map(Some)
}

/// The common part of the results of all methods.
pub(super) struct Outcome {
    pub camera_from_mesh: Sim3,
    pub metrics: Option<Metrics>,
    pub warnings: Vec<Warning>,
    pub diagnostics: Diagnostics,
    /// Number of points observed, and of points of the mesh surface.
    pub points: [usize; 2],
}

/// The outcome of a method.
pub(super) fn outcome(
    observation: &Observation,
    setup: &Setup,
    clouds: &Clouds,
    solution: &Solution,
    metrics: Option<Metrics>,
    stages: Stopwatch<'_>,
) -> Outcome {
    let &Solution { camera_from_mesh, clamped, converged, residual_m } = solution;
    let initial_scale = clouds.initial_scale();
    let scale_ratio = camera_from_mesh.scale / initial_scale;
    let mut warnings = warnings::about_observation(observation);
    warnings.extend(warnings::about_scale(scale_ratio, clamped, setup.preset));
    Outcome {
        camera_from_mesh: (&camera_from_mesh).into(),
        metrics,
        warnings,
        diagnostics: Diagnostics {
            preset: setup.preset,
            seed: setup.seed,
            initial_scale,
            scale_ratio,
            collapsed: report::is_collapsed(scale_ratio),
            clamped,
            converged,
            residual_m,
            timings_ms: stages.finish(),
        },
        points: clouds.counts(),
    }
}
