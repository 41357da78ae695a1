//! Families of objects: each draws the proportions of one object.

use super::solid::{Solid, smooth};
use super::{Axis, Draft};
use crate::prelude::*;

const ROUND: Axis = (DVec3::Z, None);
/// The half turns of a box.
const HALF_TURNS: [Axis; 3] = [(DVec3::X, Some(2)), (DVec3::Y, Some(2)), (DVec3::Z, Some(2))];

/// A frame that was moved.
fn to(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A frame whose z axis points along x.
fn along_x() -> DAffine3 {
    DAffine3::from_rotation_y(FRAC_PI_2)
}

/// A frame whose z axis points along y.
fn along_y() -> DAffine3 {
    DAffine3::from_rotation_x(-FRAC_PI_2)
}

/// A leg or post.
fn post(solid: &mut Solid, from: DVec3, to: DVec3, radii: [f64; 2]) {
    solid.at(DAffine3::IDENTITY);
    solid.tube(&[from, to], DVec3::Y, |t| [radii[0] + (radii[1] - radii[0]) * t; 2], 14);
}

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

pub fn mug(draft: &mut Draft, r: &mut Random) {
    let (radius, height) = (between(r, 0.034, 0.046), between(r, 0.075, 0.12));
    let (taper, wall) = (between(r, 0.82, 1.02), between(r, 0.003, 0.006));
    draft.solid.lathe(&hollow(|z| radius * (taper + (1.0 - taper) * z / height), height, wall), 48);
    let part = draft.solid.part();
    let (low, high) = (height * between(r, 0.15, 0.3), height * between(r, 0.72, 0.86));
    let inside = radius * taper.min(1.0) - 0.6 * wall;
    let [low, high] = [low, high].map(|z| DVec3::new(inside, 0.0, z));
    let out = DVec3::X * between(r, 0.028, 0.04);
    let path =
        smooth(&[low, low + out * 0.8, low.lerp(high, 0.4) + out, low.lerp(high, 0.75) + out, high + out * 0.8, high]);
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

pub fn hammer(draft: &mut Draft, r: &mut Random) {
    let (length, grip) = (between(r, 0.24, 0.34), between(r, 0.012, 0.016));
    let path = [DVec3::ZERO, DVec3::new(length, 0.0, 0.0)];
    draft.solid.at(to(0.0, 0.0, 0.016));
    draft.solid.tube(&path, DVec3::Y, |t| [grip * (1.0 - 0.35 * t), grip * (0.75 - 0.2 * t)], 18);
    draft.solid.part();
    let (head, radius) = (between(r, 0.035, 0.05), between(r, 0.012, 0.017));
    draft.solid.at(to(length, 0.0, 0.016) * along_y() * to(0.0, 0.0, -0.25 * head));
    draft.solid.cylinder([radius * 0.8, radius], head * 1.25);
    draft.solid.part();
    draft.solid.at(to(length, 0.0, 0.016));
    let (reach, drop) = (between(r, 0.05, 0.07), between(r, 0.008, 0.025));
    for side in [-1.0, 1.0] {
        let path = smooth(&[
            DVec3::new(0.0, 0.2 * head, 0.003 * side),
            DVec3::new(0.002, -0.4 * reach, 0.004 * side),
            DVec3::new(-drop, -reach, 0.009 * side),
        ]);
        draft.solid.tube(&path, DVec3::Z, |t| [0.007 - 0.002 * t, radius * (0.75 - 0.55 * t)], 14);
    }
}

pub fn drill(draft: &mut Draft, r: &mut Random) {
    let (body, radius) = (between(r, 0.12, 0.16), between(r, 0.027, 0.034));
    let height = between(r, 0.15, 0.19);
    draft.solid.at(to(-0.4 * body, 0.0, height) * along_x());
    draft.solid.cylinder([radius, radius * 0.9], body);
    let chuck = draft.solid.part();
    draft.solid.at(to(0.58 * body, 0.0, height) * along_x());
    draft.solid.cylinder([radius * 0.72, radius * 0.42], between(r, 0.035, 0.05));
    draft.solid.part();
    draft.solid.at(DAffine3::IDENTITY);
    let lean = between(r, 0.015, 0.035);
    let path = [DVec3::new(-0.15 * body, 0.0, height), DVec3::new(-0.15 * body - lean, 0.0, 0.02)];
    draft.solid.tube(&path, DVec3::Y, |_| [0.017, 0.022], 20);
    let battery = draft.solid.part();
    let half = DVec3::new(between(r, 0.045, 0.06), between(r, 0.03, 0.038), between(r, 0.018, 0.026));
    draft.solid.at(to(-0.15 * body - lean + 0.012, 0.0, half.z)).cuboid(half, 0.006);
    draft.losable = vec![chuck, battery];
}

/// A box, no two of whose sides are alike.
pub fn carton(draft: &mut Draft, r: &mut Random) {
    let thin = between(r, 0.02, 0.045);
    let (wide, tall) = (thin * between(r, 1.5, 2.3), thin * between(r, 2.8, 4.2));
    draft.solid.at(to(0.0, 0.0, tall)).cuboid(DVec3::new(wide, thin, tall), between(r, 0.001, 0.005));
    draft.symmetry = HALF_TURNS.to_vec();
}

/// A box with a square base.
pub fn block(draft: &mut Draft, r: &mut Random) {
    let wide = between(r, 0.02, 0.05);
    let tall = wide * between(r, 1.3, 3.0);
    draft.solid.at(to(0.0, 0.0, tall)).cuboid(DVec3::new(wide, wide, tall), between(r, 0.001, 0.005));
    draft.symmetry = vec![(DVec3::Z, Some(4)), (DVec3::X, Some(2))];
}

/// A flat box.
pub fn book(draft: &mut Draft, r: &mut Random) {
    let long = between(r, 0.06, 0.14);
    let half = DVec3::new(long, long * between(r, 0.6, 0.8), long * between(r, 0.1, 0.3));
    draft.solid.at(to(0.0, 0.0, half.z)).cuboid(half, between(r, 0.001, 0.004));
    draft.symmetry = HALF_TURNS.to_vec();
}

pub fn phone(draft: &mut Draft, r: &mut Random) {
    let half = DVec3::new(between(r, 0.065, 0.082), between(r, 0.033, 0.039), between(r, 0.0038, 0.0055));
    draft.solid.at(to(0.0, 0.0, half.z)).cuboid(half, 0.0035);
    draft.solid.part();
    let bump = DVec3::new(between(r, 0.012, 0.019), between(r, 0.012, 0.017), between(r, 0.0025, 0.004));
    let corner = DVec3::new(half.x - bump.x - 0.006, half.y - bump.y - 0.005, 2.0 * half.z);
    draft.solid.at(DAffine3::from_translation(corner)).cuboid(bump, 0.002);
    for (i, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, 0.0)] {
        let lens = corner + DVec3::new(0.45 * bump.x * i, 0.45 * bump.y * j, bump.z - 0.001);
        draft.solid.at(DAffine3::from_translation(lens)).cylinder([0.0048, 0.0045], 0.0025);
    }
}

pub fn shoe(draft: &mut Draft, r: &mut Random) {
    let (length, wide) = (between(r, 0.23, 0.3), between(r, 0.042, 0.052));
    let half = 0.5 * length;
    draft.solid.at(to(0.0, 0.0, 0.012));
    let sole = |t: f64| {
        let round = (1.0 - libm::pow((2.0 * t - 1.0).abs(), 4.0)).max(0.0).sqrt();
        [wide * round * (0.82 + 0.25 * t - 0.22 * libm::sin(PI * t)) * 1.15, 0.012]
    };
    draft.solid.tube(&[DVec3::X * -half, DVec3::new(0.0, 0.004, 0.0), DVec3::X * half], DVec3::Y, sole, 24);
    draft.solid.part();
    let upper = DVec3::new(0.34 * length, 0.95 * wide, between(r, 0.042, 0.055));
    draft.solid.at(to(0.15 * length, 0.003, 0.022)).ellipsoid(upper);
    draft.solid.part();
    draft.solid.at(to(-0.24 * length, 0.0, 0.03)).ellipsoid(DVec3::new(0.25 * length, 0.82 * wide, 0.06));
    draft.solid.part();
    let ankle = between(r, 0.085, 0.14);
    let path = [DVec3::new(-0.22 * length, 0.0, 0.03), DVec3::new(-0.27 * length, 0.0, ankle)];
    draft.solid.at(DAffine3::IDENTITY);
    draft.solid.tube(&path, DVec3::Y, |t| [0.036 - 0.003 * t, 0.052 - 0.006 * t], 22);
}

pub fn animal(draft: &mut Draft, r: &mut Random) {
    let (length, girth) = (between(r, 0.06, 0.09), between(r, 0.028, 0.042));
    let hip = between(r, 0.05, 0.09);
    draft.solid.at(to(0.0, 0.0, hip + 0.6 * girth)).ellipsoid(DVec3::new(length, girth, girth * between(r, 0.95, 1.2)));
    let thick = between(r, 0.008, 0.014);
    for (i, j) in [(-0.62, -1.0), (-0.62, 1.0), (0.62, -1.0), (0.62, 1.0)] {
        let part = draft.solid.part();
        let top = DVec3::new(i * length, 0.55 * girth * j, hip + 0.4 * girth);
        let step = between(r, -0.15, 0.15) * hip;
        post(&mut draft.solid, top, DVec3::new(top.x + step, top.y, 0.0), [1.3 * thick, thick]);
        draft.losable.push(part);
    }
    draft.solid.part();
    let (reach, rise) = (between(r, 0.02, 0.04), between(r, 0.03, 0.08));
    let head = DVec3::new(length + reach, between(r, -0.01, 0.01), hip + girth + rise);
    post(&mut draft.solid, DVec3::new(0.7 * length, 0.0, hip + 0.8 * girth), head, [0.55 * girth, 0.42 * girth]);
    draft.solid.part();
    let size = girth * between(r, 0.5, 0.7);
    let tilt = DAffine3::from_rotation_y(between(r, 0.1, 0.7));
    draft.solid.at(DAffine3::from_translation(head) * tilt * to(0.4 * size, 0.0, 0.0));
    draft.solid.ellipsoid(DVec3::new(1.5 * size, size, 0.95 * size));
    let ears = between(r, 0.012, 0.04);
    for j in [-1.0, 1.0] {
        let root = head + DVec3::new(-0.3 * size, 0.5 * size * j, 0.5 * size);
        post(&mut draft.solid, root, root + DVec3::new(-0.2 * ears, 0.4 * ears * j, ears), [0.008, 0.005]);
    }
    let tail = draft.solid.part();
    let root = DVec3::new(-0.92 * length, 0.0, hip + girth);
    let path = smooth(&[root, root + DVec3::new(-0.03, 0.0, 0.015), root + DVec3::new(-0.045, 0.01, 0.05)]);
    draft.solid.at(DAffine3::IDENTITY);
    draft.solid.tube(&path, DVec3::Y, |t| [0.008 - 0.003 * t; 2], 12);
    draft.losable.push(tail);
}

pub fn car(draft: &mut Draft, r: &mut Random) {
    let (length, wide) = (between(r, 0.06, 0.11), between(r, 0.028, 0.042));
    let (belly, wheel) = (between(r, 0.012, 0.018), between(r, 0.012, 0.018));
    draft.solid.at(to(0.0, 0.0, wheel + belly)).cuboid(DVec3::new(length, wide, belly), 0.01);
    draft.solid.part();
    let cabin = DVec3::new(length * between(r, 0.4, 0.55), 0.85 * wide, between(r, 0.014, 0.022));
    let back = to(-length * between(r, 0.2, 0.38), 0.0, wheel + 2.0 * belly + 0.7 * cabin.z);
    draft.solid.at(back).cuboid(cabin, 0.008);
    for (i, j) in [(-0.62, -1.0), (-0.62, 1.0), (0.62, -1.0), (0.62, 1.0)] {
        let part = draft.solid.part();
        draft.solid.at(to(i * length, j * wide - 0.006, wheel) * along_y()).cylinder([wheel, wheel], 0.012);
        draft.losable.push(part);
    }
}

pub fn banana(draft: &mut Draft, r: &mut Random) {
    let (length, bow, radius) = (between(r, 0.15, 0.2), between(r, 0.035, 0.055), between(r, 0.016, 0.02));
    let path: Vec<DVec3> = (0..=32)
        .map(|i| {
            let t = f64::from(i) / 16.0 - 1.0;
            DVec3::new(0.5 * length * t, bow * (t * t - 0.35), radius)
        })
        .collect();
    let thick = |t: f64| {
        // A blunt end, a long neck, a stem.
        let belly = libm::pow((t / 0.16).min(1.0), 0.5) * (1.0 - 0.62 * ((t - 0.62) / 0.26).clamp(0.0, 1.0));
        [radius * belly.max(0.3), radius * 0.95 * belly.max(0.3)]
    };
    draft.solid.tube(&path, DVec3::Z, thick, 20);
}
