//! Alignment: depth, mask and mesh in, the similarity x_cam = s·R·p + t and its metrics out.

pub mod evaluate;
pub mod field;
pub mod options;
pub mod paper_options;
pub mod report;
pub mod scale;
pub mod warnings;

use crate::error::Result;
use crate::evidence::Evidence;
use crate::evidence::extents::{Extents, initial_scale};
use crate::evidence::observation::Observation;
use crate::evidence::sample::{check_shape, sample_surface};
use crate::geometry::cloud::Cloud;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::metrics;
use crate::precise::SearchSettings;

use crate::progress::{Host, Stage, Stopwatch};
use crate::{paper, precise};
use field::Options;
use options::{AlignOptions, Method, Preset};
use paper_options::PaperOptions;
use report::{Alignment, AnyAlignment, Counts, Diagnostics, PaperAlignment, PreciseDiagnostics};

/// Aligns a mesh to an observation by the method that the caller chose.
///
/// # Errors
/// As [`align`] and [`align_paper`].
pub fn align_any(observation: &Observation, mesh: &Mesh, method: &Method, host: &mut dyn Host) -> Result<AnyAlignment> {
    match method {
        Method::Precise(options) => align(observation, mesh, options, host).map(Into::into),
        Method::Paper(options) => align_paper(observation, mesh, options, host).map(Into::into),
    }
}

/// Aligns a mesh to an observation: search by rendering.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh),
/// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus): never an identity in place of an answer.
pub fn align(observation: &Observation, mesh: &Mesh, options: &AlignOptions, host: &mut dyn Host) -> Result<Alignment> {
    align_with(observation, mesh, options, &precise::search_settings(options), host)
}

/// [`align`] with the search's own settings in place of those that follow from the options, for ablations.
///
/// # Errors
/// As [`align`].
pub fn align_with(
    observation: &Observation,
    mesh: &Mesh,
    options: &AlignOptions,
    search: &SearchSettings,
    host: &mut dyn Host,
) -> Result<Alignment> {
    let setup = Setup::of_precise(options)?;
    let (aligned, certainty) = align_by(observation, mesh, &setup, precise::PLAN, host, |clouds, stages| {
        let hypothesis = precise::hypothesis(clouds, options, stages);
        precise::estimate(observation, mesh, hypothesis, options, search, stages)
    })?;
    let PaperAlignment { camera_from_mesh, metrics, warnings, diagnostics } = aligned;
    let precise::Certainty { confidence, alternatives, uncertainty, score, terms } = certainty;
    let diagnostics = PreciseDiagnostics { common: diagnostics, score, terms };
    Ok(Alignment { camera_from_mesh, confidence, alternatives, uncertainty, metrics, warnings, diagnostics })
}

/// Aligns a mesh to an observation by the paper's method.
///
/// # Errors
/// As [`align`].
pub fn align_paper(
    observation: &Observation,
    mesh: &Mesh,
    options: &PaperOptions,
    host: &mut dyn Host,
) -> Result<PaperAlignment> {
    let setup = Setup::of_paper(options)?;
    let aligned = align_by(observation, mesh, &setup, paper::PLAN, host, |clouds, stages| {
        Ok((paper::estimate(clouds, options, stages)?, ()))
    });
    Ok(aligned?.0)
}

/// The options that all methods share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    preset: Preset,
    seed: u32,
    max_observed_points: u32,
    surface_samples: u32,
    metrics: bool,
}

impl Setup {
    /// Those of the default method, which it checks.
    fn of_precise(options: &AlignOptions) -> Result<Self> {
        options.validate()?;
        let &AlignOptions { seed, max_observed_points, surface_samples, metrics, .. } = options;
        Ok(Self { preset: Preset::Precise, seed, max_observed_points, surface_samples, metrics })
    }

    /// Those of the paper's method, which it checks.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption).
    pub fn of_paper(options: &PaperOptions) -> Result<Self> {
        options.validate()?;
        let &PaperOptions { seed, max_observed_points, surface_samples, metrics, .. } = options;
        Ok(Self { preset: Preset::Paper, seed, max_observed_points, surface_samples, metrics })
    }
}

/// What all methods share: preprocessing before the method, metrics and warnings after it. `plan` says when each stage
/// begins, as a share of the whole. The method's further findings are passed on.
///
/// # Errors
/// As [`align`], and those of the method.
pub fn align_by<T>(
    observation: &Observation,
    mesh: &Mesh,
    setup: &Setup,
    plan: &'static [(Stage, f64)],
    host: &mut dyn Host,
    method: impl FnOnce(&mut Clouds, &mut Stopwatch<'_>) -> Result<(Solution, T)>,
) -> Result<(PaperAlignment, T)> {
    let mut stages = Stopwatch::new(host, plan);
    let mut clouds = Clouds::new(observation, mesh, setup, &mut stages)?;
    if setup.metrics {
        clouds.evidence(&mut stages);
    }
    let (solution, findings) = method(&mut clouds, &mut stages)?;
    Ok((clouds.report(observation, mesh, setup, &solution, stages)?, findings))
}

/// Both clouds, and their extents.
pub struct Clouds {
    clouds: [Cloud; 2],
    extents: [Extents; 2],
    evidence: Option<Evidence>,
}

impl Clouds {
    fn new(observation: &Observation, mesh: &Mesh, setup: &Setup, stages: &mut Stopwatch<'_>) -> Result<Self> {
        check_shape(mesh)?;
        let seed = u64::from(setup.seed);
        // §3.1: the partial cloud P_obs from depth and mask, the complete cloud P_rec from the mesh, s_init from the
        // boxes.
        stages.enter(Stage::Observe);
        let observed = observation.cloud(setup.max_observed_points as usize, seed);
        stages.enter(Stage::Sample);
        let reconstructed = sample_surface(mesh, setup.surface_samples as usize, seed)?;
        let extents = [Extents::of("depth", &observed.points)?, Extents::of("mesh", &reconstructed.points)?];
        Ok(Self { clouds: [observed, reconstructed], extents, evidence: None })
    }

    /// Extents of the observed and of the reconstructed cloud.
    pub fn extents(&self) -> [&Extents; 2] {
        self.extents.each_ref()
    }

    /// The clouds with their normals, which are estimated when they are first needed, and the extents.
    pub fn evidence(&mut self, stages: &mut Stopwatch<'_>) -> (&Evidence, [&Extents; 2]) {
        let Self { clouds, extents, evidence } = self;
        let evidence = evidence.get_or_insert_with(|| {
            stages.enter(Stage::Normals);
            let [observed, reconstructed] = clouds.clone();
            Evidence::new(observed, reconstructed)
        });
        (evidence, extents.each_ref())
    }

    fn report(
        &mut self,
        observation: &Observation,
        mesh: &Mesh,
        setup: &Setup,
        solution: &Solution,
        mut stages: Stopwatch<'_>,
    ) -> Result<PaperAlignment> {
        let &Solution { camera_from_mesh, clamped, converged, residual_m, counts } = solution;
        let metrics = if setup.metrics {
            let (evidence, _) = self.evidence(&mut stages);
            stages.enter(Stage::Metrics);
            Some(metrics::score(observation, mesh, &camera_from_mesh, evidence)?)
        } else {
            None
        };
        let [observed, reconstructed] = self.extents();
        let initial_scale = initial_scale(observed, reconstructed);
        let scale_ratio = camera_from_mesh.scale / initial_scale;
        let mut warnings = warnings::about_observation(observation);
        warnings.extend(warnings::about_scale(scale_ratio, clamped, setup.preset));
        warnings.extend(warnings::about_convergence(converged, counts.icp_iterations, setup.preset));
        let [target, source] = &self.clouds;
        Ok(PaperAlignment {
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
                counts: Counts { source_points: source.len(), target_points: target.len(), ..counts },
                timings_ms: stages.finish(),
            },
        })
    }
}

/// The pose that a method found.
#[derive(Debug, Clone, Copy)]
pub struct Solution {
    /// The pose.
    pub camera_from_mesh: Similarity,
    /// Whether the scale was held at a bound.
    pub clamped: bool,
    /// Whether the refinement converged.
    pub converged: bool,
    /// Root mean square residual of the refinement, in metres.
    pub residual_m: f64,
    /// Sizes of the problem and events during the run.
    pub counts: Counts,
}

impl Solution {
    /// A pose of which nothing else is known.
    pub fn of_pose(camera_from_mesh: Similarity) -> Self {
        Self { camera_from_mesh, clamped: false, converged: true, residual_m: 0.0, counts: Counts::default() }
    }
}
