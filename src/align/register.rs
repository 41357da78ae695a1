//! General registration: two point clouds, or correspondences made elsewhere, without camera or mesh.

use nalgebra::Vector3;

use super::estimate::{NORMAL_NEIGHBORS, Settings, estimate};
use super::field::Options;
use super::options::{EstimateOptions, RegisterOptions, ScaleOption};
use super::progress::{Host, Stage, Stopwatch};
use super::report::{Counts, Registration};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::order;
use crate::geometry::random::Random;
use crate::geometry::similarity::{Similarity, vector3};
use crate::number::number;
use crate::stages::extents::{Extents, initial_scale, target_from_source};
use crate::stages::matching::Match;
use crate::stages::normals::{Neighborhood, Orientation, estimate_normals};
use crate::stages::observe::MIN_POINTS;
use crate::stages::ransac::{Guard, GuardMode, RansacSettings, ransac};
use crate::stages::umeyama::ScaleMode;

/// The random stream of the subsampling.
const STREAM: u64 = 5;

/// How far a free scale may be from the ratio of the boxes. Wide: clutter widens a box at will.
const FREE_GUARD: [f64; 2] = [0.2, 5.0];

/// When each stage begins, as a share of the whole.
const PLAN: &[(Stage, f64)] = &[
    (Stage::Sample, 0.0),
    (Stage::Normals, 0.05),
    (Stage::Features, 0.3),
    (Stage::Matching, 0.4),
    (Stage::Ransac, 0.6),
    (Stage::Filter, 0.8),
    (Stage::Icp, 0.8),
];

/// Aligns a source cloud to a target cloud, both x, y, z one after the other in any unit.
///
/// # Errors
/// [`ErrorCode::WrongLength`], [`ErrorCode::NonFinite`], [`ErrorCode::TooFewPoints`],
/// [`ErrorCode::DegeneratePoints`], [`ErrorCode::InvalidOption`], [`ErrorCode::NoConsensus`].
pub fn register(
    source_xyz: &[f64],
    target_xyz: &[f64],
    scale: ScaleOption,
    options: &RegisterOptions,
    host: &mut dyn Host,
) -> Result<Registration> {
    options.validate()?;
    scale.validate()?;
    check_cloud("source", source_xyz, MIN_POINTS)?;
    check_cloud("target", target_xyz, MIN_POINTS)?;
    let mut stages = Stopwatch::new(host, PLAN);

    stages.enter(Stage::Sample);
    let mut random = Random::new(u64::from(options.seed), STREAM);
    let source_xyz = subsample(source_xyz, options.max_points as usize, &mut random);
    let target_xyz = subsample(target_xyz, options.max_points as usize, &mut random);
    let frames = Frames::of(&source_xyz, &target_xyz, scale)?;

    stages.enter(Stage::Normals);
    let source = with_normals(frames.source.normalized_flat(&source_xyz));
    let target = with_normals(frames.target.normalized_flat(&target_xyz));

    let voxel_size = options.voxel_size.map_or(1.0 / options.voxel_divisions, |size| size / frames.target.diagonal());
    let settings = Settings::of_register(options, voxel_size, frames.scale_mode, frames.guard);
    let estimated = estimate(&source, &target, &settings, &mut stages).map_err(|e| about_clouds(e, "source"))?;
    let unit = estimated.target_from_source;
    let fitness = fitness(&source, &target, &unit, settings.ransac.inlier_distance);
    Ok(Registration {
        residual: estimated.rms * frames.target.diagonal(),
        converged: estimated.converged,
        fitness,
        ..frames.registration(&unit, options.seed, estimated.counts, stages)
    })
}

/// The similarity that most correspondences agree with; `correspondences` are pairs of indices, source then
/// target, made by any matcher.
///
/// # Errors
/// As [`register`], and [`ErrorCode::IndexOutOfRange`].
pub fn estimate_sim3(
    source_xyz: &[f64],
    target_xyz: &[f64],
    correspondences: &[u32],
    scale: ScaleOption,
    options: &EstimateOptions,
    host: &mut dyn Host,
) -> Result<Registration> {
    options.validate()?;
    scale.validate()?;
    check_cloud("source", source_xyz, 3)?;
    check_cloud("target", target_xyz, 3)?;
    let matches = check_correspondences(correspondences, source_xyz.len() / 3, target_xyz.len() / 3)?;
    let mut stages = Stopwatch::new(host, PLAN);
    stages.enter(Stage::Ransac);
    let frames = Frames::of(source_xyz, target_xyz, scale)?;
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
        guard: match scale {
            ScaleOption::Free => None,
            _ => frames.guard.map(|[min, max]| Guard { min, max, mode: GuardMode::Reject }),
        },
        seed: u64::from(options.seed),
    };
    let consensus = ransac(&source.points, &target.points, &matches, &settings)
        .map_err(|e| about_clouds(e, "correspondences"))?;
    let unit = consensus.target_from_source;
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
    Ok(Registration {
        residual: (squares / count).sqrt() * frames.target.diagonal(),
        fitness: count / matches.len() as f64,
        ..frames.registration(&unit, options.seed, counts, stages)
    })
}

/// The normalised frames of both clouds, and what is known of the scale between them.
struct Frames {
    source: Extents,
    target: Extents,
    scale_mode: ScaleMode,
    guard: Option<[f64; 2]>,
}

impl Frames {
    /// The frames in which the initial scale is 1: the ratio of the boxes, or what the caller knows.
    fn of(source_xyz: &[f64], target_xyz: &[f64], scale: ScaleOption) -> Result<Self> {
        let (source, target) = (Extents::of_flat("source", source_xyz)?, Extents::of_flat("target", target_xyz)?);
        let ratio = initial_scale(&target, &source);
        Ok(match scale {
            ScaleOption::Free => Self { source, target, scale_mode: ScaleMode::Free, guard: Some(FREE_GUARD) },
            ScaleOption::Fixed(fixed) => Self {
                source: source.with_diagonal(target.diagonal() / fixed),
                target,
                scale_mode: ScaleMode::Fixed(1.0),
                guard: None,
            },
            ScaleOption::Between([min, max]) => {
                let initial = ratio.max(min).min(max);
                Self {
                    source: source.with_diagonal(target.diagonal() / initial),
                    target,
                    scale_mode: ScaleMode::Free,
                    guard: Some([min / initial, max / initial]),
                }
            }
        })
    }

    /// The report of a transform between the frames; the residual is the caller's to add.
    fn registration(&self, unit: &Similarity, seed: u32, counts: Counts, stages: Stopwatch<'_>) -> Registration {
        let transform = target_from_source(&self.target, unit, &self.source);
        let initial_scale = initial_scale(&self.target, &self.source);
        Registration {
            target_from_source: (&transform).into(),
            seed,
            initial_scale,
            scale_ratio: transform.scale / initial_scale,
            converged: true,
            residual: 0.0,
            fitness: 0.0,
            counts,
            timings_ms: stages.finish(),
        }
    }
}

/// Normals that point away from the middle of the cloud: the median, which clutter moves least. Without a
/// viewpoint that is the orientation that both clouds can agree on.
fn with_normals(mut cloud: Cloud) -> Cloud {
    let median = |axis: usize| order::median(cloud.points.iter().map(|p| p[axis])).unwrap_or_default();
    let center = glam::Vec3::new(median(0), median(1), median(2));
    let tree = KdTree::new(&cloud.points);
    cloud.normals =
        estimate_normals(&cloud.points, &tree, Neighborhood::nearest(NORMAL_NEIGHBORS), Orientation::AwayFrom(center));
    cloud
}

/// Share of the source points that land within `distance` of a target point.
fn fitness(source: &Cloud, target: &Cloud, unit: &Similarity, distance: f64) -> f64 {
    let tree = KdTree::new(&target.points);
    let transform = unit.to_f32();
    let near = source.points.iter().filter(|&&p| tree.nearest_within(transform.apply(p), distance as f32).is_some());
    near.count() as f64 / source.len() as f64
}

/// At most `max_points` points, one drawn from each of as many equal runs.
fn subsample(xyz: &[f64], max_points: usize, random: &mut Random) -> Vec<f64> {
    let n = xyz.len() / 3;
    if n <= max_points {
        return xyz.to_vec();
    }
    let mut drawn = Vec::with_capacity(3 * max_points);
    for i in random.one_of_each_run(n, max_points) {
        drawn.extend_from_slice(&xyz[3 * i..3 * i + 3]);
    }
    drawn
}

fn check_cloud(argument: &str, xyz: &[f64], min_points: usize) -> Result<()> {
    if !xyz.len().is_multiple_of(3) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            argument,
            format!("{} numbers", xyz.len()),
            "a multiple of 3",
            "Pass x, y, z per point, one point after the other.",
        ));
    }
    if let Some(i) = xyz.iter().position(|x| !x.is_finite()) {
        return Err(Error::new(
            ErrorCode::NonFinite,
            argument,
            format!("{} in point {}", number(xyz[i]), i / 3),
            "finite numbers",
            "Leave points without a reading out of the cloud.",
        ));
    }
    let count = xyz.len() / 3;
    if count < min_points {
        return Err(Error::new(
            ErrorCode::TooFewPoints,
            argument,
            format!("{count} points"),
            format!("at least {min_points}"),
            "A shape can't be told from so few points.",
        ));
    }
    let first = Vector3::from_column_slice(&xyz[..3]);
    if xyz.chunks_exact(3).all(|p| Vector3::from_column_slice(p) == first) {
        return Err(Error::new(
            ErrorCode::DegeneratePoints,
            argument,
            "the same point again and again",
            "points that span a plane at least",
            "Check how the cloud was made.",
        ));
    }
    Ok(())
}

/// RANSAC speaks of a mesh and its observation; here they are two clouds.
fn about_clouds(error: Error, argument: &str) -> Error {
    if error.code != ErrorCode::NoConsensus {
        return error;
    }
    Error {
        expected: "at least three matches of source and target that agree on one similarity".into(),
        remedy: "Check that the clouds overlap; widen options.scale, or the distance up to which a match is an inlier."
            .into(),
        ..error.about(argument)
    }
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
