//! Uniform sampling of SO(3).

use core::f64::consts::{SQRT_2, TAU};

use glam::{DQuat, DVec3};

use super::angle::{exp_so3, sin_cos};

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
