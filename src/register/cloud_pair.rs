//! Two clouds in a common frame at two resolutions: their descriptors, and ICP from the coarse to the fine one.

use super::fpfh::{Descriptor, fpfh};
use super::grid_cloud::GridCloud;
use super::icp::{IcpSettings, Refined, refine};
use super::settings::RegistrationSettings;
use super::support::SupportSettings;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::Similarity;
use crate::progress::{Stage, Stopwatch};
use crate::report::Counts;
use crate::scheduler::Scheduler;

/// Maximum number of descriptors per cloud; denser clouds get a coarser grid. Matching is quadratic.
pub const MAX_FEATURES: usize = 8_000;

/// Maximum number of source points of the last refinement.
const FINE_POINTS: usize = 5_000;

/// A cloud at full resolution and on a voxel grid.
pub(super) struct CloudPyramid<'a> {
    /// The cloud, with normals.
    pub full: &'a Cloud,
    /// The means of its voxels, with smooth normals, and the search tree over them.
    pub grid: GridCloud,
}

impl<'a> CloudPyramid<'a> {
    async fn new(full: &'a Cloud, voxel_size: f32, scheduler: &Scheduler) -> Self {
        Self { full, grid: GridCloud::of_at_most(MAX_FEATURES, full, voxel_size, scheduler).await }
    }
}

/// Source and target in a frame where they have about the same size, with bounding boxes of diagonal 1.
pub(super) struct CloudPair<'a> {
    pub source: CloudPyramid<'a>,
    pub target: CloudPyramid<'a>,
}

impl<'a> CloudPair<'a> {
    /// A pair of clouds with normals, on grids of `voxel_size`.
    pub(super) async fn new(source: &'a Cloud, target: &'a Cloud, voxel_size: f32, scheduler: &Scheduler) -> Self {
        let source = CloudPyramid::new(source, voxel_size, scheduler).await;
        Self { source, target: CloudPyramid::new(target, voxel_size, scheduler).await }
    }

    /// The descriptors of source and target on their grids.
    pub(super) async fn descriptors(
        &self,
        settings: &RegistrationSettings,
        stages: &mut Stopwatch<'_>,
        scheduler: &Scheduler,
    ) -> [Vec<Descriptor>; 2] {
        stages.enter(Stage::Features);
        let radius = settings.fpfh_radius_voxels * settings.voxel_size;
        let mut found = [Vec::new(), Vec::new()];
        for (found, side) in found.iter_mut().zip([&self.source, &self.target]) {
            *found = fpfh(&side.grid.cloud, &side.grid.tree, radius, scheduler).await;
        }
        found
    }

    /// ICP between the grids.
    pub(super) async fn refine_on_grid(
        &self,
        initial: &Similarity,
        settings: &IcpSettings,
        scheduler: &Scheduler,
    ) -> Refined {
        let (source, target) = (&self.source.grid, &self.target.grid);
        refine(&source.cloud, &target.cloud, &target.tree, initial, settings, scheduler).await
    }

    /// ICP between the grids, then between the full clouds.
    pub(super) async fn refine(
        &self,
        initial: &Similarity,
        settings: &RegistrationSettings,
        scheduler: &Scheduler,
    ) -> Refined {
        let Some(coarse) = settings.icp_on_grid() else {
            return Refined { target_from_source: *initial, iterations: 0, converged: true, supported: 0, rms: 0.0 };
        };
        let on_grid = self.refine_on_grid(initial, &coarse, scheduler).await;
        let support = SupportSettings { max_distance: coarse.final_distance, ..settings.support };
        let fine = IcpSettings { support, ..coarse };
        let (source, target) = (self.source.full, self.target.full);
        let step = source.len().div_ceil(FINE_POINTS).max(1);
        let points = source.select((0..source.len()).step_by(step));
        let tree = KdTree::paused(&target.points, scheduler).await;
        let on_points = refine(&points, target, &tree, &on_grid.target_from_source, &fine, scheduler).await;
        Refined { iterations: on_grid.iterations + on_points.iterations, ..on_points }
    }

    /// The counts with those of points and voxels, and of the refinement.
    pub(super) fn counts(&self, refined: &Refined, others: Counts) -> Counts {
        Counts {
            source_points: self.source.full.len(),
            target_points: self.target.full.len(),
            source_voxels: self.source.grid.cloud.len(),
            target_voxels: self.target.grid.cloud.len(),
            supported: refined.supported,
            icp_iterations: refined.iterations,
            ..others
        }
    }
}
