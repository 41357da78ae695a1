//! Sine and cosine for moderate angles, and the exponential map of SO(3).
//!
//! `libm::sin` reduces arguments up to the largest f64, which takes five kilobytes of WebAssembly and a table of 2/π.
//! The polynomials are the same (fdlibm's `k_sin.c` and `k_cos.c`); the error is at most one unit in the last place.

use core::f64::consts::FRAC_2_PI;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// π/2 in two parts. The first has 33 significant bits, so that its product with an integer of up to 20 bits is exact.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// Sine and cosine of `angle`, in radians; |angle| ≤ 10⁶.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = (angle * FRAC_2_PI + 0.5).floor();
    let x = (angle - quarters * HALF_PI[0]) - quarters * HALF_PI[1];
    let z = x * x;
    let sin = polynomial(
        z,
        &[
            1.589_690_995_211_55e-10,
            -2.505_076_025_340_686_3e-8,
            2.755_731_370_707_006_8e-6,
            -1.984_126_982_985_795e-4,
            8.333_333_333_322_49e-3,
            -1.666_666_666_666_663_2e-1,
        ],
    );
    let cos = polynomial(
        z,
        &[
            -1.135_964_755_778_819_5e-11,
            2.087_572_321_298_175e-9,
            -2.755_731_435_139_066_3e-7,
            2.480_158_728_947_673e-5,
            -1.388_888_888_887_411e-3,
            4.166_666_666_666_66e-2,
        ],
    );
    let half = 0.5 * z;
    let whole = 1.0 - half;
    // Adds the rounding error of 1 − z/2.
    let (sin, cos) = (x + x * z * sin, whole + ((1.0 - whole - half) + z * z * cos));
    match quarters as i64 & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// exp(ω): the rotation by |ω| radians about the direction of ω.
pub fn exp_so3(rotation: Vector3<f64>) -> UnitQuaternion<f64> {
    let angle = rotation.norm();
    let (sin, cos) = sin_cos(0.5 * angle);
    let along = if angle > 0.0 { sin / angle } else { 0.5 };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, rotation * along))
}

fn polynomial(z: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * z + c)
}
