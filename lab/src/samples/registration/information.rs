//! The information matrix of two overlapping fragments, and what a pose that is a little off costs (Choi, Zhou,
//! Koltun, "Robust Reconstruction of Indoor Scenes", CVPR 2015).
//!
//! ξ = (t, q) is the error, its shift and the vector part of its unit quaternion. A point p then moves by
//! t + 2 q × p = G ξ with G = [1, −2 [p]×] to first order; Λ = Σ GᵀG over the corresponding points, so that ξᵀΛξ is
//! the sum of their squared distances, and Λ₀₀ their number.

use glam::Vec3;
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector6};

use sim3align_geometry::similarity::{Similarity, vector3};

/// Λ of the source's points that have a counterpart, in the source's frame.
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

/// ξᵀΛξ / Λ₀₀ of an estimate against the truth, both target from source, in m².
pub fn mean_squared_error(estimate: &Similarity, truth: &Similarity, information: &Matrix6<f64>) -> f64 {
    let error = truth.inverse().compose(estimate);
    let [x, y, z, _] = error.quaternion_xyzw();
    let t = error.translation;
    let xi = Vector6::new(t.x, t.y, t.z, x, y, z);
    (xi.transpose() * information * xi)[0] / information[(0, 0)]
}
