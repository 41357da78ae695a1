//! Convolutions with symmetric kernels, along rows and columns.

/// Half of a kernel that sums to 1: its middle, and one side.
struct Kernel(Vec<f64>);

impl Kernel {
    fn normalised(mut half: Vec<f64>) -> Self {
        let sum = 2.0 * half.iter().sum::<f64>() - half[0];
        half.iter_mut().for_each(|weight| *weight /= sum);
        Self(half)
    }

    fn gaussian(sigma: f64) -> Self {
        let radius = (3.0 * sigma).ceil() as usize;
        Self::normalised((0..=radius).map(|i| libm::exp(-0.5 * (i as f64 / sigma).powi(2))).collect())
    }

    /// A box of this width, which need not be whole.
    fn uniform(width: f64) -> Self {
        let half = 0.5 * width;
        Self::normalised((0..=half.ceil() as usize).map(|i| (half + 0.5 - i as f64).clamp(0.0, 1.0)).collect())
    }

    fn pass(&self, values: &[f64], width: usize) -> Vec<f64> {
        let last = width - 1;
        let of_row = |row: &[f64]| -> Vec<f64> {
            let at = |u: usize| {
                let side = self.0.iter().enumerate().skip(1);
                let both = side.map(|(i, weight)| weight * (row[u.saturating_sub(i)] + row[(u + i).min(last)]));
                self.0[0] * row[u] + both.sum::<f64>()
            };
            (0..width).map(at).collect()
        };
        values.chunks_exact(width).flat_map(of_row).collect()
    }

    fn apply(&self, values: &[f64], width: usize) -> Vec<f64> {
        let height = values.len() / width;
        transposed(&self.pass(&transposed(&self.pass(values, width), width), height), height)
    }
}

fn transposed(values: &[f64], width: usize) -> Vec<f64> {
    let height = values.len() / width;
    (0..values.len()).map(|i| values[i % height * width + i / height]).collect()
}

/// A Gaussian blur; `sigma` in pixels. Beyond the border, the image goes on with its last pixels.
pub fn blurred(values: &[f64], width: usize, sigma: f64) -> Vec<f64> {
    if sigma > 0.05 { Kernel::gaussian(sigma).apply(values, width) } else { values.to_vec() }
}

/// Steps made ramps of a width in pixels, as maps that were enlarged have them.
pub fn ramped(values: &[f64], width: usize, ramp_px: f64) -> Vec<f64> {
    if ramp_px > 1.0 { Kernel::uniform(ramp_px).apply(values, width) } else { values.to_vec() }
}
