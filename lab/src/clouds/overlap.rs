//! The common surface of two clouds: overlap, and the information matrix that measures how far an estimate displaces it
//! (Choi, Zhou, Koltun, "Robust Reconstruction of Indoor Scenes", CVPR 2015).
//!
//! The error ξ = (t, q) consists of the translation and the vector part of the unit quaternion. To first order, a point
//! p moves by t + 2 q × p = G ξ with G = [1, −2 [p]×]. With Λ = Σ GᵀG over the corresponding points, ξᵀΛξ is the sum of
//! their squared displacements, and Λ₀₀ their number.

use nalgebra::{Matrix6, SMatrix, Vector6};

use crate::prelude::*;

/// Indices of the source points within `distance` of a target point.
pub fn covered(source: &[Vec3], target: &KdTree, target_from_source: &Similarity, distance: f32) -> Vec<usize> {
    let transform = target_from_source.to_f32();
    let is_near = |(_, point): &(usize, &Vec3)| target.nearest_within(transform.apply(**point), distance).is_some();
    source.iter().enumerate().filter(is_near).map(|(i, _)| i).collect()
}

/// Fraction of the points of both clouds within `distance` of a point of the other, 0 to 1.
pub fn overlap(source: &[Vec3], target: &[Vec3], target_from_source: &Similarity, distance: f32) -> f64 {
    let there = covered(source, &KdTree::new(target), target_from_source, distance).len();
    let back = covered(target, &KdTree::new(source), &target_from_source.inverse(), distance).len();
    (there + back) as f64 / (source.len() + target.len()).max(1) as f64
}

/// Λ of corresponding source points, in the source frame.
pub fn information(points: impl Iterator<Item = Vec3>) -> Matrix6<f64> {
    let mut sum = Matrix6::zeros();
    for point in points {
        let p = vector3(point);
        let mut g: SMatrix<f64, 3, 6> = SMatrix::zeros();
        g.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        g.fixed_view_mut::<3, 3>(0, 3).copy_from(&(p.cross_matrix() * -2.0));
        sum += g.transpose() * g;
    }
    sum
}

/// ξᵀΛξ / Λ₀₀ of an estimate relative to the true transform, both target from source, in m².
pub fn mean_squared_error(estimate: &Similarity, truth: &Similarity, information: &Matrix6<f64>) -> f64 {
    let error = truth.inverse().compose(estimate);
    let [x, y, z, _] = error.quaternion_xyzw();
    let t = error.translation;
    let xi = Vector6::new(t.x, t.y, t.z, x, y, z);
    (xi.transpose() * information * xi)[0] / information[(0, 0)]
}
