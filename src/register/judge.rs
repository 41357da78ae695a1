//! Which of several transforms between two clouds is right: the one under which the whole clouds agree best.

use glam::Vec3;

use super::frames::{Fit, Frames};
use super::global::{Estimate, Problem, Settings};
use super::options::RegisterOptions;
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::NORMAL_NEIGHBORS;
use crate::evidence::extents::target_from_source;
use crate::evidence::normals::outward_normals;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::Similarity;
use crate::progress::{Stage, Stopwatch};
use crate::report::Registration;

/// Voxels along the target's box diagonal, where the caller says nothing.
const DIVISIONS: f64 = 30.0;

/// Poses tried for one pair of clouds at most.
const POSES: usize = 6;

/// Minimal sets drawn at most where there is a pose already that only one beyond doubt could replace: enough for clouds
/// that are the same but for their clutter.
const DOUBTFUL_ITERATIONS: usize = 20_000;

/// Agreement at which no further pose is tried: nine points in ten all but coincide.
const BEYOND_DOUBT: f64 = 0.9;

/// Tries clouds and poses, and keeps the transform under which the whole clouds agree best.
pub(crate) struct Judge {
    pub(crate) frames: Frames,
    source: Cloud,
    target: KdTree,
    inlier_distance: f32,
    best: Option<(Agreement, Attempt)>,
    /// Whether nothing that is not beyond doubt takes the place of the best.
    holds: bool,
    failure: Option<Error>,
}

impl Judge {
    pub(crate) fn new(source_xyz: &[f64], target_xyz: &[f64], frames: Frames, options: &RegisterOptions) -> Self {
        Self {
            source: frames.source.normalized_flat(source_xyz),
            target: KdTree::new(&frames.target.normalized_flat(target_xyz).points),
            inlier_distance: (options.inlier_distance_voxels * unit_voxel_size(options, &frames)) as f32,
            frames,
            best: None,
            holds: false,
            failure: None,
        }
    }

    /// Keeps a pose that was chosen from all of both scenes, unless another is beyond doubt: where these share little, a
    /// wrong pose can make more of their points agree.
    pub(crate) fn hold(&mut self, attempt: Result<Attempt>) {
        match attempt {
            Ok(attempt) => {
                self.consider(attempt);
                self.holds = true;
            }
            Err(error) => self.failure = Some(error),
        }
    }

    pub(crate) fn holds(&self) -> bool {
        self.holds
    }

    /// Solves for these clouds pose after pose until the agreement is beyond doubt.
    pub(crate) fn attempt(
        &mut self,
        source_xyz: &[f64],
        target_xyz: &[f64],
        options: &RegisterOptions,
        stages: &mut Stopwatch<'_>,
    ) -> Result<()> {
        if self.is_beyond_doubt() {
            return Ok(());
        }
        let frames = Frames::of(source_xyz, target_xyz, options.scale)?;
        stages.enter(Stage::Normals);
        let source = with_normals(frames.source.normalized_flat(source_xyz), None);
        let target = with_normals(frames.target.normalized_flat(target_xyz), None);
        let mut settings =
            Settings::of_register(options, unit_voxel_size(options, &frames), frames.scale_mode, frames.guard);
        if self.holds {
            settings.ransac.max_iterations = settings.ransac.max_iterations.min(DOUBTFUL_ITERATIONS);
        }
        let mut problem = Problem::new(&source, &target, &settings, stages);
        let poses = if self.holds { 1 } else { POSES };
        for _ in 0..poses {
            if self.is_beyond_doubt() {
                break;
            }
            match problem.solve(&settings, stages) {
                Ok(estimate) => {
                    // What agreed with this pose would again; another has to be found among the rest.
                    problem.discard(&estimate.inliers);
                    let unit = estimate.target_from_source;
                    self.consider(Attempt {
                        target_from_source: target_from_source(&frames.target, &unit, &frames.source),
                        residual: estimate.rms * frames.target.diagonal(),
                        estimate,
                    });
                }
                Err(error) => {
                    self.failure.get_or_insert(about_clouds(error, "source"));
                    break;
                }
            }
        }
        Ok(())
    }

    fn is_beyond_doubt(&self) -> bool {
        self.best.as_ref().is_some_and(|(agreement, _)| agreement.score >= BEYOND_DOUBT)
    }

    fn consider(&mut self, attempt: Attempt) {
        let unit = self.frames.unit(&attempt.target_from_source);
        let agreement = Agreement::of(&self.source, &self.target, &unit, self.inlier_distance);
        let is_taken = !self.holds || agreement.score >= BEYOND_DOUBT;
        if is_taken && self.best.as_ref().is_none_or(|(best, _)| agreement.score > best.score) {
            self.best = Some((agreement, attempt));
        }
    }

    pub(crate) fn verdict(self, options: &RegisterOptions, stages: Stopwatch<'_>) -> Result<Registration> {
        let Some((agreement, attempt)) = self.best else {
            return Err(self.failure.unwrap_or_else(no_attempt));
        };
        let Attempt { target_from_source, estimate, residual } = attempt;
        let fit = Fit { fitness: agreement.fitness, residual, converged: estimate.converged, counts: estimate.counts };
        Ok(self.frames.registration(&target_from_source, fit, options.seed, stages))
    }
}

/// A transform between the clouds' own frames, and how it came about.
pub(crate) struct Attempt {
    pub(crate) target_from_source: Similarity,
    pub(crate) estimate: Estimate,
    /// In target units.
    pub(crate) residual: f64,
}

/// How well the source's points agree with the target's.
struct Agreement {
    /// Share of the source points that land within the inlier distance of a target point.
    fitness: f64,
    /// Mean of 1 − (r/d)² over the source points, 0 beyond d, a third of the inlier distance: in clutter every
    /// point has something near; only under the right pose it has something very near.
    score: f64,
}

impl Agreement {
    fn of(source: &Cloud, target: &KdTree, unit: &Similarity, distance: f32) -> Self {
        let transform = unit.to_f32();
        let (mut near, mut sum) = (0_usize, 0.0);
        for &point in &source.points {
            if let Some(neighbor) = target.nearest_within(transform.apply(point), distance) {
                near += 1;
                let close = distance / 3.0;
                sum += (1.0 - f64::from(neighbor.distance_squared) / f64::from(close * close)).max(0.0);
            }
        }
        let count = source.len() as f64;
        Self { fitness: near as f64 / count, score: sum / count }
    }
}

/// The voxel size where the target's diagonal is 1.
fn unit_voxel_size(options: &RegisterOptions, frames: &Frames) -> f64 {
    options
        .voxel_size
        .map_or(1.0 / options.voxel_divisions.unwrap_or(DIVISIONS), |size| size / frames.target.diagonal())
}

/// See [`outward_normals`].
pub(crate) fn with_normals(mut cloud: Cloud, eye: Option<Vec3>) -> Cloud {
    cloud.normals = outward_normals(&cloud.points, eye, NORMAL_NEIGHBORS);
    cloud
}

/// RANSAC speaks of a mesh and its observation; here they are two clouds.
pub(crate) fn about_clouds(error: Error, argument: &str) -> Error {
    if error.code != ErrorCode::NoConsensus {
        return error;
    }
    Error::new(
        error.code,
        argument.to_owned(),
        error.found.clone(),
        "at least three matches of source and target that agree on one similarity",
        "Check that the clouds overlap; widen options.scale, or the distance up to which a match is an inlier.",
    )
}

fn no_attempt() -> Error {
    Error::new(ErrorCode::Internal, "source", "no attempt", "at least one", "Please report this with the two clouds.")
}
