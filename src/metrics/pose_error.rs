//! Errors of an estimated transform against the known truth.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use super::surface::Mean;
use super::symmetry::{Symmetry, mesh_diagonal};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::sample::{SurfaceMoments, sample_surface};
use crate::geometry::cloud::Bounds;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::{Similarity, vec3, vector3};
use crate::geometry::triangle_tree::{Hint, TriangleTree};

/// Surface points over which ADD-S is averaged.
const SAMPLES: usize = 5000;

/// How far an estimate is from the truth, up to the object's symmetry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
pub struct PoseErrors {
    /// |s / s_true − 1|, ≥ 0; 0.05 is 5 %.
    pub scale_error: f64,
    /// Angle between the rotations, degrees, 0 to 180; the smallest over the object's symmetries.
    pub rotation_error_deg: f64,
    /// Distance between where the two transforms put the middle of the mesh's box, metres. Not |t − t_true|: t is
    /// where the mesh's origin goes, which may lie anywhere. Under the symmetry of the rotation error.
    pub translation_error_m: f64,
    /// The same as a share of the object's diameter: the mesh's box diagonal × the true scale.
    pub translation_error_relative: f64,
    /// ADD-S, millimetres: mean distance of the truly posed surface's points to the estimated surface (Hinterstoisser
    /// et al. 2012, §4.2, with the exact surface in place of its points).
    pub add_s_mm: f64,
}

/// The errors of `estimate` against `truth`, both camera from mesh.
///
/// A truth turned by a symmetry of the object is as true. Of all such, the one nearest to the estimate in rotation
/// is compared.
///
/// # Errors
/// [`ErrorCode::DegenerateMesh`] for a mesh without area, [`ErrorCode::InvalidTransform`] where the two are so far
/// apart that f32 does not reach, and those of [`Symmetry::group`].
pub fn pose_errors(mesh: &Mesh, estimate: &Similarity, truth: &Similarity, symmetry: &Symmetry) -> Result<PoseErrors> {
    let samples = sample_surface(mesh, SAMPLES, 0)?.points;
    let relative = UnitQuaternion::from_rotation_matrix(&(truth.rotation.inverse() * estimate.rotation));
    let turn = symmetry.group(mesh)?.nearest(&relative);

    // Mesh from mesh: the turn about the surface's centroid.
    let centroid = nalgebra::Vector3::from(SurfaceMoments::of(mesh).centroid.to_array());
    let turned =
        Similarity { scale: 1.0, rotation: turn.to_rotation_matrix(), translation: centroid - turn * centroid };
    let truth = truth.compose(&turned);

    let center = Bounds::of(mesh.positions()).map_or(centroid, |b| vector3(b.min).lerp(&vector3(b.max), 0.5));
    let translation_error_m = (estimate.apply(center) - truth.apply(center)).norm();

    let tree = TriangleTree::new(mesh);
    let mesh_from_camera = estimate.inverse();
    let mut distance = Mean::default();
    let mut hint = Hint::default();
    for sample in &samples {
        let query = mesh_from_camera.apply(truth.apply(vector3(*sample)));
        let nearest = tree.nearest_from(vec3(&query), &mut hint);
        distance.add(nearest.map_or(f64::INFINITY, |s| f64::from(s.distance_squared).sqrt() * estimate.scale));
    }
    let add_s = distance.value().ok_or_else(|| {
        Error::new(
            ErrorCode::InvalidTransform,
            "transform",
            "a transform too far from the truth for a distance",
            "two transforms of one scene",
            "Check the units of both: translations are in metres.",
        )
    })?;
    Ok(PoseErrors {
        scale_error: (estimate.scale / truth.scale - 1.0).abs(),
        rotation_error_deg: truth.rotation_angle_to(estimate).to_degrees(),
        translation_error_m,
        translation_error_relative: translation_error_m / (mesh_diagonal(mesh) * truth.scale),
        add_s_mm: 1000.0 * add_s,
    })
}
