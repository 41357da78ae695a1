//! Scores any transform, wherever it came from.

use serde::Serialize;

use super::field::{Field, Options};
use super::options::AlignOptions;
use super::report::{Warning, is_collapsed};
use super::warnings;
use crate::error::Result;
use crate::evidence::extents::{Extents, initial_scale};
use crate::evidence::observation::Observation;
use crate::evidence::{Evidence, Sampling};
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::metrics::pose_error::{PoseErrors, pose_errors};
use crate::metrics::symmetry::Symmetry;
use crate::metrics::{self, Metrics};

/// Options of `evaluate`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "camelCase"))]
pub struct EvaluateOptions {
    /// Seed of all random draws, 0 to 2³² − 1. Default 0.
    pub seed: u32,
    /// Depth readings inside the mask that are used at most, 32 to 1 000 000. Default 20 000.
    pub max_observed_points: u32,
    /// Points sampled from the mesh surface, 100 to 1 000 000. Default 20 000.
    pub surface_samples: u32,
}

impl Default for EvaluateOptions {
    fn default() -> Self {
        let align = AlignOptions::default();
        Self {
            seed: align.seed,
            max_observed_points: align.max_observed_points,
            surface_samples: align.surface_samples,
        }
    }
}

impl Options for EvaluateOptions {
    fn fields(&mut self) -> Vec<(&'static str, Field<'_>)> {
        vec![
            ("seed", Field::count(&mut self.seed, 0, u32::MAX)),
            ("maxObservedPoints", Field::count(&mut self.max_observed_points, 32, 1_000_000)),
            ("surfaceSamples", Field::count(&mut self.surface_samples, 100, 1_000_000)),
        ]
    }
}

/// A transform that is known to be right, and the turns under which the object looks the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// The true transform.
    pub camera_from_mesh: Similarity,
    /// The object's symmetry.
    pub symmetry: Symmetry,
}

/// What `evaluate` found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Evaluation {
    /// The eight metrics of the pose.
    pub metrics: Metrics,
    /// The errors against the truth, where it was given.
    pub errors: Option<PoseErrors>,
    /// s_init: the ratio of the box diagonals of P_obs and P_rec (§3.1).
    pub initial_scale: f64,
    /// s / s_init.
    pub scale_ratio: f64,
    /// Whether the scale is below 0.3 of the initial one.
    pub collapsed: bool,
    /// What the caller should know about the input.
    pub warnings: Vec<Warning>,
}

/// All metrics of a transform, and its errors where the truth is known.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption), and
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
pub fn evaluate(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    truth: Option<&Truth>,
    options: &EvaluateOptions,
) -> Result<Evaluation> {
    options.validate()?;
    let evidence = Evidence::of(
        observation,
        mesh,
        &Sampling {
            max_points: options.max_observed_points as usize,
            surface_samples: options.surface_samples as usize,
            seed: u64::from(options.seed),
        },
    )?;
    let metrics = metrics::score(observation, mesh, camera_from_mesh, &evidence)?;
    let observed = Extents::of("depth", &evidence.observed.points)?;
    let reconstructed = Extents::of("mesh", &evidence.reconstructed.points)?;
    let initial_scale = initial_scale(&observed, &reconstructed);
    let scale_ratio = camera_from_mesh.scale / initial_scale;
    Ok(Evaluation {
        metrics,
        errors: truth.map(|t| pose_errors(mesh, camera_from_mesh, &t.camera_from_mesh, &t.symmetry)).transpose()?,
        initial_scale,
        scale_ratio,
        collapsed: is_collapsed(scale_ratio),
        warnings: warnings::about_observation(observation),
    })
}
