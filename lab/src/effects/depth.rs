//! Depth maps with the errors of sensors and of depth models.

use super::edges::edges;
use super::noise::{Noise, disc};
use crate::conditions::{Conditions, DepthFault, DepthSource, Tier};
use crate::numbers::mean;
use crate::objects::mesh::face;
use crate::prelude::*;
use crate::world::Placed;
use crate::world::view::Rendering;
use sim3align_geometry::order::{median, quantile};

/// Farthest reading of a sensor, metres.
pub const FARTHEST_M: f64 = 12.0;
/// Largest step of quantised depth at the object, as a share of its diagonal.
const LARGEST_STEP: f64 = 0.06;

/// A depth map with simulated errors.
#[derive(Debug)]
pub struct Readings {
    /// Depth in metres, including the scale error.
    pub depth: DepthMap,
    /// Ratio of measured to true metres.
    pub bias: f64,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
    /// Relative shift of each object along its rays by a depth model's warp; the true pose includes it.
    pub drifts: Vec<f64>,
}

/// Reads a scene, in which `rendering` shows all objects as one, and `things` the pixels of each; `diagonal` is the median
/// diagonal of the objects, metres.
pub fn read(
    rendering: &Rendering,
    things: &[&[bool]],
    diagonal: f64,
    conditions: Conditions,
    random: &mut Random,
) -> Result<Readings> {
    let Conditions { tier, class } = conditions;
    let view = &rendering.view;
    let source = class.depth[random.below(class.depth.len())];
    let mut depth = edges(source, rendering, tier, random);
    let (drifts, bias) = if source == DepthSource::Predicted {
        let drifts = warp(&mut depth, rendering, things, diagonal, tier, random);
        (drifts, libm::exp(between(random, libm::log(0.8), libm::log(1.25))))
    } else {
        roughen(&mut depth, rendering, source, diagonal, tier, random);
        lose_spots(&mut depth, rendering, diagonal, conditions, random);
        (vec![0.0; things.len()], 1.0)
    };
    depth.iter_mut().for_each(|z| *z *= bias as f32);
    let depth = DepthMap::from_metres(view.width, view.height, depth)?;
    Ok(Readings { depth, bias, tags: vec![source.as_str()], drifts })
}

impl Readings {
    /// Fraction of the pixels without a reading.
    pub fn missing(&self, pixels: &[bool]) -> f64 {
        let shown = || self.depth.data().iter().zip(pixels).filter(|(_, shown)| **shown);
        shown().filter(|(z, _)| **z == 0.0).count() as f64 / shown().count().max(1) as f64
    }

    /// Applies the fault of a class to the readings of one object, and to its mask.
    pub fn afflict(
        &mut self,
        mask: &mut Mask,
        rendering: &Rendering,
        placed: &Placed,
        conditions: Conditions,
        random: &mut Random,
    ) {
        let depth = self.depth.data_mut();
        match conditions.class.depth_fault {
            DepthFault::Holes | DepthFault::HolesOfMask => {
                holes_on(rendering, placed, conditions.tier, &mut self.tags, random)
                    .into_iter()
                    .for_each(|i| depth[i] = 0.0);
                if conditions.class.depth_fault == DepthFault::HolesOfMask {
                    mask.data_mut().iter_mut().zip(depth).filter(|(_, z)| **z == 0.0).for_each(|(m, _)| *m = 0);
                }
            }
            DepthFault::Quantised => {
                let Some(distance) = median(rendering.object_depth.iter().copied().filter(|z| *z > 0.0)) else {
                    return;
                };
                let tier = conditions.tier;
                let step = between(random, tier.pick(0.001, 0.002, 0.004), tier.pick(0.003, 0.006, 0.01));
                // z = k / disparity, whose step is k/disparity² = z²/k.
                let k = f64::from(distance).powi(2) / step.min(LARGEST_STEP * placed.object.diagonal());
                for z in depth.iter_mut().filter(|z| **z > 0.0) {
                    *z = (k / (k / f64::from(*z)).round().max(1.0)) as f32;
                }
            }
            DepthFault::None | DepthFault::Sparse => {}
        }
    }
}

/// A depth model's smooth errors: waves no shorter than the objects, because models get the parts of an object right
/// relative to each other; and hardly any noise. The warp has no part that moves all objects: that is the bias. Returns the
/// relative shift of each object.
fn warp(
    depth: &mut [f32],
    rendering: &Rendering,
    things: &[&[bool]],
    diagonal: f64,
    tier: Tier,
    random: &mut Random,
) -> Vec<f64> {
    let view = &rendering.view;
    let amplitude = between(random, 0.3, 1.0) * tier.pick(0.003, 0.012, 0.025) * diagonal;
    let noise = between(random, 0.3, 1.0) * tier.pick(0.0007, 0.0015, 0.003) * diagonal;
    let z_mean = mean(rendering.object_depth.iter().filter(|z| **z > 0.0).map(|z| f64::from(*z))).unwrap_or(0.0);
    let span = view.camera.fx * diagonal / z_mean;
    // cos(a + b) from tables along rows and columns: a wave costs two products a pixel.
    let tables: Vec<_> = (0..3)
        .map(|_| {
            let direction = crate::world::unit(TAU * random.uniform()) * (TAU * between(random, 0.25, 0.8) / span);
            let along = |n: usize, k: f64, phase: f64| -> Vec<(f64, f64)> {
                (0..n).map(|i| libm::sincos(k * i as f64 + phase)).collect()
            };
            (along(view.width, direction.x, TAU * random.uniform()), along(view.height, direction.y, 0.0))
        })
        .collect();
    let wave = |i: usize| {
        let [u, v] = view.place(i);
        let sum: f64 = tables.iter().map(|(a, b)| a[u].1 * b[v].1 - a[u].0 * b[v].0).sum();
        sum * amplitude / (1.5f64.sqrt() * z_mean)
    };
    let over = |shown: &[bool]| mean((0..shown.len()).filter(|i| shown[*i]).map(wave)).unwrap_or(0.0);
    let offset = over(&rendering.visible);
    for (i, z) in depth.iter_mut().enumerate() {
        let grain = (random.uniform() + random.uniform() - 1.0) * noise;
        *z = (f64::from(*z) * (1.0 + wave(i) - offset) + if *z > 0.0 { grain } else { 0.0 }) as f32;
    }
    things.iter().map(|shown| over(shown) - offset).collect()
}

/// Noise and steps of a sensor: as published for RealSense D400, PrimeSense and Kinect 2, and smooth noise as measured on
/// real cases (the design history has the table).
fn roughen(
    depth: &mut [f32],
    rendering: &Rendering,
    source: DepthSource,
    diagonal: f64,
    tier: Tier,
    random: &mut Random,
) {
    // Coefficients of z²: white noise, smooth noise, steps; for time of flight, of z.
    let [white, smooth, step] = match source {
        DepthSource::ActiveStereo => [0.0008, 0.014, 0.0005],
        DepthSource::StructuredLight => [0.0008, 0.004, 0.0028],
        DepthSource::TimeOfFlight | DepthSource::Predicted => [0.001, 0.001, 0.0],
    };
    let share = between(random, 0.6, 1.0);
    let bumps = Noise::new(&rendering.view, 6.0 * rendering.view.resolution(), random);
    // A sensor that drowns the object in noise is the wrong one: the user would step closer.
    let at_most = |x: f64, most: f64| x.min(most * diagonal);
    for (i, value) in depth.iter_mut().enumerate() {
        let grain = normal(random);
        let z = f64::from(*value);
        if z == 0.0 || z > FARTHEST_M {
            *value = 0.0;
            continue;
        }
        let squared = if source == DepthSource::TimeOfFlight { z } else { z * z };
        let noise = at_most(white * squared, tier.pick(0.003, 0.006, 0.01)) * grain
            + at_most(smooth * squared, tier.pick(0.01, 0.02, 0.03)) * bumps.at(i);
        let step = at_most(step * squared, tier.pick(0.004, 0.008, 0.016)).max(1e-6);
        *value = (((z + share * noise) / step).round() * step) as f32;
    }
}

/// Loses readings here and there, on the object and elsewhere.
fn lose_spots(depth: &mut [f32], rendering: &Rendering, diagonal: f64, conditions: Conditions, random: &mut Random) {
    let Conditions { tier, class } = conditions;
    let wanted = if class.depth_fault == DepthFault::Sparse {
        between(random, tier.pick(0.05, 0.1, 0.18), tier.pick(0.05, 0.18, 0.3))
    } else {
        between(random, 0.0, tier.pick(0.02, 0.08, 0.15))
    };
    let object: Vec<usize> = (0..depth.len()).filter(|&i| rendering.visible[i]).collect();
    let span = rendering.view.camera.fx * diagonal / f64::from(object.first().map_or(1.0, |&i| rendering.depth[i]));
    let missing =
        |depth: &[f32]| object.iter().filter(|&&i| depth[i] == 0.0).count() as f64 / object.len().max(1) as f64;
    for hole in 0..300 {
        let on_object = !object.is_empty() && missing(depth) < wanted;
        if !on_object && hole >= 20 {
            break;
        }
        let at = if on_object { object[random.below(object.len())] } else { random.below(depth.len()) };
        let radius = (span * between(random, 0.008, 0.05)).max(1.0);
        disc(&rendering.view, at, radius, |i| depth[i] = 0.0);
    }
}

/// Holes that cover a share of the visible object: on a dark part, on highlights, at grazing angles.
fn holes_on(
    rendering: &Rendering,
    placed: &Placed,
    tier: Tier,
    tags: &mut Vec<&'static str>,
    random: &mut Random,
) -> Vec<usize> {
    let wanted = between(random, tier.pick(0.05, 0.15, 0.25), tier.pick(0.12, 0.3, 0.45));
    let object: Vec<(usize, usize)> = rendering.object_pixels().collect();
    let pixels: Vec<usize> = object.iter().map(|(i, _)| *i).collect();
    let kinds = [chance(random, 0.6), chance(random, 0.5), chance(random, 0.5)];
    let kinds = if kinds == [false; 3] { [true, false, false] } else { kinds };
    let each = wanted / kinds.iter().filter(|kind| **kind).count() as f64;
    let (world_from_camera, eye) = (rendering.view.camera_from_world.inverse(), rendering.view.eye());
    let normal_at = |k: usize| face(&placed.mesh, object[k].1).normalize_or(DVec3::Z);
    let to_eye = |k: usize| {
        let point = rendering.view.world_point(&world_from_camera, object[k].0, rendering.object_depth[object[k].0]);
        (eye - point).normalize_or(DVec3::Z)
    };
    let mut lost = Vec::new();
    if kinds[0] {
        tags.push("dark");
        let span = (object.len() as f64).sqrt();
        let noise = Noise::new(&rendering.view, (span * between(random, 0.15, 0.35)).max(3.0), random);
        lost.extend(highest(&pixels, |k| noise.at(pixels[k]), each));
    }
    if kinds[1] {
        tags.push("shiny");
        let lamp = DVec3::new(normal(random), normal(random), between(random, 0.3, 2.0)).normalize_or(DVec3::Z);
        lost.extend(highest(&pixels, |k| normal_at(k).dot((to_eye(k) + lamp).normalize_or(DVec3::Z)).abs(), each));
    }
    if kinds[2] {
        tags.push("grazing");
        lost.extend(highest(&pixels, |k| -normal_at(k).dot(to_eye(k)).abs(), each));
    }
    lost
}

/// The pixels with the highest scores; `score` takes the index in `pixels`.
fn highest(pixels: &[usize], score: impl Fn(usize) -> f64, share: f64) -> Vec<usize> {
    let scores: Vec<f32> = (0..pixels.len()).map(|k| score(k) as f32).collect();
    let least = quantile(scores.iter().copied(), 1.0 - share).unwrap_or(f32::INFINITY);
    pixels.iter().zip(scores).filter(|(_, score)| *score > least).map(|(&i, _)| i).collect()
}
