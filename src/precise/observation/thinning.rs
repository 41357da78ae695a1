//! Thinning: the rows and columns of an image that are used.

use crate::evidence::observation::Observation;
use crate::geometry::pinhole::Pinhole;

/// Number of mask pixels that are enough: 16 samples in each of the 7000 cells of the finest grid. Of a mask with four
/// times as many, every second row and column is used, and so on.
const ENOUGH_PIXELS: usize = 16 * 7000;
/// Maximum number of pixels around the mask, which may consist of specks that are far apart: a little more than those of a
/// 4K image.
const MAX_PIXELS: usize = 1 << 23;

/// Every `step`-th row and column of an image. The first one is such that the remaining pixels are, to half a pixel, in the
/// centres of the blocks that they stand for.
#[derive(Debug, Clone, Copy)]
pub struct Thinning {
    /// The distance of the rows and columns, in pixels.
    pub step: usize,
    first: usize,
}

impl Thinning {
    /// The thinning for an observation with `around` pixels in and around it.
    pub fn of(observation: &Observation, around: usize) -> Self {
        let (mask, pixels) = (observation.mask(), observation.pixels().count());
        let of_step = |step: usize| Self { step, first: (step - 1) / 2 };
        let least = (1..).find(|step| around / (step * step) <= MAX_PIXELS).unwrap_or(1);
        let thinned = of_step((pixels / ENOUGH_PIXELS).isqrt().max(least));
        if thinned.step == least {
            return thinned;
        }
        let remaining = thinned
            .indices(mask.height())
            .flat_map(|v| thinned.indices(mask.width()).filter(move |&u| mask.get(u, v).is_some_and(|m| m != 0)));
        // A pattern, such as every second row, would vanish or fill the image.
        let is_like_mask = (pixels / 2..=2 * pixels).contains(&(remaining.count() * thinned.step * thinned.step));
        if is_like_mask { thinned } else { of_step(least) }
    }

    /// The image positions of the remaining pixels along a side of this length.
    fn indices(self, side: usize) -> impl Iterator<Item = usize> {
        (self.first..side).step_by(self.step)
    }

    /// Number of pixels that remain of a side.
    pub fn count(self, side: usize) -> usize {
        side.saturating_sub(self.first).div_ceil(self.step)
    }

    /// The image position of a remaining pixel along one side.
    pub fn at(self, index: usize) -> usize {
        self.first + index * self.step
    }

    /// The camera of the remaining pixels.
    pub fn camera(self, camera: &Pinhole) -> Pinhole {
        camera.thinned([self.first; 2], self.step)
    }
}
