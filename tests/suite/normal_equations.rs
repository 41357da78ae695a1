//! Normal equations against nalgebra's Cholesky decomposition, and where there is no step.

use nalgebra::{Cholesky, SMatrix, SVector};
use sim3align::geometry::normal_equations::PARAMETERS;

use crate::prelude::*;

type Vector = SVector<f64, PARAMETERS>;

/// Residuals with their Jacobians and weights: `free` parameters, the others' columns are 0.
fn residuals(draw: &mut Draw, count: usize, free: usize) -> Vec<(Vector, f64, f64)> {
    let mut residual = || {
        let jacobian = Vector::from_fn(|i, _| if i < free { draw.between(-1.0, 1.0) } else { 0.0 });
        (jacobian, draw.between(-0.1, 0.1), draw.between(0.0, 1.0))
    };
    (0..count).map(|_| residual()).collect()
}

fn equations(residuals: &[(Vector, f64, f64)]) -> NormalEquations {
    let mut equations = NormalEquations::new();
    for (jacobian, residual, weight) in residuals {
        equations.add(&(*jacobian).into(), *residual, *weight);
    }
    equations
}

#[wasm_bindgen_test(unsupported = test)]
fn the_step_is_that_of_nalgebra() {
    for seed in 0..50 {
        let mut draw = Draw::new(seed);
        for (count, free, damping) in [(7, 7, 1e-9), (40, 7, 0.0), (40, 6, 1e-9), (400, 7, 1e-3), (40, 3, 1.0)] {
            let residuals = residuals(&mut draw, count, free);
            let mut matrix = SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros();
            let mut gradient = Vector::zeros();
            for (jacobian, residual, weight) in &residuals {
                matrix += jacobian * jacobian.transpose() * *weight;
                gradient += jacobian * (weight * residual);
            }
            let damped = matrix + SMatrix::identity() * (damping * matrix.trace());
            let expected = -Cholesky::new(damped).unwrap().solve(&gradient);
            let found = Vector::from(equations(&residuals).solve(damping).unwrap());
            let context = format!("seed {seed}, {count} residuals in {free} parameters, damping {damping}");
            // The remainder, not the step, is what rounding leaves small where the matrix is all but singular.
            let remainder = (damped * found + gradient).norm() / gradient.norm();
            assert!(remainder < 1e-12, "{context}: remainder {remainder}");
            let off = (found - expected).norm() / expected.norm();
            assert!(off < 1e-6, "{context}: off by {off}");
            assert!(found.iter().skip(free).all(|x| *x == 0.0), "{context}: {found}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn without_a_minimum_there_is_no_step() {
    assert_eq!(NormalEquations::new().solve(1e-9), None);
    let one = [1.0; PARAMETERS];
    for (jacobian, residual, weight) in [
        ([f64::NAN; PARAMETERS], 1.0, 1.0),
        ([1e200; PARAMETERS], 1.0, 1.0),
        (one, 1.0, f64::INFINITY),
        (one, 1.0, 0.0),
    ] {
        let mut equations = NormalEquations::new();
        equations.add(&jacobian, residual, weight);
        assert_eq!(equations.solve(1e-9), None, "{jacobian:?}, {residual}, {weight}");
    }
    // One direction of seven, undamped.
    let mut equations = NormalEquations::new();
    equations.add(&one, 1.0, 1.0);
    assert_eq!(equations.solve(0.0), None);
    assert!(equations.solve(1e-9).is_some());
}
