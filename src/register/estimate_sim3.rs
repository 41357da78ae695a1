//! Robust estimation of a similarity from given correspondences, for example those of a learned matcher (Predator,
//! GeoTransformer, BUFFER-X).

use super::input::{PREPARED, check_cloud};
use super::normalized_pair::{Fit, NormalizedPair};
use super::options::EstimateSim3Options;
use super::pose_selector::about_clouds;
use super::registration::PLAN;
use super::report::Registration;
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::Cloud;
use crate::geometry::similarity::{Similarity, vector3};
use crate::options::Options;
use crate::options::scale::ScaleOption;
use crate::progress::{Host, Stage, Stopwatch};
use crate::register::matching::Match;
use crate::register::ransac::{Consensus, Guard, GuardMode, RansacSettings, ransac, reweighted};
use crate::report::Counts;
use crate::scheduler::{Boxed, Scheduler, Task, boxed, finished};

/// Estimates the similarity that most correspondences agree with. Clouds are interleaved x, y, z; `correspondences` are
/// interleaved pairs of point indices, source then target.
///
/// # Errors
/// As [`register`](super::register), and [`ErrorCode::IndexOutOfRange`].
pub fn estimate_sim3(
    source_xyz: &[f64],
    target_xyz: &[f64],
    correspondences: &[u32],
    options: &EstimateSim3Options,
    host: &mut dyn Host,
) -> Result<Registration> {
    let scheduler = Scheduler::new(|| 0.0, options.work_budget);
    finished(estimated([source_xyz, target_xyz], correspondences, options, host, &scheduler))
}

/// [`estimate_sim3`] in steps, which end by this clock.
///
/// # Errors
/// [`ErrorCode::InvalidOption`]; the others are those of the steps.
pub fn estimate_sim3_task(
    source_xyz: Vec<f64>,
    target_xyz: Vec<f64>,
    correspondences: Vec<u32>,
    options: EstimateSim3Options,
    mut host: impl Host + 'static,
    clock: fn() -> f64,
) -> Result<Task<'static, Registration>> {
    options.validate()?;
    Ok(Task::new(Scheduler::new(clock, options.work_budget), |scheduler| async move {
        estimated([&source_xyz, &target_xyz], &correspondences, &options, &mut host, &scheduler).await
    }))
}

/// Without a budget, the options bound the work, in units: `ransac_iterations` draws of 0.13 (0.0002 if their edges
/// disagree), and 0.002 for each pair.
fn estimated<'a>(
    [source_xyz, target_xyz]: [&'a [f64]; 2],
    correspondences: &'a [u32],
    options: &'a EstimateSim3Options,
    host: &'a mut dyn Host,
    scheduler: &'a Scheduler,
) -> Boxed<'a, Result<Registration>> {
    boxed(async move {
        options.validate()?;
        for (argument, xyz) in [("source", source_xyz), ("target", target_xyz)] {
            check_cloud(argument, xyz, 3)?;
            scheduler.yield_after(PREPARED * xyz.len() as f64).await;
        }
        let matches = check_correspondences(correspondences, source_xyz.len() / 3, target_xyz.len() / 3)?;
        scheduler.yield_after(PREPARED * correspondences.len() as f64).await;
        let mut stages = Stopwatch::new(host, PLAN);
        stages.enter(Stage::Ransac);
        let problem = Problem::new(source_xyz, target_xyz, matches, options)?;
        scheduler.yield_after(PREPARED * (source_xyz.len() + target_xyz.len()) as f64).await;
        let Problem { source, target, matches, settings, .. } = &problem;
        let consensus = ransac(&source.points, &target.points, matches, settings, scheduler)
            .await
            .map_err(|e| about_clouds(e, "correspondences"))?;
        scheduler.yield_after(PREPARED * consensus.inliers.len() as f64).await;
        let unit = reweighted(&source.points, &target.points, matches, &consensus, settings, scheduler).await;
        scheduler.yield_after(PREPARED * consensus.inliers.len() as f64).await;
        Ok(problem.solved(consensus, &unit, options.seed, stages))
    })
}

/// Clouds and matches in their normalised frames.
struct Problem {
    frames: NormalizedPair,
    source: Cloud,
    target: Cloud,
    matches: Vec<Match>,
    settings: RansacSettings,
}

impl Problem {
    #[inline(never)]
    fn new(source_xyz: &[f64], target_xyz: &[f64], matches: Vec<Match>, options: &EstimateSim3Options) -> Result<Self> {
        let frames = NormalizedPair::of(source_xyz, target_xyz, options.scale)?;
        let source = frames.source.normalized_flat(source_xyz);
        let target = frames.target.normalized_flat(target_xyz);
        let distance = options.inlier_distance.map_or(0.05, |d| d / frames.target.diagonal());
        let settings = RansacSettings {
            inlier_distance: distance,
            edge_similarity: options.edge_similarity,
            max_iterations: options.ransac_iterations as usize,
            confidence: options.ransac_confidence,
            scale_mode: frames.scale_mode,
            // Correspondences determine the scale better than the boxes, so that only bounds of the caller apply.
            guard: match options.scale {
                ScaleOption::Free => None,
                _ => frames.guard.map(|[min, max]| Guard { min, max, mode: GuardMode::Reject }),
            },
            seed: u64::from(options.seed),
        };
        Ok(Self { frames, source, target, matches, settings })
    }

    /// The result for the transform that a consensus agrees with.
    #[inline(never)]
    fn solved(&self, consensus: Consensus, unit: &Similarity, seed: u32, stages: Stopwatch<'_>) -> Registration {
        let Self { frames, source, target, matches, .. } = self;
        let squares: f64 = consensus
            .inliers
            .iter()
            .map(|&i| {
                let (p, q) = (source.points[matches[i].source as usize], target.points[matches[i].target as usize]);
                (unit.apply(vector3(p)) - vector3(q)).norm_squared()
            })
            .sum();
        let counts = Counts { source_points: source.len(), target_points: target.len(), ..consensus.counts };
        let count = consensus.inliers.len() as f64;
        let fit = Fit {
            fitness: count / matches.len() as f64,
            residual: (squares / count).sqrt() * frames.target.diagonal(),
            converged: true,
            counts,
        };
        frames.registration(&frames.denormalized(unit), fit, seed, stages)
    }
}

fn check_correspondences(correspondences: &[u32], sources: usize, targets: usize) -> Result<Vec<Match>> {
    if !correspondences.len().is_multiple_of(2) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            "correspondences",
            format!("{} indices", correspondences.len()),
            "an even number: source, target, source, target, …",
            "Pass the pairs as one flat array.",
        ));
    }
    if correspondences.len() < 6 {
        return Err(Error::new(
            ErrorCode::TooFewPoints,
            "correspondences",
            format!("{} pairs", correspondences.len() / 2),
            "at least 3",
            "Three pairs that are not on one line determine a similarity.",
        ));
    }
    let matches = correspondences.chunks_exact(2).map(|pair| Match { source: pair[0], target: pair[1] });
    for (i, m) in matches.clone().enumerate() {
        if m.source as usize >= sources || m.target as usize >= targets {
            return Err(Error::new(
                ErrorCode::IndexOutOfRange,
                "correspondences",
                format!("({}, {}) as pair {i}", m.source, m.target),
                format!("source indices below {sources} and target indices below {targets}"),
                "Indices refer to points, not numbers, and start at 0.",
            ));
        }
    }
    Ok(matches.collect())
}
