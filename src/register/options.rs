//! Options of `register` and `estimateSim3`.

use crate::options::scale::ScaleOption;
use crate::options::{choices, options};

/// Largest RANSAC confidence: with 1, RANSAC would never stop early.
pub const MAX_CONFIDENCE: f64 = 0.999_999;

choices! {
    /// The distance that ICP minimises.
    pub enum Icp {
        /// To the tangent plane at the nearest target point.
        #[default]
        PointToPlane = "point-to-plane",
        /// To the nearest target point.
        PointToPoint = "point-to-point",
        /// No refinement: the RANSAC pose is returned.
        None = "none",
    }
}

choices! {
    /// What RANSAC does with a hypothesis whose scale is outside the guard.
    pub enum GuardMode {
        /// Drops it.
        #[default]
        Reject = "reject",
        /// Moves its scale to the nearer bound, and counts it.
        Clamp = "clamp",
    }
}

options! {
    /// Options of `register`. All have defaults.
    pub struct RegisterOptions {
        /// The scale in target units per source unit: `"free"`, a known number (1 for rigid registration), or bounds
        /// `[min, max]`.
        scale: ScaleOption = ScaleOption::Free, Scale;
        /// Seed of all random draws. The same input and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
        /// Upper bound on the points used of each cloud. Above it, a random subset is drawn or, with a known scale,
        /// small voxels are averaged.
        max_points: u32 = 20_000, Count(32..=1_000_000);
        /// Voxel size in target units. `null` derives it from `voxelDivisions`.
        voxel_size: Option<f64> = None, Positive;
        /// Voxels along the diagonal of the target's bounding box. `null` takes 30 or, with a known scale, the size
        /// that leaves 5000 points of the larger cloud.
        voxel_divisions: Option<f64> = None, OptionalNumber(5.0..=200.0);
        /// Radius of the FPFH descriptors, in voxels.
        fpfh_radius_voxels: f64 = 5.0, Number(1.0..=20.0);
        /// Upper bound on the minimal sets that RANSAC draws. With a known scale, which needs no draws, it bounds the
        /// poses that are tried, which are 100 at most.
        ransac_iterations: u32 = 100_000, Count(1..=10_000_000);
        /// RANSAC stops once it has found the best consensus with this probability. Without effect with a known scale.
        ransac_confidence: f64 = 0.999, Number(0.0..=MAX_CONFIDENCE);
        /// Distance below which a match counts as an inlier, in voxels.
        inlier_distance_voxels: f64 = 1.5, Number(0.1..=20.0);
        /// Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched.
        /// Without effect with a known scale.
        edge_similarity: f64 = 0.9, Number(0.0..=1.0);
        /// The distance that ICP minimises, or `"none"` for no refinement.
        icp: Icp = Icp::PointToPlane, Choice;
        /// Upper bound on the iterations of each of ICP's two passes: on the voxel grid, then on the points.
        icp_iterations: u32 = 60, Count(1..=1_000);
        /// An upper bound on the work, in units of about a millisecond on a 2020 laptop. The work is counted, not timed.
        /// Draws and poses beyond it are left out; preparing the clouds takes what their points need. `null` sets no bound.
        work_budget: Option<f64> = None, Positive;
    }
}

options! {
    /// Options of `estimateSim3`. All have defaults.
    pub struct EstimateSim3Options {
        /// The scale in target units per source unit: `"free"`, a known number (1 for a rigid transform), or bounds
        /// `[min, max]`.
        scale: ScaleOption = ScaleOption::Free, Scale;
        /// Seed of all random draws. The same input and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
        /// Distance below which a correspondence counts as an inlier, in target units. `null` takes a twentieth of the
        /// diagonal of the target's bounding box.
        inlier_distance: Option<f64> = None, Positive;
        /// Upper bound on the minimal sets that RANSAC draws.
        ransac_iterations: u32 = 100_000, Count(1..=10_000_000);
        /// RANSAC stops once it has found the best consensus with this probability.
        ransac_confidence: f64 = 0.999, Number(0.0..=MAX_CONFIDENCE);
        /// Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched.
        edge_similarity: f64 = 0.9, Number(0.0..=1.0);
        /// An upper bound on the work, in units of about a millisecond on a 2020 laptop. The work is counted, not timed.
        /// Draws beyond it are left out. `null` sets no bound.
        work_budget: Option<f64> = None, Positive;
    }
}
