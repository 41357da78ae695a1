//! Masks of segmentation networks: a logit image of 256 cells on the longer side, enlarged to the photo. Corners are
//! rounded, parts thinner than a cell are lost, and the outline is off in places.

use super::mask::{Noise, Outline};
use super::scene::Scene;
use super::tier::Tier;
use crate::prelude::*;
use sim3align_geometry::image::bounds_of;

/// Cells on the longer side of the logit image.
const CELLS: f64 = 256.0;
/// Blur of the logits, cells.
const BLUR: f64 = 0.6;
/// Reach of the blur, in its deviations.
const REACH: f64 = 2.5;
/// Coverage at which logits saturate.
const LEAST_COVERAGE: f64 = 0.003;
/// Slope of the logistic function that is closest to the normal distribution's.
const LOGISTIC: f64 = 1.702;
/// Size of the places where the outline is off, cells of the logit image.
const PLACES: f64 = 4.0;
/// Most that the outline is off, in deviations of the blur.
const MOST: f64 = 2.5;
/// Cells around the object.
const MARGIN: f64 = 8.0;

/// The outline of a network; `closer` is the ratio of its cells to those of the whole image, below 1 where it sees a crop.
pub fn segmented(scene: &Scene, tier: Tier, closer: f64, random: &mut Random) -> Outline {
    let (width, height) = (scene.width, scene.height);
    let cell = (width.max(height) as f64 / CELLS * closer).max(1.0);
    // A cell of an image 640 wide has 2.5 pixels.
    let resolution = cell / 2.5;
    let bias = resolution * (tier.pick(0.0, 0.3, 0.4) + tier.pick(0.3, 0.5, 0.8) * normal(random)).clamp(-1.5, 2.0);
    let amplitude = resolution * between(random, 0.6, 1.0) * tier.pick(1.6, 2.8, 4.0);
    let noise = Noise::new(scene, PLACES * cell, random);
    let sigma = BLUR * cell;
    let grid = Grid::around(scene, cell);
    let reach = (REACH * sigma).ceil() as isize;
    let kernel: Vec<f64> = (-reach..=reach).map(|k| libm::exp(-0.5 * libm::pow(k as f64 / sigma, 2.0))).collect();
    let logit = |u: usize, v: usize| {
        let (mut covered, mut total) = (0.0, 0.0);
        for (dv, row) in (-reach..=reach).zip(&kernel) {
            for (du, column) in (-reach..=reach).zip(&kernel) {
                let (Some(x), Some(y)) = (u.checked_add_signed(du), v.checked_add_signed(dv)) else { continue };
                if x < width && y < height {
                    total += row * column;
                    covered += if scene.visible[y * width + x] { row * column } else { 0.0 };
                }
            }
        }
        let share = (covered / total).clamp(LEAST_COVERAGE, 1.0 - LEAST_COVERAGE);
        // The distance at which a straight outline has this coverage.
        let distance = sigma / LOGISTIC * libm::log(share / (1.0 - share));
        distance + (bias + amplitude * noise.at(u, v)).clamp(-MOST * sigma, MOST * sigma)
    };
    let logits: Vec<f64> = grid.centres(width, height).map(|[u, v]| logit(u, v)).collect();
    let inside = (0..width * height).map(|i| grid.between(&logits, (i % width) as f64, (i / width) as f64) > 0.0);
    Outline { inside: inside.collect(), offset_px: bias, kind: "network-mask" }
}

/// Cells around the object.
struct Grid {
    cell: f64,
    /// First cell, and number of cells.
    first: [usize; 2],
    count: [usize; 2],
}

impl Grid {
    fn around(scene: &Scene, cell: f64) -> Self {
        let bounds = bounds_of(&scene.visible, scene.width, |visible| *visible);
        let [low, high] = [0, 1].map(|end| bounds.map(|range| range[end]));
        let first = low.map(|x| (x as f64 / cell - MARGIN).max(0.0) as usize);
        let sides = [scene.width, scene.height];
        let count = [0, 1].map(|axis| {
            let all = (sides[axis] as f64 / cell).ceil() as usize;
            ((high[axis] as f64 / cell + MARGIN) as usize).min(all.max(1) - 1).saturating_sub(first[axis]) + 1
        });
        Self { cell, first, count }
    }

    /// The pixels at the cells' centres, row by row.
    fn centres(&self, width: usize, height: usize) -> impl Iterator<Item = [usize; 2]> {
        let at = |k: usize, side: usize| (((k as f64 + 0.5) * self.cell) as usize).min(side - 1);
        let (columns, rows) = (self.count[0], self.count[1]);
        (0..rows)
            .flat_map(move |j| (0..columns).map(move |i| [at(self.first[0] + i, width), at(self.first[1] + j, height)]))
    }

    /// The value at a pixel, between those of the four cells about it; below 0 far from the object.
    fn between(&self, values: &[f64], u: f64, v: f64) -> f64 {
        let place = |x: f64, axis: usize| (x + 0.5) / self.cell - 0.5 - self.first[axis] as f64;
        let [x, y] = [place(u, 0), place(v, 1)];
        let [last_x, last_y] = self.count.map(|count| count as f64 - 1.0);
        if x < -1.0 || y < -1.0 || x > last_x + 1.0 || y > last_y + 1.0 {
            return -1.0;
        }
        let [x, y] = [x.clamp(0.0, last_x), y.clamp(0.0, last_y)];
        let (i, j) = (x as usize, y as usize);
        let (s, t) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| values[j.min(self.count[1] - 1) * self.count[0] + i.min(self.count[0] - 1)];
        let [top, bottom] = [j, j + 1].map(|j| value(i, j) * (1.0 - s) + value(i + 1, j) * s);
        top * (1.0 - t) + bottom * t
    }
}
