//! Faults of masks: too wide, too narrow, with holes.

use crate::prelude::*;

/// Share of a mask that its holes take, and holes along a side.
const HOLES: f64 = 0.3;
const HOLES_ACROSS: f64 = 3.0;

/// A mask that is wrong by so many pixels all around: wider, or narrower if negative.
pub fn grown(mask: &Mask, px: i32) -> Mask {
    let (width, height) = (mask.width(), mask.height());
    let mut grown = mask.clone();
    for _ in 0..px.unsigned_abs() {
        let before = grown.clone();
        let is_set = |u: usize, v: usize| before.data()[v * width + u] != 0;
        for (i, pixel) in grown.data_mut().iter_mut().enumerate() {
            let (u, v) = (i % width, i / width);
            let near =
                [(u.max(1) - 1, v), ((u + 1).min(width - 1), v), (u, v.max(1) - 1), (u, (v + 1).min(height - 1))];
            let changes = near.iter().any(|&(u, v)| is_set(u, v) == (px > 0));
            if changes {
                *pixel = u8::from(px > 0);
            }
        }
    }
    grown
}

/// A mask with round holes all over it, which take about a third.
pub fn holed(mask: &Mask) -> Mask {
    let width = mask.width();
    let area = mask.data().iter().filter(|m| **m != 0).count() as f64;
    let period = (area.sqrt() / HOLES_ACROSS).max(2.0);
    let radius = period * (HOLES / PI).sqrt();
    let mut holed = mask.clone();
    for (i, pixel) in holed.data_mut().iter_mut().enumerate() {
        // From the centre of the hole that is nearest.
        let [x, y] = [i % width, i / width].map(|at| (at as f64 / period).fract() - 0.5);
        if (x * x + y * y).sqrt() * period < radius {
            *pixel = 0;
        }
    }
    holed
}
