//! Families of objects: furniture, toys, shoes, fruit.

use super::Draft;
use super::solid::{Solid, smooth};
use super::tools::{along_y, to};
use crate::prelude::*;

/// A leg or post.
fn post(solid: &mut Solid, from: DVec3, to: DVec3, radii: [f64; 2]) {
    solid.at(DAffine3::IDENTITY);
    solid.tube(&[from, to], DVec3::Y, |t| [radii[0] + (radii[1] - radii[0]) * t; 2], 14);
}

pub fn chair(draft: &mut Draft, r: &mut Random) {
    let (wide, deep) = (between(r, 0.19, 0.24), between(r, 0.19, 0.24));
    let (seat, top) = (between(r, 0.4, 0.48), between(r, 0.8, 1.0));
    let (leg, splay) = (between(r, 0.015, 0.022), between(r, 0.0, 0.04));
    draft.solid.at(to(0.0, 0.0, seat)).cuboid(DVec3::new(deep, wide, between(r, 0.012, 0.03)), 0.01);
    for (i, j) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let part = draft.solid.part();
        let hip = DVec3::new(i * (deep - 0.03), j * (wide - 0.03), seat);
        post(&mut draft.solid, hip, DVec3::new(hip.x + i * splay, hip.y + j * splay, 0.0), [leg, 0.7 * leg]);
        draft.losable.push(part);
    }
    draft.solid.part();
    let lean = between(r, 0.03, 0.1);
    for j in [-1.0, 1.0] {
        let low = DVec3::new(-deep + 0.02, j * (wide - 0.025), seat);
        post(&mut draft.solid, low, DVec3::new(low.x - lean, low.y, top), [leg, leg]);
    }
    let slats = 1 + r.below(4);
    for k in 0..slats {
        draft.solid.part();
        let t = 1.0 - 0.75 * k as f64 / slats as f64 - 0.1;
        let height = (0.5 * 0.6 * (top - seat) / slats as f64).min(0.12);
        let frame = to(-deep + 0.02 - lean * t, 0.0, seat + (top - seat) * t - 0.3 * height);
        draft.solid.at(frame).cuboid(DVec3::new(0.009, wide - 0.02, height), 0.006);
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
