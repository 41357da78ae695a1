//! The algebra of similarities, their matrices and quaternions, and what is refused as one.

use nalgebra::{Matrix3, Matrix4};
use sim3align::geometry::similarity::nearest_rotation;

use crate::prelude::*;

const PI: f64 = core::f64::consts::PI;

fn draw_pair(seed: u64) -> (Draw, Similarity, Similarity) {
    let mut draw = Draw::new(seed);
    let (a, b) = (draw.similarity([0.01, 100.0], 1e4), draw.similarity([0.01, 100.0], 1e4));
    (draw, a, b)
}

/// Relative to the numbers that were added up.
fn close(a: Vector3<f64>, b: Vector3<f64>, magnitude: f64) -> bool {
    (a - b).norm() <= 1e-13 * magnitude
}

#[wasm_bindgen_test(unsupported = test)]
fn algebra() {
    for seed in 0..200 {
        let (mut draw, a, b) = draw_pair(seed);
        let x = draw.cube(10.0);
        let size = a.scale * (b.scale * 20.0 + 2e4) + 2e4;
        assert!(close(a.compose(&b).apply(x), a.apply(b.apply(x)), size), "seed {seed}");
        assert!(close(a.inverse().apply(a.apply(x)), x, 20.0 + 2e4 / a.scale), "seed {seed}");
        assert!(close(a.apply(a.inverse().apply(x)), x, 4e4), "seed {seed}");
        let nothing = a.compose(&a.inverse());
        assert!((nothing.scale - 1.0).abs() < 1e-14 && nothing.translation.norm() < 1e-8, "seed {seed}: {nothing:?}");
        let c = draw.similarity([0.5, 2.0], 1.0);
        let (left, right) = (a.compose(&b).compose(&c), a.compose(&b.compose(&c)));
        assert!(close(left.apply(x), right.apply(x), 10.0 * size), "seed {seed}");
        assert_eq!(a.compose(&Similarity::identity()), a, "seed {seed}");
        let by_matrix = Matrix4::from_column_slice(&a.to_column_major()) * x.push(1.0);
        assert!(close(by_matrix.xyz(), a.apply(x), 2e4), "seed {seed}");
        assert_eq!(by_matrix.w, 1.0);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn column_major_is_what_three_js_calls_elements() {
    let quarter_turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5 * PI);
    let pose = Similarity { scale: 2.0, rotation: quarter_turn, translation: Vector3::new(5.0, 6.0, 7.0) };
    // x goes to y: the first column is (0, 2, 0, 0); the translation stands in elements 12 to 14.
    let expected = [0.0, 2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 5.0, 6.0, 7.0, 1.0];
    for (found, expected) in pose.to_column_major().into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-15, "{:?}", pose.to_column_major());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn round_trips() {
    for seed in 0..300 {
        let (_, a, _) = draw_pair(seed);
        let back = Similarity::from_column_major(&a.to_column_major()).unwrap();
        assert!((back.scale / a.scale - 1.0).abs() < 1e-14, "seed {seed}");
        assert!((back.rotation.matrix() - a.rotation.matrix()).amax() < 1e-14, "seed {seed}");
        assert_eq!(back.translation, a.translation, "seed {seed}");

        let q = a.quaternion_xyzw();
        assert!((q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14 && q[3] >= 0.0, "seed {seed}: {q:?}");
        for stretched in [q, q.map(|x| -3.0 * x)] {
            let rotation = Similarity::rotation_from_xyzw(&stretched).unwrap();
            assert!((rotation - a.rotation.matrix()).amax() < 1e-14, "seed {seed}: {q:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn half_turns_have_quaternions() {
    let mut draw = Draw::new(1);
    let mut axes = vec![Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::x(), Vector3::new(1.0, 1.0, 0.0)];
    axes.extend((0..200).map(|_| draw.direction()));
    for axis in axes.iter().map(|a| a.normalize()) {
        for short_of_it in [0.0, 1e-15, 1e-9, 1e-4] {
            let rotation = Rotation3::new(axis * (PI - short_of_it));
            let q = Similarity { rotation, ..Similarity::identity() }.quaternion_xyzw();
            let back = Similarity::rotation_from_xyzw(&q).unwrap();
            assert!((back - rotation.matrix()).amax() < 1e-14, "{axis}, {short_of_it}: {q:?}");
        }
    }
    // The smallest of them by hand: half a turn about y is (0, 1, 0, 0).
    let half = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0);
    let q = Similarity::from_parts(1.0, half, Vector3::zeros()).unwrap().quaternion_xyzw();
    assert_eq!(q.map(f64::abs), [0.0, 1.0, 0.0, 0.0]);
}

#[wasm_bindgen_test(unsupported = test)]
fn quaternions_without_direction_are_refused() {
    for q in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 1.0], [1e-200; 4]] {
        assert_eq!(Similarity::rotation_from_xyzw(&q).unwrap_err().code, ErrorCode::InvalidTransform);
    }
    assert_eq!(Similarity::rotation_from_xyzw(&[0.0, 0.0, 0.0, 5.0]).unwrap(), Matrix3::identity());
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_no_similarity_is_refused() {
    let good = Similarity::from_column_major(&Draw::new(2).similarity([0.5, 2.0], 10.0).to_column_major()).unwrap();
    let (r, t) = (*good.rotation.matrix(), good.translation);
    let refused = |what: &str, scale: f64, rotation: Matrix3<f64>, translation: Vector3<f64>| {
        let error = Similarity::from_parts(scale, rotation, translation).expect_err(what);
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidTransform, "transform"), "{what}");
    };
    assert!(Similarity::from_parts(1.0, r, t).is_ok());
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused("scale", scale, r, t);
    }
    refused("reflection", 1.0, -r, t);
    refused("mirror", 1.0, r * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0)), t);
    refused("shear", 1.0, r * Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), t);
    refused("uneven scale", 1.0, r * Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 0.5)), t);
    refused("scale inside the rotation", 1.0, r * 2.0, t);
    refused("nothing", 1.0, Matrix3::zeros(), t);
    // |RᵀR − 1| of 1e-3 is where rounding ends.
    refused("slightly scaled", 1.0, r * 1.0006, t);
    assert!(Similarity::from_parts(1.0, r * 1.0004, t).is_ok());
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        refused("rotation not finite", 1.0, r * x, t);
        refused("translation not finite", 1.0, r, Vector3::new(0.0, x, 0.0));
    }
    // Squares that overflow to ∞ − ∞.
    refused("huge", 1.0, Matrix3::new(1e200, -1e200, 1e200, 1e200, 1e200, -1e200, -1e200, 1e200, 1e200), t);
    refused("huge", 1.0, Matrix3::repeat(1e200), t);
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_no_matrix_of_one_is_refused() {
    let good = Draw::new(3).similarity([0.5, 2.0], 10.0).to_column_major();
    let refused = |what: &str, change: &dyn Fn(&mut [f64; 16])| {
        let mut m = good;
        change(&mut m);
        let error = Similarity::from_column_major(&m).expect_err(what);
        assert_eq!(error.code, ErrorCode::InvalidTransform, "{what}");
        error
    };
    let transposed = refused("row-major", &|m| {
        *m = Matrix4::from_row_slice(&good).as_slice().try_into().unwrap();
    });
    assert!(transposed.to_string().contains("Transpose a row-major matrix"), "{transposed}");
    refused("reflection", &|m| m[..3].iter_mut().for_each(|x| *x = -*x));
    refused("one column stretched", &|m| m[4..7].iter_mut().for_each(|x| *x *= 1.1));
    refused("zero", &|m| m[..12].fill(0.0));
    for i in 0..16 {
        for x in [f64::NAN, f64::INFINITY] {
            refused("not finite", &|m| m[i] = x);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn decimals_of_a_file_are_repaired() {
    for seed in 0..50 {
        let (_, a, _) = draw_pair(seed);
        // Four decimals, as people print matrices.
        let printed = a.rotation.matrix().map(|x| (x * 1e4).round() / 1e4);
        let read = Similarity::from_parts(a.scale, printed, a.translation).unwrap();
        assert!(rotation_defect(read.rotation.matrix()) < 1e-14, "seed {seed}");
        assert!(read.rotation_angle_to(&a) < 2e-4, "seed {seed}");
    }
    // The furthest that is taken at all.
    let r = Draw::new(9).rotation();
    let off = r.matrix() * (1.0 + 4.9e-4);
    assert!(rotation_defect(nearest_rotation(off).matrix()) < 1e-15);
    assert!((nearest_rotation(off).matrix() - r.matrix()).amax() < 1e-15);
}

#[wasm_bindgen_test(unsupported = test)]
fn angles_are_exact_near_0_and_near_half_a_turn() {
    let mut draw = Draw::new(4);
    for _ in 0..50 {
        let base = Similarity { rotation: draw.rotation(), scale: 3.0, translation: draw.cube(5.0) };
        for angle in [0.0, 1e-12, 1e-8, 1e-4, 0.5, 1.0, 0.5 * PI, 2.0, PI - 1e-4, PI - 1e-8, PI - 1e-12, PI] {
            let turned = Similarity { rotation: base.rotation * draw.rotation_by(angle), ..base };
            for found in [base.rotation_angle_to(&turned), turned.rotation_angle_to(&base)] {
                assert!((found - angle).abs() < 2e-15, "{found} for {angle}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn f32_agrees_with_f64() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        let pose = draw.similarity([0.01, 100.0], 1.0);
        let (x, n) = (draw.cube(1.0), draw.direction());
        let (fast, slow) = (pose.to_f32().apply(vec3(&x)), pose.apply(x));
        assert!((vector3(fast) - slow).norm() < 4e-7 * (2.0 * pose.scale + 2.0), "seed {seed}");
        assert!((vector3(pose.to_f32().rotate(vec3(&n))) - pose.rotation * n).norm() < 4e-7, "seed {seed}");
    }
}
