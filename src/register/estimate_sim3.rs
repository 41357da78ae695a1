//! A similarity from correspondences that were made elsewhere (Predator, GeoTransformer, BUFFER-X, …).

use super::frames::{Fit, Frames};
use super::judge::about_clouds;
use super::options::EstimateSim3Options;
use super::{PLAN, check_cloud};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::extents::target_from_source;
use crate::geometry::similarity::vector3;
use crate::options::Options;
use crate::options::scale::ScaleOption;
use crate::progress::{Host, Stage, Stopwatch};
use crate::register::matching::Match;
use crate::register::ransac::{Guard, GuardMode, RansacSettings, ransac, reweighted};
use crate::report::{Counts, Registration};

/// The similarity that most correspondences agree with; `correspondences` are pairs of indices, source then
/// target, made by any matcher.
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
    options.validate()?;
    check_cloud("source", source_xyz, 3)?;
    check_cloud("target", target_xyz, 3)?;
    let matches = check_correspondences(correspondences, source_xyz.len() / 3, target_xyz.len() / 3)?;
    let mut stages = Stopwatch::new(host, PLAN);
    stages.enter(Stage::Ransac);
    let frames = Frames::of(source_xyz, target_xyz, options.scale)?;
    let source = frames.source.normalized_flat(source_xyz);
    let target = frames.target.normalized_flat(target_xyz);
    let distance = options.inlier_distance.map_or(0.05, |d| d / frames.target.diagonal());
    let settings = RansacSettings {
        inlier_distance: distance,
        edge_similarity: options.edge_similarity,
        max_iterations: options.ransac_iterations as usize,
        confidence: options.ransac_confidence,
        scale_mode: frames.scale_mode,
        // Correspondences say more about the scale than boxes do: only bounds that the caller gave are held.
        guard: match options.scale {
            ScaleOption::Free => None,
            _ => frames.guard.map(|[min, max]| Guard { min, max, mode: GuardMode::Reject }),
        },
        seed: u64::from(options.seed),
    };
    let consensus =
        ransac(&source.points, &target.points, &matches, &settings).map_err(|e| about_clouds(e, "correspondences"))?;
    let unit = reweighted(&source.points, &target.points, &matches, &consensus, &settings);
    let squares: f64 = consensus
        .inliers
        .iter()
        .map(|&i| {
            let (p, q) = (source.points[matches[i].source as usize], target.points[matches[i].target as usize]);
            (unit.apply(vector3(p)) - vector3(q)).norm_squared()
        })
        .sum();
    let counts = Counts {
        source_points: source.len(),
        target_points: target.len(),
        matches: matches.len(),
        inliers: consensus.inliers.len(),
        iterations: consensus.counts.iterations,
        inconsistent: consensus.counts.inconsistent,
        rejected: consensus.counts.rejected,
        clamped: consensus.counts.clamped,
        ..Counts::default()
    };
    let count = consensus.inliers.len() as f64;
    let fit = Fit {
        fitness: count / matches.len() as f64,
        residual: (squares / count).sqrt() * frames.target.diagonal(),
        converged: true,
        counts,
    };
    let transform = target_from_source(&frames.target, &unit, &frames.source);
    Ok(frames.registration(&transform, fit, options.seed, stages))
}

fn check_correspondences(correspondences: &[u32], sources: usize, targets: usize) -> Result<Vec<Match>> {
    if !correspondences.len().is_multiple_of(2) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            "correspondences",
            format!("{} indices", correspondences.len()),
            "an even number: source, target, source, target, …",
            "Flatten the pairs row by row.",
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
                "Indices count points, not numbers, and start at 0.",
            ));
        }
    }
    Ok(matches.collect())
}
