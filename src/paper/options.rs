//! Options of the paper's method.

use crate::options::options;
pub use crate::register::options::GuardMode;
use crate::register::options::{Icp, MAX_CONFIDENCE};

options! {
    /// Options of `align` with `preset: "paper"`: the method of the paper, for comparison. All others have defaults.
    pub struct PaperOptions {
        /// Seed of all random draws. The same input and seed give the same bits.
        seed: u32 = 0, Count(0..=u32::MAX);
        /// Upper bound on the depth readings used. Above it, an even random subset is drawn.
        max_observed_points: u32 = 20_000, Count(32..=1_000_000);
        /// Number of points sampled on the mesh surface.
        surface_samples: u32 = 20_000, Count(100..=1_000_000);
        /// Whether to compute `metrics`. Without them the call takes less time.
        metrics: bool = true, Flag;
        /// Voxels along the diagonal of the observation's bounding box (the paper compares 20, 30 and 50).
        voxel_divisions: f64 = 30.0, Number(5.0..=200.0);
        /// Radius of the FPFH descriptors, in voxels.
        fpfh_radius_voxels: f64 = 5.0, Number(1.0..=20.0);
        /// Bounds [λmin, λmax] of the scale relative to the initial scale. `null` leaves the scale unbounded, which is
        /// an ablation of the paper.
        guard: Option<[f64; 2]> = Some([0.5, 1.5]), Guard;
        /// What RANSAC does with a hypothesis whose scale is outside the guard.
        guard_mode: GuardMode = GuardMode::Reject, Choice;
        /// Upper bound on the minimal sets that RANSAC draws.
        ransac_iterations: u32 = 100_000, Count(1..=10_000_000);
        /// RANSAC stops once it has found the best consensus with this probability.
        ransac_confidence: f64 = 0.999, Number(0.0..=MAX_CONFIDENCE);
        /// Distance below which a match counts as an inlier, in voxels.
        inlier_distance_voxels: f64 = 1.5, Number(0.1..=20.0);
        /// Smallest accepted ratio between the stretches of a minimal set's three edges, least to most stretched.
        edge_similarity: f64 = 0.9, Number(0.0..=1.0);
        /// Whether mesh regions without support by the observation are left out.
        hallucination_filter: bool = true, Flag;
        /// Largest distance to an observed point that counts as support, in voxels. ICP tightens it to a third as the
        /// pose improves.
        support_distance_voxels: f64 = 3.0, Number(0.1..=50.0);
        /// Largest angle between the two normals that counts as support, in degrees.
        support_angle_deg: f64 = 60.0, Number(0.0..=180.0);
        /// The distance that ICP minimises, or `"none"` for no refinement.
        icp: Icp = Icp::PointToPlane, Choice;
        /// Whether ICP leaves the scale as RANSAC found it (§3.3). `false` is an ablation of the paper.
        lock_scale: bool = true, Flag;
        /// Upper bound on the iterations of each of ICP's two passes: on the voxel grid, then on the points.
        icp_iterations: u32 = 60, Count(1..=1_000);
    }
}
