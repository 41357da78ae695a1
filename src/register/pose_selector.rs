//! Selects among transforms between two clouds the one under which the complete clouds agree best.

use glam::Vec3;

use super::feature_registration::{Estimate, FeatureRegistration};
use super::input::PREPARED;
use super::normalized_pair::{Fit, NormalizedPair};
use super::options::RegisterOptions;
use super::report::Registration;
use super::settings::{RegistrationSettings, given_voxel_size};
use crate::error::{Error, ErrorCode, Result, Text};
use crate::evidence::NORMAL_NEIGHBORS;
use crate::evidence::normals::outward_normals;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::Similarity;
use crate::geometry::voxel_grid::voxel_size_leaving;
use crate::options::scale::ScaleOption;
use crate::progress::{Stage, Stopwatch};
use crate::scheduler::Scheduler;

/// Default number of voxels along the diagonal of the target's bounding box.
const DIVISIONS: f64 = 30.0;

/// Maximum number of poses tried per pair of clouds.
const POSES: usize = 6;

/// Limit on minimal sets once a pose exists that only a certain one can replace. It suffices for clouds that differ
/// only in clutter.
const ITERATIONS_WITH_PREFERRED: usize = 20_000;

/// Agreement at which a pose is certain and the search stops: about nine of ten points coincide.
const CERTAIN: f64 = 0.9;

/// Fitness in both directions from which the clouds show the same surface.
const MUTUAL: f64 = 0.9;

/// Fitness in the worse direction below which clouds have only a part in common, or one is cluttered.
const PARTIAL: f64 = 0.5;

/// Tries poses, and keeps the one under which the complete clouds agree best.
pub(crate) struct PoseSelector {
    pub(crate) frames: NormalizedPair,
    source: Cloud,
    target: KdTree,
    inlier_distance: f32,
    /// The other direction, unless the scale is fixed.
    reverse: Option<Reverse>,
    best: Option<(Agreement, Candidate)>,
    /// If set, only a certain pose replaces the best one.
    has_preferred: bool,
    failure: Option<Error>,
}

impl PoseSelector {
    pub(crate) async fn new(
        source_xyz: &[f64],
        target_xyz: &[f64],
        frames: NormalizedPair,
        options: &RegisterOptions,
        scheduler: &Scheduler,
    ) -> Self {
        let source = frames.source.normalized_flat(source_xyz);
        let target = frames.target.normalized_flat(target_xyz);
        scheduler.yield_after(PREPARED * (source_xyz.len() + target_xyz.len()) as f64).await;
        let tree = KdTree::paused(&target.points, scheduler).await;
        let reverse = match options.scale {
            ScaleOption::Fixed(_) => None,
            _ => Some(Reverse::new(&source, target, scheduler).await),
        };
        Self {
            reverse,
            source,
            target: tree,
            inlier_distance: (options.inlier_distance_voxels * unit_voxel_size(options, &frames)) as f32,
            frames,
            best: None,
            has_preferred: false,
            failure: None,
        }
    }

    /// Sets a pose that was selected by evidence from both complete scenes; only a certain pose replaces it. If scenes
    /// overlap little, more points can agree under a wrong pose.
    pub(crate) async fn prefer(&mut self, candidate: Result<Candidate>, scheduler: &Scheduler) {
        match candidate {
            Ok(candidate) => {
                let other = self.best.take();
                self.consider(candidate, scheduler).await;
                self.has_preferred = true;
                if let Some((agreement, other)) = other {
                    self.keep_better(agreement, other);
                }
            }
            Err(error) => self.failure = Some(error),
        }
    }

    pub(crate) fn has_preferred(&self) -> bool {
        self.has_preferred
    }

    /// Registers these clouds by features, pose by pose until one is certain.
    pub(crate) async fn try_clouds(
        &mut self,
        source_xyz: &[f64],
        target_xyz: &[f64],
        options: &RegisterOptions,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Result<()> {
        if self.is_certain() || !scheduler.may_continue(self.has_pose()) {
            return Ok(());
        }
        let frames = NormalizedPair::of(source_xyz, target_xyz, options.scale)?;
        // Without a known scale, clutter misleads the preferred pose as well.
        let is_brief = self.has_preferred && self.reverse.is_none();
        stages.enter(Stage::Normals);
        let source = with_normals(frames.source.normalized_flat(source_xyz), None, scheduler).await;
        let target = with_normals(frames.target.normalized_flat(target_xyz), None, scheduler).await;
        let mut settings =
            RegistrationSettings::new(options, unit_voxel_size(options, &frames), frames.scale_mode, frames.guard);
        if is_brief {
            settings.ransac.max_iterations = settings.ransac.max_iterations.min(ITERATIONS_WITH_PREFERRED);
        }
        let mut registration = FeatureRegistration::new(&source, &target, &settings, stages, scheduler).await;
        let poses = if is_brief { 1 } else { POSES };
        for _ in 0..poses {
            if self.is_certain() || self.is_partial(source_xyz) || !scheduler.may_continue(self.has_pose()) {
                break;
            }
            match registration.solve(&settings, stages, scheduler).await {
                Ok(estimate) => {
                    // The inliers would lead to the same pose again.
                    registration.discard(&estimate.inliers);
                    match check_scale(&estimate, options) {
                        Ok(()) => self.consider(Candidate::new(&frames, estimate), scheduler).await,
                        Err(error) => drop(self.failure.get_or_insert(error)),
                    }
                }
                Err(error) => {
                    self.failure.get_or_insert(about_clouds(error, "source"));
                    break;
                }
            }
        }
        Ok(())
    }

    /// Whether almost all points of both clouds coincide under the best pose: no cloud is partial, and no scale too small.
    pub(crate) fn is_mutual(&self) -> bool {
        self.best.as_ref().is_some_and(|(agreement, _)| agreement.mutual >= MUTUAL)
    }

    /// Whether the first pose of all points with a free scale shows that they have only a part in common. Of dense
    /// points, clutter is left out, which says as much of the others.
    fn is_partial(&self, source_xyz: &[f64]) -> bool {
        let is_free = self.reverse.is_some() && source_xyz.len() == 3 * self.source.len();
        is_free && self.best.as_ref().is_some_and(|(agreement, _)| agreement.mutual < PARTIAL)
    }

    pub(crate) fn has_pose(&self) -> bool {
        self.best.is_some()
    }

    fn is_certain(&self) -> bool {
        self.best.as_ref().is_some_and(|(agreement, _)| agreement.score >= CERTAIN)
    }

    async fn consider(&mut self, candidate: Candidate, scheduler: &Scheduler) {
        let unit = self.frames.normalized(&candidate.target_from_source);
        let distance = self.inlier_distance;
        let mut agreement = Agreement::of(&self.source, &self.target, &unit, distance, scheduler).await;
        if let Some(reverse) = &self.reverse {
            let (inverse, distance) = (unit.inverse(), distance / unit.scale as f32);
            let back = Agreement::of(&reverse.target, &reverse.source, &inverse, distance, scheduler).await;
            reverse.complete(&mut agreement, &back, unit.scale);
        }
        self.keep_better(agreement, candidate);
    }

    fn keep_better(&mut self, agreement: Agreement, candidate: Candidate) {
        let is_taken = !self.has_preferred || agreement.score >= CERTAIN;
        if is_taken && self.best.as_ref().is_none_or(|(best, _)| agreement.rank > best.rank) {
            self.best = Some((agreement, candidate));
        }
    }

    /// The result for the best pose.
    ///
    /// # Errors
    /// The error of the first failed attempt, if there is no pose.
    pub(crate) fn finish(self, options: &RegisterOptions, stages: Stopwatch<'_>) -> Result<Registration> {
        let Some((agreement, candidate)) = self.best else {
            return Err(self.failure.unwrap_or_else(no_attempt));
        };
        let Candidate { target_from_source, estimate, residual } = candidate;
        let fit = Fit { fitness: agreement.fitness, residual, converged: estimate.converged, counts: estimate.counts };
        Ok(self.frames.registration(&target_from_source, fit, options.seed, stages))
    }
}

/// A candidate transform between the frames of the clouds.
pub(crate) struct Candidate {
    target_from_source: Similarity,
    estimate: Estimate,
    /// In target units.
    residual: f64,
}

impl Candidate {
    /// The candidate for an estimate in normalised frames.
    pub(crate) fn new(frames: &NormalizedPair, estimate: Estimate) -> Self {
        Self {
            target_from_source: frames.denormalized(&estimate.target_from_source),
            residual: estimate.rms * frames.target.diagonal(),
            estimate,
        }
    }
}

/// Agreement of the source points with the target points.
struct Agreement {
    /// Fraction of the source points within the inlier distance of a target point.
    fitness: f64,
    /// Mean of max(0, 1 − (r/d)²) over the source points; d is a third of the inlier distance. In clutter, every point
    /// has a near neighbour; only under the correct pose, many have a very near one.
    score: f64,
    /// The rank of a pose: the score or, with a free scale, that of both directions.
    rank: f64,
    /// The lower fitness of both directions, if both are known.
    mutual: f64,
}

/// A score that compares poses of different scales: a source that shrinks agrees everywhere, but with ever less of the target.
struct Reverse {
    source: KdTree,
    target: Cloud,
    /// Linear size of the source relative to the target, at scale 1, by the area that their points cover.
    size: f64,
}

/// Number of voxels that compare the areas of two clouds.
const AREA_VOXELS: usize = 1_500;

impl Reverse {
    async fn new(source: &Cloud, target: Cloud, scheduler: &Scheduler) -> Self {
        let mut sizes = [0.0; 2];
        for (size, cloud) in sizes.iter_mut().zip([source, &target]) {
            *size = voxel_size_leaving(cloud, AREA_VOXELS.min(cloud.len() / 2), scheduler).await;
        }
        let tree = KdTree::paused(&source.points, scheduler).await;
        Self { source: tree, target, size: f64::from(sizes[0] / sizes[1]) }
    }

    /// Adds the other direction: the rank becomes the area on which both clouds agree, relative to the geometric mean of
    /// their areas.
    fn complete(&self, agreement: &mut Agreement, back: &Agreement, scale: f64) {
        let size = scale * self.size;
        agreement.rank = agreement.score * size + back.score / size;
        agreement.mutual = agreement.fitness.min(back.fitness);
    }
}

impl Agreement {
    async fn of(source: &Cloud, target: &KdTree, unit: &Similarity, distance: f32, scheduler: &Scheduler) -> Self {
        let transform = unit.to_f32();
        let (mut near, mut sum) = (0_usize, 0.0);
        for &point in &source.points {
            if let Some(neighbor) = target.nearest_within(transform.apply(point), distance) {
                near += 1;
                let close = distance / 3.0;
                sum += (1.0 - f64::from(neighbor.distance_squared) / f64::from(close * close)).max(0.0);
            }
            scheduler.yield_after(NEAREST).await;
        }
        let count = source.len() as f64;
        let score = sum / count;
        Self { fitness: near as f64 / count, score, rank: score, mutual: 0.0 }
    }
}

/// The voxel size in the normalised frame of the target.
fn unit_voxel_size(options: &RegisterOptions, frames: &NormalizedPair) -> f64 {
    given_voxel_size(options, frames).unwrap_or(1.0 / DIVISIONS)
}

/// The cloud with [`outward_normals`].
pub(crate) async fn with_normals(mut cloud: Cloud, eye: Option<Vec3>, scheduler: &Scheduler) -> Cloud {
    cloud.normals = outward_normals(&cloud.points, eye, NORMAL_NEIGHBORS, scheduler).await;
    cloud
}

/// Units of work of a search for the nearest point.
const NEAREST: f64 = 1e-3;

/// Rewords errors of RANSAC, which refer to mesh and observation, for two clouds.
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

/// The error for clouds without a consistent pose.
pub(super) fn no_consensus(found: impl Into<Text>) -> Error {
    about_clouds(Error::new(ErrorCode::NoConsensus, "source", found, "", ""), "source")
}

/// Rejects an estimate whose free scale ended at a bound. Bounds that are given hold a scale; the default ones only limit
/// the search.
pub(super) fn check_scale(estimate: &Estimate, options: &RegisterOptions) -> Result<()> {
    if estimate.clamped && matches!(options.scale, ScaleOption::Free) {
        return Err(no_consensus("a scale at a bound of the range that was searched"));
    }
    Ok(())
}

fn no_attempt() -> Error {
    Error::new(ErrorCode::Internal, "source", "no candidate", "at least one", "Please report this with the two clouds.")
}
