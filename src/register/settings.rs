//! Settings of feature-based registration.

use super::icp::{IcpMetric, IcpSettings};
use super::normalized_pair::NormalizedPair;
use super::options::RegisterOptions;
use super::ransac::{Guard, GuardMode, RansacSettings};
use super::support::SupportSettings;
use super::umeyama::ScaleMode;
use crate::register::options::Icp;

/// Distance of support at the start of the refinement of `register`, in voxels.
const SUPPORT_DISTANCE_VOXELS: f64 = 3.0;

/// ICP has converged if no corner of the unit box moves further than this in an iteration.
const TOLERANCE: f64 = 1e-4;

/// Settings in the normalised frames, in which both bounding boxes have a diagonal of 1 and s_init is 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegistrationSettings {
    /// Edge of the voxels.
    pub voxel_size: f32,
    /// Radius of the descriptors, in voxels.
    pub fpfh_radius_voxels: f32,
    /// RANSAC, with the bounds of the scale.
    pub ransac: RansacSettings,
    /// Support at the start of the refinement; at its end, the distance is a third.
    pub support: SupportSettings,
    /// The ICP metric; `None` for no refinement.
    pub icp: Option<IcpMetric>,
    /// Whether ICP keeps the scale.
    pub lock_scale: bool,
    /// Maximum number of ICP iterations, on the grid and on the points each.
    pub icp_iterations: usize,
}

impl RegistrationSettings {
    /// The settings of `register`. Without a camera, the side of a normal is unknown, so that support only depends on
    /// the distance.
    pub(super) fn new(
        options: &RegisterOptions,
        voxel_size: f64,
        scale_mode: ScaleMode,
        guard: Option<[f64; 2]>,
    ) -> Self {
        // As the reciprocal of the number of voxels along the diagonal, whose rounding is part of the bits of results.
        let voxel_size = 1.0 / (1.0 / voxel_size);
        Self {
            voxel_size: voxel_size as f32,
            fpfh_radius_voxels: options.fpfh_radius_voxels as f32,
            ransac: RansacSettings {
                inlier_distance: options.inlier_distance_voxels * voxel_size,
                edge_similarity: options.edge_similarity,
                max_iterations: options.ransac_iterations as usize,
                confidence: options.ransac_confidence,
                scale_mode,
                guard: guard.map(|[min, max]| Guard { min, max, mode: GuardMode::Reject }),
                seed: u64::from(options.seed),
            },
            support: SupportSettings { max_distance: (SUPPORT_DISTANCE_VOXELS * voxel_size) as f32, min_cosine: -1.0 },
            icp: icp_metric(options.icp),
            lock_scale: matches!(scale_mode, ScaleMode::Fixed(_)),
            icp_iterations: options.icp_iterations as usize,
        }
    }

    /// Settings of ICP on the voxel grid with at most this many iterations; `None` for no refinement.
    pub(super) fn brief_icp_on_grid(&self, iterations: usize) -> Option<IcpSettings> {
        self.icp_on_grid().map(|icp| IcpSettings { max_iterations: iterations.min(icp.max_iterations), ..icp })
    }

    /// Settings of ICP on the voxel grid; `None` for no refinement.
    pub(super) fn icp_on_grid(&self) -> Option<IcpSettings> {
        Some(IcpSettings {
            metric: self.icp?,
            lock_scale: self.lock_scale,
            scale_bounds: self.ransac.guard.map(|g| [g.min, g.max]),
            max_iterations: self.icp_iterations,
            support: self.support,
            final_distance: self.support.max_distance / 3.0,
            tolerance: TOLERANCE,
        })
    }
}

/// The voxel size of the options in the normalised frame of the target, if they give one.
pub(super) fn given_voxel_size(options: &RegisterOptions, frames: &NormalizedPair) -> Option<f64> {
    let of_size = options.voxel_size.map(|size| size / frames.target.diagonal());
    of_size.or(options.voxel_divisions.map(|divisions| 1.0 / divisions))
}

/// The ICP metric of an option; `None` for no refinement.
pub fn icp_metric(icp: Icp) -> Option<IcpMetric> {
    match icp {
        Icp::PointToPlane => Some(IcpMetric::PointToPlane),
        Icp::PointToPoint => Some(IcpMetric::PointToPoint),
        Icp::None => None,
    }
}
