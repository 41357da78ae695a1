//! Errors of layout: how well a posed object occupies the place of the true one. These are the metrics of single-image
//! reconstruction of scenes, and of the alignment of CAD models.

use glam::Vec3;
use nalgebra::Vector3;
use serde::Serialize;

use super::oriented_box::OrientedBox;
use super::pose_error::{PoseComparison, PoseErrors};
use crate::error::Result;
use crate::geometry::angle::exp_so3;
use crate::geometry::normal_equations::{NormalEquations, PARAMETERS};
use crate::geometry::similarity::{Similarity, vec3, vector3};

/// ADD-S relative to the diameter below which an object counts as found: ADD-S@0.1.
const ADD_S_TOLERANCE: f64 = 0.1;

/// Largest translation error of an aligned CAD model, metres.
const CAD_TRANSLATION_M: f64 = 0.2;
/// Largest rotation error of an aligned CAD model, degrees.
const CAD_ROTATION_DEG: f64 = 20.0;
/// Largest scale error of an aligned CAD model.
const CAD_SCALE: f64 = 0.2;

/// Every n-th sample takes part in ICP.
const ICP_STRIDE: usize = 8;
/// Limit on the iterations of ICP; near a minimum, 10 to 40 are usual.
const ICP_ITERATIONS: usize = 100;
/// Limit on the triangles and nodes of the surface that ICP visits, more than five times those of any object. Only
/// triangles that all overlap reach it.
const ICP_VISITS: usize = 1 << 25;
/// ICP has converged if no iteration moves the object by more than this part of its diameter.
const ICP_TOLERANCE: f64 = 1e-5;
/// Damping of the steps, which leaves directions alone that nothing constrains.
const ICP_DAMPING: f64 = 1e-9;

/// Errors of layout of an estimate relative to the true pose, up to the symmetry of the object as the pose errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct LayoutErrors {
    /// 3D IoU: volume of the intersection over volume of the union of the mesh's bounding box under both transforms, 0 to
    /// 1, higher is better. The boxes are in the axes of the mesh, and the volumes are exact.
    pub box_iou: f64,
    /// ICP-Rot (SAM 3D Objects 2025), degrees, 0 to 180: the rotation that ICP (Besl and McKay 1992, rigid,
    /// point-to-point) needs to bring the surface under the estimated pose onto that under the true one. Half turns of
    /// shapes that look alike afterwards do not count, whether they are declared as symmetries or not.
    pub icp_rotation_deg: f64,
    /// ADD-S in both directions, relative to the diameter (SAM 3D Objects 2025): the mean of both mean distances from the
    /// surface under one pose to that under the other, divided by the largest distance between two points of the true
    /// object.
    pub add_s_relative: f64,
    /// Whether `addSRelative` is below 0.1; ADD-S@0.1 is the share of such objects.
    pub is_found: bool,
    /// Whether a CAD model counts as aligned (Scan2CAD, Avetisyan et al. 2019): translation within 20 cm, rotation within
    /// 20°, scale within 20 %.
    pub is_cad_aligned: bool,
}

impl LayoutErrors {
    /// The errors of a comparison whose pose errors are known.
    ///
    /// # Errors
    /// As [`PoseComparison::errors`].
    pub fn of(comparison: &PoseComparison, errors: &PoseErrors) -> Result<Self> {
        let PoseComparison { estimate, truth, bounds, samples, .. } = comparison;
        let box_of = |pose| OrientedBox::of(bounds, pose);
        let back = comparison.mean_distance(estimate, truth)?;
        let diameter = diameter(samples);
        let add_s_relative = 0.5 * (errors.add_s_m + back) / (diameter * truth.scale);
        Ok(Self {
            box_iou: box_of(estimate).iou(&box_of(truth)),
            icp_rotation_deg: icp_rotation(comparison, diameter).to_degrees(),
            add_s_relative,
            is_found: add_s_relative < ADD_S_TOLERANCE,
            is_cad_aligned: errors.translation_error_m <= CAD_TRANSLATION_M
                && errors.rotation_error_deg <= CAD_ROTATION_DEG
                && errors.scale_error <= CAD_SCALE,
        })
    }
}

/// The largest distance between two of the points.
fn diameter(points: &[Vec3]) -> f64 {
    let mut squared = 0.0f32;
    for (i, a) in points.iter().enumerate() {
        for b in &points[i + 1..] {
            squared = squared.max(a.distance_squared(*b));
        }
    }
    f64::from(squared).sqrt()
}

/// The angle, in radians, by which ICP turns the surface under the estimate. `diameter` is that of the mesh.
///
/// In the frame of the true mesh, where the exact nearest points of its surface are found. Each step is that of Gauss and
/// Newton for the sum of squared distances between corresponding points, in a small rotation and a translation.
fn icp_rotation(comparison: &PoseComparison, diameter: f64) -> f64 {
    let start = comparison.truth.inverse().compose(&comparison.estimate);
    let mut moved = start;
    let mut turn = Similarity::identity();
    let points: Vec<Vector3<f64>> = comparison.samples.iter().step_by(ICP_STRIDE).map(|p| vector3(*p)).collect();
    let mut visits = 0;
    for _ in 0..ICP_ITERATIONS {
        if visits > ICP_VISITS {
            break;
        }
        let landed: Vec<Vector3<f64>> = points.iter().map(|p| moved.apply(*p)).collect();
        let middle = landed.iter().sum::<Vector3<f64>>() / landed.len() as f64;
        let mut equations = NormalEquations::new();
        visits += comparison.tree.nearest_of_each(landed.len(), &|i| (vec3(&landed[i]), None), &mut |i, nearest| {
            let Some(nearest) = nearest else { return };
            // In units of the diameter about the middle, so that rotation and translation are of one size.
            let arm = (landed[i] - middle) / diameter;
            let off = (landed[i] - vector3(nearest.point)) / diameter;
            for k in 0..3 {
                let axis = Vector3::ith(k, 1.0);
                let lever = arm.cross(&axis);
                let mut jacobian = [0.0; PARAMETERS];
                jacobian[..3].copy_from_slice(lever.as_slice());
                jacobian[3 + k] = 1.0;
                equations.add(&jacobian, off[k], 1.0);
            }
        });
        let Some([a, b, c, x, y, z, _]) = equations.solve(ICP_DAMPING) else { break };
        let rotation = exp_so3(Vector3::new(a, b, c)).to_rotation_matrix();
        let shift = Vector3::new(x, y, z) * diameter;
        let step = Similarity { scale: 1.0, rotation, translation: middle + shift - rotation * middle };
        moved = step.compose(&moved);
        turn = step.compose(&turn);
        if Vector3::new(a, b, c).norm() + Vector3::new(x, y, z).norm() < ICP_TOLERANCE {
            break;
        }
    }
    Similarity::identity().rotation_angle_to(&turn)
}
