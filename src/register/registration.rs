//! Registration of two point clouds of any origin.

use super::density::dense_points;
use super::free_scale::register_free;
use super::input::{PREPARED, check_cloud, finite_points, subsample};
use super::normalized_pair::NormalizedPair;
use super::options::RegisterOptions;
use super::pose_selector::PoseSelector;
use super::report::Registration;
use super::rigid::register_rigid;
use crate::error::Result;
use crate::evidence::observation::MIN_POINTS;
use crate::geometry::random::Random;
use crate::options::Options;
use crate::options::scale::ScaleOption;
use crate::progress::{Host, Stage, Stopwatch};
use crate::scheduler::{Boxed, Scheduler, Task, boxed, finished};

/// Random stream of the subsampling.
const STREAM: u64 = 5;

/// A cloud may be cluttered if its dense points are less than this fraction. Uniform samples keep more than nine of ten
/// points. A false positive costs little, because the correct pose is then found at once.
const CLUTTERED: f64 = 0.97;

/// Progress at the start of each stage, 0 to 1.
pub(super) const PLAN: &[(Stage, f64)] = &[
    (Stage::Sample, 0.0),
    (Stage::Normals, 0.05),
    (Stage::Features, 0.3),
    (Stage::Matching, 0.4),
    (Stage::Ransac, 0.6),
    (Stage::Filter, 0.8),
    (Stage::Icp, 0.8),
];

/// Estimates the similarity from a source cloud to a target cloud, both interleaved x, y, z in any unit. Points with NaN
/// or infinite coordinates are skipped.
///
/// # Errors
/// [`WrongLength`](crate::error::ErrorCode::WrongLength), [`TooFewPoints`](crate::error::ErrorCode::TooFewPoints),
/// [`DegeneratePoints`](crate::error::ErrorCode::DegeneratePoints), [`InvalidOption`](crate::error::ErrorCode::InvalidOption),
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus).
pub fn register(
    source_xyz: &[f64],
    target_xyz: &[f64],
    options: &RegisterOptions,
    host: &mut dyn Host,
) -> Result<Registration> {
    let scheduler = Scheduler::new(|| 0.0, options.work_budget);
    finished(registered([source_xyz, target_xyz], options, host, &scheduler))
}

/// [`register`] in steps, which end by this clock.
///
/// # Errors
/// [`InvalidOption`](crate::error::ErrorCode::InvalidOption); the others are those of the steps.
pub fn register_task(
    source_xyz: Vec<f64>,
    target_xyz: Vec<f64>,
    options: RegisterOptions,
    mut host: impl Host + 'static,
    clock: fn() -> f64,
) -> Result<Task<'static, Registration>> {
    options.validate()?;
    Ok(Task::new(Scheduler::new(clock, options.work_budget), |scheduler| async move {
        registered([&source_xyz, &target_xyz], &options, &mut host, &scheduler).await
    }))
}

/// Without a budget, the options bound the work, in units: RANSAC makes at most 18 poses, each from at most
/// `ransac_iterations` draws of 0.13 (0.0002 if their edges disagree). Descriptors are compared of at most 30 pairs of
/// grids, of at most 8000 voxels each, which takes 2200. Trees, normals, grids and agreements take at most 0.5 for each
/// point that is used.
fn registered<'a>(
    [source_xyz, target_xyz]: [&'a [f64]; 2],
    options: &'a RegisterOptions,
    host: &'a mut dyn Host,
    scheduler: &'a Scheduler,
) -> Boxed<'a, Result<Registration>> {
    boxed(async move {
        options.validate()?;
        let (source_xyz, skipped_source) = finite_points(source_xyz);
        scheduler.yield_after(PREPARED * source_xyz.len() as f64).await;
        let (target_xyz, skipped_target) = finite_points(target_xyz);
        scheduler.yield_after(PREPARED * target_xyz.len() as f64).await;
        let complete: [&[f64]; 2] = [&source_xyz, &target_xyz];
        for (argument, xyz) in ["source", "target"].into_iter().zip(complete) {
            check_cloud(argument, xyz, MIN_POINTS)?;
            scheduler.yield_after(PREPARED * xyz.len() as f64).await;
        }
        let [source_xyz, target_xyz] = complete;
        let mut stages = Stopwatch::new(host, PLAN);

        stages.enter(Stage::Sample);
        let mut random = Random::new(u64::from(options.seed), STREAM);
        let source_xyz = subsample(source_xyz, options.max_points as usize, &mut random);
        let target_xyz = subsample(target_xyz, options.max_points as usize, &mut random);
        let frames = NormalizedPair::of(&source_xyz, &target_xyz, options.scale)?;

        // With a known scale, correct matches preserve distances, which rigid registration uses. Otherwise, or if that
        // fails, clouds are registered by features. Clutter enlarges the boxes and disturbs the descriptors, so that the
        // dense points are tried first; but if the density varies by nature (lidar), they omit most of the scene, so that
        // all points are tried as well. The agreement of all points selects the result. Without a known scale, features
        // suffice for clouds that show the same surface; for others, matches vote for the scale.
        scheduler.yield_after(PREPARED * (source_xyz.len() + target_xyz.len()) as f64).await;
        let mut selector = PoseSelector::new(&source_xyz, &target_xyz, frames, options, scheduler).await;
        let is_fixed = matches!(options.scale, ScaleOption::Fixed(_));
        if is_fixed {
            let found = register_rigid(complete, options, &mut stages, scheduler).await;
            selector.prefer(found, scheduler).await;
        }
        let dense = dense(&source_xyz, &target_xyz, &selector.frames, scheduler).await;
        if let Some((source_xyz, target_xyz)) = &dense {
            selector.try_clouds(source_xyz, target_xyz, options, &mut stages, scheduler).await?;
        }
        if !selector.has_preferred() && (is_fixed || dense.is_none()) {
            selector.try_clouds(&source_xyz, &target_xyz, options, &mut stages, scheduler).await?;
        }
        if !is_fixed && !selector.is_mutual() && scheduler.may_continue(selector.has_pose()) {
            let found = register_free(complete, options, &mut stages, scheduler).await;
            selector.prefer(found, scheduler).await;
        }
        if !selector.has_pose() {
            selector.try_clouds(&source_xyz, &target_xyz, options, &mut stages, scheduler).await?;
        }
        let mut found = selector.finish(options, stages)?;
        found.diagnostics.skipped_source_points = skipped_source;
        found.diagnostics.skipped_target_points = skipped_target;
        Ok(found)
    })
}

/// The dense points of both clouds; `None` if they are too few, or almost all.
async fn dense(
    source_xyz: &[f64],
    target_xyz: &[f64],
    frames: &NormalizedPair,
    scheduler: &Scheduler,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let source = dense_points(&frames.source.normalized_flat(source_xyz).points, scheduler).await;
    let target = dense_points(&frames.target.normalized_flat(target_xyz).points, scheduler).await;
    let kept = |dense: &[usize], xyz: &[f64]| dense.len() as f64 / (xyz.len() / 3) as f64;
    let least = kept(&source, source_xyz).min(kept(&target, target_xyz));
    let enough = source.len().min(target.len()) >= MIN_POINTS;
    let pick = |dense: &[usize], xyz: &[f64]| dense.iter().flat_map(|i| &xyz[3 * i..3 * i + 3]).copied().collect();
    (enough && least < CLUTTERED).then(|| (pick(&source, source_xyz), pick(&target, target_xyz)))
}
