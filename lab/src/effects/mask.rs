//! Masks with the errors of segmentation networks and of annotators.

use super::noise::{Noise, convolved, disc, gaussian};
use crate::conditions::{Conditions, Framing, MaskSource, Tier};
use crate::prelude::*;
use crate::world::view::Rendering;

/// Share of the masks that networks make; annotators make the others.
const NETWORKS: f64 = 0.63;
/// Coverage at which the logits of a network saturate.
const LEAST_COVERAGE: f64 = 0.003;
/// Slope of the logistic function that is closest to the normal distribution's.
const LOGISTIC: f64 = 1.702;
/// Most that an outline is off, in deviations of the blur.
const MOST: f64 = 2.5;

/// Errors of a source of masks by tier, in pixels of an image 640 wide.
struct MaskErrors {
    /// Deviation of the blur, which rounds corners and loses thin parts.
    blur: [f64; 3],
    /// Mean and deviation of the offset of the whole outline.
    offset: [[f64; 2]; 3],
    /// Largest offset that changes along the outline, and the size of the places where it does.
    wobble: [f64; 3],
    place: f64,
    /// Ratio of its pixels to those of the image for a few hundred pixels of an object: networks and annotators see a crop.
    crop: f64,
}

/// Logits of 256 cells on the longer side, blurred and enlarged to the photo.
const NETWORK: MaskErrors = MaskErrors {
    blur: [1.8, 1.8, 1.8],
    offset: [[0.0, 0.3], [0.3, 0.5], [0.4, 0.8]],
    wobble: [1.6, 2.8, 4.0],
    place: 10.0,
    crop: 0.4,
};
/// Polygons whose corners are right within about a pixel, as dense as patience allows.
const ANNOTATOR: MaskErrors = MaskErrors {
    blur: [0.8, 1.1, 1.4],
    offset: [[0.0, 0.2], [0.0, 0.3], [0.0, 0.4]],
    wobble: [1.2, 2.0, 2.8],
    place: 12.0,
    crop: 0.5,
};

/// A mask with simulated errors, and their names.
pub fn mask_of(
    rendering: &Rendering,
    conditions: Conditions,
    random: &mut Random,
) -> Result<(Mask, Vec<&'static str>)> {
    let Conditions { tier, class } = conditions;
    let view = &rendering.view;
    if rendering.visible_px() == 0 {
        return Ok((Mask::filled(view.width, view.height, 0), Vec::new()));
    }
    let is_network = chance(random, NETWORKS);
    let source = class.mask.unwrap_or(if is_network { MaskSource::Network } else { MaskSource::Annotator });
    let errors = match source {
        MaskSource::Network => NETWORK,
        MaskSource::Annotator => ANNOTATOR,
    };
    let is_tiny = class.framing == Framing::Tiny;
    let resolution = if is_tiny { errors.crop } else { view.resolution() };
    let mut data = errors.outline(rendering, tier, resolution, random);
    let mut tags = vec![source.as_str()];
    spoil(&mut data, rendering, (tier, class.is_ragged), resolution, &mut tags, random);
    Ok((Image::new("mask", view.width, view.height, data)?, tags))
}

impl MaskErrors {
    /// The pixels in its outline of an object.
    fn outline(&self, rendering: &Rendering, tier: Tier, resolution: f64, random: &mut Random) -> Vec<u8> {
        let view = &rendering.view;
        let sigma = resolution * self.blur[tier as usize];
        let [mean, deviation] = self.offset[tier as usize];
        let offset = resolution * (mean + deviation * normal(random).clamp(-2.0, 2.0));
        let wobble = resolution * between(random, 0.6, 1.0) * self.wobble[tier as usize];
        let noise = Noise::new(view, self.place * resolution, random);
        let visible: Vec<f64> = rendering.visible.iter().map(|visible| f64::from(u8::from(*visible))).collect();
        let coverage = convolved(&visible, view.width, &gaussian(sigma));
        let is_inside = |(i, share): (usize, f64)| {
            let share = share.clamp(LEAST_COVERAGE, 1.0 - LEAST_COVERAGE);
            // The distance at which a straight outline has this coverage.
            let distance = sigma / LOGISTIC * libm::log(share / (1.0 - share));
            let off = (offset + wobble * noise.at(i)).clamp(-MOST * sigma, MOST * sigma);
            u8::from(distance + off > 0.0)
        };
        coverage.into_iter().enumerate().map(is_inside).collect()
    }
}

/// Adds and removes regions: background, lost parts, pin holes, islands.
fn spoil(
    data: &mut [u8],
    rendering: &Rendering,
    (tier, is_ragged): (Tier, bool),
    resolution: f64,
    tags: &mut Vec<&'static str>,
    random: &mut Random,
) {
    let view = &rendering.view;
    let probability = if is_ragged { tier.pick(0.0, 0.5, 0.8) } else { tier.pick(0.0, 0.08, 0.25) };
    let inner: Vec<usize> = (0..data.len()).filter(|&i| rendering.visible[i]).collect();
    let is_rim =
        |i: &usize| [-1, 1].iter().any(|by| i.checked_add_signed(*by).is_some_and(|k| data.get(k) != Some(&1)));
    let rim: Vec<usize> = inner.iter().copied().filter(is_rim).collect();
    let area = inner.len() as f64;
    let mut spot = |random: &mut Random, of: &[usize], tag| {
        let at = of.get(random.below(of.len())).copied();
        at.filter(|_| chance(random, probability)).inspect(|_| tags.push(tag))
    };
    if let Some(at) = spot(random, &rim, "background-included") {
        disc(view, at, (area * between(random, 0.015, 0.05)).sqrt(), |i| data[i] = 1);
    }
    if let Some(at) = spot(random, &rim, "part-of-mask-lost") {
        // Half of the disc, about, lies on the object.
        disc(view, at, (area * between(random, 0.02, 0.06)).sqrt(), |i| data[i] = 0);
    }
    if spot(random, &inner, "pin-holes").is_some() {
        for _ in 0..3 + random.below(6) {
            let (at, radius) = (inner[random.below(inner.len())], resolution * between(random, 0.8, 2.0));
            disc(view, at, radius, |i| data[i] = 0);
        }
    }
    if let Some(at) = spot(random, &inner, "stray-island") {
        let reach = 0.6 * area.sqrt() + resolution * between(random, 15.0, 60.0);
        let towards = crate::world::unit(TAU * random.uniform()) * reach;
        let [u, v] = view.place(at).map(|x| x as f64);
        let column = (u + towards.x).clamp(0.0, view.width as f64 - 1.0) as usize;
        let row = (v + towards.y).clamp(0.0, view.height as f64 - 1.0) as usize;
        let radius = (resolution * between(random, 2.0, 6.0)).min(0.15 * area.sqrt());
        disc(view, row * view.width + column, radius, |i| data[i] = 1);
    }
}
