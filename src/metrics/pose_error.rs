//! Errors of an estimated transform relative to the true pose.

use glam::Vec3;
use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use super::searchable;
use super::surface::Mean;
use super::symmetry::SymmetryGroup;
use crate::error::{Error, ErrorCode, Result};
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::geometry::surface::{SurfaceMoments, sample_surface};
use crate::geometry::triangle_tree::TriangleTree;

/// Number of surface samples for ADD-S.
const SAMPLES: usize = 5000;

/// Errors of an estimate relative to the true pose, up to the symmetry of the object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct PoseErrors {
    /// |s / s_true − 1|, ≥ 0; 0.05 is 5 %.
    pub scale_error: f64,
    /// Angle between the rotations, degrees, 0 to 180; the smallest over the symmetries of the object.
    pub rotation_error_deg: f64,
    /// Distance between the centres of the mesh's bounding box under both transforms, metres. Unlike |t − t_true|, it
    /// does not depend on the origin of the mesh. Uses the symmetry of the rotation error.
    pub translation_error_m: f64,
    /// The translation error relative to the diameter of the object: the diagonal of the mesh's bounding box × the true
    /// scale.
    pub translation_error_relative: f64,
    /// ADD-S, metres: mean distance of surface points under the true pose to the surface under the estimated pose
    /// (Hinterstoisser et al. 2012, §4.2, with the exact surface instead of its points).
    pub add_s_m: f64,
}

/// The errors of `estimate` relative to the true pose `truth`, both camera from mesh. Among the equivalent true poses
/// under the symmetries of the object, the one with the nearest rotation is used.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`] for a mesh without area, and [`ErrorCode::InvalidTransform`] if the distance between the
/// poses overflows f32.
pub fn pose_errors(
    mesh: &Mesh,
    estimate: &Similarity,
    truth: &Similarity,
    symmetry: &SymmetryGroup,
) -> Result<PoseErrors> {
    let samples = sample_surface(mesh, SAMPLES, 0)?.points;
    let relative = UnitQuaternion::from_rotation_matrix(&(truth.rotation.inverse() * estimate.rotation));
    let rotation = symmetry.nearest(&relative);

    // Mesh from mesh: the symmetry rotation about the centroid of the surface.
    let centroid = SurfaceMoments::of(mesh).centroid;
    let center = Vector3::from(centroid.to_array());
    let symmetric =
        Similarity { scale: 1.0, rotation: rotation.to_rotation_matrix(), translation: center - rotation * center };
    let truth = truth.compose(&symmetric);

    let at_centroid = || Bounds { min: centroid.as_vec3(), max: centroid.as_vec3() };
    let bounds = Bounds::of(mesh.positions()).unwrap_or_else(at_centroid);
    let center = vector3(bounds.min).lerp(&vector3(bounds.max), 0.5);
    let translation_error_m = (estimate.apply(center) - truth.apply(center)).norm();
    Ok(PoseErrors {
        scale_error: (estimate.scale / truth.scale - 1.0).abs(),
        rotation_error_deg: truth.rotation_angle_to(estimate).to_degrees(),
        translation_error_m,
        translation_error_relative: translation_error_m / (mesh.diagonal() * truth.scale),
        add_s_m: mean_distance(mesh, &samples, &truth, estimate)?,
    })
}

/// Mean distance of surface points of a mesh under one pose to its surface under another, metres.
fn mean_distance(mesh: &Mesh, samples: &[Vec3], points: &Similarity, surface: &Similarity) -> Result<f64> {
    let mesh_from_camera = surface.inverse();
    let mut distance = Mean::default();
    let query = |i: usize| (vec3(&mesh_from_camera.apply(points.apply(vector3(samples[i])))), None);
    TriangleTree::new(&searchable(mesh)).nearest_of_each(samples.len(), &query, &mut |_, nearest| {
        distance.add(nearest.map_or(f64::INFINITY, |s| f64::from(s.distance_squared).sqrt() * surface.scale));
    });
    distance.value().ok_or_else(|| {
        Error::new(
            ErrorCode::InvalidTransform,
            "transform",
            "a transform too far from the true pose to measure the distance",
            "two transforms in the same scene",
            "Check the units of both: translations are in metres.",
        )
    })
}
