//! Depth maps as depth models give them for a photo, made from depth with a known truth.

use super::noise::{convolved, gaussian};
use crate::prelude::*;
use crate::statistics::median;
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::image::bounds_of;

/// The longer side of the images that networks take, pixels.
const NETWORK_PX: f64 = 500.0;
/// The nearest depth that a model gives, as a share of the distance of the objects.
const NEAREST: f64 = 0.02;
/// Share of the pixels that an export leaves beyond each end of its range.
const BEYOND: f64 = 2e-4;
/// The relative standard deviation of a doubted focal length.
const FOCAL_DOUBT: f64 = 0.1;
/// The horizontal field of view of an unknown camera, degrees, and the standard deviation of the logarithm of its focal
/// length.
const GUESSED_VIEW: (f64, f64) = (60.0, 0.25);
/// Range of the factors of maps in an unknown unit.
const ANY_FACTOR: [f64; 2] = [0.3, 3.0];
/// Lengths of the waves of a bend, in widths of the objects. Amplitudes are proportional to lengths, so all waves are equally
/// steep: errors of networks are smooth.
const WAVES: [f64; 2] = [4.0, 1.0];

/// The focal length as it is given.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FocalFault {
    None,
    /// Wrong by this share, and doubted.
    Wrong(f64),
    Unknown,
}

/// A kind of depth model: the kind that its maps state, and their errors. Shares have a random sign.
#[derive(Debug)]
pub struct DepthModel {
    pub name: &'static str,
    kind: DepthKind,
    /// Share by which the map is too far; `None` for an unknown unit.
    factor: Option<f64>,
    /// Added to depth before the factor, as a share of the distance of the objects.
    shift: f64,
    /// Largest share of smooth errors.
    bend: f64,
    /// Standard deviation of a blur, as a share of the width of the objects.
    blur: f64,
    /// Width of the ramps at edges, pixels of the network.
    ramp: f64,
    /// Whether the model's own output, which it blurs, is inverse depth.
    is_inverse: bool,
    /// Bits of an integer export from 0 to 1 of inverse depth; 0 for depth.
    bits: u32,
    focal: FocalFault,
}

const FILLED: DepthModel = DepthModel {
    name: "filled",
    kind: DepthKind::Metric,
    factor: Some(0.0),
    shift: 0.0,
    bend: 0.0,
    blur: 0.0,
    ramp: 0.0,
    is_inverse: false,
    bits: 0,
    focal: FocalFault::None,
};
const DISPARITY: DepthModel = DepthModel {
    name: "disparity",
    kind: DepthKind::AffineInvariantDisparity,
    ramp: 3.0,
    is_inverse: true,
    bits: 16,
    ..FILLED
};

/// The depth models of the benchmark.
pub const DEPTH_MODELS: &[DepthModel] = &[
    FILLED,
    DepthModel { name: "scaled", factor: Some(0.15), ..FILLED },
    DepthModel { name: "scale-invariant", kind: DepthKind::ScaleInvariant, factor: Some(0.15), ..FILLED },
    DepthModel { name: "shifted", kind: DepthKind::AffineInvariant, factor: None, shift: 0.12, ..FILLED },
    DISPARITY,
    DepthModel { name: "disparity-8", bits: 8, ..DISPARITY },
    DepthModel { name: "bent", bend: 0.02, ..FILLED },
    DepthModel { name: "blurred", blur: 1.0 / 40.0, ramp: 3.0, ..FILLED },
    DepthModel { name: "blurred-disparity", blur: 1.0 / 40.0, ramp: 3.0, is_inverse: true, ..FILLED },
    DepthModel {
        name: "mild",
        factor: Some(0.06),
        shift: 0.04,
        bend: 0.007,
        blur: 0.01,
        ramp: 2.0,
        focal: FocalFault::Wrong(0.05),
        ..FILLED
    },
    DepthModel { name: "focal-wrong", focal: FocalFault::Wrong(0.165), ..FILLED },
    DepthModel { name: "focal-unknown", focal: FocalFault::Unknown, ..FILLED },
    DepthModel { name: "disparity-focal-unknown", focal: FocalFault::Unknown, ..DISPARITY },
];

impl DepthModel {
    /// The model of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        DEPTH_MODELS.iter().find(|model| model.name == name)
    }

    /// The map of an image with objects in these masks. Images with other names get other errors; all models see one image
    /// with the same signs.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] for an image without objects or readings.
    pub fn predict(&self, name: &str, depth: &DepthMap, masks: &[&Mask], camera: Pinhole) -> Result<RawView> {
        let random = &mut Random::new(u64::from(crc32fast::hash(name.as_bytes())), 0);
        let signs: [f64; 3] = core::array::from_fn(|_| sign(random));
        let unit = libm::exp(between(random, libm::log(ANY_FACTOR[0]), libm::log(ANY_FACTOR[1])));
        let (width, height) = (depth.width(), depth.height());
        // Only generated depth has steps at edges, of which a model makes ramps.
        let has_steps = depth.data().iter().all(|z| *z > 0.0);
        // Models give depth everywhere.
        let farthest = depth.data().iter().copied().fold(0.0, f32::max);
        let mut values: Vec<f64> =
            depth.data().iter().map(|&z| f64::from(if z > 0.0 { z } else { farthest })).collect();
        let (distance, object_width_px) = extent(&values, masks).ok_or_else(|| {
            let remedy = "Leave this image out.";
            Error::new(ErrorCode::InvalidArgument, "objects", "no pixel of an object", "at least one mask", remedy)
        })?;
        if self.bend > 0.0 {
            bend(&mut values, width, object_width_px, self.bend, random);
        }
        let ramp = if has_steps { self.ramp * width.max(height) as f64 / NETWORK_PX } else { 0.0 };
        let soften = |values: &[f64]| {
            let blurred = convolved(values, width, &gaussian(self.blur * object_width_px));
            convolved(&blurred, width, &uniform(ramp))
        };
        let inverse = |values: &[f64]| -> Vec<f64> { values.iter().map(|z| 1.0 / z).collect() };
        values = if self.is_inverse { inverse(&soften(&inverse(&values))) } else { soften(&values) };
        values = if self.bits > 0 {
            exported(&inverse(&values), self.bits)
        } else {
            let factor = self.factor.map_or(unit, |share| 1.0 + signs[0] * share);
            let shift = signs[1] * self.shift * distance;
            values.iter().map(|z| factor * (z + shift).max(NEAREST * distance)).collect()
        };
        let values = Image::new("depth", width, height, values.into_iter().map(|x| x as f32).collect())?;
        let (camera, focal) = match self.focal {
            FocalFault::None => (camera, Focal::Known),
            FocalFault::Wrong(share) => {
                let factor = 1.0 + signs[2] * share;
                let (fx, fy) = (factor * camera.fx, factor * camera.fy);
                (Pinhole { fx, fy, ..camera }, Focal::Guessed(FOCAL_DOUBT))
            }
            FocalFault::Unknown => {
                let (degrees, deviation) = GUESSED_VIEW;
                let (width, height) = (width as f64, height as f64);
                let focal = 0.5 * width / libm::tan(0.5 * degrees.to_radians());
                let camera = Pinhole::new(focal, focal, 0.5 * (width - 1.0), 0.5 * (height - 1.0))?;
                (camera, Focal::Guessed(deviation))
            }
        };
        Ok(RawView { values, kind: self.kind, camera, focal })
    }
}

/// Median distance of the objects, metres, and their median width, pixels.
fn extent(depth: &[f64], masks: &[&Mask]) -> Option<(f64, f64)> {
    let distance =
        |mask: &&Mask| median(depth.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(z, _)| *z).collect());
    let width = |mask: &&Mask| {
        let [width, height] = bounds_of(mask.data(), mask.width(), |m| *m != 0).map(|[low, high]| high + 1 - low);
        ((width * height) as f64).sqrt()
    };
    median(masks.iter().filter_map(distance).collect()).zip(median(masks.iter().map(width).collect()))
}

/// Waves across the image: factors on depth, the largest of which is 1 + `amplitude`.
fn bend(depth: &mut [f64], width: usize, object_width_px: f64, amplitude: f64, random: &mut Random) {
    let all: f64 = WAVES.iter().sum();
    let waves = WAVES.map(|length| {
        let frequency = crate::world::unit(TAU * random.uniform()) * (TAU / (length * object_width_px));
        (frequency, TAU * random.uniform(), amplitude * length / all)
    });
    for (i, z) in depth.iter_mut().enumerate() {
        let at = DVec2::new((i % width) as f64, (i / width) as f64);
        let wave = |(frequency, phase, most): &(DVec2, f64, f64)| most * libm::cos(frequency.dot(at) + phase);
        *z *= 1.0 + waves.iter().map(wave).sum::<f64>();
    }
}

/// Inverse depth as exports have it: from 0 to 1 over the image, in steps.
fn exported(inverse: &[f64], bits: u32) -> Vec<f64> {
    let mut sorted = inverse.to_vec();
    sorted.sort_by(f64::total_cmp);
    let beyond = (BEYOND * sorted.len() as f64) as usize;
    let (low, high) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
    let range = (high - low).max(1e-6 * high);
    let steps = f64::from((1u32 << bits) - 1);
    inverse.iter().map(|x| (((x - low) / range).clamp(0.0, 1.0) * steps).round() / steps).collect()
}

/// The middle and one side of a box kernel, whose width in pixels need not be whole.
fn uniform(width: f64) -> Vec<f64> {
    let half = 0.5 * width.max(1.0);
    (0..=half.ceil() as usize).map(|i| (half + 0.5 - i as f64).clamp(0.0, 1.0)).collect()
}
