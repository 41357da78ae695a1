//! Rotations, and even sampling of SO(3) and of the sphere.

use core::f64::consts::{SQRT_2, TAU};

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{Matrix3, Rotation3};

use super::angle::{exp_so3, sin_cos};
use super::similarity::Similarity;

/// ψ of the super-Fibonacci spiral: the root of ψ⁴ = ψ + 4.
const PSI: f64 = 1.533_751_168_755_204_3;

/// The `i`-th of `n` rotations of a super-Fibonacci spiral (Alexa, "Super-Fibonacci Spirals: Fast, Low-Discrepancy
/// Sampling of SO(3)", CVPR 2022): nearly as uniform as the best known coverings, for any `n`, without tables.
pub fn super_fibonacci(i: usize, n: usize) -> DQuat {
    let s = i as f64 + 0.5;
    let t = s / n as f64;
    let (sin_a, cos_a) = sin_cos(TAU * s / SQRT_2);
    let (sin_b, cos_b) = sin_cos(TAU * s / PSI);
    let (r, q) = (t.sqrt(), (1.0 - t).sqrt());
    DQuat::from_xyzw(r * sin_a, r * cos_a, q * sin_b, q * cos_b)
}

/// The `k`-th of `n` points of a Fibonacci spiral on the unit sphere.
pub fn fibonacci_sphere(k: usize, n: usize) -> DVec3 {
    /// Angle between consecutive points, radians: the golden angle.
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
    let (sin, cos) = sin_cos(GOLDEN * k as f64);
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

/// The angle between two rotations, in radians.
pub fn angle_between(a: DQuat, b: DQuat) -> f64 {
    // Uses the arc tangent, because the arc cosine is inaccurate near 0.
    let relative = a.conjugate() * b;
    let sine = (relative.x * relative.x + relative.y * relative.y + relative.z * relative.z).sqrt();
    2.0 * libm::atan2(sine, relative.w.abs())
}

/// The rotation by |`vector`| radians about `vector`.
pub fn exp(vector: DVec3) -> DQuat {
    DQuat::from_array(exp_so3(vector.to_array().into()).coords.into()).normalize()
}

/// The rotation of a similarity as a quaternion.
pub fn quaternion_of(similarity: &Similarity) -> DQuat {
    DQuat::from_array(similarity.quaternion_xyzw()).normalize()
}

/// The rotation matrix of a unit quaternion.
pub fn matrix_of(rotation: DQuat) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Matrix3::from_column_slice(&DMat3::from_quat(rotation).to_cols_array()))
}
