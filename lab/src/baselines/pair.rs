//! Registration of two clouds of the same scale, such as scans of a room or a street, by the methods for comparison.

use super::baseline::Baseline;
use super::clouds::{Clouds, Settings};
use crate::prelude::*;
use sim3align::evidence::extents::{Extents, target_from_source};
use sim3align::evidence::normals::outward_normals;
use sim3align::evidence::observation::MIN_POINTS;
use sim3align::pauses::{Pauses, finished};
use sim3align::register::at_once::grid_cloud;
use sim3align_geometry::number::number;

/// Neighbours for normal estimation, for clouds without normals.
const NORMAL_NEIGHBORS: usize = 30;

/// Estimates the rigid transform from source to target, on voxels of this edge. Local methods start at the identity; up
/// is z in both clouds.
///
/// Normals of the clouds are used if present (for scans, they point to the scanner). Otherwise they are estimated, and
/// point away from the centre of each cloud.
///
/// # Errors
/// [`ErrorCode::TooFewPoints`], [`ErrorCode::NonFinite`], [`ErrorCode::DegeneratePoints`],
/// [`ErrorCode::InvalidOption`] for a voxel size that is not above 0, [`ErrorCode::NoConsensus`].
pub fn register_pair(
    source: &Cloud,
    target: &Cloud,
    baseline: Baseline,
    voxel_size: f64,
    paper: &PaperOptions,
) -> Result<Similarity> {
    if !(voxel_size.is_finite() && voxel_size > 0.0) {
        let remedy = "Pass it in the unit of the points.";
        let found = number(voxel_size);
        return Err(Error::new(ErrorCode::InvalidOption, "options.voxelSize", found, "a number above 0", remedy));
    }
    check("source", source)?;
    check("target", target)?;
    // A common frame, so that the relative pose of the clouds is preserved.
    let frame = Extents::of("target", &target.points)?;
    let voxel_size = voxel_size / frame.diagonal();
    let grid = |argument: &str, cloud: &Cloud| {
        let mut cloud = frame.normalized(cloud);
        if cloud.normals.len() != cloud.len() {
            cloud.normals = finished(outward_normals(&cloud.points, None, NORMAL_NEIGHBORS, &Pauses::none()));
        }
        let grid = grid_cloud(usize::MAX, &cloud, voxel_size as f32);
        enough(argument, grid.cloud.len(), "voxels").map(|()| grid)
    };
    let clouds = Clouds { source: grid("source", source)?, target: grid("target", target)? };
    let settings = Settings { paper, voxel_size, estimates_scale: false, is_upright: true };
    let matches = if baseline.is_local() { Vec::new() } else { clouds.matches(&settings) };
    let found = clouds.solve(baseline, &matches, &settings)?.target_from_source;
    let own = target_from_source(&frame, &found, &frame);
    // The product of the scale of the frame and its inverse may round.
    Ok(Similarity { scale: 1.0, ..own })
}

fn check(argument: &str, cloud: &Cloud) -> Result<()> {
    enough(argument, cloud.len(), "points")?;
    if cloud.points.iter().chain(&cloud.normals).all(|p| p.is_finite()) {
        return Extents::of(argument, &cloud.points).map(|_| ());
    }
    let remedy = "Leave points without a reading out.";
    Err(Error::new(ErrorCode::NonFinite, argument.to_owned(), "a number that is not finite", "finite numbers", remedy))
}

fn enough(argument: &str, count: usize, of_what: &str) -> Result<()> {
    if count >= MIN_POINTS {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::TooFewPoints,
        argument.to_owned(),
        format!("{count} {of_what}"),
        format!("at least {MIN_POINTS}"),
        "A shape can't be told from so few: pass more points, or a smaller voxel size.",
    ))
}
