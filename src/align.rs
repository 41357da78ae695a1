//! The pipeline ("Robust 3D Alignment of Generative Reconstructions via Partial Monocular Observations"):
//! depth, mask and mesh in, the similarity x_cam = s·R·p + t and its metrics out.

mod combination;
pub mod evaluate;
pub mod field;
pub mod options;
pub mod report;
pub mod warnings;

use crate::error::Result;
use crate::evidence::Evidence;
use crate::evidence::extents::{Extents, initial_scale};
use crate::evidence::observation::Observation;
use crate::evidence::sample::{check_shape, sample_surface};
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::metrics;
use crate::precise::SearchSettings;

use crate::progress::{Host, Stage, Stopwatch};
use crate::{paper, precise};
use field::Options;
use options::{AlignOptions, Preset};
use report::{Alignment, Alternative, Counts, ScoreTerms, Uncertainty};

/// Aligns a mesh to an observation, by the preset's method.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh),
/// [`ErrorCode::NoConsensus`](crate::error::ErrorCode::NoConsensus): never an identity in place of an answer.
pub fn align(observation: &Observation, mesh: &Mesh, options: &AlignOptions, host: &mut dyn Host) -> Result<Alignment> {
    align_with(observation, mesh, options, &precise::search_settings(options), host)
}

/// [`align`], with the search's own settings in place of those that follow from the options: for ablations.
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
    let plan = if options.preset == Preset::Paper { paper::PLAN } else { precise::PLAN };
    align_by(observation, mesh, options, plan, host, |evidence, extents, stages| match options.preset {
        Preset::Paper => paper::estimate(evidence, extents, options, stages),
        Preset::Precise => {
            let hypothesis = precise::hypothesis(evidence, extents, options, stages);
            precise::estimate(observation, mesh, hypothesis, options, search, stages)
        }
    })
}

/// What any method has in common: preprocessing before it, metrics and warnings after it. `plan` says when each stage
/// begins, as a share of the whole.
///
/// # Errors
/// As [`align`], and those of the method.
pub fn align_by(
    observation: &Observation,
    mesh: &Mesh,
    options: &AlignOptions,
    plan: &'static [(Stage, f64)],
    host: &mut dyn Host,
    method: impl FnOnce(&Evidence, [&Extents; 2], &mut Stopwatch<'_>) -> Result<Estimated>,
) -> Result<Alignment> {
    let mut stages = Stopwatch::new(host, plan);
    let clouds = Clouds::new(observation, mesh, options, &mut stages)?;
    let estimated = method(&clouds.evidence, clouds.extents(), &mut stages)?;
    clouds.report(observation, mesh, options, estimated, stages)
}

/// Both clouds, and their extents.
struct Clouds {
    evidence: Evidence,
    observed: Extents,
    reconstructed: Extents,
}

impl Clouds {
    /// What comes before every method.
    fn new(observation: &Observation, mesh: &Mesh, options: &AlignOptions, stages: &mut Stopwatch<'_>) -> Result<Self> {
        options.validate()?;
        check_shape(mesh)?;
        let seed = u64::from(options.seed);

        // §3.1: the partial cloud P_obs from depth and mask, the complete cloud P_rec from the mesh, s_init from the
        // boxes.
        stages.enter(Stage::Observe);
        let observed = observation.cloud(options.max_observed_points as usize, seed);
        stages.enter(Stage::Sample);
        let reconstructed = sample_surface(mesh, options.surface_samples as usize, seed)?;
        let extents_obs = Extents::of("depth", &observed.points)?;
        let extents_rec = Extents::of("mesh", &reconstructed.points)?;
        stages.enter(Stage::Normals);
        let evidence = Evidence::new(observed, reconstructed);
        Ok(Self { evidence, observed: extents_obs, reconstructed: extents_rec })
    }

    fn extents(&self) -> [&Extents; 2] {
        [&self.observed, &self.reconstructed]
    }

    /// What comes after every method.
    fn report(
        &self,
        observation: &Observation,
        mesh: &Mesh,
        options: &AlignOptions,
        estimated: Estimated,
        mut stages: Stopwatch<'_>,
    ) -> Result<Alignment> {
        let Self { evidence, observed, reconstructed } = self;
        stages.enter(Stage::Metrics);
        let metrics = metrics::score(observation, mesh, &estimated.camera_from_mesh, evidence)?;
        let timings_ms = stages.finish();

        let initial_scale = initial_scale(observed, reconstructed);
        let scale_ratio = estimated.camera_from_mesh.scale / initial_scale;
        let mut warnings = warnings::about_observation(observation);
        warnings.extend(warnings::about_scale(scale_ratio, estimated.clamped, options.preset));
        warnings.extend(warnings::about_convergence(
            estimated.converged,
            estimated.counts.icp_iterations,
            options.preset,
        ));
        Ok(Alignment {
            camera_from_mesh: (&estimated.camera_from_mesh).into(),
            preset: options.preset,
            seed: options.seed,
            initial_scale,
            scale_ratio,
            collapsed: report::is_collapsed(scale_ratio),
            clamped: estimated.clamped,
            converged: estimated.converged,
            residual_m: estimated.residual_m,
            confidence: estimated.confidence,
            score: estimated.score,
            terms: estimated.terms,
            alternatives: estimated.alternatives,
            uncertainty: estimated.uncertainty,
            metrics,
            counts: Counts {
                source_points: evidence.reconstructed.len(),
                target_points: evidence.observed.len(),
                ..estimated.counts
            },
            timings_ms,
            warnings,
        })
    }
}

/// What a method found.
#[derive(Debug, Clone)]
pub struct Estimated {
    /// The pose.
    pub camera_from_mesh: Similarity,
    /// Whether the scale stands at a bound because it was projected there.
    pub clamped: bool,
    /// Whether the refinement came to rest.
    pub converged: bool,
    /// Root mean square residual of the refinement, in metres.
    pub residual_m: f64,
    /// See [`Alignment::confidence`].
    pub confidence: Option<f64>,
    /// See [`Alignment::score`].
    pub score: Option<f64>,
    /// See [`Alignment::terms`].
    pub terms: Option<ScoreTerms>,
    /// See [`Alignment::alternatives`].
    pub alternatives: Vec<Alternative>,
    /// See [`Alignment::uncertainty`].
    pub uncertainty: Option<Uncertainty>,
    /// How often what happened.
    pub counts: Counts,
}

impl Estimated {
    /// A pose of which nothing else is known.
    pub fn of_pose(camera_from_mesh: Similarity) -> Self {
        Self {
            camera_from_mesh,
            clamped: false,
            converged: true,
            residual_m: 0.0,
            confidence: None,
            score: None,
            terms: None,
            alternatives: Vec::new(),
            uncertainty: None,
            counts: Counts::default(),
        }
    }
}
