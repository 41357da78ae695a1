//! A furnished room to scan, as a mesh: metres, z up, the floor at z = 0.

use crate::objects::solid::Solid;
use crate::prelude::*;

/// Random stream of what stands in a room.
const ROOM_STREAM: u64 = 0x726f_6f6d;

/// A room, its middle at the origin.
pub struct Room {
    pub mesh: Mesh,
    /// Half its width, depth and height inside.
    pub half: DVec3,
}

impl Room {
    /// The room of a seed.
    pub fn new(seed: u64) -> Result<Self> {
        let random = &mut Random::new(seed, ROOM_STREAM);
        let half = DVec3::new(between(random, 2.2, 3.4), between(random, 1.8, 2.8), between(random, 1.25, 1.4));
        let mut solid = Solid::default();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let (mut center, mut size) = (DVec3::new(0.0, 0.0, half.z), half + DVec3::splat(0.1));
            center[axis] += side * (half[axis] + 0.05);
            size[axis] = 0.05;
            solid.at(DAffine3::from_translation(center)).cuboid(size, 0.0);
        }
        for wall in 0..4 {
            let [along, out] = if wall % 2 == 0 { [half.x, half.y] } else { [half.y, half.x] };
            let turn = DAffine3::from_rotation_z(f64::from(wall) * FRAC_PI_2);
            // Pictures, shelves and doors, and cabinets and tables before them.
            for (gap, high, deep) in [(0.5, [0.8, 1.6], [0.03, 0.25]), (0.8, [0.0, 0.0], [0.3, 0.8])] {
                let mut x = 0.4 - along;
                while x < along - 0.9 {
                    let size = DVec3::new(between(random, 0.4, 1.2), between(random, deep[0], deep[1]), 0.0);
                    let low = if chance(random, 0.3) { 0.0 } else { between(random, high[0], high[1]) };
                    let size = size.with_z(between(random, 0.4, 1.2));
                    let corner = DVec3::new(x, -out, low);
                    slab(&mut solid, turn * DAffine3::from_translation(corner + 0.5 * size), size);
                    x += size.x + between(random, 0.1, gap);
                }
            }
        }
        for i in 0..18 {
            let spot = DVec3::new(between(random, -0.6, 0.6) * half.x, between(random, -0.6, 0.6) * half.y, 0.0);
            if i < 4 {
                table(&mut solid, spot, random);
            } else {
                let (half_width, height) = (between(random, 0.06, 0.2), between(random, 0.1, 0.4));
                solid.block(spot, 0.0, half_width, height, random);
            }
        }
        Ok(Self { mesh: solid.finish()?.0, half })
    }
}

fn slab(solid: &mut Solid, frame: DAffine3, size: DVec3) {
    solid.at(frame).cuboid(0.5 * size, 0.006);
}

/// A board on four legs, with things on it.
fn table(solid: &mut Solid, spot: DVec3, random: &mut Random) {
    let frame = DAffine3::from_translation(spot) * DAffine3::from_rotation_z(between(random, 0.0, TAU));
    let size = DVec3::new(between(random, 0.5, 1.4), between(random, 0.45, 0.75), between(random, 0.45, 0.78));
    let mut at = |place: DVec3, size| slab(solid, frame * DAffine3::from_translation(place), size);
    at(DVec3::Z * (size.z - 0.02), size.with_z(0.04));
    for (x, y) in [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)] {
        at(DVec3::new(x * (size.x - 0.08), y * (size.y - 0.08), 0.5 * size.z), DVec3::new(0.05, 0.05, size.z));
    }
    for _ in 0..2 + random.below(4) {
        let place = DVec3::new(between(random, -0.4, 0.4) * size.x, between(random, -0.35, 0.35) * size.y, size.z);
        let (half_width, height) = (between(random, 0.03, 0.09), between(random, 0.05, 0.2));
        solid.block(frame.transform_point3(place), 0.0, half_width, height, random);
    }
}
