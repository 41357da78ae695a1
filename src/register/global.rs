//! From two clouds with normals to a similarity: what `align` and `register` have in common.

use super::options::RegisterOptions;
use crate::error::Result;
use crate::geometry::angle::sin_cos;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::similarity::{Similarity, vector3};
use crate::paper::options::{GuardMode, Icp, PaperOptions};
use crate::progress::{Stage, Stopwatch};
use crate::register::fpfh::fpfh;
use crate::register::grid_cloud::GridCloud;
use crate::register::icp::{IcpMetric, IcpSettings, Refined, refine};
use crate::register::matching::{Match, enough_matches};
use crate::register::ransac::{self, Consensus, Guard, RansacSettings, ransac};
use crate::register::support::{SupportSettings, supported};
use crate::register::umeyama::{Pair, ScaleMode, umeyama};
use crate::report::Counts;

/// Points that descriptors are computed for at most; denser clouds get a coarser grid. Matching is quadratic.
pub const MAX_FEATURES: usize = 8_000;

/// Source points of the last refinement at most.
const FINE_POINTS: usize = 5_000;

/// ICP has come to rest when nothing in the unit box moves further than this.
const TOLERANCE: f64 = 1e-4;

/// Everything the estimation can be told, in the normalised frames (box diagonals 1, s_init = 1).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub voxel_size: f32,
    pub fpfh_radius_voxels: f32,
    pub ransac: RansacSettings,
    /// Support at the start of the refinement; its end is a third of it.
    pub support: SupportSettings,
    pub icp: Option<IcpMetric>,
    pub lock_scale: bool,
    pub icp_iterations: usize,
}

impl Settings {
    pub(crate) fn of(options: &PaperOptions) -> Self {
        let voxel_size = 1.0 / options.voxel_divisions;
        let mode = match options.guard_mode {
            GuardMode::Reject => ransac::GuardMode::Reject,
            GuardMode::Clamp => ransac::GuardMode::Clamp,
        };
        Self {
            voxel_size: voxel_size as f32,
            fpfh_radius_voxels: options.fpfh_radius_voxels as f32,
            ransac: RansacSettings {
                inlier_distance: options.inlier_distance_voxels * voxel_size,
                edge_similarity: options.edge_similarity,
                max_iterations: options.ransac_iterations as usize,
                confidence: options.ransac_confidence,
                scale_mode: ScaleMode::Free,
                guard: options.guard.map(|[min, max]| Guard { min, max, mode }),
                seed: u64::from(options.seed),
            },
            support: if options.hallucination_filter {
                SupportSettings {
                    max_distance: (options.support_distance_voxels * voxel_size) as f32,
                    min_cosine: sin_cos(options.support_angle_deg.to_radians()).1 as f32,
                }
            } else {
                SupportSettings::EVERYTHING
            },
            icp: icp_metric(options.icp),
            lock_scale: options.lock_scale,
            icp_iterations: options.icp_iterations as usize,
        }
    }

    /// Those of `register`: no camera says which side of a normal is outside, so support asks for distance only.
    pub(crate) fn of_register(
        options: &RegisterOptions,
        voxel_size: f64,
        scale_mode: ScaleMode,
        guard: Option<[f64; 2]>,
    ) -> Self {
        let mut settings = Self::of(&PaperOptions {
            seed: options.seed,
            voxel_divisions: 1.0 / voxel_size,
            fpfh_radius_voxels: options.fpfh_radius_voxels,
            guard,
            ransac_iterations: options.ransac_iterations,
            ransac_confidence: options.ransac_confidence,
            inlier_distance_voxels: options.inlier_distance_voxels,
            edge_similarity: options.edge_similarity,
            support_angle_deg: 180.0,
            icp: options.icp,
            lock_scale: matches!(scale_mode, ScaleMode::Fixed(_)),
            icp_iterations: options.icp_iterations,
            ..PaperOptions::default()
        });
        settings.ransac.scale_mode = scale_mode;
        settings
    }
}

/// The ICP metric that an option asks for; `None` for no refinement.
pub fn icp_metric(icp: Icp) -> Option<IcpMetric> {
    match icp {
        Icp::PointToPlane => Some(IcpMetric::PointToPlane),
        Icp::PointToPoint => Some(IcpMetric::PointToPoint),
        Icp::None => None,
    }
}

/// The estimated transform between the normalised frames.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    pub target_from_source: Similarity,
    pub clamped: bool,
    pub converged: bool,
    /// Of the last refinement, in the target's normalised frame.
    pub rms: f64,
    pub counts: Counts,
    /// Which matches agreed, before the refinement.
    pub inliers: Vec<usize>,
}

/// A cloud at both of its resolutions.
pub(crate) struct Side<'a> {
    pub(crate) full: &'a Cloud,
    pub(crate) voxels: Cloud,
    pub(crate) tree: KdTree,
}

impl<'a> Side<'a> {
    pub(crate) fn new(full: &'a Cloud, voxel_size: f32) -> Self {
        let GridCloud { cloud, tree } = GridCloud::of_at_most(MAX_FEATURES, full, voxel_size);
        Self { full, voxels: cloud, tree }
    }
}

/// Two clouds with their correspondences: everything before the first draw.
pub(crate) struct Problem<'a> {
    source: Side<'a>,
    target: Side<'a>,
    matches: Vec<Match>,
}

impl<'a> Problem<'a> {
    /// Descriptors and matches of both clouds; both with normals, centred, and of box diagonal 1.
    pub(crate) fn new(source: &'a Cloud, target: &'a Cloud, settings: &Settings, stages: &mut Stopwatch<'_>) -> Self {
        let (source, target) = (Side::new(source, settings.voxel_size), Side::new(target, settings.voxel_size));

        stages.enter(Stage::Features);
        let radius = settings.fpfh_radius_voxels * settings.voxel_size;
        let source_features = fpfh(&source.voxels, &source.tree, radius);
        let target_features = fpfh(&target.voxels, &target.tree, radius);

        stages.enter(Stage::Matching);
        Self { source, target, matches: enough_matches(&source_features, &target_features) }
    }

    /// The similarity that takes the source to the target.
    pub(crate) fn solve(&self, settings: &Settings, stages: &mut Stopwatch<'_>) -> Result<Estimate> {
        let Self { source, target, matches } = self;
        stages.enter(Stage::Ransac);
        let consensus = ransac(&source.voxels.points, &target.voxels.points, matches, &settings.ransac)?;

        stages.enter(Stage::Filter);
        let filtered = refit_on_supported(source, target, matches, &consensus, settings);

        stages.enter(Stage::Icp);
        let refined = refine_coarse_to_fine(source, target, &filtered, settings);
        // A refinement that may move the scale can end at the guard as well as RANSAC can.
        let guard = settings.ransac.guard.filter(|_| !settings.lock_scale);
        let stopped = guard.is_some_and(|g| g.is_bound(refined.target_from_source.scale));

        Ok(Estimate {
            target_from_source: refined.target_from_source,
            clamped: consensus.clamped || stopped,
            converged: refined.converged,
            rms: refined.rms,
            counts: Counts {
                source_points: source.full.len(),
                target_points: target.full.len(),
                source_voxels: source.voxels.len(),
                target_voxels: target.voxels.len(),
                matches: matches.len(),
                inliers: consensus.inliers.len(),
                supported: refined.supported,
                iterations: consensus.counts.iterations,
                inconsistent: consensus.counts.inconsistent,
                rejected: consensus.counts.rejected,
                clamped: consensus.counts.clamped,
                icp_iterations: refined.iterations,
                renders: 0,
            },
            inliers: consensus.inliers,
        })
    }

    /// Leaves matches out of what is solved for next.
    pub(crate) fn discard(&mut self, matches: &[usize]) {
        let mut index = 0..;
        self.matches.retain(|_| index.next().is_none_or(|i| matches.binary_search(&i).is_err()));
    }
}

/// The closed form once more, on those inliers whose source point the observation supports. Keeps the
/// consensus as it is where too few are left, or where the new scale would leave the guard.
fn refit_on_supported(
    source: &Side<'_>,
    target: &Side<'_>,
    matches: &[Match],
    consensus: &Consensus,
    settings: &Settings,
) -> Similarity {
    let pose = consensus.target_from_source;
    let support = supported(&source.voxels, &target.voxels, &target.tree, &pose, &settings.support);
    let is_supported = |index: u32| support.binary_search_by_key(&index, |s| s.source).is_ok();
    let kept = consensus.inliers.iter().map(|&i| matches[i]).filter(|m| is_supported(m.source));
    let pairs = kept.map(|m| Pair {
        source: vector3(source.voxels.points[m.source as usize]),
        target: vector3(target.voxels.points[m.target as usize]),
        weight: 1.0,
    });
    let scale_mode = if consensus.clamped { ScaleMode::Fixed(pose.scale) } else { settings.ransac.scale_mode };
    let inside = |s: &Similarity| settings.ransac.guard.is_none_or(|g| (g.min..=g.max).contains(&s.scale));
    umeyama(pairs, scale_mode).ok().filter(inside).unwrap_or(pose)
}

/// ICP on the voxel grid, then on the points themselves.
pub(crate) fn refine_coarse_to_fine(
    source: &Side<'_>,
    target: &Side<'_>,
    initial: &Similarity,
    settings: &Settings,
) -> Refined {
    let Some(metric) = settings.icp else {
        return Refined { target_from_source: *initial, iterations: 0, converged: true, supported: 0, rms: 0.0 };
    };
    let coarse = IcpSettings {
        metric,
        robust: true,
        lock_scale: settings.lock_scale,
        scale_bounds: settings.ransac.guard.map(|g| [g.min, g.max]),
        max_iterations: settings.icp_iterations,
        support: settings.support,
        final_distance: settings.support.max_distance / 3.0,
        tolerance: TOLERANCE,
    };
    let on_grid = refine(&source.voxels, &target.voxels, &target.tree, initial, &coarse);
    let fine =
        IcpSettings { support: SupportSettings { max_distance: coarse.final_distance, ..settings.support }, ..coarse };
    let step = source.full.len().div_ceil(FINE_POINTS).max(1);
    let points = source.full.select((0..source.full.len()).step_by(step));
    let tree = KdTree::new(&target.full.points);
    let on_points = refine(&points, target.full, &tree, &on_grid.target_from_source, &fine);
    Refined { iterations: on_grid.iterations + on_points.iterations, ..on_points }
}
