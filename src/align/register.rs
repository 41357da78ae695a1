//! General registration: two point clouds, or correspondences made elsewhere, without camera or mesh.

use nalgebra::Vector3;

use super::estimate::{Estimate, NORMAL_NEIGHBORS, Problem, Settings};
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
use crate::stages::density::dense_points;
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

/// Without its sparse points a cloud of less than this share counts as cluttered. Uniform samples keep 99 %.
const CLUTTERED: f64 = 0.97;

/// Poses tried for one pair of clouds at most.
const POSES: usize = 6;

/// Agreement at which no further pose is tried: nine points in ten all but coincide.
const BEYOND_DOUBT: f64 = 0.9;

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
    let whole = Frames::of(&source_xyz, &target_xyz, scale)?;

    // Clutter widens the boxes and drowns the descriptors; but where the density varies by nature (lidar),
    // dropping the sparse points drops the scene. So both are tried, and the points themselves decide.
    let mut judge = Judge::new(&source_xyz, &target_xyz, whole, options);
    if let Some((source_xyz, target_xyz)) = dense(&source_xyz, &target_xyz, &judge.frames) {
        judge.attempt(&source_xyz, &target_xyz, scale, options, &mut stages)?;
    }
    judge.attempt(&source_xyz, &target_xyz, scale, options, &mut stages)?;
    judge.verdict(options, stages)
}

/// Tries clouds and poses, and keeps the transform under which the whole clouds agree best.
struct Judge {
    frames: Frames,
    source: Cloud,
    target: KdTree,
    inlier_distance: f32,
    best: Option<(Agreement, Attempt)>,
    failure: Option<Error>,
}

impl Judge {
    fn new(source_xyz: &[f64], target_xyz: &[f64], frames: Frames, options: &RegisterOptions) -> Self {
        Self {
            source: frames.source.normalized_flat(source_xyz),
            target: KdTree::new(&frames.target.normalized_flat(target_xyz).points),
            inlier_distance: (options.inlier_distance_voxels * unit_voxel_size(options, &frames)) as f32,
            frames,
            best: None,
            failure: None,
        }
    }

    /// Solves for these clouds pose after pose until the agreement is beyond doubt.
    fn attempt(
        &mut self,
        source_xyz: &[f64],
        target_xyz: &[f64],
        scale: ScaleOption,
        options: &RegisterOptions,
        stages: &mut Stopwatch<'_>,
    ) -> Result<()> {
        let frames = Frames::of(source_xyz, target_xyz, scale)?;
        stages.enter(Stage::Normals);
        let source = with_normals(frames.source.normalized_flat(source_xyz));
        let target = with_normals(frames.target.normalized_flat(target_xyz));
        let settings =
            Settings::of_register(options, unit_voxel_size(options, &frames), frames.scale_mode, frames.guard);
        let mut problem = Problem::new(&source, &target, &settings, stages);
        for _ in 0..POSES {
            if self.best.as_ref().is_some_and(|(agreement, _)| agreement.score >= BEYOND_DOUBT) {
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
                    self.failure.get_or_insert(error);
                    break;
                }
            }
        }
        Ok(())
    }

    fn consider(&mut self, attempt: Attempt) {
        let unit = self.frames.unit(&attempt.target_from_source);
        let agreement = Agreement::of(&self.source, &self.target, &unit, self.inlier_distance);
        if self.best.as_ref().is_none_or(|(best, _)| agreement.score > best.score) {
            self.best = Some((agreement, attempt));
        }
    }

    fn verdict(self, options: &RegisterOptions, stages: Stopwatch<'_>) -> Result<Registration> {
        let Some((agreement, attempt)) = self.best else {
            return Err(self.failure.unwrap_or_else(no_attempt));
        };
        Ok(Registration {
            residual: attempt.residual,
            converged: attempt.estimate.converged,
            fitness: agreement.fitness,
            ..self.frames.registration(&attempt.target_from_source, options.seed, attempt.estimate.counts, stages)
        })
    }
}

/// A transform between the clouds' own frames, and how it came about.
struct Attempt {
    target_from_source: Similarity,
    estimate: Estimate,
    /// In target units.
    residual: f64,
}

/// The voxel size where the target's diagonal is 1.
fn unit_voxel_size(options: &RegisterOptions, frames: &Frames) -> f64 {
    options.voxel_size.map_or(1.0 / options.voxel_divisions, |size| size / frames.target.diagonal())
}

/// Both clouds without their sparse points; `None` where that is next to nothing, or almost everything.
fn dense(source_xyz: &[f64], target_xyz: &[f64], frames: &Frames) -> Option<(Vec<f64>, Vec<f64>)> {
    let source = dense_points(&frames.source.normalized_flat(source_xyz).points);
    let target = dense_points(&frames.target.normalized_flat(target_xyz).points);
    let kept = |dense: &[usize], xyz: &[f64]| dense.len() as f64 / (xyz.len() / 3) as f64;
    let least = kept(&source, source_xyz).min(kept(&target, target_xyz));
    let enough = source.len().min(target.len()) >= MIN_POINTS;
    let pick = |dense: &[usize], xyz: &[f64]| dense.iter().flat_map(|i| &xyz[3 * i..3 * i + 3]).copied().collect();
    (enough && least < CLUTTERED).then(|| (pick(&source, source_xyz), pick(&target, target_xyz)))
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
    let consensus = ransac(&source.points, &target.points, &matches, &settings)?;
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
        ..frames.registration(&target_from_source(&frames.target, &unit, &frames.source), options.seed, counts, stages)
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

    /// A transform between the clouds' own frames, taken to the normalised ones.
    fn unit(&self, target_from_source: &Similarity) -> Similarity {
        let own_from_unit = self.source.unit_from_own().inverse();
        self.target.unit_from_own().compose(target_from_source).compose(&own_from_unit)
    }

    /// The report of a transform between the clouds' own frames; residual and fitness are the caller's to add.
    fn registration(&self, transform: &Similarity, seed: u32, counts: Counts, stages: Stopwatch<'_>) -> Registration {
        let initial_scale = initial_scale(&self.target, &self.source);
        Registration {
            target_from_source: transform.into(),
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

fn no_attempt() -> Error {
    Error::new(ErrorCode::Internal, "source", "no attempt", "at least one", "Please report this with the two clouds.")
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
