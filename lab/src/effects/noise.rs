//! Random fields, discs and blurs of images.

use crate::prelude::*;
use crate::world::view::View;

/// Smooth noise from −1 to 1: a lattice of random values, blended between.
pub struct Noise {
    cell: f64,
    columns: usize,
    width: usize,
    values: Vec<f64>,
}

impl Noise {
    /// Noise over an image, with lattice cells of `cell` pixels.
    pub fn new(view: &View, cell: f64, random: &mut Random) -> Self {
        let [columns, rows] = [view.width, view.height].map(|n| (n as f64 / cell) as usize + 2);
        let values = (0..columns * rows).map(|_| between(random, -1.0, 1.0)).collect();
        Self { cell, columns, width: view.width, values }
    }

    /// The value at a pixel.
    pub fn at(&self, pixel: usize) -> f64 {
        let [x, y] = [pixel % self.width, pixel / self.width].map(|x| x as f64 / self.cell);
        let (i, j) = (x as usize, y as usize);
        let (s, t) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| self.values[j * self.columns + i];
        let [top, bottom] = [j, j + 1].map(|j| value(i, j) * (1.0 - s) + value(i + 1, j) * s);
        top * (1.0 - t) + bottom * t
    }
}

/// Visits the pixels of a disc about pixel `at`.
pub fn disc(view: &View, at: usize, radius: f64, mut visit: impl FnMut(usize)) {
    let [u, v] = view.place(at).map(|x| x as f64);
    for y in (v - radius).max(0.0) as usize..=((v + radius) as usize).min(view.height - 1) {
        for x in (u - radius).max(0.0) as usize..=((u + radius) as usize).min(view.width - 1) {
            if (x as f64 - u).powi(2) + (y as f64 - v).powi(2) <= radius * radius {
                visit(y * view.width + x);
            }
        }
    }
}

/// The middle and one side of a Gaussian kernel; σ in pixels.
pub fn gaussian(sigma: f64) -> Vec<f64> {
    if sigma < 0.05 {
        return vec![1.0];
    }
    (0..=(3.0 * sigma).ceil() as usize).map(|i| libm::exp(-0.5 * (i as f64 / sigma).powi(2))).collect()
}

/// Values convolved with a symmetric kernel along rows and columns. Beyond the border, the image goes on with its last
/// pixels.
pub fn convolved(values: &[f64], width: usize, kernel: &[f64]) -> Vec<f64> {
    let sum = 2.0 * kernel.iter().sum::<f64>() - kernel[0];
    let pass = |values: &[f64], width: usize| -> Vec<f64> {
        let at = |row: &[f64], u: usize| {
            let sides = kernel.iter().enumerate().skip(1);
            let both = sides.map(|(i, weight)| weight * (row[u.saturating_sub(i)] + row[(u + i).min(width - 1)]));
            (kernel[0] * row[u] + both.sum::<f64>()) / sum
        };
        values.chunks_exact(width).flat_map(|row| (0..width).map(|u| at(row, u)).collect::<Vec<_>>()).collect()
    };
    let transposed = |values: &[f64], width: usize| -> Vec<f64> {
        let height = values.len() / width;
        (0..values.len()).map(|i| values[i % height * width + i / height]).collect()
    };
    let height = values.len() / width;
    transposed(&pass(&transposed(&pass(values, width), width), height), height)
}
