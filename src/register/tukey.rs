//! Tukey's biweight, which gives outliers a weight of 0.

use crate::geometry::order::median;

/// Tukey's constant: 95 % efficiency for Gaussian residuals.
const TUKEY: f64 = 4.685;

/// Ratio of the standard deviation to the median absolute residual of a Gaussian.
const MAD_TO_SIGMA: f64 = 1.4826;

/// The weights of residuals, from 0 to 1. The width follows from their median, but is at least `floor`, the rounding
/// error of the coordinates: for exact data, the median is 0.
pub fn biweights(residuals: &[f64], floor: f64) -> Vec<f64> {
    let median = median(residuals.iter().map(|r| r.abs() as f32)).unwrap_or_default();
    let width = (TUKEY * MAD_TO_SIGMA * f64::from(median)).max(floor);
    let biweight = |residual: &f64| {
        let ratio = residual / width;
        if ratio.abs() < 1.0 { (1.0 - ratio * ratio) * (1.0 - ratio * ratio) } else { 0.0 }
    };
    residuals.iter().map(biweight).collect()
}
