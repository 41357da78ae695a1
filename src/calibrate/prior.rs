//! The prior on what is unknown of a view, from what photos show.
//!
//! An object that is seen from the front is little evidence of its relief, and noise hides that. The prior keeps such objects from
//! being flattened.

use super::raw_view::{Focal, RawView};
use super::unknowns::{Reference, Unknowns};
use crate::geometry::order::quantile;
use crate::precise::scoring::conditioning::DROP;

/// Relief of objects beside their width: median, and standard deviation of the logarithm.
const RELIEF: [f64; 2] = [0.4, 0.6];
/// Logarithm of the ratio of far to near in a photo, without the outermost readings: median, and standard deviation of its
/// logarithm.
const RANGE: [f64; 2] = [1.1, 0.8];
/// Shares of the readings that are nearer than near, and nearer than far.
const OUTERMOST: [f64; 2] = [0.02, 0.98];
/// Least depth of a reading, which a shift may put behind the camera, relative to the distance of the objects; and least
/// logarithm of that ratio.
const NEAREST: f64 = 1e-3;
const LEAST_RANGE: f64 = 1e-3;
/// Weight of the prior on the depth: the errors of sensors, depth models and meshes are the same over whole parts of an
/// object, so that its score falls more steeply than it should. From 3 to 8, the errors on real objects are about the same.
const WEIGHT: f64 = 3.0;
/// Step of the second differences of the prior, and the least precision: a shift may put what is far near infinity, where
/// the prior bends down.
const STEP: f64 = 0.1;
const LEAST_PRECISION: f64 = 1.0;

/// The prior of a view.
pub struct Prior<'a> {
    view: &'a RawView,
    reference: Reference,
    /// The value of near and far, in any order.
    range: [f64; 2],
}

impl<'a> Prior<'a> {
    /// The prior of a view.
    pub fn of(view: &'a RawView, reference: Reference) -> Self {
        let values = || view.values.data().iter().copied().filter(|d| d.is_finite());
        let range = if view.kind.is_affine() {
            OUTERMOST.map(|share| quantile(values(), share).map_or(0.0, f64::from))
        } else {
            [0.0; 2]
        };
        Self { view, reference, range }
    }

    /// The cost in units of the score: [`DROP`] at one standard deviation of the focal length.
    pub fn cost(&self, at: Unknowns) -> f64 {
        let square = |x: f64| x * x;
        let mut cost = 0.0;
        if self.view.kind.is_affine() {
            let calibration = self.reference.calibration(self.view.kind, at);
            let [a, b] = self.range.map(|d| calibration.depth(self.view.kind, d).max(NEAREST));
            let range = libm::log((a / b).max(b / a)).max(LEAST_RANGE);
            cost += WEIGHT * square((at.relief - libm::log(RELIEF[0])) / RELIEF[1]);
            cost += WEIGHT * square(libm::log(range / RANGE[0]) / RANGE[1]);
        }
        if let Focal::Guessed(deviation) = self.view.focal {
            cost += square(at.focal / deviation);
        }
        DROP * cost
    }

    /// The inverse of the variance of the relief or of the focal length.
    pub fn precision(&self, at: Unknowns, relief: bool) -> f64 {
        let [below, here, above] = [-STEP, 0.0, STEP].map(|by| self.cost(at.moved(relief, by)));
        let weight = if relief { WEIGHT } else { 1.0 };
        ((below - 2.0 * here + above) / (2.0 * STEP * STEP * DROP * weight)).max(LEAST_PRECISION)
    }
}
