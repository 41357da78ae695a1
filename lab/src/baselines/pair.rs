//! Registration of two clouds of the same scale, such as scans of a room or a street, by the methods for comparison.

use super::baseline::Baseline;
use super::clouds::{Clouds, UnitSettings};
use crate::prelude::*;
use sim3align::evidence::extents::{Extents, target_from_source};
use sim3align::evidence::normals::outward_normals;
use sim3align::evidence::observation::MIN_POINTS;
use sim3align::pauses::{Pauses, finished};
use sim3align::register::at_once::grid_cloud;
use sim3align::register::icp::IcpMetric;
use sim3align_geometry::number::number;

/// Neighbours for normal estimation, for clouds without normals.
const NORMAL_NEIGHBORS: usize = 30;

/// Settings of [`register_pair`], in the unit of the clouds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairSettings {
    /// Edge of the voxels, above 0.
    pub voxel_size: f64,
    /// Radius of the descriptors, in voxels.
    pub fpfh_radius_voxels: f64,
    /// Maximum number of matched points per cloud; more are subsampled evenly. Matching is quadratic.
    pub max_features: usize,
    /// Maximum distance of an inlier, in voxels; the noise bound β of TEASER and Quatro.
    pub inlier_distance_voxels: f64,
    /// Maximum correspondence distance of local methods, in voxels.
    pub max_correspondence_distance_voxels: f64,
    /// Maximum number of minimal sets of RANSAC.
    pub ransac_iterations: usize,
    /// The ICP metric that refines the pose of RANSAC; `None` for no refinement.
    pub icp: Option<IcpMetric>,
    /// Maximum number of iterations of local methods.
    pub icp_iterations: usize,
    /// Up direction in both frames, for Quatro.
    pub up: [f64; 3],
    /// Seed of all random draws.
    pub seed: u64,
}

impl PairSettings {
    /// Default settings; z is up.
    pub fn new(voxel_size: f64) -> Self {
        Self {
            voxel_size,
            fpfh_radius_voxels: 5.0,
            max_features: 8_000,
            inlier_distance_voxels: 1.5,
            max_correspondence_distance_voxels: 3.0,
            ransac_iterations: 100_000,
            icp: None,
            icp_iterations: 60,
            up: [0.0, 0.0, 1.0],
            seed: 0,
        }
    }
}

/// Estimates the rigid transform from source to target. Local methods start at the identity.
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
    settings: &PairSettings,
) -> Result<Similarity> {
    if !(settings.voxel_size.is_finite() && settings.voxel_size > 0.0) {
        let remedy = "Pass it in the unit of the points.";
        let found = number(settings.voxel_size);
        return Err(Error::new(ErrorCode::InvalidOption, "options.voxelSize", found, "a number above 0", remedy));
    }
    check("source", source)?;
    check("target", target)?;
    // A common frame, so that the relative pose of the clouds is preserved.
    let frame = Extents::of("target", &target.points)?;
    let voxel_size = settings.voxel_size / frame.diagonal();
    let grid = |argument: &str, cloud: &Cloud| {
        let mut cloud = frame.normalized(cloud);
        if cloud.normals.len() != cloud.len() {
            cloud.normals = finished(outward_normals(&cloud.points, None, NORMAL_NEIGHBORS, &Pauses::none()));
        }
        let grid = grid_cloud(usize::MAX, &cloud, voxel_size as f32);
        enough(argument, grid.cloud.len(), "voxels").map(|()| grid)
    };
    let clouds = Clouds { source: grid("source", source)?, target: grid("target", target)? };
    let up = Vector3::from(settings.up);
    let unit = UnitSettings {
        fpfh_radius: (settings.fpfh_radius_voxels * voxel_size) as f32,
        max_features: settings.max_features,
        inlier_distance: settings.inlier_distance_voxels * voxel_size,
        edge_similarity: 0.9,
        ransac_iterations: settings.ransac_iterations,
        ransac_confidence: 0.999,
        icp: settings.icp,
        max_correspondence_distance: (settings.max_correspondence_distance_voxels * voxel_size) as f32,
        icp_iterations: settings.icp_iterations,
        estimates_scale: false,
        up: Some([up, up]),
        seed: settings.seed,
    };
    let matches = if baseline.is_local() { Vec::new() } else { clouds.matches(&unit) };
    let found = clouds.solve(baseline, &matches, &unit)?.target_from_source;
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
