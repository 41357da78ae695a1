//! Clutter on desks.

use crate::cases::solid::Solid;
use crate::prelude::*;

/// A thing about the origin, on z = 0: books, a box, a can, a ball, a cup of pens.
pub fn thing(random: &mut Random) -> Result<Mesh> {
    let mut solid = Solid::default();
    let heading = DAffine3::from_rotation_z(TAU * random.uniform());
    match random.below(6) {
        0 | 1 => books(&mut solid, random),
        2 => {
            let half =
                DVec3::new(between(random, 0.04, 0.13), between(random, 0.03, 0.09), between(random, 0.015, 0.08));
            solid.at(heading * lifted(half.z)).cuboid(half, 0.003);
        }
        3 => {
            let radius = between(random, 0.025, 0.045);
            solid.cylinder([radius, radius * between(random, 0.9, 1.0)], between(random, 0.07, 0.17));
        }
        4 => {
            let radius = between(random, 0.025, 0.05);
            solid.at(lifted(radius)).ellipsoid(DVec3::splat(radius));
        }
        _ => pens(&mut solid, random),
    }
    Ok(solid.finish()?.0)
}

/// A screen on a foot that faces the angle `front` about z.
pub fn monitor(front: f64, random: &mut Random) -> Result<Mesh> {
    let mut solid = Solid::default();
    let facing = DAffine3::from_rotation_z(front + between(random, -0.35, 0.35));
    let half = DVec3::new(0.012, between(random, 0.2, 0.31), between(random, 0.12, 0.18));
    let height = between(random, 0.08, 0.15);
    solid.at(facing * lifted(height + half.z)).cuboid(half, 0.004);
    solid.at(facing * DAffine3::from_translation(DVec3::new(-0.03, 0.0, 0.5 * height + 0.02)));
    solid.cuboid(DVec3::new(0.012, 0.03, 0.5 * height + 0.02), 0.004);
    solid.at(facing * lifted(0.006)).cuboid(DVec3::new(0.09, 0.12, 0.006), 0.003);
    Ok(solid.finish()?.0)
}

/// One to three books, each turned a little against the one below.
fn books(solid: &mut Solid, random: &mut Random) {
    let mut height = 0.0;
    let first = TAU * random.uniform();
    for _ in 0..1 + random.below(3) {
        let turn = DAffine3::from_rotation_z(first + between(random, -0.25, 0.25));
        let half =
            DVec3::new(between(random, 0.085, 0.125), between(random, 0.06, 0.09), between(random, 0.005, 0.018));
        solid.at(turn * lifted(height + half.z)).cuboid(half, 0.002);
        height += 2.0 * half.z;
    }
}

/// Pens that lean against the rim of a cup.
fn pens(solid: &mut Solid, random: &mut Random) {
    let (radius, height) = (between(random, 0.03, 0.042), between(random, 0.08, 0.11));
    solid.cylinder([radius, radius], height);
    for _ in 0..2 + random.below(4) {
        let (sine, cosine) = libm::sincos(TAU * random.uniform());
        let [low, high] = [between(random, 0.0, 0.5), between(random, 0.6, 1.15)].map(|share| radius * share);
        let path = [
            DVec3::new(low * cosine, low * sine, 0.8 * height),
            DVec3::new(high * cosine, high * sine, height + between(random, 0.03, 0.08)),
        ];
        solid.tube(&path, DVec3::new(-sine, cosine, 0.0), |_| [0.004; 2], 10);
    }
}

fn lifted(height: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::Z * height)
}
