//! Tukey's biweight by hand.

use sim3align::register::tukey::biweights;

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn weights_by_hand() {
    // The median magnitude is 1: the width is 4.685 · 1.4826.
    let residuals = [0.0, 0.5, -1.0, 2.0, 7.0];
    let width: f64 = 4.685 * 1.4826;
    for (weight, residual) in biweights(&residuals, 1e-6).into_iter().zip(residuals) {
        let ratio: f64 = residual / width;
        let expected = if ratio.abs() < 1.0 { (1.0 - ratio * ratio).powi(2) } else { 0.0 };
        assert!((weight - expected).abs() < 1e-12, "{residual}: {weight}");
    }
    assert_eq!(biweights(&residuals, 1e-6)[4], 0.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn exact_residuals_stay_and_the_others_go() {
    assert_eq!(biweights(&[0.0, 0.0, 0.0, 1e-3], 1e-6), [1.0, 1.0, 1.0, 0.0]);
    assert_eq!(biweights(&[], 1e-6), Vec::<f64>::new());
    // What is not a number belongs nowhere.
    assert_eq!(biweights(&[0.0, f64::NAN], 1e-6)[1], 0.0);
}
