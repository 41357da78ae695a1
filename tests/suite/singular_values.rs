//! The decomposition into rotations against nalgebra's, from well-shaped matrices to all but singular ones.

use nalgebra::Matrix3;
use sim3align::geometry::singular_values::SingularValues;

use crate::prelude::*;

fn check(matrix: &Matrix3<f64>, context: &str) {
    let found = SingularValues::of(matrix);
    let d = found.values;
    let (size, context) = (matrix.norm(), format!("{context}, {matrix}: {found:?}"));
    for rotation in [found.u, found.v] {
        assert!((rotation.transpose() * rotation - Matrix3::identity()).amax() < 1e-14, "{context}");
        assert!((rotation.determinant() - 1.0).abs() < 1e-14, "{context}");
    }
    let product = found.u * Matrix3::from_diagonal(&Vector3::from(d)) * found.v.transpose();
    assert!((product - matrix).amax() <= 1e-14 * size, "{context}");
    assert!(d[0] - d[1] >= -1e-15 * size && d[1] - d[2].abs() >= -1e-15 * size, "{context}");
    let expected = matrix.svd(false, false).singular_values;
    for i in 0..3 {
        assert!((d[i].abs() - expected[i]).abs() <= 1e-14 * size, "{context}, not {expected}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn matrices_of_any_shape() {
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        let (u, v) = (draw.rotation(), draw.rotation());
        for d in [
            [3.0, 2.0, 1.0],
            [3.0, 2.0, -1.0],
            [1.0, 1.0, 1.0],
            [1.0, 1.0, -1.0],
            [1.0, 1e-3, 1e-6],
            [1.0, 1e-5, -1e-10],
            [2.0, 1.0, 0.0],
            [1e150, 1e149, 1e140],
            [1e-150, 1e-151, -1e-152],
        ] {
            let matrix = u.matrix() * Matrix3::from_diagonal(&Vector3::from(d)) * v.matrix().transpose();
            check(&matrix, &format!("seed {seed}, {d:?}"));
        }
        check(&Matrix3::from_fn(|_, _| draw.between(-1.0, 1.0)), &format!("seed {seed}"));
    }
    check(&Matrix3::identity(), "identity");
    check(&Matrix3::from_diagonal(&Vector3::new(-1.0, 2.0, -3.0)), "diagonal");
}

#[wasm_bindgen_test(unsupported = test)]
fn small_singular_values_keep_their_digits() {
    let seed = 3;
    let mut draw = Draw::new(seed);
    let v = draw.rotation();
    // Columns of very different sizes: what one-sided rotations resolve and MᵀM would not.
    let matrix = Matrix3::from_diagonal(&Vector3::new(1.0, 1e-9, 1e-12)) * v.matrix().transpose();
    let found = SingularValues::of(&matrix);
    assert!((found.values[1] / 1e-9 - 1.0).abs() < 1e-6, "seed {seed}: {found:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn what_has_no_decomposition_shows_in_its_values() {
    assert_eq!(SingularValues::of(&Matrix3::zeros()).values, [0.0; 3]);
    let line = SingularValues::of(&(Vector3::new(1.0, 2.0, 3.0) * Vector3::new(1.0, 0.0, -1.0).transpose()));
    assert!(line.values[1] <= 1e-15 && line.values[2].abs() <= 1e-15, "{line:?}");
    let infinite = Matrix3::from_element(f64::INFINITY);
    assert!(!SingularValues::of(&infinite).values[0].is_finite());
}
