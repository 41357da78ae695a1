//! The result of an alignment of several views, before its metrics.

use super::ViewsOptions;
use super::report::{CameraPose, ViewPose, ViewRole, ViewsAlignment, ViewsDiagnostics, WorldFrame, WorldUncertainty};
use crate::align::warnings;
use crate::error::{Error, Result};
use crate::evidence::clouds::Sampling;
use crate::evidence::observation::Observation;
use crate::geometry::similarity::Similarity;
use crate::metrics::{self, Metrics};
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::scoring::score::Score;
use crate::precise::verdict::color::agreement;
use crate::precise::verdict::confidence::with_turn;
use crate::progress::Stopwatch;
use crate::report::{Alternative, ColorReport, Effort, FoundSymmetry, ScoreTerms, Stretch, Warning, WarningCode};

/// The poses found.
pub struct Summary {
    /// The pose in the world.
    pub world_from_mesh: Similarity,
    /// The world.
    pub world: WorldFrame,
    /// See [`ViewsAlignment::shape_confidence`].
    pub shape_confidence: f64,
    /// See [`ViewsAlignment`].
    pub turn_confidence: Option<f64>,
    /// Whether more effort would not change the verdict of shape.
    pub is_sure: bool,
    /// The symmetry of the shape.
    pub symmetry: Vec<FoundSymmetry>,
    /// See [`ViewsAlignment`].
    pub alternatives: Vec<Alternative>,
    /// See [`ViewsAlignment`].
    pub uncertainty: Option<WorldUncertainty>,
    /// See [`ViewsAlignment`].
    pub proportions: Option<Stretch>,
    /// The object in each view.
    pub views: Vec<SummaryView>,
    /// Sum of the scores.
    pub score: f64,
    /// Whether the refinement converged.
    pub converged: bool,
    /// Number of images drawn.
    pub renders: usize,
    /// The effort of the searches.
    pub effort: Effort,
}

/// The object in one view.
pub struct SummaryView {
    /// The pose in the view.
    pub camera_from_mesh: Similarity,
    /// The probability that it is right up to the symmetry of the shape.
    pub shape_confidence: f64,
    /// That of the turn.
    pub turn_confidence: Option<f64>,
    /// The part of the view in the result.
    pub role: ViewRole,
    /// The camera.
    pub world_from_camera: Similarity,
    /// See [`CameraPose`].
    pub rotation_sd_deg: Option<f64>,
    /// See [`CameraPose`].
    pub position_sd_m: Option<f64>,
    /// The score in the view.
    pub score: Score,
    /// The contribution of colour.
    pub color: Option<ColorReport>,
}

impl SummaryView {
    /// A view that was not searched, whose camera is unknown.
    pub fn unseen(world_from_mesh: Similarity) -> Self {
        Self {
            camera_from_mesh: world_from_mesh,
            shape_confidence: 0.0,
            turn_confidence: None,
            role: ViewRole::Unusable,
            world_from_camera: Similarity::identity(),
            rotation_sd_deg: None,
            position_sd_m: None,
            score: Score::default(),
            color: None,
        }
    }
}

impl Summary {
    /// The result, with the metrics of each view that has a mask, if they are wanted. `unusable` are the errors of the views whose
    /// masks cannot be used.
    ///
    /// # Errors
    /// As [`metrics::evaluate`].
    pub fn report(
        &self,
        mesh: &PreparedMesh<'_>,
        observations: &[Option<Observation>],
        unusable: &[Error],
        options: &ViewsOptions,
        stages: Stopwatch<'_>,
    ) -> Result<ViewsAlignment> {
        let sampling = Sampling {
            max_points: options.max_observed_points as usize,
            surface_samples: options.surface_samples as usize,
            seed: u64::from(options.seed),
            ..Sampling::default()
        };
        let mut views = Vec::with_capacity(self.views.len());
        for (view, observation) in self.views.iter().zip(observations) {
            let measured = match observation {
                Some(observation) if options.metrics => {
                    let pose = &view.camera_from_mesh;
                    let measured = metrics::evaluate(observation, mesh.mesh(), pose, &sampling)?;
                    Some(Metrics { color_agreement: agreement(observation, None, mesh, pose), ..measured })
                }
                _ => None,
            };
            let terms: ScoreTerms = (&view.score).into();
            let mut warnings = observation.as_ref().map_or_else(Vec::new, warnings::about_observation);
            if view.role == ViewRole::Used && observation.is_some() {
                warnings.extend(warnings::about_fit(&terms));
            }
            warnings::retain_doubts(&mut warnings, view.shape_confidence);
            views.push(ViewPose {
                camera_from_mesh: (&view.camera_from_mesh).into(),
                confidence: with_turn(view.shape_confidence, view.turn_confidence),
                role: view.role,
                camera: CameraPose {
                    world_from_camera: (&view.world_from_camera).into(),
                    rotation_sd_deg: view.rotation_sd_deg,
                    position_sd_m: view.position_sd_m,
                },
                score: f64::from(view.score.total),
                terms,
                color: view.color,
                metrics: measured,
                warnings,
            });
        }
        Ok(ViewsAlignment {
            world_from_mesh: (&self.world_from_mesh).into(),
            world: self.world,
            confidence: with_turn(self.shape_confidence, self.turn_confidence),
            shape_confidence: self.shape_confidence,
            turn_confidence: self.turn_confidence,
            symmetry: self.symmetry.clone(),
            alternatives: self.alternatives.clone(),
            uncertainty: self.uncertainty,
            proportions: self.proportions.clone(),
            views,
            warnings: self.warnings(mesh, unusable),
            diagnostics: ViewsDiagnostics {
                seed: options.seed,
                effort: self.effort,
                score: self.score,
                converged: self.converged,
                renders: self.renders,
                timings_ms: stages.finish(),
            },
        })
    }

    /// Warnings about the views as a whole.
    fn warnings(&self, mesh: &PreparedMesh<'_>, unusable: &[Error]) -> Vec<Warning> {
        let of = |role| {
            let views = self.views.iter().enumerate().filter(move |(_, view)| view.role == role);
            let names: Vec<String> = views.map(|(k, _)| k.to_string()).collect();
            names
        };
        let (contradicting, unseen) = (of(ViewRole::Contradicting), of(ViewRole::Unusable));
        let mut warnings: Vec<Warning> = warnings::about_mesh(&mesh.removed_parts()).into_iter().collect();
        if !contradicting.is_empty() {
            warnings.push(Warning {
                code: WarningCode::ViewContradicts,
                message: format!(
                    "Views {} contradict the others and do not count. Check their masks and camera poses, and that they show the same object.",
                    contradicting.join(", ")
                ),
            });
        }
        if !unseen.is_empty() {
            let mut message = format!(
                "Views {} have too few readings where the object should be, and do not count.",
                unseen.join(", ")
            );
            unusable.iter().for_each(|error| message += &format!(" {error}"));
            warnings.push(Warning { code: WarningCode::ViewShowsNothing, message });
        }
        warnings
    }
}
