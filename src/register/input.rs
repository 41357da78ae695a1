//! Validates clouds, and subsamples them.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::random::Random;
use crate::number::number;

/// Units of work of a number that is checked, selected or converted.
pub(super) const PREPARED: f64 = 1e-5;

/// Checks for complete, finite, sufficiently many and non-coincident points (interleaved x, y, z).
pub(super) fn check_cloud(argument: &str, xyz: &[f64], min_points: usize) -> Result<()> {
    if !xyz.len().is_multiple_of(3) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            argument.to_owned(),
            format!("{} numbers", xyz.len()),
            "a multiple of 3",
            "Pass interleaved x, y, z.",
        ));
    }
    if let Some(i) = xyz.iter().position(|x| !x.is_finite()) {
        return Err(Error::new(
            ErrorCode::NonFinite,
            argument.to_owned(),
            format!("{} in point {}", number(xyz[i]), i / 3),
            "finite numbers",
            "Remove points without a reading from the cloud.",
        ));
    }
    let count = xyz.len() / 3;
    if count < min_points {
        return Err(Error::new(
            ErrorCode::TooFewPoints,
            argument.to_owned(),
            format!("{count} points"),
            format!("at least {min_points}"),
            "Too few points to determine a shape.",
        ));
    }
    let first = Vector3::from_column_slice(&xyz[..3]);
    if xyz.chunks_exact(3).all(|p| Vector3::from_column_slice(p) == first) {
        return Err(Error::new(
            ErrorCode::DegeneratePoints,
            argument.to_owned(),
            "identical points",
            "points that span at least a plane",
            "Check the source of the cloud.",
        ));
    }
    Ok(())
}

/// The points without NaN and infinite coordinates, which organised clouds have at pixels without a reading, and how
/// many were skipped.
pub(super) fn finite_points(xyz: &[f64]) -> (Cow<'_, [f64]>, usize) {
    let is_finite = |point: &&[f64]| point.iter().all(|x| x.is_finite());
    let points = || xyz.chunks_exact(3);
    let skipped = points().len() - points().filter(is_finite).count();
    // A broken triple is left to the check of the length.
    if skipped == 0 || !xyz.len().is_multiple_of(3) {
        return (Cow::Borrowed(xyz), 0);
    }
    (points().filter(is_finite).flatten().copied().collect(), skipped)
}

/// At most `max_points` points, one drawn from each of `max_points` equal intervals.
pub(super) fn subsample(xyz: &[f64], max_points: usize, random: &mut Random) -> Vec<f64> {
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
