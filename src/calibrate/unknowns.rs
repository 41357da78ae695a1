//! Unknowns: the numbers that are estimated, in units that are the same for every depth map.

use super::calibration::Calibration;
use super::profile::CalibrationObject;
use super::raw_view::RawView;
use crate::geometry::depth_kind::DepthKind;
use crate::geometry::image::bounds_of;
use crate::geometry::order::{median, quantile};

/// The shares of the values of an object between which its relief is measured: its outline may be blurred.
const RELIEF: [f64; 2] = [0.1, 0.9];
/// The relief is at most so many times the range between the quartiles: 1.3 to 2.6 on real objects, and 38 on a mostly hidden
/// bowl, whose mask shows the table in more than a tenth of its readings.
const WIDEST: f32 = 3.0;
const QUARTILES: [f64; 2] = [0.25, 0.75];

/// Logarithms of the relief of the objects beside their width, ρ, and of the focal length relative to the guess. An object
/// determines ρ, whatever the focal length is, and the focal length only by its perspective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unknowns {
    /// ln ρ; without meaning where the shift is known.
    pub relief: f64,
    /// Logarithm of the focal length, relative to the guess.
    pub focal: f64,
}

impl Unknowns {
    /// One of them, changed.
    pub fn moved(self, relief: bool, by: f64) -> Self {
        if relief { Self { relief: self.relief + by, ..self } } else { Self { focal: self.focal + by, ..self } }
    }
}

/// The inputs that [`Unknowns`] refer to.
#[derive(Debug, Clone, Copy)]
pub struct Reference {
    /// The value of the objects, in the median.
    value: f64,
    /// Their relief per width, in the unit of the values, with the focal length of the guess.
    relief: f64,
}

impl Reference {
    /// The reference of the objects of a view; `None` without a reading.
    pub fn of<'a>(view: &RawView, subjects: impl Iterator<Item = &'a CalibrationObject<'a>>) -> Option<Self> {
        let (mut middles, mut reliefs) = (Vec::new(), Vec::new());
        for CalibrationObject { mask, .. } in subjects {
            let pixels = view.values.data().iter().zip(mask.data());
            let values = || pixels.clone().filter(|(d, m)| **m != 0 && d.is_finite()).map(|(d, _)| *d);
            let bounds = bounds_of(mask.data(), mask.width(), |m| *m != 0);
            let side = bounds.iter().map(|[low, high]| high + 1 - low).max()? as f64;
            let range = |[low, high]: [f64; 2]| Some(quantile(values(), high)? - quantile(values(), low)?);
            let Some((whole, inner)) = range(RELIEF).zip(range(QUARTILES)) else { continue };
            let relief = if inner > 0.0 { whole.min(WIDEST * inner) } else { whole };
            middles.push(median(values())?);
            reliefs.push((f64::from(relief) * view.camera.fx / side) as f32);
        }
        let [value, relief] = [median(middles.into_iter())?, median(reliefs.into_iter())?].map(f64::from);
        (relief > 0.0).then_some(Self { value, relief })
    }

    /// The calibration. That of a relative depth map has the objects at a distance of 1.
    pub fn calibration(&self, kind: DepthKind, unknowns: Unknowns) -> Calibration {
        let focal = libm::exp(unknowns.focal);
        // d + t at the objects: their relief is ρ · width / focal of it.
        let value = self.relief * focal / libm::exp(unknowns.relief);
        let shift = value - self.value;
        match kind {
            DepthKind::Metric | DepthKind::ScaleInvariant => Calibration { focal, ..Calibration::default() },
            DepthKind::AffineInvariant => Calibration { scale: 1.0 / value, shift, focal },
            DepthKind::AffineInvariantDisparity => Calibration { scale: value, shift, focal },
        }
    }
}
