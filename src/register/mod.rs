//! General registration: two point clouds, without camera or mesh.

pub mod compatibility;
pub mod density;
mod estimate_sim3;
pub mod fpfh;
mod frames;
pub mod free_space;
pub mod global;
pub mod grid_cloud;
pub mod icp;
mod judge;
pub mod matching;
pub mod options;
pub mod ransac;
mod rigid;
pub mod support;
pub mod tukey;
pub mod umeyama;
mod verifier;

pub use estimate_sim3::estimate_sim3;

use nalgebra::Vector3;

use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::MIN_POINTS;
use crate::geometry::random::Random;
use crate::number::number;
use crate::options::Options;
use crate::options::scale::ScaleOption;
use crate::progress::{Host, Stage, Stopwatch};
use crate::register::density::dense_points;
use crate::report::Registration;
use frames::Frames;
use judge::Judge;
use options::RegisterOptions;
use rigid::register_rigid;

/// The random stream of the subsampling.
const STREAM: u64 = 5;

/// A cloud that keeps less than this share without its sparse points may be cluttered. Even samples keep more than
/// nine points in ten; to take one for cluttered costs nothing, for the right pose is found at once.
const CLUTTERED: f64 = 0.97;

/// When each stage begins, as a share of the whole.
pub(super) const PLAN: &[(Stage, f64)] = &[
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
    options: &RegisterOptions,
    host: &mut dyn Host,
) -> Result<Registration> {
    options.validate()?;
    check_cloud("source", source_xyz, MIN_POINTS)?;
    check_cloud("target", target_xyz, MIN_POINTS)?;
    let mut stages = Stopwatch::new(host, PLAN);

    stages.enter(Stage::Sample);
    let given = [source_xyz, target_xyz];
    let mut random = Random::new(u64::from(options.seed), STREAM);
    let source_xyz = subsample(source_xyz, options.max_points as usize, &mut random);
    let target_xyz = subsample(target_xyz, options.max_points as usize, &mut random);
    let whole = Frames::of(&source_xyz, &target_xyz, options.scale)?;

    // A known scale says which matches keep their distances. Otherwise, and where clutter defeats that:
    // clutter widens the boxes and drowns the descriptors; but where the density varies by nature (lidar),
    // dropping the sparse points drops the scene. So both are tried, and the points themselves decide.
    let mut judge = Judge::new(&source_xyz, &target_xyz, whole, options);
    if matches!(options.scale, ScaleOption::Fixed(_)) {
        judge.hold(register_rigid(given, options, &mut stages));
    }
    if let Some((source_xyz, target_xyz)) = dense(&source_xyz, &target_xyz, &judge.frames) {
        judge.attempt(&source_xyz, &target_xyz, options, &mut stages)?;
    }
    if !judge.holds() {
        judge.attempt(&source_xyz, &target_xyz, options, &mut stages)?;
    }
    judge.verdict(options, stages)
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

/// Whole points, finite, enough of them, and not all one.
pub(super) fn check_cloud(argument: &str, xyz: &[f64], min_points: usize) -> Result<()> {
    if !xyz.len().is_multiple_of(3) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            argument.to_owned(),
            format!("{} numbers", xyz.len()),
            "a multiple of 3",
            "Pass x, y, z per point, one point after the other.",
        ));
    }
    if let Some(i) = xyz.iter().position(|x| !x.is_finite()) {
        return Err(Error::new(
            ErrorCode::NonFinite,
            argument.to_owned(),
            format!("{} in point {}", number(xyz[i]), i / 3),
            "finite numbers",
            "Leave points without a reading out of the cloud.",
        ));
    }
    let count = xyz.len() / 3;
    if count < min_points {
        return Err(Error::new(
            ErrorCode::TooFewPoints,
            argument.to_owned(),
            format!("{count} points"),
            format!("at least {min_points}"),
            "A shape can't be told from so few points.",
        ));
    }
    let first = Vector3::from_column_slice(&xyz[..3]);
    if xyz.chunks_exact(3).all(|p| Vector3::from_column_slice(p) == first) {
        return Err(Error::new(
            ErrorCode::DegeneratePoints,
            argument.to_owned(),
            "the same point again and again",
            "points that span a plane at least",
            "Check how the cloud was made.",
        ));
    }
    Ok(())
}
