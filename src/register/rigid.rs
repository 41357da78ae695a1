//! Registration with a known scale, for partial scans of scenes with low overlap and repeated structure.
//!
//! The voxel size follows from the number of points. Poses come from matches that preserve distances, and are ranked by
//! the agreement of both complete scenes and by the free space of their sensors.

use super::cloud_pair::CloudPair;
use super::feature_registration::Estimate;
use super::input::PREPARED;
use super::normalized_pair::NormalizedPair;
use super::options::RegisterOptions;
use super::pose_scorer::{PoseScorer, distinctiveness};
use super::pose_selector::{Candidate, no_consensus, with_normals};
use super::settings::{RegistrationSettings, given_voxel_size};
use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::similarity::{Similarity, vec3};
use crate::geometry::voxel_grid::{paused_downsample, voxel_size_leaving};
use crate::progress::{Stage, Stopwatch};
use crate::register::compatibility::{Hypothesis, hypotheses};
use crate::register::fpfh::Descriptor;
use crate::register::free_space::{FreeSpace, SEEN};
use crate::register::icp::movement;
use crate::register::matching::{Match, Nearest};
use crate::report::Counts;
use crate::scheduler::Scheduler;

/// Maximum number of voxels of the larger cloud by default: it resolves furniture and keeps the run time at seconds.
const VOXELS: usize = 5_000;

/// Maximum number of matches: mutual ones, supplemented by one-way matches.
const MATCHES: usize = 3_000;

/// Maximum number of poses from matches, and of those that are refined.
const HYPOTHESES: usize = 100;
const REFINED: usize = 5;

/// ICP iterations of that refinement, after which a correct pose is close.
const ITERATIONS: usize = 15;

/// Tolerance of the points that bound free space, in voxels.
pub(super) const FREE_SLACK_VOXELS: f32 = 2.0;

/// Registers clouds with a known scale (`options.scale` is fixed).
///
/// # Errors
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus).
pub(super) async fn register_rigid(
    [source_xyz, target_xyz]: [&[f64]; 2],
    options: &RegisterOptions,
    stages: &mut Stopwatch<'_>,
    scheduler: &Scheduler,
) -> Result<Candidate> {
    let frames = NormalizedPair::of(source_xyz, target_xyz, options.scale)?;
    scheduler.yield_after(PREPARED * (source_xyz.len() + target_xyz.len()) as f64).await;
    let scans = Scans::new(&frames, [source_xyz, target_xyz], options, stages, scheduler).await;
    let [source, target] = &scans.clouds;
    let clouds = CloudPair::new(source, target, scans.settings.voxel_size, scheduler).await;
    let features = clouds.descriptors(&scans.settings, stages, scheduler).await;
    stages.enter(Stage::Matching);
    let matches = Nearest::of(&features[0], &features[1], scheduler).await.best(MATCHES);
    let estimate = scans.estimate(&clouds, &features, &matches, stages, scheduler).await?;
    Ok(Candidate::new(&frames, estimate))
}

/// Both clouds in their normalised frames, with normals.
struct Scans {
    clouds: [Cloud; 2],
    /// Free space in their frames, if the position of the sensor is known.
    free: [Option<FreeSpace>; 2],
    settings: RegistrationSettings,
}

impl Scans {
    async fn new(
        frames: &NormalizedPair,
        [source_xyz, target_xyz]: [&[f64]; 2],
        options: &RegisterOptions,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Self {
        let most = options.max_points as usize;
        let source = limit_points(frames.source.normalized_flat(source_xyz), most, scheduler).await;
        let target = limit_points(frames.target.normalized_flat(target_xyz), most, scheduler).await;
        let voxel_size = match given_voxel_size(options, frames) {
            Some(size) => size as f32,
            None => {
                let of_source = voxel_size_leaving(&source, VOXELS, scheduler).await;
                of_source.max(voxel_size_leaving(&target, VOXELS, scheduler).await)
            }
        };
        let settings = RegistrationSettings::new(options, f64::from(voxel_size), frames.scale_mode, frames.guard);

        stages.enter(Stage::Normals);
        // Scans are usually in the frame of their sensor; the points show whether that is plausible.
        let [source_eye, target_eye] = [&frames.source, &frames.target].map(|f| vec3(&f.unit_from_own().translation));
        let slack = FREE_SLACK_VOXELS * voxel_size;
        let source_free = FreeSpace::seen_from(source_eye, &source.points, slack);
        scheduler.yield_after(SEEN * source.len() as f64).await;
        let target_free = FreeSpace::seen_from(target_eye, &target.points, slack);
        scheduler.yield_after(SEEN * target.len() as f64).await;
        let source = with_normals(source, source_free.as_ref().map(|_| source_eye), scheduler).await;
        let target = with_normals(target, target_free.as_ref().map(|_| target_eye), scheduler).await;
        Self { clouds: [source, target], free: [source_free, target_free], settings }
    }

    /// The best pose from matches.
    async fn estimate(
        &self,
        clouds: &CloudPair<'_>,
        features: &[Vec<Descriptor>; 2],
        matches: &[Match],
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Result<Estimate> {
        let settings = &self.settings;
        stages.enter(Stage::Ransac);
        let distance = settings.ransac.inlier_distance as f32;
        let count = HYPOTHESES.min(settings.ransac.max_iterations);
        let [source_points, target_points] = [&clouds.source, &clouds.target].map(|side| &side.grid.cloud.points);
        let found = hypotheses(source_points, target_points, matches, distance, count, scheduler).await;
        let iterations = found.len();

        stages.enter(Stage::Filter);
        let scorer = PoseScorer {
            clouds,
            weights: features.each_ref().map(|features| distinctiveness(features)),
            free: self.free.clone(),
            distance,
        };
        let candidates = distinct_candidates(&scorer, found, scheduler).await;

        stages.enter(Stage::Icp);
        let mut best: Option<(f64, Similarity, Vec<usize>)> = None;
        let icp = settings.brief_icp_on_grid(ITERATIONS);
        for hypothesis in candidates {
            if !scheduler.may_continue(best.is_some()) {
                break;
            }
            let mut pose = hypothesis.target_from_source;
            if let Some(icp) = &icp {
                pose = clouds.refine_on_grid(&pose, icp, scheduler).await.target_from_source;
            }
            scheduler.yield_after(scorer.work()).await;
            let score = scorer.score(&pose);
            if best.as_ref().is_none_or(|(highest, ..)| score > *highest) {
                best = Some((score, pose, hypothesis.inliers));
            }
        }
        let Some((_, pose, inliers)) = best else {
            return Err(no_consensus(format!("{} matches, no three of which preserve distances", matches.len())));
        };
        let refined = clouds.refine(&pose, settings, scheduler).await;
        let found = Counts { matches: matches.len(), inliers: inliers.len(), iterations, ..Counts::default() };
        Ok(Estimate {
            target_from_source: refined.target_from_source,
            clamped: false,
            converged: refined.converged,
            rms: refined.rms,
            counts: clouds.counts(&refined, found),
            inliers,
        })
    }
}

/// The cloud if it has at most `most` points; otherwise the means of the smallest voxels that leave that many.
pub(super) async fn limit_points(cloud: Cloud, most: usize, scheduler: &Scheduler) -> Cloud {
    if cloud.len() <= most {
        return cloud;
    }
    let size = voxel_size_leaving(&cloud, most, scheduler).await;
    paused_downsample(&cloud, size, scheduler).await
}

/// The poses with the highest scores, best first, without near duplicates.
async fn distinct_candidates(
    scorer: &PoseScorer<'_>,
    mut found: Vec<Hypothesis>,
    scheduler: &Scheduler,
) -> Vec<Hypothesis> {
    let mut scores = Vec::with_capacity(found.len());
    for hypothesis in &found {
        scores.push(scorer.score(&hypothesis.target_from_source));
        scheduler.yield_after(scorer.work()).await;
    }
    let mut chosen: Vec<Hypothesis> = Vec::new();
    while chosen.len() < REFINED {
        let highest = (0..scores.len()).reduce(|best, i| if scores[i] > scores[best] { i } else { best });
        let Some(highest) = highest else { break };
        scores.swap_remove(highest);
        let hypothesis = found.swap_remove(highest);
        let pose = &hypothesis.target_from_source;
        let is_new = |other: &Hypothesis| movement(&other.target_from_source, pose) > f64::from(2.0 * scorer.distance);
        if chosen.iter().all(is_new) {
            chosen.push(hypothesis);
        }
    }
    chosen
}
