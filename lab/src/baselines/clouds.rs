//! Two clouds on a voxel grid in a common scale: the input of every method.

use super::baseline::Baseline;
use super::fgr::{self, FgrSettings};
use super::gicp;
use super::gnc::Turns;
use super::icp::{self, classical};
use super::measurements::{Matched, no_consensus};
use super::teaser::{self, TeaserSettings};
use crate::prelude::*;
use sim3align::register::at_once::{fpfh, nearest, ransac};
use sim3align::register::cloud_pair::MAX_FEATURES;
use sim3align::register::grid_cloud::GridCloud;
use sim3align::register::icp::{IcpMetric, Refined};
use sim3align::register::matching::Match;
use sim3align::register::ransac::RansacSettings;
use sim3align::register::settings::icp_metric;
use sim3align::register::umeyama::ScaleMode;

/// Random stream of the subsampling of descriptors.
const STREAM: u64 = 8;

/// Settings of all methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings<'a> {
    /// Descriptors, RANSAC and ICP, as in the paper's method. `inlier_distance_voxels` is also the noise bound β of TEASER
    /// and Quatro; `support_distance_voxels` bounds the correspondences of local methods and of the refinement.
    pub paper: &'a PaperOptions,
    /// Edge of a voxel, in the common unit of the clouds.
    pub voxel_size: f64,
    /// Whether TEASER estimates the scale; for all others it is 1.
    pub estimates_scale: bool,
    /// Whether z is up in both clouds, which Quatro needs.
    pub is_upright: bool,
}

impl Settings<'_> {
    fn seed(&self) -> u64 {
        self.paper.seed.into()
    }

    fn inlier_distance(&self) -> f64 {
        self.paper.inlier_distance_voxels * self.voxel_size
    }
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
    pub fn matches(&self, settings: &Settings) -> Vec<Match> {
        let mut random = Random::new(settings.seed(), STREAM);
        let mut described = |side: &GridCloud| {
            let descriptors =
                fpfh(&side.cloud, &side.tree, (settings.paper.fpfh_radius_voxels * settings.voxel_size) as f32);
            let (all, most) = (descriptors.len(), MAX_FEATURES);
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
    pub fn solve(&self, baseline: Baseline, matches: &[Match], settings: &Settings) -> Result<Solved> {
        let (source, target) = (&self.source.cloud, &self.target.cloud);
        let posed = |target_from_source: Similarity, inliers: usize| Solved {
            target_from_source,
            matches: matches.len(),
            inliers,
            ransac_iterations: 0,
            refined: None,
        };
        let reach = (settings.paper.support_distance_voxels * settings.voxel_size) as f32;
        let iterations = settings.paper.icp_iterations as usize;
        let icp = |metric: IcpMetric, initial: &Similarity| {
            icp::solve(source, target, &self.target.tree, initial, &classical(metric, reach, iterations))
        };
        let start = Similarity::identity();
        let local = |refined: Refined| Solved { refined: Some(refined), ..posed(refined.target_from_source, 0) };
        let scale = if settings.estimates_scale { ScaleMode::Free } else { ScaleMode::Fixed(1.0) };
        let teaser = TeaserSettings { seed: settings.seed(), ..TeaserSettings::new(settings.inlier_distance(), scale) };
        match baseline {
            Baseline::Fgr => {
                let fgr = FgrSettings { seed: settings.seed(), ..FgrSettings::default() };
                let found = fgr::solve(&source.points, &target.points, matches, &fgr)?;
                Ok(posed(found.target_from_source, found.used.len()))
            }
            Baseline::Gicp => {
                gicp::solve(&source.points, &target.points, &self.target.tree, &start, reach, iterations).map(local)
            }
            Baseline::IcpPointToPlane => icp(IcpMetric::PointToPlane, &start).map(local),
            Baseline::IcpPointToPoint => icp(IcpMetric::PointToPoint, &start).map(local),
            Baseline::Ransac => {
                let found = self.ransac(matches, settings)?;
                // Without correspondences for ICP, the pose of RANSAC is the result.
                let refined =
                    icp_metric(settings.paper.icp).and_then(|metric| icp(metric, &found.target_from_source).ok());
                let target_from_source = refined.map_or(found.target_from_source, |refined| refined.target_from_source);
                Ok(Solved { target_from_source, refined, ..found })
            }
            Baseline::Quatro if !settings.is_upright => Err(no_vertical()),
            Baseline::Teaser | Baseline::Quatro => {
                let turns = if baseline == Baseline::Teaser { Turns::All } else { Turns::About(Vector3::z()) };
                let matched = Matched::of(&source.points, &target.points, matches)?;
                let found = teaser::solve(&matched.source, &matched.target, &teaser, turns)?;
                Ok(posed(found.target_from_source, found.inliers.len()))
            }
        }
    }

    fn ransac(&self, matches: &[Match], settings: &Settings) -> Result<Solved> {
        let (source, target): (&[Vec3], &[Vec3]) = (&self.source.cloud.points, &self.target.cloud.points);
        let paper = settings.paper;
        let ransac_settings = RansacSettings {
            inlier_distance: settings.inlier_distance(),
            edge_similarity: paper.edge_similarity,
            max_iterations: paper.ransac_iterations as usize,
            confidence: paper.ransac_confidence,
            scale_mode: ScaleMode::Fixed(1.0),
            guard: None,
            seed: settings.seed(),
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
