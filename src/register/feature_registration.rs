//! Registration by features (paper §3.2, §3.3): FPFH descriptors, mutual matches, guarded RANSAC, hallucination filter,
//! ICP. Shared by the preset `paper` and `register`.

use super::cloud_pair::CloudPair;
use super::matching::{Match, Nearest};
use super::ransac::{Consensus, ransac};
use super::settings::RegistrationSettings;
use super::support::supported;
use super::umeyama::{Pair, ScaleMode, umeyama};
use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::similarity::{Similarity, vector3};
use crate::progress::{Stage, Stopwatch};
use crate::report::Counts;
use crate::scheduler::Scheduler;

/// An estimated transform between normalised frames.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    pub target_from_source: Similarity,
    /// Whether the scale was clamped to the guard.
    pub clamped: bool,
    /// Whether ICP converged.
    pub converged: bool,
    /// Root mean square residual of the last refinement, in the normalised frame of the target.
    pub rms: f64,
    pub counts: Counts,
    /// Indices of the matches that agreed with the pose before the refinement.
    pub inliers: Vec<usize>,
}

/// Two clouds with matches of their descriptors.
pub(crate) struct FeatureRegistration<'a> {
    clouds: CloudPair<'a>,
    matches: Vec<Match>,
}

impl<'a> FeatureRegistration<'a> {
    /// Computes descriptors and matches. Both clouds have normals, and are centred with a box diagonal of 1.
    pub(crate) async fn new(
        source: &'a Cloud,
        target: &'a Cloud,
        settings: &RegistrationSettings,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Self {
        let clouds = CloudPair::new(source, target, settings.voxel_size, scheduler).await;
        let [source, target] = clouds.descriptors(settings, stages, scheduler).await;
        stages.enter(Stage::Matching);
        let matches = Nearest::of(&source, &target, scheduler).await.enough();
        Self { clouds, matches }
    }

    /// Estimates the similarity from source to target.
    ///
    /// # Errors
    /// [`NoConsensus`](crate::error::ErrorCode::NoConsensus).
    pub(crate) async fn solve(
        &self,
        settings: &RegistrationSettings,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> Result<Estimate> {
        let Self { clouds, matches } = self;
        stages.enter(Stage::Ransac);
        let points = [&clouds.source, &clouds.target].map(|side| &side.grid.cloud.points);
        let consensus = ransac(points[0], points[1], matches, &settings.ransac, scheduler).await?;
        stages.enter(Stage::Filter);
        let filtered = self.refit_on_supported(&consensus, settings);

        stages.enter(Stage::Icp);
        let refined = clouds.refine(&filtered, settings, scheduler).await;
        // If the refinement may change the scale, it can also end at a bound of the guard.
        let guard = settings.ransac.guard.filter(|_| !settings.lock_scale);
        let stopped = guard.is_some_and(|g| g.is_bound(refined.target_from_source.scale));

        Ok(Estimate {
            target_from_source: refined.target_from_source,
            clamped: consensus.clamped || stopped,
            converged: refined.converged,
            rms: refined.rms,
            counts: clouds.counts(&refined, consensus.counts),
            inliers: consensus.inliers,
        })
    }

    /// Removes matches (sorted indices) from later calls of [`FeatureRegistration::solve`].
    pub(crate) fn discard(&mut self, matches: &[usize]) {
        let mut index = 0..;
        self.matches.retain(|_| index.next().is_none_or(|i| matches.binary_search(&i).is_err()));
    }

    /// Refits the closed form on the inliers whose source points the observation supports. Keeps the consensus if too
    /// few remain, or if the new scale is outside the guard.
    fn refit_on_supported(&self, consensus: &Consensus, settings: &RegistrationSettings) -> Similarity {
        let [source, target] = [&self.clouds.source.grid, &self.clouds.target.grid];
        let pose = consensus.target_from_source;
        let support = supported(&source.cloud, &target.cloud, &target.tree, &pose, &settings.support);
        let is_supported = |index: u32| support.binary_search_by_key(&index, |s| s.source).is_ok();
        let kept = consensus.inliers.iter().map(|&i| self.matches[i]).filter(|m| is_supported(m.source));
        let pairs = kept.map(|m| Pair {
            source: vector3(source.cloud.points[m.source as usize]),
            target: vector3(target.cloud.points[m.target as usize]),
            weight: 1.0,
        });
        let scale_mode = if consensus.clamped { ScaleMode::Fixed(pose.scale) } else { settings.ransac.scale_mode };
        let inside = |s: &Similarity| settings.ransac.guard.is_none_or(|g| (g.min..=g.max).contains(&s.scale));
        umeyama(pairs, scale_mode).ok().filter(inside).unwrap_or(pose)
    }
}
