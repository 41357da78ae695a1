//! Registration with an unknown scale, for partial scans.
//!
//! A small scale makes a source fit anywhere, and the boxes of clouds that overlap in part are little evidence of it. Matches
//! therefore vote for the scale: at each of a series of scales, poses come from matches that preserve distances, as with
//! a known scale. Poses of different scales are compared by the area on which both scenes agree, relative to the sizes
//! of both (see [`PoseScorer::balanced`]).

use glam::Vec3;

use super::cloud_pair::CloudPair;
use super::compatibility::hypotheses;
use super::feature_registration::Estimate;
use super::icp::movement;
use super::input::PREPARED;
use super::matching::{Match, Nearest};
use super::normalized_pair::NormalizedPair;
use super::options::RegisterOptions;
use super::pose_scorer::{PoseScorer, distinctiveness};
use super::pose_selector::{Candidate, check_scale, no_consensus, with_normals};
use super::ransac::{Guard, GuardMode};
use super::rigid::{FREE_SLACK_VOXELS, limit_points};
use super::settings::{RegistrationSettings, given_voxel_size};
use super::umeyama::ScaleMode;
use crate::error::Result;
use crate::evidence::extents::Extents;
use crate::geometry::cloud::Cloud;
use crate::geometry::order::largest;
use crate::geometry::similarity::{Similarity, vec3};
use crate::geometry::voxel_grid::voxel_size_leaving;
use crate::progress::{Stage, Stopwatch};
use crate::register::free_space::{FreeSpace, SEEN};
use crate::report::Counts;
use crate::scheduler::Scheduler;

/// Settings of one round of matching and RANSAC.
struct Round {
    /// Voxels of the larger cloud.
    voxels: usize,
    /// Maximum number of matches.
    matches: usize,
    /// Maximum number of poses from the matches at each fine step.
    hypotheses: usize,
    /// Matches are tested at the scale, and at this ratio above and below: descriptors tolerate other scales better
    /// than distances do.
    fine_step: f64,
}

/// Finds the scale.
const VOTE: Round = Round { voxels: 1_500, matches: 1_000, hypotheses: 8, fine_step: 1.1 };

/// Finds the pose.
const POSE: Round = Round { voxels: 5_000, matches: 3_000, hypotheses: 80, fine_step: 1.05 };

/// Ratio of successive scales of the series.
const COARSE_STEP: f64 = 1.35;

/// Widest range of scales that bounds can ask for, relative to the ratio of the boxes.
const WIDEST: [f64; 2] = [0.02, 50.0];

/// A second scale is tried if its best score in the vote is at least this fraction of the best one, and if it differs by
/// this ratio.
const SECOND: f64 = 0.7;
const SECOND_RATIO: f64 = 1.3;

/// Number of poses of the vote that are candidates at the scale in question.
const VOTED: usize = 20;

/// Number of candidates that are refined, and ICP iterations of that refinement.
const REFINED: usize = 8;
const ITERATIONS: usize = 20;

/// Distance of two candidates that are both refined, relative to the size of the smaller cloud: about 10°.
const APART: f64 = 0.15;

/// Bounds of the scale in the refinement of a pose, relative to its scale. With few points in common, ICP shrinks the
/// source otherwise.
const SCALE_SLACK: [f64; 2] = [0.87, 1.15];

/// Registers clouds whose scale is unknown, or known to be within bounds.
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus), also if a scale without given bounds ends at a bound of the default range.
pub(super) async fn register_free(
    [source_xyz, target_xyz]: [&[f64]; 2],
    options: &RegisterOptions,
    stages: &mut Stopwatch<'_>,
    scheduler: &Scheduler,
) -> Result<Candidate> {
    let frames = NormalizedPair::of(source_xyz, target_xyz, options.scale)?;
    let guard = frames.guard.unwrap_or([1.0; 2]);
    stages.enter(Stage::Normals);
    scheduler.yield_after(PREPARED * (source_xyz.len() + target_xyz.len()) as f64).await;
    let scans = Scans::new(&frames, [source_xyz, target_xyz], options, scheduler).await;

    let [least, most] = [guard[0].max(WIDEST[0]), guard[1].min(WIDEST[1])];
    let vote = scans.at(&VOTE, scheduler).await;
    let mut voted: Vec<Hypothesis> = Vec::new();
    let mut scale = least * COARSE_STEP.min(most / least).sqrt();
    while scale <= most && scheduler.may_continue(!voted.is_empty()) {
        let scaled = scans.scaled(scale, &vote, guard, options, scheduler).await;
        let clouds = CloudPair::new(&scaled.source, scaled.target, scaled.settings.voxel_size, scheduler).await;
        let level = Level::new(&scaled, &clouds, &VOTE, stages, scheduler).await;
        voted.extend(level.hypotheses(&VOTE, scheduler).await);
        scale *= COARSE_STEP;
    }
    let voted = best_first(&voted, VOTED);

    let Some(first) = voted.first() else { return Err(no_consensus("no three matches that preserve distances")) };
    let (scale, least) = (first.pose.scale, SECOND * first.score);
    let differs = |other: &f64| (other / scale).max(scale / other) >= SECOND_RATIO;
    let second = voted.iter().take_while(|vote| vote.score >= least).map(|vote| vote.pose.scale).find(differs);
    let pose = scans.at(&POSE, scheduler).await;
    let mut best: Option<(f64, Estimate)> = None;
    for scale in core::iter::once(scale).chain(second) {
        if !scheduler.may_continue(best.is_some()) {
            break;
        }
        let mut scaled = scans.scaled(scale, &pose, guard, options, scheduler).await;
        if let Some(voxel_size) = given_voxel_size(options, &frames) {
            let guard = guard.map(|bound| bound / scale);
            scaled.settings = RegistrationSettings::new(options, voxel_size, ScaleMode::Free, Some(guard));
        }
        if let Some((score, estimate)) = scaled.solve(&voted, guard, stages, scheduler).await
            && best.as_ref().is_none_or(|(highest, _)| score > *highest)
        {
            best = Some((score, estimate));
        }
    }
    let Some((_, estimate)) = best else { return Err(no_consensus("no pose")) };
    check_scale(&estimate, options)?;
    Ok(Candidate::new(&frames, estimate))
}

/// Both clouds in their normalised frames, with normals.
struct Scans {
    source: Cloud,
    target: Cloud,
    /// Positions of the sensors, if they are plausible.
    eyes: [Option<Vec3>; 2],
}

impl Scans {
    async fn new(frames: &NormalizedPair, xyz: [&[f64]; 2], options: &RegisterOptions, scheduler: &Scheduler) -> Self {
        let (source, source_eye) = scan(&frames.source, xyz[0], options, scheduler).await;
        let (target, target_eye) = scan(&frames.target, xyz[1], options, scheduler).await;
        Self { source, target, eyes: [source_eye, target_eye] }
    }

    /// The resolution of a round, as far as it does not depend on the scale.
    async fn at(&self, round: &Round, scheduler: &Scheduler) -> Resolution {
        Resolution { voxels: round.voxels, target: voxel_size_leaving(&self.target, round.voxels, scheduler).await }
    }

    /// Both clouds, the source scaled.
    async fn scaled(
        &self,
        scale: f64,
        resolution: &Resolution,
        guard: [f64; 2],
        options: &RegisterOptions,
        scheduler: &Scheduler,
    ) -> Scaled<'_> {
        let factor = scale as f32;
        let points = self.source.points.iter().map(|&p| factor * p).collect();
        let source = Cloud { points, normals: self.source.normals.clone() };
        let voxel_size = voxel_size_leaving(&source, resolution.voxels, scheduler).await.max(resolution.target);
        let slack = FREE_SLACK_VOXELS * voxel_size;
        let of_source = self.eyes[0].and_then(|eye| FreeSpace::seen_from(factor * eye, &source.points, slack));
        scheduler.yield_after(SEEN * source.len() as f64).await;
        let of_target = self.eyes[1].and_then(|eye| FreeSpace::seen_from(eye, &self.target.points, slack));
        scheduler.yield_after(SEEN * self.target.len() as f64).await;
        let free = [of_source, of_target];
        let guard = guard.map(|bound| bound / scale);
        let settings = RegistrationSettings::new(options, f64::from(voxel_size), ScaleMode::Free, Some(guard));
        Scaled { scale, source, target: &self.target, free, settings }
    }
}

/// A cloud with normals, and the position of its sensor.
async fn scan(
    extents: &Extents,
    xyz: &[f64],
    options: &RegisterOptions,
    scheduler: &Scheduler,
) -> (Cloud, Option<Vec3>) {
    let cloud = limit_points(extents.normalized_flat(xyz), options.max_points as usize, scheduler).await;
    // Scans are usually in the frame of their sensor; the points show whether that is plausible.
    let eye = vec3(&extents.unit_from_own().translation);
    let slack = FREE_SLACK_VOXELS * voxel_size_leaving(&cloud, POSE.voxels, scheduler).await;
    let eye = FreeSpace::seen_from(eye, &cloud.points, slack).map(|_| eye);
    scheduler.yield_after(SEEN * cloud.len() as f64).await;
    (with_normals(cloud, eye, scheduler).await, eye)
}

/// The resolution of both clouds.
struct Resolution {
    /// Voxels of the larger cloud.
    voxels: usize,
    /// Size of the voxels that leave so many of the target.
    target: f32,
}

/// Both clouds at a relative scale, at which that of a pose is about 1.
struct Scaled<'a> {
    scale: f64,
    source: Cloud,
    target: &'a Cloud,
    free: [Option<FreeSpace>; 2],
    settings: RegistrationSettings,
}

impl Scaled<'_> {
    /// The best pose at about this scale, between the normalised frames, and its score.
    async fn solve(
        &self,
        voted: &[Hypothesis],
        guard: [f64; 2],
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Option<(f64, Estimate)> {
        let clouds = CloudPair::new(&self.source, self.target, self.settings.voxel_size, scheduler).await;
        let level = Level::new(self, &clouds, &POSE, stages, scheduler).await;
        let mut found = level.hypotheses(&POSE, scheduler).await;
        let iterations = found.len();
        stages.enter(Stage::Filter);
        for vote in voted {
            found.push(level.judged(vote.pose, vote.inliers));
            scheduler.yield_after(level.scorer.work()).await;
        }
        let chosen = self.distinct(&found, level.scorer.distance);

        stages.enter(Stage::Icp);
        let mut best: Option<Hypothesis> = None;
        for candidate in chosen {
            if !scheduler.may_continue(best.is_some()) {
                break;
            }
            let mut own = self.own(&candidate.pose);
            if let Some(icp) = self.near(own.scale).brief_icp_on_grid(ITERATIONS) {
                own = clouds.refine_on_grid(&own, &icp, scheduler).await.target_from_source;
            }
            scheduler.yield_after(level.scorer.work()).await;
            let refined = level.judged(self.unscaled(own), candidate.inliers);
            if best.is_none_or(|best| refined.score > best.score) {
                best = Some(refined);
            }
        }
        let best = best?;
        let own = self.own(&best.pose);
        let refined = clouds.refine(&own, &self.near(own.scale), scheduler).await;
        let pose = self.unscaled(refined.target_from_source);
        let bounds = Guard { min: guard[0], max: guard[1], mode: GuardMode::Reject };
        let matches = level.matches.len();
        let estimate = Estimate {
            target_from_source: pose,
            clamped: bounds.is_bound(pose.scale),
            converged: refined.converged,
            rms: refined.rms,
            counts: clouds.counts(&refined, Counts { matches, inliers: best.inliers, iterations, ..Counts::default() }),
            inliers: Vec::new(),
        };
        Some((best.score, estimate))
    }

    /// The best candidates without near duplicates, best first.
    fn distinct(&self, candidates: &[Hypothesis], distance: f32) -> Vec<Hypothesis> {
        let apart = f64::from(2.0 * distance).max(APART * self.scale.min(1.0));
        let mut chosen: Vec<Hypothesis> = Vec::new();
        for candidate in best_first(candidates, candidates.len()) {
            let pose = self.own(&candidate.pose);
            let is_new = |other: &Hypothesis| movement(&self.own(&other.pose), &pose) > apart;
            if chosen.len() < REFINED && chosen.iter().all(is_new) {
                chosen.push(candidate);
            }
        }
        chosen
    }

    /// Settings whose bounds of the scale are about that of a pose.
    fn near(&self, scale: f64) -> RegistrationSettings {
        let mut settings = self.settings;
        if let Some(guard) = &mut settings.ransac.guard {
            // Not `clamp`, whose panic formats numbers: 10 kB of the module.
            let within = |bound: f64| bound.max(guard.min).min(guard.max);
            let [min, max] = SCALE_SLACK.map(|factor| within(factor * scale));
            (guard.min, guard.max) = (min, max);
        }
        settings
    }

    /// A pose between the normalised frames as one from the scaled source, and back.
    fn own(&self, pose: &Similarity) -> Similarity {
        Similarity { scale: pose.scale / self.scale, ..*pose }
    }

    fn unscaled(&self, own: Similarity) -> Similarity {
        Similarity { scale: own.scale * self.scale, ..own }
    }
}

/// A pose between the normalised frames.
#[derive(Clone, Copy)]
struct Hypothesis {
    pose: Similarity,
    /// See [`PoseScorer::balanced`].
    score: f64,
    /// Number of matches that agree.
    inliers: usize,
}

/// The best `count` hypotheses, best first.
fn best_first(hypotheses: &[Hypothesis], count: usize) -> Vec<Hypothesis> {
    let best = largest(hypotheses.iter().map(|h| h.score as f32), count);
    best.into_iter().map(|i| hypotheses[i as usize]).collect()
}

/// The matches of both clouds at a scale, and what scores poses.
struct Level<'a> {
    scaled: &'a Scaled<'a>,
    scorer: PoseScorer<'a>,
    matches: Vec<Match>,
}

impl<'a> Level<'a> {
    async fn new(
        scaled: &'a Scaled<'a>,
        clouds: &'a CloudPair<'a>,
        round: &Round,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Self {
        let settings = &scaled.settings;
        let [source, target] = clouds.descriptors(settings, stages, scheduler).await;
        stages.enter(Stage::Matching);
        let matches = Nearest::of(&source, &target, scheduler).await.best(round.matches);
        stages.enter(Stage::Ransac);
        let weights = [distinctiveness(&source), distinctiveness(&target)];
        let distance = scaled.settings.ransac.inlier_distance as f32;
        Self { scaled, scorer: PoseScorer { clouds, weights, free: scaled.free.clone(), distance }, matches }
    }

    fn judged(&self, pose: Similarity, inliers: usize) -> Hypothesis {
        Hypothesis { pose, score: self.scorer.balanced(&self.scaled.own(&pose)), inliers }
    }

    /// Poses from matches.
    async fn hypotheses(&self, round: &Round, scheduler: &Scheduler) -> Vec<Hypothesis> {
        let [source, target] = [&self.scorer.clouds.source, &self.scorer.clouds.target].map(|side| &side.grid.cloud);
        let mut found = Vec::new();
        for scale in [1.0 / round.fine_step, 1.0, round.fine_step] {
            let points: Vec<Vec3> = source.points.iter().map(|&p| scale as f32 * p).collect();
            let distance = self.scorer.distance;
            let count = round.hypotheses;
            for rigid in hypotheses(&points, &target.points, &self.matches, distance, count, scheduler).await {
                let own = Similarity { scale, ..rigid.target_from_source };
                found.push(self.judged(self.scaled.unscaled(own), rigid.inliers.len()));
                scheduler.yield_after(self.scorer.work()).await;
            }
        }
        found
    }
}
