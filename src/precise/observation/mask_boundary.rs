//! Rim: where the outline of the object is, by the mask and by the depth map.
//!
//! A mask that is too large or too small all around would bias the scale. If the background is farther away than the
//! object, the depth map shows the outline as well, but sensors move it: stereo widens objects, structured light and time
//! of flight erode them, and depth may be shifted against the photo that the mask was drawn in. What moves an edge also
//! scatters it. The offset between the two outlines is therefore weighed by its scatter across the rim, against the errors
//! that masks have.

use crate::geometry::order::{median, quantile};

/// Steps of a ray across the rim, pixels, inwards (negative) to outwards.
const STEP: f64 = 0.5;
/// The parts of a ray where the depths of the object and of the background are read.
const INSIDE: [f64; 2] = [-9.0, -3.0];
const OUTSIDE: [f64; 2] = [4.0, 9.0];
/// Distance inside the outline at which depths certainly belong to the object, pixels.
const DEEP: f32 = 2.0;
/// Maximum gap without readings, pixels; in larger gaps, the position of the outline is unknown.
const MAX_GAP: f64 = 2.0;
/// Minimum number of rays with an outline, and their minimum share of the rim.
const MIN_RAYS: usize = 24;
const MIN_SHARE: f64 = 0.12;
/// Errors of masks, pixels: standard deviations of the usual ones and of the rare ones, which are too large or too small
/// all around, and the share of the rare ones.
const USUAL: f64 = 0.7;
const RARE: f64 = 2.5;
const RARE_SHARE: f64 = 0.1;
/// Standard deviation of the offset of a depth edge: of an exact one, pixels, and relative to its scatter. On real sensors,
/// edges with a scatter (90th percentile) of 1 to 4 pixels are off by 1 to 5.
const EXACT: f64 = 0.3;
const OF_SCATTER: f64 = 1.5;
/// Standard deviation of a shift between mask and depth map, pixels, which rays on one side of the object show as an
/// offset.
const SHIFT: f64 = 2.0;

/// The images that the rim is found in, row by row.
#[derive(Clone, Copy)]
pub struct BoundaryImages<'a> {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Signed distance to the outline of the mask, pixels, negative inside.
    pub outline: &'a [f32],
    /// Every reading, metres; 0 for none.
    pub scene: &'a [f32],
}

/// The most likely offset of the outline from that of the mask, pixels: positive if the mask is too small; 0 if the depth map
/// does not show it.
pub fn boundary_offset(images: BoundaryImages<'_>, jump_m: f64) -> f64 {
    let (mut rim, mut offsets, mut side) = (0usize, Vec::new(), [0.0, 0.0]);
    images.rays(|ray| {
        rim += 1;
        let Some(ray) = ray else { return };
        if let Some(t) = ray.crossing(jump_m) {
            offsets.push((t - 0.5) as f32);
            side.iter_mut().zip(ray.direction).for_each(|(sum, x)| *sum += x);
        }
    });
    if offsets.len() < MIN_RAYS || (offsets.len() as f64) < MIN_SHARE * rim as f64 {
        return 0.0;
    }
    let middle = median(offsets.iter().copied()).unwrap_or(0.0);
    let scatter = quantile(offsets.iter().map(|t| (t - middle).abs()), 0.9).map_or(f64::INFINITY, f64::from);
    // The mean of the values near the median, because rays step by half a pixel.
    let near = || offsets.iter().filter(|t| (**t - middle).abs() <= 1.0);
    let offset = near().map(|t| f64::from(*t)).sum::<f64>() / near().count().max(1) as f64;
    let count = offsets.len() as f64;
    let one_sided = (side[0] * side[0] + side[1] * side[1]) / (count * count);
    most_likely(offset, EXACT * EXACT + (OF_SCATTER * scatter).powi(2) + SHIFT * SHIFT * one_sided)
}

/// The mean of the offset, given a measurement of it with this variance.
fn most_likely(measured: f64, variance: f64) -> f64 {
    let [usual, rare] = [(USUAL, 1.0 - RARE_SHARE), (RARE, RARE_SHARE)].map(|(deviation, share)| {
        let total = deviation * deviation + variance;
        (share * libm::exp(-0.5 * measured * measured / total) / total.sqrt(), deviation * deviation / total)
    });
    let mean = usual.0 * usual.1 + rare.0 * rare.1;
    if mean > 0.0 { measured * mean / (usual.0 + rare.0) } else { 0.0 }
}

impl<'a> BoundaryImages<'a> {
    /// Visits the rays across the rim: one for each of the outermost pixels of the mask, `None` where the outline has no
    /// direction.
    pub fn rays(self, mut visit: impl FnMut(Option<Ray<'a>>)) {
        let Self { width, height, outline: signed, .. } = self;
        for v in 2..height.saturating_sub(2) {
            for u in 2..width.saturating_sub(2) {
                let i = v * width + u;
                if signed[i] >= 0.0 || signed[i] < -0.5 {
                    continue;
                }
                let slope = [
                    f64::from(signed[i + 2] - signed[i - 2]),
                    f64::from(signed[i + 2 * width] - signed[i - 2 * width]),
                ];
                let length = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
                let direction = slope.map(|x| x / length);
                visit((length >= 1.0).then_some(Ray { images: self, start: [u as f64, v as f64], direction }));
            }
        }
    }
}

/// A line across the rim.
pub struct Ray<'a> {
    images: BoundaryImages<'a>,
    start: [f64; 2],
    direction: [f64; 2],
}

impl Ray<'_> {
    /// The reading `t` pixels outwards from the start; `None` if there is none.
    pub fn depth(&self, t: f64) -> Option<f64> {
        let z = self.images.scene[self.pixel(t)?];
        (z > 0.0).then_some(f64::from(z))
    }

    fn pixel(&self, t: f64) -> Option<usize> {
        let at = [0, 1].map(|axis| self.start[axis] + t * self.direction[axis] + 0.5);
        let (width, height) = (self.images.width, self.images.height);
        let inside = at[0] >= 0.0 && at[1] >= 0.0 && at[0] < width as f64 && at[1] < height as f64;
        inside.then(|| at[1] as usize * width + at[0] as usize)
    }

    /// The median reading of a segment of the ray, over pixels at least `inside` from the outline of the mask.
    fn median(&self, [from, to]: [f64; 2], inside: f32) -> Option<f64> {
        let steps = (to - from) as usize;
        let stretch = (0..=steps).map(|k| from + k as f64);
        // In a thin object, the ray leaves on the other side.
        let depths = stretch.filter(|t| self.outline(*t) <= -inside).filter_map(|t| self.depth(t));
        median(depths.map(|z| z as f32)).map(f64::from)
    }

    /// The signed distance to the outline of the mask there.
    pub fn outline(&self, t: f64) -> f32 {
        self.pixel(t).map_or(f32::INFINITY, |i| self.images.outline[i])
    }

    /// The position where the depth steps from the object to at least `jump_m` behind it.
    fn crossing(&self, jump_m: f64) -> Option<f64> {
        let (inside, outside) = (self.median(INSIDE, DEEP)?, self.median(OUTSIDE, f32::NEG_INFINITY)?);
        if outside - inside < jump_m {
            return None;
        }
        let middle = 0.5 * (inside + outside);
        let steps = ((OUTSIDE[1] - INSIDE[0]) / STEP) as usize;
        let mut last_near = None;
        for k in 0..=steps {
            let t = INSIDE[0] + k as f64 * STEP;
            match self.depth(t) {
                Some(z) if z < middle => last_near = Some(t),
                Some(_) => {
                    let near = last_near?;
                    return (t - near <= MAX_GAP).then_some(0.5 * (t + near));
                }
                None => {}
            }
        }
        None
    }
}
