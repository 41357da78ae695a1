//! Families of objects: what stands in a kitchen.

use super::Draft;
use super::solid::smooth;
use crate::prelude::*;

const ROUND: (DVec3, Option<u32>) = (DVec3::Z, None);

/// A hollow vessel: the outer radius by height, the wall, the floor.
fn hollow(outer: impl Fn(f64) -> f64, height: f64, wall: f64) -> Vec<[f64; 2]> {
    let mut profile: Vec<[f64; 2]> = (0..5).map(|i| [outer(0.0) * f64::from(i) / 5.0, 0.0]).collect();
    profile.extend((0..=24).map(|i| height * f64::from(i) / 24.0).map(|z| [outer(z), z]));
    profile.push([outer(height) - 0.5 * wall, height + 0.4 * wall]);
    let inside = |i: i32| wall + (height - wall) * f64::from(i) / 24.0;
    profile.extend((0..=24).rev().map(inside).map(|z| [outer(z) - wall, z]));
    profile.extend((0..5).rev().map(|i| [(outer(wall) - wall) * f64::from(i) / 5.0, wall]));
    profile
}

/// A loop of a handle in the plane y = 0, towards +x, between two points of (x, z).
fn handle(lower: [f64; 2], upper: [f64; 2], reach: f64) -> Vec<DVec3> {
    let [low, high] = [lower, upper].map(|[x, z]| DVec3::new(x, 0.0, z));
    let out = DVec3::X * reach;
    smooth(&[low, low + out * 0.8, low.lerp(high, 0.4) + out, low.lerp(high, 0.75) + out, high + out * 0.8, high])
}

pub fn mug(draft: &mut Draft, r: &mut Random) {
    let (radius, height) = (between(r, 0.034, 0.046), between(r, 0.075, 0.12));
    let (taper, wall) = (between(r, 0.82, 1.02), between(r, 0.003, 0.006));
    draft.solid.lathe(&hollow(|z| radius * (taper + (1.0 - taper) * z / height), height, wall), 48);
    let part = draft.solid.part();
    let (low, high) = (height * between(r, 0.15, 0.3), height * between(r, 0.72, 0.86));
    let inside = radius * taper.min(1.0) - 0.6 * wall;
    let path = handle([inside, low], [inside, high], between(r, 0.028, 0.04));
    let radii = [between(r, 0.005, 0.008), between(r, 0.0035, 0.005)];
    draft.solid.tube(&path, DVec3::Y, |_| radii, 14);
    draft.keys = vec![part];
}

pub fn can(draft: &mut Draft, r: &mut Random) {
    let radius = between(r, 0.03, 0.055);
    let height = radius * between(r, 0.9, 3.2);
    draft.solid.at(DAffine3::IDENTITY).cylinder([radius, radius], height);
    draft.symmetry = vec![ROUND, (DVec3::X, Some(2))];
}

pub fn bottle(draft: &mut Draft, r: &mut Random) {
    let (radius, height) = (between(r, 0.028, 0.045), between(r, 0.17, 0.3));
    let neck = radius * between(r, 0.3, 0.5);
    let (shoulder, neck_z, cap) = (height * between(r, 0.5, 0.68), height * between(r, 0.74, 0.84), height * 0.92);
    let waist = between(r, 0.0, 0.12);
    let profile: Vec<[f64; 2]> = (0..4).map(|i| [radius * 0.94 * f64::from(i) / 4.0, 0.0]).collect();
    let body = (0..=36).map(|i| {
        let z = cap * f64::from(i) / 36.0;
        let t = ((z - shoulder) / (neck_z - shoulder)).clamp(0.0, 1.0);
        let t = t * t * (3.0 - 2.0 * t);
        let belt = 1.0 - waist * libm::sin(PI * (z / shoulder).min(1.0));
        let foot = 1.0 - 0.06 * (1.0 - (z / (0.04 * height)).min(1.0));
        [(radius * belt * foot) * (1.0 - t) + neck * t, z]
    });
    let lid = neck * between(r, 1.08, 1.35);
    let top = [[lid, cap], [lid, 0.5 * (cap + height)], [lid * 0.95, height]];
    let close = (0..4).rev().map(|i| [lid * 0.95 * f64::from(i) / 4.0, height]);
    draft.solid.lathe(&profile.into_iter().chain(body).chain(top).chain(close).collect::<Vec<_>>(), 48);
    draft.symmetry = vec![ROUND];
}

pub fn bowl(draft: &mut Draft, r: &mut Random) {
    let (radius, height) = (between(r, 0.06, 0.13), between(r, 0.045, 0.09));
    let (foot, power) = (between(r, 0.35, 0.55), between(r, 0.4, 0.75));
    let outer = |z: f64| radius * (foot + (1.0 - foot) * libm::pow(z / height, power));
    draft.solid.lathe(&hollow(outer, height, between(r, 0.0035, 0.006)), 56);
    draft.symmetry = vec![ROUND];
}

pub fn teapot(draft: &mut Draft, r: &mut Random) {
    let (radius, height) = (between(r, 0.06, 0.085), between(r, 0.1, 0.14));
    let belly = |z: f64| radius * (0.6 + 0.4 * libm::sin(PI * (0.12 + 0.76 * z / height)));
    let mut profile: Vec<[f64; 2]> = (0..4).map(|i| [belly(0.0) * f64::from(i) / 4.0, 0.0]).collect();
    profile.extend((0..=24).map(|i| height * f64::from(i) / 24.0).map(|z| [belly(z), z]));
    let lid = belly(height) * 0.92;
    profile.extend((0..8).map(|i| {
        let (sine, cosine) = libm::sincos(0.5 * PI * f64::from(i) / 8.0);
        [lid * cosine, height + 0.18 * height * sine]
    }));
    profile.push([0.0, 1.18 * height]);
    draft.solid.lathe(&profile, 48);
    draft.solid.at(DAffine3::from_translation(DVec3::Z * 1.2 * height)).ellipsoid(DVec3::splat(0.014));
    draft.solid.at(DAffine3::IDENTITY);
    let spout = draft.solid.part();
    let tip = radius + between(r, 0.04, 0.06);
    let path = smooth(&[
        DVec3::new(-0.7 * radius, 0.0, 0.3 * height),
        DVec3::new(-1.15 * radius, 0.0, 0.4 * height),
        DVec3::new(-0.92 * tip, 0.0, 0.75 * height),
        DVec3::new(-tip, 0.0, height * between(r, 0.92, 1.05)),
    ]);
    let (wide, slim) = (between(r, 0.016, 0.022), between(r, 0.007, 0.01));
    draft.solid.tube(&path, DVec3::Y, |t| [wide + (slim - wide) * t; 2], 18);
    let grip = draft.solid.part();
    let inside = belly(0.5 * height) * 0.9;
    let path = handle([inside, 0.25 * height], [belly(0.85 * height) * 0.95, 0.86 * height], between(r, 0.035, 0.05));
    draft.solid.tube(&path, DVec3::Y, |_| [0.008, 0.0055], 14);
    draft.keys = vec![spout, grip];
    draft.losable = vec![spout, grip];
}

pub fn spoon(draft: &mut Draft, r: &mut Random) {
    let (length, bowl) = (between(r, 0.11, 0.2), between(r, 0.024, 0.034));
    let (width, depth) = (bowl * between(r, 0.58, 0.72), between(r, 0.007, 0.011));
    let sheet = between(r, 0.0016, 0.0026);
    let dish = |s: f64, lift: f64| [s, lift - depth * (1.0 - s * s)];
    let mut profile: Vec<[f64; 2]> = (0..=10).map(|i| dish(f64::from(i) / 10.0, depth)).collect();
    profile.extend((0..=10).rev().map(|i| dish(0.97 * f64::from(i) / 10.0, depth + sheet)));
    draft.solid.lathe_scaled(&profile, [bowl, width], 40);
    draft.solid.part();
    let (arch, end) = (between(r, 0.008, 0.018), between(r, 0.0, 0.01));
    let path = smooth(&[
        DVec3::new(0.93 * bowl, 0.0, depth),
        DVec3::new(1.5 * bowl, 0.0, depth + arch),
        DVec3::new(0.6 * length, 0.0, depth + 0.8 * arch),
        DVec3::new(length, 0.0, end),
    ]);
    let (neck, tail) = (between(r, 0.003, 0.004), between(r, 0.007, 0.011));
    draft.solid.tube(&path, DVec3::Y, |t| [neck + (tail - neck) * t * t, sheet * 0.8], 16);
}
