//! Scores a given transform.

use serde::Serialize;

use super::warnings;
use crate::error::Result;
use crate::evidence::Evidence;
use crate::evidence::clouds::{MEASURED, Sampling};
use crate::evidence::extents::{Extents, initial_scale};
use crate::evidence::observation::Observation;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::metrics::pose_error::{PoseErrors, pose_errors};
use crate::metrics::symmetry::Symmetry;
use crate::metrics::{self, Metrics};
use crate::options::{Options, options};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::verdict::color::agreement;
use crate::report::{Warning, is_collapsed};

options! {
    /// Options of `evaluate`. All have defaults.
    pub struct EvaluateOptions {
        /// The known transform, camera from mesh, that `errors` compares with.
        truth: Option<Similarity> = None, Transform;
        /// The object's symmetry: the rotation error is the smallest over it. `"auto"` finds it on the surface of the
        /// mesh, once for all calls with the mesh.
        symmetry: Symmetry = Symmetry::Auto, Symmetry;
        /// Seed of all random draws. The same input and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
        /// Upper bound on the depth readings used. Above it, an even random subset is drawn.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface.
        surface_samples: u32 = 10_000, Count(100..=1_000_000);
        /// Number of points, evenly spread over those of each side, from which distances and normals are measured. By
        /// default, the means are within about half a per cent of those from all: 1 000 000 measures from every point.
        measured_points: u32 = MEASURED as u32, Count(32..=1_000_000);
    }
}

impl EvaluateOptions {
    /// The default options with this truth, where there is one.
    pub fn against(truth: Option<&Truth>) -> Self {
        truth.map_or_else(Self::default, |truth| Self {
            truth: Some(truth.camera_from_mesh),
            symmetry: truth.symmetry.clone(),
            ..Self::default()
        })
    }
}

/// A known transform, and the object's symmetry.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// The true transform.
    pub camera_from_mesh: Similarity,
    /// The object's symmetry.
    pub symmetry: Symmetry,
}

/// The result of `evaluate`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Evaluation {
    /// Agreement of the posed mesh with the observation.
    pub metrics: Metrics,
    /// The errors against the truth; `null` where no truth was given.
    pub errors: Option<PoseErrors>,
    /// Conditions that the caller should know about; the result stands.
    pub warnings: Vec<Warning>,
    /// How the scale compares with the initial one.
    pub diagnostics: EvaluationDiagnostics,
}

/// How an evaluated scale compares with the initial one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct EvaluationDiagnostics {
    /// s_init: the ratio of the bounding boxes' diagonals, observation to mesh (§3.1).
    pub initial_scale: f64,
    /// The scale divided by the initial scale.
    pub scale_ratio: f64,
    /// Whether the scale collapsed: `scaleRatio` is below 0.3.
    pub collapsed: bool,
}

/// Computes the metrics of a transform, and its errors where the truth is known.
///
/// # Errors
/// [`ErrorCode::InvalidOption`](crate::error::ErrorCode::InvalidOption), and
/// [`ErrorCode::DegenerateMesh`](crate::error::ErrorCode::DegenerateMesh) for a mesh without area.
pub fn evaluate(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    options: &EvaluateOptions,
) -> Result<Evaluation> {
    evaluate_prepared(observation, &PreparedMesh::borrowed(mesh), camera_from_mesh, options)
}

/// [`evaluate`] for a prepared mesh, which may have colours.
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_prepared(
    observation: &Observation,
    prepared: &PreparedMesh<'_>,
    camera_from_mesh: &Similarity,
    options: &EvaluateOptions,
) -> Result<Evaluation> {
    options.validate()?;
    let mesh = prepared.mesh();
    let evidence = Evidence::of(
        observation,
        mesh,
        &Sampling {
            max_points: options.max_observed_points as usize,
            surface_samples: options.surface_samples as usize,
            measured: options.measured_points as usize,
            seed: u64::from(options.seed),
        },
    )?;
    let mut metrics = metrics::score(observation, mesh, camera_from_mesh, &evidence)?;
    metrics.color_agreement = agreement(observation, None, prepared, camera_from_mesh);
    let observed = Extents::of("depth", &evidence.observed.points)?;
    let reconstructed = Extents::of("mesh", &evidence.reconstructed.points)?;
    let initial_scale = initial_scale(&observed, &reconstructed);
    let scale_ratio = camera_from_mesh.scale / initial_scale;
    let mut warnings = warnings::about_observation(observation);
    warnings.extend(warnings::about_mesh(&prepared.removed_parts()));
    let compared = options.truth.map(|truth| {
        let symmetry = prepared.symmetry(&options.symmetry)?;
        pose_errors(mesh, camera_from_mesh, &truth, &symmetry)
    });
    Ok(Evaluation {
        metrics,
        errors: compared.transpose()?,
        warnings,
        diagnostics: EvaluationDiagnostics { initial_scale, scale_ratio, collapsed: is_collapsed(scale_ratio) },
    })
}
