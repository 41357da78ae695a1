//! Families of objects: tools, devices, boxes.

use super::Draft;
use super::solid::{arc, smooth};
use crate::prelude::*;

/// A frame that was moved.
pub fn to(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A frame whose z axis points along x.
pub fn along_x() -> DAffine3 {
    DAffine3::from_rotation_y(FRAC_PI_2)
}

/// A frame whose z axis points along y.
pub fn along_y() -> DAffine3 {
    DAffine3::from_rotation_x(-FRAC_PI_2)
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

pub fn scissors(draft: &mut Draft, r: &mut Random) {
    let (blade, shank) = (between(r, 0.075, 0.11), between(r, 0.045, 0.06));
    let open = between(r, 6.0, 22.0).to_radians();
    let loops = [between(r, 0.014, 0.017), between(r, 0.021, 0.026)];
    for (side, radius) in [(-1.0, loops[0]), (1.0, loops[1])] {
        draft.solid.part();
        draft.solid.at(to(0.0, 0.0, 0.006 + 0.0012 * side) * DAffine3::from_rotation_z(0.5 * open * side));
        let path = [DVec3::new(-shank, -0.006 * side, 0.0), DVec3::ZERO, DVec3::new(blade, 0.002 * side, 0.0)];
        draft.solid.tube(&smooth(&path), DVec3::Y, |t| [0.0065 - 0.0045 * (2.0 * t - 1.0).max(0.0), 0.0016], 14);
        let centre = DVec3::new(-shank - radius, -0.35 * radius * side, 0.0);
        let mut path = arc(centre, DVec3::X * radius * 1.35, DVec3::Y * radius, 0.0, TAU, 40);
        path.pop();
        draft.solid.ring(&path, DVec3::Z, [0.0045, 0.0035], 12);
    }
}

/// A box, no two of whose sides are alike.
pub fn carton(draft: &mut Draft, r: &mut Random) {
    let thin = between(r, 0.02, 0.045);
    let (wide, tall) = (thin * between(r, 1.5, 2.3), thin * between(r, 2.8, 4.2));
    draft.solid.at(to(0.0, 0.0, tall)).cuboid(DVec3::new(wide, thin, tall), between(r, 0.001, 0.005));
    draft.symmetry = vec![(DVec3::X, Some(2)), (DVec3::Y, Some(2)), (DVec3::Z, Some(2))];
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
    draft.symmetry = vec![(DVec3::X, Some(2)), (DVec3::Y, Some(2)), (DVec3::Z, Some(2))];
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
