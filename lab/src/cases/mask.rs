//! Masks with the errors of segmentation models and of annotators.

use super::annotated_mask::annotated;
use super::network_mask::segmented;
use super::readings::disc;
use super::scene::Scene;
use super::tier::{Class, OutlineErrors, Tier};
use crate::prelude::*;
use sim3align_geometry::distance_transform::squared_distances;
use sim3align_geometry::image::bounds_of;

/// Shares of the masks that networks and annotators make; the rest is uniformly too large or too small.
const NETWORKS: f64 = 0.6;
const ANNOTATORS: f64 = 0.35;

/// A mask with simulated errors.
#[derive(Debug)]
pub struct Segmented {
    /// The mask.
    pub mask: Mask,
    /// Offset of the boundary in pixels; positive if the mask is too large.
    pub offset_px: f64,
    /// Its source: `"network-mask"`, `"annotated-mask"` or `"uniform-mask"`.
    pub kind: &'static str,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
}

/// The outline of a mask.
pub(super) struct Outline {
    /// Whether each pixel is inside.
    pub inside: Vec<bool>,
    /// See [`Segmented`].
    pub offset_px: f64,
    /// See [`Segmented`].
    pub kind: &'static str,
}

impl Segmented {
    /// The mask of a scene's object.
    pub fn draw(
        scene: &Scene,
        (tier, class): (Tier, Class),
        errors: OutlineErrors,
        random: &mut Random,
    ) -> Result<Self> {
        let signed = signed_distances(scene);
        let depths = || signed.iter().filter(|d| **d < 0.0).map(|d| -f64::from(*d));
        let half_width = 2.0 * depths().sum::<f64>() / depths().count().max(1) as f64;
        // Few pixels are segmented at a higher resolution: models look at a crop, and annotators, too.
        let resolution = if class == Class::Tiny { 0.5 } else { scene.width as f64 / 640.0 };
        let kind = match (errors, class) {
            (OutlineErrors::Uniform, _) => 1.0,
            (OutlineErrors::Measured, Class::NetworkMask) => 0.0,
            (OutlineErrors::Measured, Class::AnnotatedMask) => NETWORKS,
            (OutlineErrors::Measured, _) => random.uniform(),
        };
        let outline = if kind < NETWORKS {
            segmented(scene, tier, if class == Class::Tiny { 0.4 } else { 1.0 }, random)
        } else if kind < NETWORKS + ANNOTATORS {
            annotated(scene, tier, resolution, random)
        } else {
            uniform(scene, (&signed, half_width), (tier, class), resolution, random)
        };
        let mut tags = Vec::new();
        tags.extend((errors == OutlineErrors::Measured).then_some(outline.kind));
        let mut data: Vec<u8> = outline.inside.into_iter().map(u8::from).collect();
        tags.extend(spoil(&mut data, scene, (&signed, half_width), (tier, class), resolution, random));
        let mask = Image::new("mask", scene.width, scene.height, data)?;
        Ok(Self { mask, offset_px: outline.offset_px, kind: outline.kind, tags })
    }
}

/// An outline that is too far outside or inside everywhere, and rough.
fn uniform(
    scene: &Scene,
    (signed, half_width): (&[f32], f64),
    (tier, class): (Tier, Class),
    resolution: f64,
    random: &mut Random,
) -> Outline {
    let ragged = class == Class::RaggedMask;
    let most = tier.pick(1.0, if ragged { 2.0 } else { 1.6 }, if ragged { 3.0 } else { 2.3 }) * resolution;
    let offset = match tier {
        Tier::Easy => between(random, -1.0, 1.0),
        // More often too large than too small, as the models' masks are.
        _ => between(random, 0.2, 1.0) * most * if chance(random, 0.6) { 1.0 } else { -1.0 },
    };
    let roughness = resolution * if ragged { tier.pick(0.0, 1.2, 2.2) } else { tier.pick(0.0, 0.5, 1.1) };
    // Half as wide as the object is on average: no model is off by as much as the thing itself.
    let offset_px = offset.clamp(-0.25 * half_width, 0.45 * half_width);
    let roughness = roughness.min(0.35 * half_width);
    let noise = Noise::new(scene, (5.0 * resolution).max(2.5), random);
    let inside = signed.iter().enumerate().map(|(i, d)| {
        let d = f64::from(*d);
        let rough = if d.abs() < 16.0 { noise.at(i % scene.width, i / scene.width) } else { 0.0 };
        d < offset_px + roughness * rough
    });
    Outline { inside: inside.collect(), offset_px, kind: "uniform-mask" }
}

/// Adds and removes regions: background, lost parts, pin holes, islands. Returns their names.
fn spoil(
    data: &mut [u8],
    scene: &Scene,
    (signed, half_width): (&[f32], f64),
    (tier, class): (Tier, Class),
    resolution: f64,
    random: &mut Random,
) -> Vec<&'static str> {
    let (width, height) = (scene.width, scene.height);
    let mut tags = Vec::new();
    let inner: Vec<usize> = (0..data.len()).filter(|&i| signed[i] < 0.0).collect();
    let rim: Vec<usize> = inner.iter().copied().filter(|&i| signed[i] > -2.0).collect();
    let probability = match (tier, class == Class::RaggedMask) {
        (Tier::Easy, _) => 0.0,
        (Tier::Medium, false) => 0.08,
        (Tier::Medium, true) => 0.5,
        (Tier::Hard, false) => 0.25,
        (Tier::Hard, true) => 0.8,
    };
    let area = inner.len() as f64;
    let mut spot = |random: &mut Random, of: &[usize], tag| {
        let at = of.get(random.below(of.len())).copied();
        let at = at.filter(|_| chance(random, probability));
        at.inspect(|_| tags.push(tag))
    };
    if let Some(at) = spot(random, &rim, "background-included") {
        let radius = (area * between(random, 0.015, 0.05)).sqrt();
        disc(width, height, at, radius, |i| data[i] = 1);
    }
    if let Some(at) = spot(random, &rim, "part-of-mask-lost") {
        // Half of the disc, about, lies on the object.
        let radius = (area * between(random, 0.02, 0.06)).sqrt();
        disc(width, height, at, radius, |i| data[i] = 0);
    }
    if spot(random, &inner, "pin-holes").is_some() {
        for _ in 0..3 + random.below(6) {
            let (at, radius) = (inner[random.below(inner.len())], resolution * between(random, 0.8, 2.0));
            disc(width, height, at, radius, |i| data[i] = 0);
        }
    }
    if let Some(at) = spot(random, &inner, "stray-island") {
        let reach = 3.0 * half_width + resolution * between(random, 15.0, 60.0);
        let (sine, cosine) = libm::sincos(TAU * random.uniform());
        let (u, v) = ((at % width) as f64 + reach * cosine, (at / width) as f64 + reach * sine);
        let (u, v) = (u.clamp(0.0, width as f64 - 1.0) as usize, v.clamp(0.0, height as f64 - 1.0) as usize);
        let radius = (resolution * between(random, 2.0, 6.0)).min(0.15 * area.sqrt());
        disc(width, height, v * width + u, radius, |i| data[i] = 1);
    }
    tags
}

/// Distance to the outline of what is visible, pixels: negative inside, ±0.5 along it, large far away.
pub(super) fn signed_distances(scene: &Scene) -> Vec<f32> {
    let (width, height) = (scene.width, scene.height);
    let mut signed = vec![f32::MAX; width * height];
    // Only around the object: the transform costs more than anything else here.
    let margin = 24 * width / 640;
    if !scene.visible.contains(&true) {
        return signed;
    }
    let [columns, rows] = bounds_of(&scene.visible, width, |visible| *visible);
    let low = [columns[0], rows[0]].map(|x| x.saturating_sub(margin));
    let high = [(columns[1] + margin).min(width - 1), (rows[1] + margin).min(height - 1)];
    let size = [0, 1].map(|axis| high[axis] - low[axis] + 1);
    let index = |k: usize| (low[1] + k / size[0]) * width + low[0] + k % size[0];
    let inside: Vec<bool> = (0..size[0] * size[1]).map(|k| scene.visible[index(k)]).collect();
    let outside: Vec<bool> = inside.iter().map(|inside| !inside).collect();
    let [to_inside, to_outside] = [&inside, &outside].map(|set| squared_distances(set, size[0], size[1]));
    for k in 0..inside.len() {
        let [far_in, far_out] = [to_inside[k], to_outside[k]].map(|d| f64::from(d).sqrt() as f32);
        signed[index(k)] = if inside[k] { 0.5 - far_out } else { far_in - 0.5 };
    }
    signed
}

/// Smooth noise from −1 to 1: a lattice of random values, blended between.
pub(super) struct Noise {
    cell: f64,
    columns: usize,
    values: Vec<f64>,
}

impl Noise {
    pub(super) fn new(scene: &Scene, cell: f64, random: &mut Random) -> Self {
        let [columns, rows] = [scene.width, scene.height].map(|n| (n as f64 / cell) as usize + 2);
        Self { cell, columns, values: (0..columns * rows).map(|_| between(random, -1.0, 1.0)).collect() }
    }

    pub(super) fn at(&self, u: usize, v: usize) -> f64 {
        let [x, y] = [u, v].map(|x| x as f64 / self.cell);
        let (i, j) = (x as usize, y as usize);
        let (s, t) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| self.values[j * self.columns + i];
        let [top, bottom] = [j, j + 1].map(|j| value(i, j) * (1.0 - s) + value(i + 1, j) * s);
        top * (1.0 - t) + bottom * t
    }
}
