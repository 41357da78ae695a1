//! Tukey's biweight: points that do not belong get no say.

use crate::geometry::order::median;

/// Tukey's constant: 95 % efficient on Gaussian residuals.
const TUKEY: f64 = 4.685;

/// From the median of absolute residuals to their standard deviation.
const MAD_TO_SIGMA: f64 = 1.4826;

/// A weight from 0 to 1 for each residual, by a biweight as wide as the median residual says. On exact data the
/// median is 0; `floor`, the rounding of the coordinates, keeps the exact points in.
pub fn biweights(residuals: &[f64], floor: f64) -> Vec<f64> {
    let median = median(residuals.iter().map(|r| r.abs() as f32)).unwrap_or_default();
    let width = (TUKEY * MAD_TO_SIGMA * f64::from(median)).max(floor);
    let biweight = |residual: &f64| {
        let ratio = residual / width;
        if ratio.abs() < 1.0 { (1.0 - ratio * ratio) * (1.0 - ratio * ratio) } else { 0.0 }
    };
    residuals.iter().map(biweight).collect()
}
