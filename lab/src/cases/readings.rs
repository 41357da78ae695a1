//! Depth maps with the errors of monocular models or sensors.

use super::edges::{DepthSource, Edges, edges};
use super::mask::Noise;
use super::scene::Scene;
use super::tier::{Class, Tier};
use crate::prelude::*;

/// A depth map with simulated errors.
#[derive(Debug)]
pub struct Readings {
    /// Depth in metres, including the scale error.
    pub depth: DepthMap,
    /// Ratio of measured to true metres.
    pub bias: f64,
    /// `"monocular"`, `"sensor"` or `"exact"`.
    pub kind: &'static str,
    /// What made the edges, if they are as measured.
    pub source: Option<DepthSource>,
    /// Magnitudes at the edges, by name.
    pub parameters: Vec<(&'static str, f64)>,
    /// Fraction of the visible pixels of the object without a reading.
    pub missing: f64,
    /// By what share the warp moves each of the things asked for along its rays: what its truth has to follow.
    pub drifts: Vec<f64>,
}

impl Readings {
    /// What an ideal camera reads.
    pub fn exact(scene: &Scene) -> Result<Self> {
        let depth = DepthMap::from_metres(scene.width, scene.height, scene.depth.clone())?;
        let missing = missing(scene, &scene.depth);
        Ok(Self { depth, bias: 1.0, kind: "exact", source: None, parameters: Vec::new(), missing, drifts: Vec::new() })
    }

    /// Reads a scene that shows an object of this diagonal, metres. Without `edge_random`, edges are exact.
    pub fn draw(
        scene: &Scene,
        diagonal: f64,
        cell: (Tier, Class),
        random: &mut Random,
        edge_random: Option<&mut Random>,
    ) -> Result<Self> {
        Self::of_several(scene, &[], (diagonal, 1.0), cell, random, edge_random)
    }

    /// Reads a scene that shows several things, each at these pixels, all of them being what the scene calls visible;
    /// of a monocular model's grain, it has this share. Without `edge_random`, edges are exact.
    pub fn of_several(
        scene: &Scene,
        things: &[&[bool]],
        (diagonal, grain): (f64, f64),
        (tier, class): (Tier, Class),
        random: &mut Random,
        edge_random: Option<&mut Random>,
    ) -> Result<Self> {
        let sensor = chance(random, tier.pick(0.3, 0.35, 0.3)) || class == Class::SparseSensor || class.needs_sensor();
        let sensor = sensor && class != Class::PredictedDepth;
        let drawn = edge_random.map(|random| {
            let source = DepthSource::draw(class, sensor, random);
            (source, edges(source, scene, tier, random))
        });
        let mut parameters = Vec::new();
        if let Some((_, Edges { offset_px, shift_px, .. })) = &drawn {
            let shift = libm::hypot(shift_px[0], shift_px[1]);
            parameters.extend([("depthEdgePx", *offset_px), ("depthShiftPx", shift)]);
        }
        let source = drawn.as_ref().map(|(source, _)| *source);
        let (mut depth, drifts, bias) = if sensor {
            let depth = match drawn {
                Some((source, edges)) => measured(edges.depth, scene, source, diagonal, tier, random),
                None => sensed(scene, diagonal, tier, random),
            };
            (spotted(depth, scene, diagonal, (tier, class), random), vec![0.0; things.len()], 1.0)
        } else {
            let edged = drawn.map(|(_, edges)| edges.depth);
            let (depth, drifts) = estimated(scene, edged, things, (diagonal, grain), tier, random);
            (depth, drifts, libm::exp(between(random, libm::log(0.8), libm::log(1.25))))
        };
        depth.iter_mut().for_each(|z| *z *= bias as f32);
        let missing = missing(scene, &depth);
        let kind = if sensor { "sensor" } else { "monocular" };
        let depth = DepthMap::from_metres(scene.width, scene.height, depth)?;
        Ok(Self { depth, bias, kind, source, parameters, missing, drifts })
    }
}

/// Fraction of the visible pixels of the object without a reading.
pub fn missing(scene: &Scene, depth: &[f32]) -> f64 {
    let shown = || depth.iter().zip(&scene.visible).filter(|(_, visible)| **visible);
    shown().filter(|(z, _)| **z == 0.0).count() as f64 / shown().count().max(1) as f64
}

/// Monocular: blurred over edges, or with the given ones, warped by long waves, hardly any noise. The warp has no part that moves the object
/// as a whole: that is the bias, which the truth follows. Of several things it moves each by a share, which is
/// returned.
fn estimated(
    scene: &Scene,
    edged: Option<Vec<f32>>,
    things: &[&[bool]],
    (diagonal, grain): (f64, f64),
    tier: Tier,
    random: &mut Random,
) -> (Vec<f32>, Vec<f64>) {
    let (width, height) = (scene.width, scene.height);
    let resolution = (width as f64 / 640.0).round() as usize;
    let radius = resolution * tier.pick(usize::from(chance(random, 0.5)), 1, 1 + random.below(2));
    let mut depth = edged.unwrap_or_else(|| blurred(&scene.depth, width, height, radius));
    let amplitude = between(random, 0.3, 1.0) * tier.pick(0.003, 0.012, 0.025) * diagonal;
    let noise = between(random, 0.3, 1.0) * tier.pick(0.0007, 0.0015, 0.003) * diagonal * grain;
    // Waves no shorter than the object: a model gets its parts right to each other, and the whole not quite.
    let z_mean = mean(scene.object_depth.iter().filter(|z| **z > 0.0).map(|z| f64::from(*z)));
    let span = scene.camera.fx * diagonal / z_mean;
    let waves: Vec<[f64; 3]> = (0..3)
        .map(|_| {
            let (sine, cosine) = libm::sincos(TAU * random.uniform());
            let frequency = TAU * between(random, 0.25, 0.8) / span;
            [frequency * cosine, frequency * sine, TAU * random.uniform()]
        })
        .collect();
    // cos(a + b) from tables along rows and columns: a wave costs two products a pixel.
    let tables: Vec<_> = waves
        .iter()
        .map(|[du, dv, phase]| {
            let along = |n: usize, k: f64, phase: f64| -> Vec<(f64, f64)> {
                (0..n).map(|i| libm::sincos(k * i as f64 + phase)).collect()
            };
            (along(width, *du, *phase), along(height, *dv, 0.0))
        })
        .collect();
    let wave = |u: usize, v: usize| {
        let sum: f64 = tables.iter().map(|(a, b)| a[u].1 * b[v].1 - a[u].0 * b[v].0).sum();
        sum * amplitude / (1.5f64.sqrt() * z_mean)
    };
    let pixels = || (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    let over = |shown: &[bool]| mean(pixels().zip(shown).filter(|(_, shown)| **shown).map(|((u, v), _)| wave(u, v)));
    let offset = over(&scene.visible);
    let drifts = things.iter().map(|shown| over(shown) - offset).collect();
    for ((u, v), z) in pixels().zip(&mut depth) {
        let grain = (random.uniform() + random.uniform() - 1.0) * noise;
        *z = (f64::from(*z) * (1.0 + wave(u, v) - offset) + if *z > 0.0 { grain } else { 0.0 }) as f32;
    }
    (depth, drifts)
}

/// Mean over a square of readings.
fn blurred(depth: &[f32], width: usize, height: usize, radius: usize) -> Vec<f32> {
    if radius == 0 {
        return depth.to_vec();
    }
    let pass = |from: &[f32], n: usize, lines: usize, at: &dyn Fn(usize, usize) -> usize| {
        let mut out = vec![0.0; from.len()];
        for line in 0..lines {
            for i in 0..n {
                let (mut sum, mut count) = (0.0, 0.0);
                for k in i.saturating_sub(radius)..=(i + radius).min(n - 1) {
                    let z = from[at(line, k)];
                    if z > 0.0 {
                        (sum, count) = (sum + z, count + 1.0);
                    }
                }
                out[at(line, i)] = if count > 0.0 { sum / count } else { 0.0 };
            }
        }
        out
    };
    let rows = pass(depth, width, height, &|line, i| line * width + i);
    pass(&rows, height, width, &|line, i| i * width + line)
}

/// A sensor with exact edges: noise that grows with the distance, steps, no reading beside edges and at grazing angles.
fn sensed(scene: &Scene, diagonal: f64, tier: Tier, random: &mut Random) -> Vec<f32> {
    let (width, height) = (scene.width, scene.height);
    let resolution = width as f64 / 640.0;
    let share = between(random, 0.4, 1.0);
    // A sensor that drowns the object in noise is the wrong one: the user would step closer.
    let noise = |z: f64| (0.0015 * z * z).min(tier.pick(0.005, 0.01, 0.016) * diagonal) * share;
    let step = |z: f64| (0.0008 * z * z).min(tier.pick(0.003, 0.006, 0.01) * diagonal);
    let shadow = (resolution * between(random, 1.0, tier.pick(2.0, 4.0, 7.0))) as usize;
    let jump = 0.15 * diagonal;
    let mut depth = scene.depth.clone();
    for v in 0..height {
        let row = &scene.depth[v * width..(v + 1) * width];
        for u in 0..width {
            let z = f64::from(row[u]);
            let value = &mut depth[v * width + u];
            let grain = normal(random);
            // The second eye, to the right, does not see what is left behind of something nearer.
            let nearer = row[u..(u + 1 + shadow).min(width)].iter().any(|&other| f64::from(other) < z - jump);
            let slope = if u > 0 { (z - f64::from(row[u - 1])).abs() * scene.camera.fx / z.max(1e-9) } else { 0.0 };
            if nearer || slope > 6.0 || z > 12.0 || z == 0.0 {
                *value = 0.0;
                continue;
            }
            let noisy = z + noise(z) * grain;
            let step = step(z).max(1e-6);
            *value = ((noisy / step).round() * step) as f32;
        }
    }
    depth
}

/// Noise and steps of a sensor, on a map with its edges: as published for RealSense D400, PrimeSense and Kinect 2, and smooth
/// noise as measured on real cases (the design history has the table).
fn measured(
    mut depth: Vec<f32>,
    scene: &Scene,
    source: DepthSource,
    diagonal: f64,
    tier: Tier,
    random: &mut Random,
) -> Vec<f32> {
    // By z²: white noise, smooth noise, and steps; of time of flight, the noise hardly grows.
    let [white, smooth, step] = match source {
        DepthSource::ActiveStereo => [0.0008, 0.014, 0.0005],
        DepthSource::StructuredLight => [0.0008, 0.004, 0.0028],
        DepthSource::TimeOfFlight | DepthSource::Predicted => [0.001, 0.001, 0.0],
    };
    let share = between(random, 0.6, 1.0);
    let bumps = Noise::new(scene, 6.0 * scene.width as f64 / 640.0, random);
    // A sensor that drowns the object in noise is the wrong one: the user would step closer.
    let at_most = |x: f64, most: f64| x.min(most * diagonal);
    for (i, value) in depth.iter_mut().enumerate() {
        let grain = normal(random);
        let z = f64::from(*value);
        if z == 0.0 || z > 12.0 {
            *value = 0.0;
            continue;
        }
        let squared = if source == DepthSource::TimeOfFlight { z } else { z * z };
        let noise = at_most(white * squared, tier.pick(0.003, 0.006, 0.01)) * grain
            + at_most(smooth * squared, tier.pick(0.01, 0.02, 0.03)) * bumps.at(i % scene.width, i / scene.width);
        let step = at_most(step * squared, tier.pick(0.004, 0.008, 0.016)).max(1e-6);
        *value = (((z + share * noise) / step).round() * step) as f32;
    }
    depth
}

/// The map without readings here and there, on the object and elsewhere.
fn spotted(
    mut depth: Vec<f32>,
    scene: &Scene,
    diagonal: f64,
    (tier, class): (Tier, Class),
    random: &mut Random,
) -> Vec<f32> {
    let (width, height) = (scene.width, scene.height);
    let wanted = if class == Class::SparseSensor {
        between(random, tier.pick(0.05, 0.1, 0.18), tier.pick(0.05, 0.18, 0.3))
    } else {
        between(random, 0.0, tier.pick(0.02, 0.08, 0.15))
    };
    let object: Vec<usize> = (0..depth.len()).filter(|&i| scene.visible[i]).collect();
    let span = scene.camera.fx * diagonal / f64::from(object.first().map_or(1.0, |&i| scene.depth[i]));
    let missing =
        |depth: &[f32]| object.iter().filter(|&&i| depth[i] == 0.0).count() as f64 / object.len().max(1) as f64;
    for hole in 0..300 {
        let on_object = missing(&depth) < wanted;
        if !on_object && hole >= 20 {
            break;
        }
        let at = if on_object { object.get(random.below(object.len())).copied() } else { None };
        let at = at.unwrap_or(random.below(depth.len()));
        let radius = (span * between(random, 0.008, 0.05)).max(1.0);
        disc(width, height, at, radius, |i| depth[i] = 0.0);
    }
    depth
}

/// Visits the pixels of a disc about pixel `at`.
pub fn disc(width: usize, height: usize, at: usize, radius: f64, mut visit: impl FnMut(usize)) {
    let (u, v) = ((at % width) as f64, (at / width) as f64);
    let rows = (v - radius).max(0.0) as usize..=((v + radius) as usize).min(height - 1);
    for y in rows {
        for x in (u - radius).max(0.0) as usize..=((u + radius) as usize).min(width - 1) {
            let (du, dv) = (x as f64 - u, y as f64 - v);
            if du * du + dv * dv <= radius * radius {
                visit(y * width + x);
            }
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
