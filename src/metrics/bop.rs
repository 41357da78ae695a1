//! Pose errors of the BOP benchmark (Hodaň et al. 2018, 2020): VSD, MSSD, MSPD, ADD and ADD-S, with the parameters of its
//! challenges since 2019.
//!
//! The definitions, and the points at which the model is drawn for VSD, are those of the official toolkit. Its renderer
//! evaluates depth half a pixel right of and below the pixels' places in the depth map; so does this one. Outlines differ
//! in single pixels, because both snap vertices to a sub-pixel grid of their own. The toolkit skips poses whose bounding
//! spheres are apart and gives them the worst error, which these poses have anyway.

use glam::Vec3;
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

use super::surface::Mean;
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::angle::exp_so3;
use crate::geometry::image::DepthMap;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::mesh::Mesh;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::rasteriser::Rasteriser;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::number::number;

/// δ: a surface at most this far behind the depth map is visible, metres.
pub const VISIBILITY_TOLERANCE_M: f64 = 0.015;

/// Number of misalignment tolerances of VSD.
pub const TAUS: usize = 10;
/// Step of the misalignment tolerances τ of VSD, .05 to .5, relative to the diameter.
pub const TAU_STEP: f64 = 0.05;

/// Largest step of a discretised continuous symmetry: the farthest point moves by this part of the diameter.
const SYMMETRY_STEP: f64 = 0.01;

/// Maximum number of symmetry transformations, far beyond the 315 of an axis of revolution.
const MAX_SYMMETRIES: usize = 100_000;

/// A symmetry of a model: model from model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelSymmetry {
    /// The rotation.
    pub rotation: Matrix3<f64>,
    /// The translation, in the unit of the model.
    pub translation: Vector3<f64>,
}

impl ModelSymmetry {
    /// A symmetry from 4 × 4 numbers, row by row, as in `models_info.json`; the last row is not read.
    pub fn from_rows(m: &[f64; 16]) -> Self {
        Self {
            rotation: Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]),
            translation: Vector3::new(m[3], m[7], m[11]),
        }
    }
}

/// An axis of revolution of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RevolutionAxis {
    /// Direction, of any length above 0.
    pub axis: Vector3<f64>,
    /// A point on the axis, in the unit of the model.
    pub offset: Vector3<f64>,
}

impl RevolutionAxis {
    /// An axis from its direction and a point on it.
    pub fn from_numbers(n: &[f64; 6]) -> Self {
        Self { axis: Vector3::new(n[0], n[1], n[2]), offset: Vector3::new(n[3], n[4], n[5]) }
    }
}

/// The symmetry transformations of a model: the identity and the discrete ones, each followed by the turns about the axes
/// of revolution, which are discretised in steps of a hundredth of the diameter, as in BOP.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] for numbers that are not finite, an axis of length 0, and too many symmetries.
pub fn symmetry_transformations(
    discrete: &[ModelSymmetry],
    continuous: &[RevolutionAxis],
) -> Result<Vec<ModelSymmetry>> {
    let invalid = |found: String, expected: &str| {
        let remedy = "Check the symmetries of the model in models_info.json.";
        Error::new(ErrorCode::InvalidArgument, "symmetries", found, expected.to_owned(), remedy)
    };
    let identity = ModelSymmetry { rotation: Matrix3::identity(), translation: Vector3::zeros() };
    let steps = (core::f64::consts::PI / SYMMETRY_STEP).ceil() as usize;
    let mut turns = Vec::new();
    let count = discrete.len().saturating_add(1).saturating_mul(continuous.len().max(1).saturating_mul(steps));
    if count > MAX_SYMMETRIES {
        return Err(invalid(format!("{} symmetries", discrete.len() + continuous.len()), "a few symmetries"));
    }
    for RevolutionAxis { axis, offset } in continuous {
        let Some(axis) = axis.try_normalize(1e-12).filter(|a| a.iter().chain(offset).all(|x| x.is_finite())) else {
            return Err(invalid("an axis without direction".into(), "a direction other than 0"));
        };
        turns.extend((0..steps).map(|i| {
            let angle = core::f64::consts::TAU * i as f64 / steps as f64;
            let rotation = *exp_so3(axis * angle).to_rotation_matrix().matrix();
            ModelSymmetry { rotation, translation: offset - rotation * offset }
        }));
    }
    let mut all = Vec::with_capacity((discrete.len() + 1) * turns.len().max(1));
    for inner in core::iter::once(&identity).chain(discrete) {
        if !inner.rotation.iter().chain(&inner.translation).all(|x| x.is_finite()) {
            return Err(invalid("a number that is not finite".into(), "4 × 4 finite numbers"));
        }
        if turns.is_empty() {
            all.push(*inner);
        }
        all.extend(turns.iter().map(|turn| ModelSymmetry {
            rotation: turn.rotation * inner.rotation,
            translation: turn.rotation * inner.translation + turn.translation,
        }));
    }
    Ok(all)
}

/// A model with what its errors are measured by.
#[derive(Debug, Clone, Copy)]
pub struct BopModel<'a> {
    /// The mesh, in its own unit.
    pub mesh: &'a Mesh,
    /// The diameter, metres, by which distances of VSD are divided.
    pub diameter_m: f64,
    /// See [`symmetry_transformations`].
    pub symmetries: &'a [ModelSymmetry],
}

/// Errors of an estimated pose relative to a true one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct BopErrors {
    /// Visible Surface Discrepancy, 0 to 1, for each misalignment tolerance: .05, .1 … .5 of the diameter.
    pub vsd: [f64; TAUS],
    /// Maximum Symmetry-Aware Surface Distance, metres.
    pub mssd_m: f64,
    /// Maximum Symmetry-Aware Projection Distance, pixels; `null` if a vertex is not in front of the camera.
    pub mspd_px: Option<f64>,
    /// ADD: mean distance between the same vertices under both poses, metres.
    pub add_m: f64,
    /// ADD-S, also called ADI: mean distance from the vertices under the true pose to the nearest vertices under the
    /// estimated pose, metres.
    pub add_s_m: f64,
}

/// The errors of each estimate relative to each true pose, estimate by estimate. All poses are camera from model, in
/// metres: those of BOP have a scale of .001.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] for a diameter that is not a finite number above 0, [`ErrorCode::DegenerateMesh`] for a
/// model without vertices.
pub fn bop_errors(
    model: &BopModel<'_>,
    depth: &DepthMap,
    camera: &Pinhole,
    estimates: &[Similarity],
    truths: &[Similarity],
) -> Result<Vec<BopErrors>> {
    if !(model.diameter_m.is_finite() && model.diameter_m > 0.0) {
        let found = number(model.diameter_m);
        let remedy = "Pass the diameter in models_info.json, in metres.";
        return Err(Error::new(ErrorCode::InvalidArgument, "diameterM", found, "a finite number above 0", remedy));
    }
    let points: Vec<Vector3<f64>> = model.mesh.positions().iter().map(|p| vector3(*p)).collect();
    if points.is_empty() {
        let remedy = "Pass the model of the object.";
        return Err(Error::new(ErrorCode::DegenerateMesh, "mesh", "no vertices", "a mesh with vertices", remedy));
    }
    let tree = KdTree::new(model.mesh.positions());
    let scene = Distances::of_depth(depth, camera);
    let mut rasteriser = Rasteriser::new();
    let mut draw = |poses: &[Similarity]| -> Vec<Distances> {
        poses.iter().map(|pose| Distances::of_model(model.mesh, pose, camera, depth, &mut rasteriser)).collect()
    };
    let (drawn_estimates, drawn_truths) = (draw(estimates), draw(truths));
    let mut errors = Vec::with_capacity(estimates.len() * truths.len());
    for (estimate, drawn_estimate) in estimates.iter().zip(&drawn_estimates) {
        for (truth, drawn_truth) in truths.iter().zip(&drawn_truths) {
            let pair = Pair { points: &points, estimate, truth };
            errors.push(BopErrors {
                vsd: vsd(&scene, drawn_estimate, drawn_truth, model.diameter_m),
                mssd_m: pair.mssd(model.symmetries),
                mspd_px: Some(pair.mspd(model.symmetries, camera)).filter(|px| px.is_finite()),
                add_m: pair.add(),
                add_s_m: pair.add_s(&tree),
            });
        }
    }
    Ok(errors)
}

/// Two poses of the vertices of a model.
struct Pair<'a> {
    points: &'a [Vector3<f64>],
    estimate: &'a Similarity,
    truth: &'a Similarity,
}

impl Pair<'_> {
    fn mssd(&self, symmetries: &[ModelSymmetry]) -> f64 {
        let estimated: Vec<_> = self.points.iter().map(|p| self.estimate.apply(*p)).collect();
        self.least_maximum(symmetries, |i, truth| (estimated[i] - truth).norm_squared())
    }

    fn mspd(&self, symmetries: &[ModelSymmetry], camera: &Pinhole) -> f64 {
        let project = |p: Vector3<f64>| {
            // Behind the camera is nowhere.
            let z = if p.z > 0.0 { p.z } else { f64::NAN };
            [camera.fx * p.x / z + camera.cx, camera.fy * p.y / z + camera.cy]
        };
        let estimated: Vec<_> = self.points.iter().map(|p| project(self.estimate.apply(*p))).collect();
        self.least_maximum(symmetries, |i, truth| {
            let ([u, v], [x, y]) = (estimated[i], project(truth));
            let squared = (u - x) * (u - x) + (v - y) * (v - y);
            if squared.is_nan() { f64::INFINITY } else { squared }
        })
    }

    /// The root of the smallest, over the symmetries, of the largest value over the vertices. `value` gets the index of a
    /// vertex and its place under the true pose.
    fn least_maximum(&self, symmetries: &[ModelSymmetry], value: impl Fn(usize, Vector3<f64>) -> f64) -> f64 {
        let mut least = f64::INFINITY;
        // The vertex that ended the last symmetry is likely to end the next one as well.
        let mut first = 0;
        for ModelSymmetry { rotation, translation } in symmetries {
            let at = |i: usize| value(i, self.truth.apply(rotation * self.points[i] + translation));
            let mut largest = at(first);
            for i in 0..self.points.len() {
                if largest >= least {
                    break;
                }
                let found = at(i);
                if found > largest {
                    (largest, first) = (found, i);
                }
            }
            least = least.min(largest);
        }
        least.sqrt()
    }

    fn add(&self) -> f64 {
        let mut mean = Mean::default();
        for p in self.points {
            mean.add((self.estimate.apply(*p) - self.truth.apply(*p)).norm());
        }
        mean.value().unwrap_or(f64::MAX)
    }

    fn add_s(&self, tree: &KdTree) -> f64 {
        // In the frame of the model, where the estimate's vertices do not move.
        let model_from_camera = self.estimate.inverse();
        let mut mean = Mean::default();
        for p in self.points {
            let query: Vec3 = vec3(&model_from_camera.apply(self.truth.apply(*p)));
            let distance = tree.nearest(query).map_or(f64::INFINITY, |n| f64::from(n.distance_squared).sqrt());
            mean.add(distance * self.estimate.scale);
        }
        mean.value().unwrap_or(f64::MAX)
    }
}

/// Distances from the camera's centre, metres, row-major; 0 is nothing.
struct Distances(Vec<f32>);

impl Distances {
    fn of_depth(depth: &DepthMap, camera: &Pinhole) -> Self {
        Self::along_rays(depth.data(), depth.width(), camera)
    }

    fn of_model(
        mesh: &Mesh,
        pose: &Similarity,
        camera: &Pinhole,
        depth: &DepthMap,
        rasteriser: &mut Rasteriser,
    ) -> Self {
        // The places where the toolkit's renderer evaluates depth.
        let sampled = Pinhole { cx: camera.cx - 0.5, cy: camera.cy - 0.5, ..*camera };
        rasteriser.render(mesh, pose, &sampled, depth.width(), depth.height());
        Self::along_rays(rasteriser.depth(), depth.width(), camera)
    }

    fn along_rays(depth: &[f32], width: usize, camera: &Pinhole) -> Self {
        let distance = |(i, z): (usize, &f32)| {
            let (x, y) = ((i % width) as f64 - camera.cx, (i / width) as f64 - camera.cy);
            let (x, y) = (x / camera.fx, y / camera.fy);
            (f64::from(*z) * (x * x + y * y + 1.0).sqrt()) as f32
        };
        Self(depth.iter().enumerate().map(distance).collect())
    }
}

/// Visible Surface Discrepancy, with the step cost. A missing reading hides nothing.
fn vsd(scene: &Distances, estimate: &Distances, truth: &Distances, diameter_m: f64) -> [f64; TAUS] {
    let is_visible =
        |model: f32, scene: f32| model > 0.0 && (scene == 0.0 || f64::from(model - scene) <= VISIBILITY_TOLERANCE_M);
    let (mut union, mut costs) = (0u64, [0u64; TAUS]);
    for ((&scene, &estimate), &truth) in scene.0.iter().zip(&estimate.0).zip(&truth.0) {
        let in_truth = is_visible(truth, scene);
        let in_estimate = is_visible(estimate, scene) || (in_truth && estimate > 0.0);
        if !(in_truth || in_estimate) {
            continue;
        }
        union += 1;
        let distance = f64::from((truth - estimate).abs()) / diameter_m;
        for (i, cost) in costs.iter_mut().enumerate() {
            let tau = TAU_STEP * (i + 1) as f64;
            *cost += u64::from(!(in_truth && in_estimate) || distance >= tau);
        }
    }
    costs.map(|cost| if union == 0 { 1.0 } else { cost as f64 / union as f64 })
}
