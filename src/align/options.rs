//! Options of the entry points: flat, each with a default that follows the data, each with its range checked.

use serde::Serialize;

use super::combination;
use super::field::{Field, Options, choice};
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::Symmetry;
use crate::number::{number, numbers};

/// The largest confidence: a certainty of 1 would never stop early.
const MAX_CONFIDENCE: f64 = 0.999_999;

/// Which method runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Search by rendering: the pose whose picture explains mask, free space and depth best.
    #[default]
    Precise,
    /// The paper's method: FPFH, guarded Sim(3) RANSAC, hallucination filtering, scale-locked ICP.
    Paper,
}

choice!(Preset { Precise: "precise", Paper: "paper" });
choice!(Quality { Fast: "fast", Balanced: "balanced", Best: "best" });
choice!(SearchScope { Global: "global", Local: "local" });
choice!(ExtentAxis { Longest: "longest", X: "x", Y: "y", Z: "z" });
choice!(GuardMode { Reject: "reject", Clamp: "clamp" });
choice!(Icp { PointToPlane: "point-to-plane", PointToPoint: "point-to-point", None: "none" });

/// What RANSAC does with a hypothesis whose scale leaves the guard.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "kebab-case"))]
pub enum GuardMode {
    /// Drops it.
    #[default]
    Reject,
    /// Projects its scale to the nearer bound and counts it.
    Clamp,
}

/// What ICP minimises.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "kebab-case"))]
pub enum Icp {
    /// Distance to the tangent plane at the nearest observed point.
    #[default]
    PointToPlane,
    /// Distance to the nearest observed point.
    PointToPoint,
    /// No refinement: the RANSAC pose as it is.
    None,
}

/// How much work `precise` puts in.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "kebab-case"))]
pub enum Quality {
    /// Fewer rotations, fewer candidates: about a third of the time.
    Fast,
    /// What most callers want.
    #[default]
    Balanced,
    /// More of everything, and the paper's own pose among the candidates: about four times the time.
    Best,
}

/// Where `precise` searches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "kebab-case"))]
pub enum SearchScope {
    /// All rotations; an initial pose is one candidate more.
    #[default]
    Global,
    /// The neighbourhood of the initial pose.
    Local,
}

/// Which side of the mesh's box a known length is that of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "kebab-case"))]
pub enum ExtentAxis {
    /// The longest one.
    #[default]
    Longest,
    /// That along the mesh's x axis.
    X,
    /// That along the mesh's y axis.
    Y,
    /// That along the mesh's z axis.
    Z,
}

/// Options of `align`. All have defaults; most callers need none.
///
/// An option whose documentation begins with the name of a preset has no effect under the other one.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "camelCase"))]
pub struct AlignOptions {
    /// The method. Default `"precise"`.
    pub preset: Preset,
    /// `precise`: how much work. Default `"balanced"`.
    pub quality: Quality,
    /// `precise`: what is known of the scale, in metres per mesh unit, above 0: a number fixes it (1 for a mesh that
    /// is in metres), `[min, max]` or `{ min, max }` bounds it, `null` leaves it free. Not together with
    /// `knownExtentM`. Default `null`.
    #[cfg_attr(feature = "types", ts(type = "ScaleBounds | null"))]
    pub scale: Option<[f64; 2]>,
    /// `precise`: the length of the object along `knownExtentAxis`, in metres, above 0, which fixes the scale: for
    /// "this mug is 9.5 cm tall" and a mesh whose y axis is up, `{ knownExtentM: 0.095, knownExtentAxis: "y" }`. `null`
    /// where it is not known. Default `null`.
    pub known_extent_m: Option<f64>,
    /// `precise`: the side of the mesh's box that `knownExtentM` is the length of. Default `"longest"`.
    pub known_extent_axis: ExtentAxis,
    /// `precise`: the direction that is up, against gravity, in the camera's frame (OpenCV: y is down), of any length
    /// above 0: `[0, -1, 0]` for a level camera. Together with `meshUp`, it favours poses in which the object stands
    /// upright. Default `null`.
    #[cfg_attr(feature = "types", ts(type = "Direction | null"))]
    pub camera_up: Option<[f64; 3]>,
    /// `precise`: the direction that is up in the mesh's frame, of any length above 0: `[0, 1, 0]` for glTF. It belongs
    /// to `cameraUp`. Default `null`.
    #[cfg_attr(feature = "types", ts(type = "Direction | null"))]
    pub mesh_up: Option<[f64; 3]>,
    /// `precise`: the turns under which the object looks the same, so that no pose is listed among the alternatives
    /// that only repeats another one. `"auto"` finds the half turns about the principal axes that the mesh itself shows,
    /// `"auto-revolution"` those axes about which it can be turned by any angle, too; `[{ axis: [0, 1, 0], fold: 4 }]`
    /// declares a quarter turn about the mesh's y axis, without `fold` any turn about it. Default `"auto"`.
    #[cfg_attr(feature = "types", ts(type = "SymmetryOption"))]
    pub symmetry: Symmetry,
    /// `precise`: a pose to start from, camera from mesh, in metres, such as the generator's own or an annotator's:
    /// whatever `evaluate` takes as a transform, or `null`. Its scale has to be within `scale`. Default `null`.
    #[cfg_attr(feature = "types", ts(type = "Sim3Like | null"))]
    pub initial: Option<Similarity>,
    /// `precise`: where to search: everywhere, or around `initial` only, which it then needs. Default `"global"`.
    pub search: SearchScope,
    /// `precise`: a bound on the work of the search, above 0, in milliseconds of a machine of 2020; the work is
    /// counted, not timed, so that the result does not depend on the machine. `null` leaves it to `quality`. Default
    /// `null`.
    pub budget_ms: Option<f64>,
    /// Seed of all random draws, 0 to 2³² − 1. The same input and seed give the same bits. Default 0.
    pub seed: u32,
    /// Depth readings inside the mask that are used at most, 32 to 1 000 000; of more, an even random share is
    /// drawn. `precise` uses them for metrics and initial scale alone. Default 20 000.
    pub max_observed_points: u32,
    /// Points sampled from the mesh surface, 100 to 1 000 000. `precise` uses them for metrics and initial scale alone.
    /// Default 20 000.
    pub surface_samples: u32,
    /// `paper`: voxels along the observation's box diagonal, 5 to 200: the voxel size is the diagonal divided by this
    /// (paper: 20, 30, 50). Default 30.
    pub voxel_divisions: f64,
    /// `paper`: radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
    pub fpfh_radius_voxels: f64,
    /// `paper`: bounds [λmin, λmax] of the scale relative to the initial scale, 0 < λmin ≤ 1 ≤ λmax; `null` lets the
    /// scale go anywhere (the ablation). Default [0.5, 1.5].
    pub guard: Option<[f64; 2]>,
    /// `paper`: what happens to hypotheses outside the guard. Default `"reject"`.
    pub guard_mode: GuardMode,
    /// `paper`: minimal sets that RANSAC draws at most, 1 to 10 000 000. Default 100 000.
    pub ransac_iterations: u32,
    /// `paper`: RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999.
    /// Default 0.999.
    pub ransac_confidence: f64,
    /// `paper`: a match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
    pub inlier_distance_voxels: f64,
    /// `paper`: how alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
    /// Default 0.9.
    pub edge_similarity: f64,
    /// `paper`: whether mesh regions that the observation does not support are left out. Default `true`.
    pub hallucination_filter: bool,
    /// `paper`: support: largest distance to an observed point, in voxels, 0.1 to 50; ICP tightens it to a third as
    /// the pose improves. Default 3.
    pub support_distance_voxels: f64,
    /// `paper`: support: largest angle between the two normals, in degrees, 0 to 180. Default 60.
    pub support_angle_deg: f64,
    /// `paper`: the refinement. Default `"point-to-plane"`.
    pub icp: Icp,
    /// Whether the refinement leaves the scale alone. Under `paper` it stays as RANSAC found it (§3.3; `false` is the
    /// ablation); under `precise` it stays that of `initial` or, without it, as the grid of rotations found it. `null`
    /// is `true` for `paper` and `false` for `precise`. Default `null`.
    pub lock_scale: Option<bool>,
    /// `paper`: ICP iterations at most, 1 to 1 000. Default 60.
    pub icp_iterations: u32,
}

impl Default for AlignOptions {
    fn default() -> Self {
        Self {
            preset: Preset::Precise,
            quality: Quality::Balanced,
            scale: None,
            known_extent_m: None,
            known_extent_axis: ExtentAxis::Longest,
            camera_up: None,
            mesh_up: None,
            symmetry: Symmetry::Auto,
            initial: None,
            search: SearchScope::Global,
            budget_ms: None,
            seed: 0,
            max_observed_points: 20_000,
            surface_samples: 20_000,
            voxel_divisions: 30.0,
            fpfh_radius_voxels: 5.0,
            guard: Some([0.5, 1.5]),
            guard_mode: GuardMode::Reject,
            ransac_iterations: 100_000,
            ransac_confidence: 0.999,
            inlier_distance_voxels: 1.5,
            edge_similarity: 0.9,
            hallucination_filter: true,
            support_distance_voxels: 3.0,
            support_angle_deg: 60.0,
            icp: Icp::PointToPlane,
            lock_scale: None,
            icp_iterations: 60,
        }
    }
}

impl Options for AlignOptions {
    fn fields(&mut self) -> Vec<(&'static str, Field<'_>)> {
        vec![
            ("preset", Field::Choice(&mut self.preset)),
            ("quality", Field::Choice(&mut self.quality)),
            ("scale", Field::Bounds(&mut self.scale)),
            ("knownExtentM", Field::Positive(&mut self.known_extent_m)),
            ("knownExtentAxis", Field::Choice(&mut self.known_extent_axis)),
            ("cameraUp", Field::Direction(&mut self.camera_up)),
            ("meshUp", Field::Direction(&mut self.mesh_up)),
            ("symmetry", Field::Symmetry(&mut self.symmetry)),
            ("initial", Field::Transform(&mut self.initial)),
            ("search", Field::Choice(&mut self.search)),
            ("budgetMs", Field::Positive(&mut self.budget_ms)),
            ("seed", Field::count(&mut self.seed, 0, u32::MAX)),
            ("maxObservedPoints", Field::count(&mut self.max_observed_points, 32, 1_000_000)),
            ("surfaceSamples", Field::count(&mut self.surface_samples, 100, 1_000_000)),
            ("voxelDivisions", Field::number(&mut self.voxel_divisions, 5.0, 200.0)),
            ("fpfhRadiusVoxels", Field::number(&mut self.fpfh_radius_voxels, 1.0, 20.0)),
            ("guard", Field::Guard(&mut self.guard)),
            ("guardMode", Field::Choice(&mut self.guard_mode)),
            ("ransacIterations", Field::count(&mut self.ransac_iterations, 1, 10_000_000)),
            ("ransacConfidence", Field::number(&mut self.ransac_confidence, 0.0, MAX_CONFIDENCE)),
            ("inlierDistanceVoxels", Field::number(&mut self.inlier_distance_voxels, 0.1, 20.0)),
            ("edgeSimilarity", Field::number(&mut self.edge_similarity, 0.0, 1.0)),
            ("hallucinationFilter", Field::Flag(&mut self.hallucination_filter)),
            ("supportDistanceVoxels", Field::number(&mut self.support_distance_voxels, 0.1, 50.0)),
            ("supportAngleDeg", Field::number(&mut self.support_angle_deg, 0.0, 180.0)),
            ("icp", Field::Choice(&mut self.icp)),
            ("lockScale", Field::Switch(&mut self.lock_scale)),
            ("icpIterations", Field::count(&mut self.icp_iterations, 1, 1_000)),
        ]
    }

    fn check_combination(&self) -> Result<()> {
        combination::check(self)
    }
}

/// What `register` and `estimateSim3` may do with the scale, in target units per source unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ScaleOption {
    /// Solved for, within the guard around the ratio of the clouds' boxes.
    Free,
    /// Known.
    Fixed(f64),
    /// Solved for, within these bounds.
    Between([f64; 2]),
}

impl ScaleOption {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn validate(&self) -> Result<()> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let found = match *self {
            Self::Free => return Ok(()),
            Self::Fixed(scale) if positive(scale) => return Ok(()),
            Self::Between([min, max]) if positive(min) && positive(max) && min <= max => return Ok(()),
            Self::Fixed(scale) => number(scale),
            Self::Between([min, max]) => numbers(&[min, max]),
        };
        Err(Error::new(
            ErrorCode::InvalidOption,
            "options.scale",
            found,
            "\"free\", \"fixed\" (1), a number above 0, or [min, max] with 0 < min ≤ max",
            "The scale is in target units per source unit.",
        ))
    }
}

/// Options of `register`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "camelCase"))]
pub struct RegisterOptions {
    /// Seed of all random draws, 0 to 2³² − 1. Default 0.
    pub seed: u32,
    /// Points of each cloud that are used at most, 32 to 1 000 000: of more, a random share or, with a fixed scale, the
    /// means of small voxels. Default 20 000.
    pub max_points: u32,
    /// Voxel size in target units, above 0; `null` derives it from `voxelDivisions`. Default `null`.
    pub voxel_size: Option<f64>,
    /// Voxels along the target's box diagonal, 5 to 200; `null` takes 30 or, with a fixed scale, a voxel that leaves
    /// 5000 points of the larger cloud. Default `null`.
    pub voxel_divisions: Option<f64>,
    /// Radius of the FPFH descriptors, in voxels, 1 to 20. Default 5.
    pub fpfh_radius_voxels: f64,
    /// Minimal sets that RANSAC draws at most, 1 to 10 000 000; with a fixed scale, which needs no draws, at most so
    /// many poses are tried, and no more than 100. Default 100 000.
    pub ransac_iterations: u32,
    /// RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999; without effect where the
    /// scale is fixed. Default 0.999.
    pub ransac_confidence: f64,
    /// A match within this distance of its counterpart is an inlier, in voxels, 0.1 to 20. Default 1.5.
    pub inlier_distance_voxels: f64,
    /// How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1;
    /// without effect where the scale is fixed. Default 0.9.
    pub edge_similarity: f64,
    /// The refinement. Default `"point-to-plane"`.
    pub icp: Icp,
    /// ICP iterations at most, 1 to 1 000. Default 60.
    pub icp_iterations: u32,
}

impl Default for RegisterOptions {
    fn default() -> Self {
        let align = AlignOptions::default();
        Self {
            seed: align.seed,
            max_points: align.max_observed_points,
            voxel_size: None,
            voxel_divisions: None,
            fpfh_radius_voxels: align.fpfh_radius_voxels,
            ransac_iterations: align.ransac_iterations,
            ransac_confidence: align.ransac_confidence,
            inlier_distance_voxels: align.inlier_distance_voxels,
            edge_similarity: align.edge_similarity,
            icp: align.icp,
            icp_iterations: align.icp_iterations,
        }
    }
}

impl Options for RegisterOptions {
    fn fields(&mut self) -> Vec<(&'static str, Field<'_>)> {
        vec![
            ("seed", Field::count(&mut self.seed, 0, u32::MAX)),
            ("maxPoints", Field::count(&mut self.max_points, 32, 1_000_000)),
            ("voxelSize", Field::Positive(&mut self.voxel_size)),
            ("voxelDivisions", Field::Positive(&mut self.voxel_divisions)),
            ("fpfhRadiusVoxels", Field::number(&mut self.fpfh_radius_voxels, 1.0, 20.0)),
            ("ransacIterations", Field::count(&mut self.ransac_iterations, 1, 10_000_000)),
            ("ransacConfidence", Field::number(&mut self.ransac_confidence, 0.0, MAX_CONFIDENCE)),
            ("inlierDistanceVoxels", Field::number(&mut self.inlier_distance_voxels, 0.1, 20.0)),
            ("edgeSimilarity", Field::number(&mut self.edge_similarity, 0.0, 1.0)),
            ("icp", Field::Choice(&mut self.icp)),
            ("icpIterations", Field::count(&mut self.icp_iterations, 1, 1_000)),
        ]
    }

    fn check_combination(&self) -> Result<()> {
        self.voxel_divisions.map_or(Ok(()), |mut given| Field::number(&mut given, 5.0, 200.0).check("voxelDivisions"))
    }
}

/// Options of `estimateSim3`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename_all = "camelCase"))]
pub struct EstimateOptions {
    /// Seed of all random draws, 0 to 2³² − 1. Default 0.
    pub seed: u32,
    /// A correspondence whose source lands within this of its target is an inlier, in target units, above 0;
    /// `null` takes a twentieth of the target's box diagonal. Default `null`.
    pub inlier_distance: Option<f64>,
    /// Minimal sets that RANSAC draws at most, 1 to 10 000 000. Default 100 000.
    pub ransac_iterations: u32,
    /// RANSAC stops early at this probability of having missed nothing better, 0 to 0.999999.
    /// Default 0.999.
    pub ransac_confidence: f64,
    /// How alike the three edges of a minimal set must be stretched: least over most stretched, 0 to 1.
    /// Default 0.9.
    pub edge_similarity: f64,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        let align = AlignOptions::default();
        Self {
            seed: align.seed,
            inlier_distance: None,
            ransac_iterations: align.ransac_iterations,
            ransac_confidence: align.ransac_confidence,
            edge_similarity: align.edge_similarity,
        }
    }
}

impl Options for EstimateOptions {
    fn fields(&mut self) -> Vec<(&'static str, Field<'_>)> {
        vec![
            ("seed", Field::count(&mut self.seed, 0, u32::MAX)),
            ("inlierDistance", Field::Positive(&mut self.inlier_distance)),
            ("ransacIterations", Field::count(&mut self.ransac_iterations, 1, 10_000_000)),
            ("ransacConfidence", Field::number(&mut self.ransac_confidence, 0.0, MAX_CONFIDENCE)),
            ("edgeSimilarity", Field::number(&mut self.edge_similarity, 0.0, 1.0)),
        ]
    }
}
