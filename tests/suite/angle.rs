//! Sines, cosines and turns against libm and nalgebra.

use core::f64::consts::{FRAC_PI_2, PI};

use nalgebra::UnitQuaternion;
use sim3align::geometry::angle::{exp_so3, sin_cos};

use crate::prelude::*;

/// Both are off by one unit in the last place at most, of numbers up to 1.
const ROUNDING: f64 = 2.3e-16;

#[wasm_bindgen_test(unsupported = test)]
fn sines_and_cosines_are_those_of_libm() {
    let seed = 1;
    let mut draw = Draw::new(seed);
    let mut angles = vec![0.0, -0.0, 1e-300, 1e-9, -1e-9];
    for i in -40..=40 {
        // Near the ends of the quarters, where the reduction loses the most.
        for off in [0.0, 1e-15, -1e-15, 1e-8, -1e-8] {
            angles.push(f64::from(i) * 0.5 * FRAC_PI_2 + off);
        }
    }
    for reach in [1e-3, 1.0, PI, 10.0, 1e3, 1e6] {
        angles.extend((0..2000).map(|_| draw.between(-reach, reach)));
    }
    for angle in angles {
        let ((sin, cos), (expected_sin, expected_cos)) = (sin_cos(angle), libm::sincos(angle));
        let context =
            format!("seed {seed}, angle {angle:e}: ({sin:e}, {cos:e}), not ({expected_sin:e}, {expected_cos:e})");
        assert!((sin - expected_sin).abs() <= ROUNDING && (cos - expected_cos).abs() <= ROUNDING, "{context}");
        let small = angle.abs() < 0.7;
        assert!(!small || (sin - expected_sin).abs() <= ROUNDING * expected_sin.abs(), "{context}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn turns_are_those_of_nalgebra() {
    let seed = 2;
    let mut draw = Draw::new(seed);
    for size in [0.0, 1e-300, 1e-12, 1e-3, 1.0, 3.0, 7.0] {
        for _ in 0..100 {
            let rotation = draw.direction() * size;
            let off = (exp_so3(rotation).coords - UnitQuaternion::from_scaled_axis(rotation).coords).amax();
            assert!(off < 4e-16, "seed {seed}, {rotation:?}: off by {off:e}");
        }
    }
    assert_eq!(exp_so3(Vector3::zeros()), UnitQuaternion::identity());
}
