//! Registration where the scale is known: scenes that were scanned in part, at low overlap, with repeated structure.
//!
//! The voxel follows from the number of points; poses come from matches that keep their distances; both scenes as a
//! whole choose among them, and what their sensors saw to be empty.

use super::frames::Frames;
use super::global::{Estimate, Settings, Side, refine_coarse_to_fine};
use super::judge::{Attempt, about_clouds, with_normals};
use super::options::RegisterOptions;
use super::verifier::{Verifier, distinctiveness};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::extents::target_from_source;
use crate::geometry::cloud::Cloud;
use crate::geometry::similarity::{Similarity, vec3};
use crate::geometry::voxel_grid::{voxel_downsample, voxel_size_leaving};
use crate::progress::{Stage, Stopwatch};
use crate::register::compatibility::{Hypothesis, hypotheses};
use crate::register::fpfh::fpfh;
use crate::register::free_space::FreeSpace;
use crate::register::icp::{IcpSettings, movement, refine};
use crate::register::matching::best_matches;
use crate::report::Counts;

/// Voxels of the larger cloud, at most, where the caller gives no voxel size: a scene's furniture, and seconds.
const VOXELS: usize = 5_000;

/// Matches at most: the mutual ones, and one-way ones where these are fewer.
const MATCHES: usize = 3_000;

/// Poses made of matches, and those of them that are refined.
const HYPOTHESES: usize = 100;
const REFINED: usize = 5;

/// Iterations of their refinement; a right one is near by then.
const ITERATIONS: usize = 15;

/// How far off the points behind free space may be, in voxels.
const FREE_SLACK_VOXELS: f32 = 2.0;

/// Aligns clouds whose scale is known, in frames that make it 1.
pub(super) fn register_rigid(
    [source_xyz, target_xyz]: [&[f64]; 2],
    options: &RegisterOptions,
    stages: &mut Stopwatch<'_>,
) -> Result<Attempt> {
    let frames = Frames::of(source_xyz, target_xyz, options.scale)?;
    let most = options.max_points as usize;
    let source = thin(frames.source.normalized_flat(source_xyz), most);
    let target = thin(frames.target.normalized_flat(target_xyz), most);
    let given = options.voxel_size.map(|size| size / frames.target.diagonal());
    let voxel_size = match given.or(options.voxel_divisions.map(|divisions| 1.0 / divisions)) {
        Some(size) => size as f32,
        None => voxel_size_leaving(&source, VOXELS).max(voxel_size_leaving(&target, VOXELS)),
    };
    let settings = Settings::of_register(options, f64::from(voxel_size), frames.scale_mode, frames.guard);

    stages.enter(Stage::Normals);
    // Scans come in their sensor's frame more often than not; the points themselves tell.
    let [source_eye, target_eye] = [&frames.source, &frames.target].map(|f| vec3(&f.unit_from_own().translation));
    let slack = FREE_SLACK_VOXELS * voxel_size;
    let source_free = FreeSpace::seen_from(source_eye, &source.points, slack);
    let target_free = FreeSpace::seen_from(target_eye, &target.points, slack);
    let source = with_normals(source, source_free.as_ref().map(|_| source_eye));
    let target = with_normals(target, target_free.as_ref().map(|_| target_eye));
    let (source, target) = (Side::new(&source, voxel_size), Side::new(&target, voxel_size));

    stages.enter(Stage::Features);
    let radius = settings.fpfh_radius_voxels * voxel_size;
    let source_features = fpfh(&source.voxels, &source.tree, radius);
    let target_features = fpfh(&target.voxels, &target.tree, radius);

    stages.enter(Stage::Matching);
    let matches = best_matches(&source_features, &target_features, MATCHES);

    stages.enter(Stage::Ransac);
    let distance = settings.ransac.inlier_distance as f32;
    let most = HYPOTHESES.min(settings.ransac.max_iterations);
    let found = hypotheses(&source.voxels.points, &target.voxels.points, &matches, distance, most);
    let iterations = found.len();

    stages.enter(Stage::Filter);
    let verifier = Verifier {
        source: &source,
        target: &target,
        weights: [distinctiveness(&source_features), distinctiveness(&target_features)],
        free: [source_free, target_free],
        distance,
    };
    let candidates = most_different(&verifier, found);

    stages.enter(Stage::Icp);
    let mut best: Option<(f64, Similarity, Vec<usize>)> = None;
    for hypothesis in candidates {
        let pose = settle(&source, &target, &hypothesis.target_from_source, &settings);
        let score = verifier.score(&pose);
        if best.as_ref().is_none_or(|(highest, ..)| score > *highest) {
            best = Some((score, pose, hypothesis.inliers));
        }
    }
    let Some((_, pose, inliers)) = best else { return Err(no_consensus(matches.len())) };
    let refined = refine_coarse_to_fine(&source, &target, &pose, &settings);
    let counts = Counts {
        source_points: source.full.len(),
        target_points: target.full.len(),
        source_voxels: source.voxels.len(),
        target_voxels: target.voxels.len(),
        matches: matches.len(),
        inliers: inliers.len(),
        supported: refined.supported,
        iterations,
        icp_iterations: refined.iterations,
        ..Counts::default()
    };
    let unit = refined.target_from_source;
    Ok(Attempt {
        target_from_source: target_from_source(&frames.target, &unit, &frames.source),
        residual: refined.rms * frames.target.diagonal(),
        estimate: Estimate {
            target_from_source: unit,
            clamped: false,
            converged: refined.converged,
            rms: refined.rms,
            counts,
            inliers,
        },
    })
}

/// At most so many points: the means of voxels as small as that allows.
fn thin(cloud: Cloud, most: usize) -> Cloud {
    if cloud.len() <= most { cloud } else { voxel_downsample(&cloud, voxel_size_leaving(&cloud, most)) }
}

/// The best poses of which no two are nearly the same, best first.
fn most_different(verifier: &Verifier<'_>, mut found: Vec<Hypothesis>) -> Vec<Hypothesis> {
    let mut scores: Vec<f64> = found.iter().map(|hypothesis| verifier.score(&hypothesis.target_from_source)).collect();
    let mut chosen: Vec<Hypothesis> = Vec::new();
    while chosen.len() < REFINED {
        let highest = (0..scores.len()).reduce(|best, i| if scores[i] > scores[best] { i } else { best });
        let Some(highest) = highest else { break };
        scores.swap_remove(highest);
        let hypothesis = found.swap_remove(highest);
        let pose = &hypothesis.target_from_source;
        let is_new =
            |other: &Hypothesis| movement(&other.target_from_source, pose) > f64::from(2.0 * verifier.distance);
        if chosen.iter().all(is_new) {
            chosen.push(hypothesis);
        }
    }
    chosen
}

/// A few iterations of ICP on the voxel grid.
fn settle(source: &Side<'_>, target: &Side<'_>, pose: &Similarity, settings: &Settings) -> Similarity {
    let Some(metric) = settings.icp else { return *pose };
    let settings = IcpSettings {
        robust: true,
        metric,
        lock_scale: true,
        scale_bounds: None,
        max_iterations: ITERATIONS.min(settings.icp_iterations),
        support: settings.support,
        final_distance: settings.support.max_distance / 3.0,
        tolerance: 1e-4,
    };
    refine(&source.voxels, &target.voxels, &target.tree, pose, &settings).target_from_source
}

fn no_consensus(matches: usize) -> Error {
    let found = format!("{matches} matches, no three of which keep their distances");
    about_clouds(Error::new(ErrorCode::NoConsensus, "source", found, "", ""), "source")
}
