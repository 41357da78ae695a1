//! Fills the holes of depth maps.

use crate::prelude::*;

/// Rounds that smooth what was filled, and by how much each goes too far, which makes them converge sooner.
const ROUNDS: usize = 120;
const OVERSHOOT: f64 = 1.7;

/// The map without holes: what an object or the background lacks comes from its own readings around. `masks` are the
/// objects; where they overlap, the first counts. Depth of a model has no holes.
///
/// Inverse depth is what is continued, smoothly: that of a plane is linear in the image.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] for a map without readings.
pub fn filled(depth: &DepthMap, masks: &[&Mask]) -> Result<Vec<f64>> {
    let (width, height) = (depth.width(), depth.height());
    if depth.data().iter().all(|z| *z <= 0.0) {
        let remedy = "Leave this image out.";
        return Err(Error::new(ErrorCode::InvalidArgument, "depth", "no readings", "a map with readings", remedy));
    }
    let labels: Vec<usize> = (0..width * height)
        .map(|i| masks.iter().position(|mask| mask.data()[i] != 0).map_or(0, |object| object + 1))
        .collect();
    let mut inverse: Vec<f64> = depth.data().iter().map(|&z| if z > 0.0 { 1.0 / f64::from(z) } else { 0.0 }).collect();
    let holes: Vec<usize> = (0..inverse.len()).filter(|&i| inverse[i] == 0.0).collect();
    let readings = inverse.clone();
    for label in 0..=masks.len() {
        let of_label: Vec<usize> = holes.iter().copied().filter(|&i| labels[i] == label).collect();
        if of_label.is_empty() {
            continue;
        }
        let has_readings = readings.iter().zip(&labels).any(|(x, l)| *x > 0.0 && *l == label);
        // An object without any reading gets those around it.
        let counts = |i: usize| readings[i] > 0.0 && (labels[i] == label || !has_readings);
        let level = Level::new(width, height, |i| if counts(i) { [readings[i], 1.0] } else { [0.0; 2] });
        let coarse = level.continued();
        of_label.iter().for_each(|&i| inverse[i] = coarse[i]);
    }
    // Rounds of successive over-relaxation towards the mean of the neighbours of the same label.
    for _ in 0..ROUNDS {
        for &i in &holes {
            let (u, v) = (i % width, i / width);
            let neighbours = [
                (u > 0).then(|| i - 1),
                (u + 1 < width).then(|| i + 1),
                (v > 0).then(|| i - width),
                (v + 1 < height).then(|| i + width),
            ];
            let same = neighbours.into_iter().flatten().filter(|&j| labels[j] == labels[i]);
            let (sum, count) = same.fold((0.0, 0.0), |(sum, count), j| (sum + inverse[j], count + 1.0));
            if count > 0.0 {
                let relaxed = inverse[i] + OVERSHOOT * (sum / count - inverse[i]);
                // Going too far must not go through infinity.
                inverse[i] = relaxed.max(0.5 * sum / count);
            }
        }
    }
    Ok(inverse.into_iter().map(|x| 1.0 / x).collect())
}

/// A level of a pyramid of sums and weights.
struct Level {
    width: usize,
    height: usize,
    sums: Vec<[f64; 2]>,
}

impl Level {
    fn new(width: usize, height: usize, of: impl Fn(usize) -> [f64; 2]) -> Self {
        Self { width, height, sums: (0..width * height).map(of).collect() }
    }

    fn coarser(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let sum = |i: usize| {
            let (u, v) = (2 * (i % width), 2 * (i / width));
            let columns = u..(u + 2).min(self.width);
            let cells = (v..(v + 2).min(self.height)).flat_map(|y| columns.clone().map(move |x| y * self.width + x));
            cells.fold([0.0; 2], |[a, b], cell| [a + self.sums[cell][0], b + self.sums[cell][1]])
        };
        Self::new(width, height, sum)
    }

    /// The mean of each cell and, where it has none, that of the coarser level.
    fn continued(&self) -> Vec<f64> {
        let is_whole = self.sums.iter().all(|[_, weight]| *weight > 0.0) || self.sums.len() == 1;
        let coarse = if is_whole { Vec::new() } else { self.coarser().continued() };
        let width = self.width.div_ceil(2);
        let cell = |(i, [sum, weight]): (usize, &[f64; 2])| {
            if *weight > 0.0 { sum / weight } else { coarse[i / self.width / 2 * width + i % self.width / 2] }
        };
        self.sums.iter().enumerate().map(cell).collect()
    }
}
