//! Effects of the classes of the set [`super::tier::CaseSet::Sensors`] on depth and mask.

use super::draft::Object;
use super::holes;
use super::mask::Segmented;
use super::predicted_mask::predict;
use super::readings::{Readings, missing};
use super::scene::Scene;
use super::shadow;
use super::split::{in_two, parts};
use super::tier::{Class, Tier};
use crate::prelude::*;
use sim3align_geometry::order::median;

/// Largest step of quantised depth at the object, as a share of its diagonal.
const LARGEST_STEP: f64 = 0.06;
/// Probability of holes around an object with holes.
const HOLES_AROUND: f64 = 0.5;
/// Fewest masked pixels with a reading.
const LEAST_READINGS: usize = 250;
/// Fewest masked pixels of a part that determines the orientation of the object.
const LEAST_KEY_PX: usize = 40;

/// Magnitudes of the effects, by name.
pub type Parameters = Vec<(&'static str, f64)>;

/// Applies the effects of a class; `None` if this scene cannot show them. Other classes have none.
pub fn apply(
    scene: &Scene,
    (object, placed): (&Object, &Mesh),
    (tier, class): (Tier, Class),
    (readings, segmented): (&mut Readings, &mut Segmented),
    random: &mut Random,
) -> Result<Option<Parameters>> {
    let mut parameters = Vec::new();
    match class {
        Class::WideShadow => {
            let Some(shadow) = shadow::cast(scene, placed, object.diagonal(), random)? else { return Ok(None) };
            lose(readings, (0..shadow.dark.len()).filter(|&i| shadow.dark[i]));
            parameters.extend([("shadow", shadow.share), ("baselineM", shadow.baseline_m)]);
        }
        Class::Holes | Class::MaskOfReadings => {
            let holes = holes::on_object(scene, (object, placed), tier, random);
            lose(readings, holes.pixels.iter().copied());
            segmented.tags.extend(holes.tags);
            if chance(random, HOLES_AROUND) {
                lose(readings, holes::around(scene, random).into_iter());
                segmented.tags.push("holes-around");
            }
            if class == Class::MaskOfReadings {
                let depth = readings.depth.data();
                segmented.mask.data_mut().iter_mut().zip(depth).filter(|(_, z)| **z == 0.0).for_each(|(m, _)| *m = 0);
                if !shows_key(scene, object, segmented) {
                    return Ok(None);
                }
            }
            let visible = scene.visible_px().max(1) as f64;
            parameters.push(("holes", holes.pixels.len() as f64 / visible));
        }
        Class::SplitMask => {
            let mask: Vec<bool> = segmented.mask.data().iter().map(|m| *m != 0).collect();
            if !in_two(&mask, scene.width) {
                return Ok(None);
            }
            let parts = parts(&mask, scene.width);
            let smaller = parts[1].count() as f64 / mask.iter().filter(|m| **m).count().max(1) as f64;
            parameters.push(("smallerPart", smaller));
            let lost = usize::from(chance(random, 0.7));
            if chance(random, 0.5) {
                lose(readings, parts[lost].pixels());
                segmented.tags.push("part-without-depth");
            }
        }
        Class::Quantised => {
            let Some(distance) = median(scene.object_depth.iter().copied().filter(|z| *z > 0.0)) else {
                return Ok(None);
            };
            let step = between(random, tier.pick(0.001, 0.002, 0.004), tier.pick(0.003, 0.006, 0.01));
            let step = step.min(LARGEST_STEP * object.diagonal());
            // z = k / disparity, whose step is k/disparity² = z²/k.
            let k = f64::from(distance).powi(2) / step;
            for z in readings.depth.data_mut().iter_mut().filter(|z| **z > 0.0) {
                *z = (k / (k / f64::from(*z)).round().max(1.0)) as f32;
            }
            parameters.push(("stepMm", 1000.0 * step));
        }
        Class::PredictedMask => {
            let (predicted, share) = predict(scene, tier, random)?;
            *segmented = predicted;
            parameters.push(("maskError", share));
        }
        _ => return Ok(Some(parameters)),
    }
    readings.missing = missing(scene, readings.depth.data());
    let masked = segmented.mask.data().iter().zip(readings.depth.data());
    let with_reading = masked.filter(|(m, z)| **m != 0 && **z > 0.0).count();
    Ok(Some(parameters).filter(|_| with_reading >= LEAST_READINGS))
}

/// Whether the mask contains enough of a part that determines the orientation of the object.
fn shows_key(scene: &Scene, object: &Object, segmented: &Segmented) -> bool {
    let masked = segmented.mask.data().iter().zip(&scene.object_triangles).filter(|(m, _)| **m != 0);
    let is_key = |triangle: u32| object.parts.get(triangle as usize).is_some_and(|part| object.keys.contains(part));
    let key_px = masked.filter(|(_, triangle)| is_key(**triangle)).count();
    object.keys.is_empty() || key_px >= LEAST_KEY_PX
}

fn lose(readings: &mut Readings, pixels: impl Iterator<Item = usize>) {
    let depth = readings.depth.data_mut();
    pixels.for_each(|i| depth[i] = 0.0);
}
