//! Two clouds on a voxel grid in a common scale: the input of every method.

use super::baseline::Baseline;
use super::fgr::{self, FgrSettings};
use super::gicp::{self, GicpSettings};
use super::icp::{self, classical};
use super::measurements::{Matched, no_consensus};
use super::quatro::{self, QuatroSettings};
use super::teaser::{self, TeaserSettings};
use crate::prelude::*;
use sim3align::register::at_once::{fpfh, nearest, ransac};
use sim3align::register::grid_cloud::GridCloud;
use sim3align::register::icp::{IcpMetric, Refined};
use sim3align::register::matching::Match;
use sim3align::register::ransac::RansacSettings;
use sim3align::register::umeyama::ScaleMode;

/// Random stream of the subsampling of descriptors.
const STREAM: u64 = 8;

/// Settings of all methods, in the common unit of the clouds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitSettings {
    /// Radius of the descriptors.
    pub fpfh_radius: f32,
    /// Maximum number of matched points per cloud; matching is quadratic.
    pub max_features: usize,
    /// Maximum distance of an inlier; the noise bound β of TEASER and Quatro.
    pub inlier_distance: f64,
    /// Minimum ratio of the smallest to the largest edge scale within RANSAC's minimal sets.
    pub edge_similarity: f64,
    /// Maximum number of minimal sets of RANSAC.
    pub ransac_iterations: usize,
    /// RANSAC's confidence.
    pub ransac_confidence: f64,
    /// The ICP metric that refines the pose of RANSAC; `None` for no refinement.
    pub icp: Option<IcpMetric>,
    /// Maximum correspondence distance of local methods.
    pub max_correspondence_distance: f32,
    /// Maximum number of iterations of local methods.
    pub icp_iterations: usize,
    /// Whether TEASER estimates the scale; for all others it is 1.
    pub estimates_scale: bool,
    /// Up directions in the source and target frames, for Quatro.
    pub up: Option<[Vector3<f64>; 2]>,
    /// Seed of all random draws.
    pub seed: u64,
}

/// Result of a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// The transform.
    pub target_from_source: Similarity,
    /// Number of matches.
    pub matches: usize,
    /// Number of inliers.
    pub inliers: usize,
    /// Number of minimal sets that RANSAC drew.
    pub ransac_iterations: usize,
    /// The refinement, if any.
    pub refined: Option<Refined>,
}

/// A pair of clouds.
#[derive(Debug, Clone)]
pub struct Clouds {
    /// The cloud that is transformed.
    pub source: GridCloud,
    /// The reference cloud.
    pub target: GridCloud,
}

impl Clouds {
    /// Matches of FPFH descriptors.
    pub fn matches(&self, settings: &UnitSettings) -> Vec<Match> {
        let mut random = Random::new(settings.seed, STREAM);
        let mut described = |side: &GridCloud| {
            let descriptors = fpfh(&side.cloud, &side.tree, settings.fpfh_radius);
            let (all, most) = (descriptors.len(), settings.max_features);
            if all <= most {
                return ((0..all as u32).collect::<Vec<_>>(), descriptors);
            }
            random.one_of_each_run(all, most).map(|i| (i as u32, descriptors[i])).unzip()
        };
        let (source, target) = (described(&self.source), described(&self.target));
        let own = |m: Match| Match { source: source.0[m.source as usize], target: target.0[m.target as usize] };
        nearest(&source.1, &target.1).enough().into_iter().map(own).collect()
    }

    /// Estimates the transform from matches; local methods ignore them and start at the identity.
    ///
    /// # Errors
    /// [`ErrorCode::NoConsensus`]; [`ErrorCode::InvalidOption`] for Quatro without the vertical.
    pub fn solve(&self, baseline: Baseline, matches: &[Match], settings: &UnitSettings) -> Result<Solved> {
        let (source, target) = (&self.source.cloud, &self.target.cloud);
        let posed = |target_from_source: Similarity, inliers: usize| Solved {
            target_from_source,
            matches: matches.len(),
            inliers,
            ransac_iterations: 0,
            refined: None,
        };
        let reach = settings.max_correspondence_distance;
        let icp = |metric: IcpMetric, initial: &Similarity| {
            let settings = classical(metric, reach, settings.icp_iterations);
            icp::solve(source, target, &self.target.tree, initial, &settings)
        };
        let start = Similarity::identity();
        let local = |refined: Refined| Solved { refined: Some(refined), ..posed(refined.target_from_source, 0) };
        let scale = if settings.estimates_scale { ScaleMode::Free } else { ScaleMode::Fixed(1.0) };
        let teaser = TeaserSettings { seed: settings.seed, ..TeaserSettings::new(settings.inlier_distance, scale) };
        match baseline {
            Baseline::Fgr => {
                let fgr = FgrSettings { seed: settings.seed, ..FgrSettings::default() };
                let found = fgr::solve(&source.points, &target.points, matches, &fgr)?;
                Ok(posed(found.target_from_source, found.used.len()))
            }
            Baseline::Gicp => {
                let gicp = GicpSettings::new(reach, settings.icp_iterations);
                gicp::solve(&source.points, &target.points, &self.target.tree, &start, &gicp).map(local)
            }
            Baseline::IcpPointToPlane => icp(IcpMetric::PointToPlane, &start).map(local),
            Baseline::IcpPointToPoint => icp(IcpMetric::PointToPoint, &start).map(local),
            Baseline::Ransac => {
                let found = self.ransac(matches, settings)?;
                // Without correspondences for ICP, the pose of RANSAC is the result.
                let refined = settings.icp.and_then(|metric| icp(metric, &found.target_from_source).ok());
                let target_from_source = refined.map_or(found.target_from_source, |refined| refined.target_from_source);
                Ok(Solved { target_from_source, refined, ..found })
            }
            Baseline::Teaser => {
                let matched = Matched::of(&source.points, &target.points, matches)?;
                let found = teaser::solve(&matched.source, &matched.target, &teaser)?;
                Ok(posed(found.target_from_source, found.inliers.len()))
            }
            Baseline::Quatro => {
                let [source_up, target_up] = settings.up.ok_or_else(no_vertical)?;
                let matched = Matched::of(&source.points, &target.points, matches)?;
                let teaser = TeaserSettings { scale: ScaleMode::Fixed(1.0), ..teaser };
                let quatro = QuatroSettings { teaser, source_up, target_up };
                let found = quatro::solve(&matched.source, &matched.target, &quatro)?;
                Ok(posed(found.target_from_source, found.inliers.len()))
            }
        }
    }

    fn ransac(&self, matches: &[Match], settings: &UnitSettings) -> Result<Solved> {
        let (source, target): (&[Vec3], &[Vec3]) = (&self.source.cloud.points, &self.target.cloud.points);
        let ransac_settings = RansacSettings {
            inlier_distance: settings.inlier_distance,
            edge_similarity: settings.edge_similarity,
            max_iterations: settings.ransac_iterations,
            confidence: settings.ransac_confidence,
            scale_mode: ScaleMode::Fixed(1.0),
            guard: None,
            seed: settings.seed,
        };
        let found = ransac(source, target, matches, &ransac_settings)
            .map_err(|_| no_consensus(matches.len(), 0, "three at least"))?;
        Ok(Solved {
            target_from_source: found.target_from_source,
            matches: matches.len(),
            inliers: found.inliers.len(),
            ransac_iterations: found.counts.iterations,
            refined: None,
        })
    }
}

fn no_vertical() -> Error {
    Error::new(
        ErrorCode::InvalidOption,
        "options.cameraUp",
        "no vertical",
        "the direction that is up in both frames, which quatro turns about",
        "Pass `cameraUp` and `meshUp`, or choose teaser.",
    )
}
