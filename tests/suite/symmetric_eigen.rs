//! Eigen-decomposition: the definition itself is the oracle.

use sim3align::geometry::symmetric_eigen::{SymmetricEigen, outer};

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn satisfies_the_definition() {
    for seed in 0..500 {
        let mut random = Random::new(seed, 900);
        let mut vector = || DVec3::from_array([0; 3].map(|_| random.uniform() * 2.0 - 1.0));
        // Sums of one, two or three outer products: rank-deficient ones too; over twenty decades.
        let mut m = outer(vector());
        for _ in 0..seed % 3 {
            m += outer(vector());
        }
        let m = m * [1e-20, 1.0, 1e20][(seed / 3) as usize % 3];
        let size = m.to_cols_array().iter().fold(0.0f64, |a, x| a.max(x.abs()));
        let eigen = SymmetricEigen::of(m);
        assert!(eigen.values.is_sorted(), "seed {seed}: {eigen:?}");
        for (i, (value, vector)) in eigen.values.into_iter().zip(eigen.vectors).enumerate() {
            let residual = (m * vector - vector * value).length();
            assert!(residual <= 1e-14 * size, "seed {seed}, pair {i}: residual {residual:e} of {size:e}");
            for (j, other) in eigen.vectors.into_iter().enumerate() {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((vector.dot(other) - expected).abs() < 1e-14, "seed {seed}, vectors {i} and {j}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn handles_diagonal_equal_and_zero_matrices() {
    let eigen = SymmetricEigen::of(DMat3::from_diagonal(DVec3::new(3.0, 1.0, 2.0)));
    assert_eq!(eigen.values, [1.0, 2.0, 3.0]);
    assert_eq!(eigen.vectors, [DVec3::Y, DVec3::Z, DVec3::X]);
    assert_eq!(SymmetricEigen::of(DMat3::IDENTITY).values, [1.0; 3]);
    assert_eq!(SymmetricEigen::of(DMat3::ZERO).values, [0.0; 3]);
}
