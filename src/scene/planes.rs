//! Planes in a depth map: what things may stand on, walls as well.

use glam::DVec3;

use super::plane::Plane;
use crate::geometry::image::{DepthMap, Image, Mask};
use crate::geometry::order::quantile;
use crate::geometry::pinhole::Pinhole;
use crate::geometry::random::Random;

/// Random stream of the draws.
const STREAM: u64 = 31;
/// Number of readings used.
const SAMPLES: usize = 20_000;
/// Number of readings that a drawn plane is tested on.
const TESTED: usize = 1500;
/// Drawn planes, and the number of planes sought.
const DRAWS: usize = 400;
const PLANES: usize = 4;
/// Distance of the points of a draw from the first, relative to the longer side of the image: neighbours are more often
/// on one plane.
const NEAR: f64 = 0.15;
/// Distance within which a reading is on a plane: metres, and metres per metre of depth.
const TOLERANCE: [f64; 2] = [0.002, 0.005];
/// Minimum share of the readings on a plane.
const SHARE: f64 = 0.03;
const LEAST: usize = 100;
/// Rounds of the refit.
const REFITS: usize = 6;

/// A plane of a depth map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundPlane {
    /// The plane.
    pub plane: Plane,
    /// Share of the readings outside the objects that are on the plane, 0 to 1.
    pub share: f64,
    /// Median distance of these readings from the plane, metres.
    pub spread_m: f64,
}

/// A reading.
#[derive(Clone, Copy)]
struct Reading {
    at: [usize; 2],
    point: DVec3,
    tolerance: f64,
}

/// The planes outside the `taken` pixels, those with the most readings first. The same input and seed give the same
/// planes.
pub fn find_planes(depth: &DepthMap, camera: &Pinhole, taken: &Mask, seed: u64) -> Vec<FoundPlane> {
    let mut left = readings(depth, camera, taken);
    let all = left.len();
    let least = LEAST.max((SHARE * all as f64) as usize);
    let mut random = Random::new(seed, STREAM);
    let reach = NEAR * depth.width().max(depth.height()) as f64;
    let mut planes = Vec::new();
    while planes.len() < PLANES && left.len() >= least {
        let Some(drawn) = draw(&left, reach, &mut random) else { break };
        let plane = refit(drawn, &left);
        let distance = |r: &Reading| plane.height(r.point).abs() / r.tolerance;
        let on: Vec<f32> =
            left.iter().filter(|r| distance(r) < 1.0).map(|r| plane.height(r.point).abs() as f32).collect();
        if on.len() < least {
            break;
        }
        let spread_m = quantile(on.iter().copied(), 0.5).map_or(0.0, f64::from);
        let share = on.len() as f64 / all as f64;
        let place = planes.iter().position(|known: &FoundPlane| known.share < share).unwrap_or(planes.len());
        planes.insert(place, FoundPlane { plane, share, spread_m });
        // Twice the tolerance: what is almost on a plane would be found again, tilted.
        left.retain(|r| distance(r) >= 2.0);
    }
    planes
}

fn readings(depth: &DepthMap, camera: &Pinhole, taken: &Mask) -> Vec<Reading> {
    let width = depth.width();
    let known = depth.data().iter().zip(taken.data()).filter(|(z, taken)| **z > 0.0 && **taken == 0).count();
    let step = ((known as f64 / SAMPLES as f64).sqrt().ceil() as usize).max(1);
    let mut readings = Vec::new();
    for v in (step / 2..depth.height()).step_by(step) {
        for u in (step / 2..width).step_by(step) {
            let i = v * width + u;
            let z = f64::from(depth.data()[i]);
            if z > 0.0 && taken.data()[i] == 0 {
                let point = camera.back_project(u as f64, v as f64, z).as_dvec3();
                readings.push(Reading { at: [u, v], point, tolerance: TOLERANCE[0] + TOLERANCE[1] * z });
            }
        }
    }
    readings
}

/// The best of many planes through three neighbouring readings, by truncated squares.
fn draw(readings: &[Reading], reach: f64, random: &mut Random) -> Option<Plane> {
    let step = readings.len().div_ceil(TESTED).max(1);
    let mut best: Option<(f64, Plane)> = None;
    for _ in 0..DRAWS {
        let first = readings[random.below(readings.len())];
        let mut near = || {
            for _ in 0..24 {
                let other = readings[random.below(readings.len())];
                let apart = [0, 1].map(|axis| (first.at[axis] as f64 - other.at[axis] as f64).abs());
                if apart[0].max(apart[1]) <= reach {
                    return Some(other);
                }
            }
            None
        };
        let Some([second, third]) = near().zip(near()).map(|(a, b)| [a, b]) else { continue };
        let Some(plane) = Plane::through([first.point, second.point, third.point]) else { continue };
        let credit: f64 = readings.iter().step_by(step).map(|r| credit(&plane, r)).sum();
        if best.is_none_or(|(most, _)| credit > most) {
            best = Some((credit, plane));
        }
    }
    best.map(|(_, plane)| plane)
}

fn credit(plane: &Plane, reading: &Reading) -> f64 {
    let q = plane.height(reading.point) / reading.tolerance;
    (1.0 - q * q).max(0.0)
}

/// Fits a plane to the readings on it, by Tukey's weights.
fn refit(mut plane: Plane, readings: &[Reading]) -> Plane {
    for _ in 0..REFITS {
        let weighted = readings.iter().map(|r| {
            let credit = credit(&plane, r);
            // The noise of depth grows with its square, about.
            (r.point, credit * credit / (r.tolerance * r.tolerance))
        });
        let Some(fitted) = Plane::fitted(weighted) else { break };
        plane = fitted;
    }
    plane
}

/// The pixels of any of these masks and their neighbours, whose depths mix with those of the object.
pub fn union_of<'a>(width: usize, height: usize, masks: impl Iterator<Item = &'a Mask>) -> Mask {
    const RIM: usize = 2;
    let mut union = Image::filled(width, height, 0u8);
    for mask in masks {
        for v in 0..height {
            for u in 0..width {
                if mask.data()[v * width + u] == 0 {
                    continue;
                }
                let pixels = union.data_mut();
                for y in v.saturating_sub(RIM)..=(v + RIM).min(height - 1) {
                    pixels[y * width + u.saturating_sub(RIM)..=y * width + (u + RIM).min(width - 1)].fill(1);
                }
            }
        }
    }
    union
}
