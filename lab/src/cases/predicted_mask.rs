//! Masks as segmentation networks predict them: a smooth outline that is off in places, and small islands.

use super::mask::{Noise, Segmented, signed_distances};
use super::readings::disc;
use super::scene::Scene;
use super::tier::Tier;
use crate::prelude::*;

/// Halvings of the interval of amplitudes.
const HALVINGS: usize = 10;

/// A predicted mask, and the share of the object's area that its outline loses or adds.
pub fn predict(scene: &Scene, tier: Tier, random: &mut Random) -> Result<(Segmented, f64)> {
    let (width, height) = (scene.width, scene.height);
    let resolution = width as f64 / 640.0;
    let wanted = between(random, tier.pick(0.01, 0.018, 0.026), tier.pick(0.018, 0.028, 0.04));
    let signed = signed_distances(scene);
    let area = signed.iter().filter(|d| **d < 0.0).count().max(1) as f64;
    let span = area.sqrt();
    let waves = [0.5, 0.2].map(|cell| Noise::new(scene, (cell * span).max(4.0), random));
    // More often too large than too small.
    let lean = between(random, -0.3, 0.5);
    let near: Vec<(usize, f64, f64)> = (0..signed.len())
        .filter(|&i| signed[i] < f32::MAX)
        .map(|i| {
            let at = |noise: &Noise| noise.at(i % width, i / width);
            (i, f64::from(signed[i]), lean + 0.7 * at(&waves[0]) + 0.3 * at(&waves[1]))
        })
        .collect();
    let wrong = |amplitude: f64| {
        let differs = |&&(_, d, offset): &&(usize, f64, f64)| (d < 0.0) != (d < amplitude * offset);
        near.iter().filter(differs).count() as f64 / area
    };
    let [mut low, mut high] = [0.0, 20.0 * resolution];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if wrong(middle) < wanted { low = middle } else { high = middle }
    }
    let amplitude = 0.5 * (low + high);
    let mut data = vec![0u8; width * height];
    near.iter().for_each(|&(i, d, offset)| data[i] = u8::from(d < amplitude * offset));
    let share = wrong(amplitude);

    let mut tags = Vec::new();
    let outside: Vec<usize> = near.iter().filter(|(_, d, _)| *d > 3.0 * resolution).map(|&(i, ..)| i).collect();
    let inside: Vec<usize> = near.iter().filter(|(_, d, _)| *d < -3.0 * resolution).map(|&(i, ..)| i).collect();
    for _ in 0..random.below(tier.pick(2, 3, 4)) {
        let radius = (area * between(random, 0.0004, 0.0025)).sqrt().max(1.0);
        let hole = chance(random, 0.3);
        let of = if hole { &inside } else { &outside };
        if let Some(&at) = of.get(random.below(of.len().max(1))) {
            disc(width, height, at, radius, |i| data[i] = u8::from(!hole));
            tags.push(if hole { "pin-holes" } else { "stray-island" });
        }
    }
    let mask = Image::new("mask", width, height, data)?;
    Ok((Segmented { mask, offset_px: amplitude * lean, kind: "predicted-mask", tags }, share))
}
