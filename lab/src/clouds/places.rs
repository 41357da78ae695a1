//! Places to scan, as meshes: a furnished room and a street. Metres, z up, the floor at z = 0.

use crate::cases::solid::Solid;
use crate::prelude::*;

/// Random stream of what stands in a place.
const PLACE_STREAM: u64 = 0x706c_6163;

/// A room, its middle at the origin.
pub struct Room {
    pub mesh: Mesh,
    /// Half its width, depth and height inside.
    pub half: DVec3,
}

/// Puts boxes, cylinders and ellipsoids on the floor or on one another.
struct Builder<'a> {
    solid: Solid,
    random: &'a mut Random,
}

impl Builder<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        between(self.random, low, high)
    }

    /// A box that stands at a place of a frame.
    fn block(&mut self, frame: DAffine3, at: DVec3, size: DVec3) {
        let middle = DAffine3::from_translation(at + DVec3::new(0.0, 0.0, 0.5 * size.z));
        self.solid.at(frame * middle).cuboid(0.5 * size, 0.006);
    }

    /// A box, a cylinder or an ellipsoid of about this size.
    fn thing(&mut self, frame: DAffine3, size: f64) {
        let turned = frame * DAffine3::from_rotation_z(self.between(0.0, TAU));
        let [a, b, c] = [(0.5, 1.4), (0.5, 1.4), (0.4, 1.6)].map(|(low, high)| size * self.between(low, high));
        match self.random.below(4) {
            0 | 1 => self.block(turned, DVec3::ZERO, DVec3::new(a, b, c)),
            2 => self.solid.at(turned).cylinder([0.4 * a, 0.4 * b], c),
            _ => {
                let lifted = turned * DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.5 * c));
                self.solid.at(lifted).ellipsoid(0.5 * DVec3::new(a, b, c));
            }
        }
    }

    /// A board on four legs, with things on it, and with a back where it is a chair.
    fn table(&mut self, frame: DAffine3, size: DVec3, is_chair: bool) {
        self.block(frame, DVec3::new(0.0, 0.0, size.z - 0.04), DVec3::new(size.x, size.y, 0.04));
        for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let at = DVec3::new(x * (0.5 * size.x - 0.04), y * (0.5 * size.y - 0.04), 0.0);
            self.block(frame, at, DVec3::new(0.05, 0.05, size.z - 0.04));
        }
        if is_chair {
            return self.block(frame, DVec3::new(0.0, -0.5 * size.y, size.z), DVec3::new(size.x, 0.04, 0.45));
        }
        for _ in 0..self.random.below(4) + 2 {
            let at = DVec3::new(self.between(-0.4, 0.4) * size.x, self.between(-0.35, 0.35) * size.y, size.z);
            self.thing(frame * DAffine3::from_translation(at), 0.13);
        }
    }

    /// A piece of furniture that faces +y: a table, a chair, a cabinet or a sofa.
    fn furniture(&mut self, frame: DAffine3) {
        match self.random.below(4) {
            0 => {
                let size = DVec3::new(self.between(0.8, 1.4), self.between(0.5, 0.75), self.between(0.68, 0.78));
                self.table(frame, size, false);
            }
            1 => {
                let size = DVec3::new(self.between(0.42, 0.5), self.between(0.42, 0.5), self.between(0.42, 0.48));
                self.table(frame, size, true);
            }
            2 => {
                let size = DVec3::new(self.between(0.6, 1.1), self.between(0.3, 0.5), self.between(0.7, 2.0));
                self.block(frame, DVec3::ZERO, size);
                self.thing(frame * DAffine3::from_translation(DVec3::new(0.1, 0.0, size.z)), 0.2);
            }
            _ => {
                let width = self.between(1.2, 1.9);
                self.block(frame, DVec3::new(0.0, 0.1, 0.05), DVec3::new(width, 0.75, 0.37));
                self.block(frame, DVec3::new(0.0, -0.3, 0.05), DVec3::new(width, 0.2, 0.8));
                for side in [-0.5, 0.5] {
                    self.block(frame, DVec3::new(side * width, 0.05, 0.05), DVec3::new(0.18, 0.85, 0.58));
                }
            }
        }
    }

    /// Pictures, shelves and doors along a wall of the frame's x axis.
    fn wall(&mut self, frame: DAffine3, half_length: f64) {
        let mut x = 0.4 - half_length;
        while x < half_length - 0.9 {
            let width = self.between(0.5, 1.2);
            let (low, height) = if chance(self.random, 0.3) { (0.0, 2.05) } else { (self.between(0.8, 1.6), 0.5) };
            let deep = self.between(0.03, 0.25);
            self.block(frame, DVec3::new(x + 0.5 * width, 0.5 * deep, low), DVec3::new(width, deep, height));
            x += width + self.between(0.15, 0.7);
        }
    }
}

impl Room {
    /// The room of a seed.
    ///
    /// # Errors
    /// Those of [`Mesh::new`], which only a bug in the generator could cause.
    pub fn new(seed: u64) -> Result<Self> {
        let random = &mut Random::new(seed, PLACE_STREAM);
        let half = DVec3::new(between(random, 2.2, 3.4), between(random, 1.8, 2.8), between(random, 1.25, 1.4));
        let mut room = Builder { solid: Solid::default(), random };
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let (mut center, mut size) = (DVec3::new(0.0, 0.0, half.z), half + DVec3::splat(0.1));
            center[axis] += side * (half[axis] + 0.05);
            size[axis] = 0.05;
            room.solid.at(DAffine3::from_translation(center)).cuboid(size, 0.0);
        }
        for wall in 0..4 {
            let [along, out] = if wall % 2 == 0 { [half.x, half.y] } else { [half.y, half.x] };
            let frame = DAffine3::from_rotation_z(f64::from(wall) * FRAC_PI_2)
                * DAffine3::from_translation(DVec3::new(0.0, -out, 0.0));
            room.wall(frame, along);
            let mut x = 0.5 - along;
            while x < along - 0.6 {
                let at = DVec3::new(x, room.between(0.35, 0.5), 0.0);
                room.furniture(frame * DAffine3::from_translation(at));
                x += room.between(1.0, 1.7);
            }
        }
        for i in 0..18 {
            let at = DVec3::new(room.between(-0.6, 0.6) * half.x, room.between(-0.6, 0.6) * half.y, 0.0);
            let frame = DAffine3::from_translation(at) * DAffine3::from_rotation_z(room.between(0.0, TAU));
            if i < 4 { room.furniture(frame) } else { room.thing(frame, 0.25) }
        }
        Ok(Self { mesh: room.solid.finish()?.0, half })
    }
}

/// A straight street along x, with houses, parked cars, poles and trees at both sides.
///
/// # Errors
/// Those of [`Mesh::new`], which only a bug in the generator could cause.
pub fn street(seed: u64, length: f64) -> Result<Mesh> {
    let mut street = Builder { solid: Solid::default(), random: &mut Random::new(seed, PLACE_STREAM) };
    let ends = 80.0;
    let ground = DVec3::new(length + 4.0 * ends, 200.0, 0.2);
    street.block(DAffine3::IDENTITY, DVec3::new(0.5 * length, 0.0, -0.2), ground);
    for side in [-1.0, 1.0] {
        let mut x = -ends;
        while x < length + ends {
            let size = DVec3::new(street.between(6.0, 16.0), street.between(6.0, 10.0), street.between(3.5, 14.0));
            let front = street.between(7.5, 13.0);
            street.block(DAffine3::IDENTITY, DVec3::new(x + 0.5 * size.x, side * (front + 0.5 * size.y), 0.0), size);
            for _ in 0..street.random.below(7) + 3 {
                let bay = DVec3::new(street.between(0.6, 2.5), street.between(0.3, 1.2), street.between(0.2, 2.2));
                let at = DVec3::new(x + street.between(0.05, 0.95) * size.x, side * front, street.between(0.0, 3.0));
                street.block(DAffine3::IDENTITY, at, bay);
            }
            x += size.x + if chance(street.random, 0.35) { street.between(3.0, 12.0) } else { 0.0 };
        }
        let mut x = -ends;
        while x < length + ends {
            let turn = DAffine3::from_rotation_z(street.between(-0.15, 0.15));
            let mut at = |near: f64, far: f64| {
                DAffine3::from_translation(DVec3::new(x, side * street.between(near, far), 0.0)) * turn
            };
            let (car, beside) = (at(3.9, 4.1), at(5.3, 7.0));
            match street.random.below(4) {
                0 | 1 => {
                    let long = street.between(3.8, 4.8);
                    street.block(car, DVec3::new(0.0, 0.0, 0.25), DVec3::new(long, 1.75, 0.6));
                    street.block(car, DVec3::new(0.0, 0.0, 0.85), DVec3::new(0.55 * long, 1.55, 0.55));
                }
                2 => {
                    let (radius, height) = (street.between(0.05, 0.3), street.between(2.2, 5.0));
                    street.solid.at(beside).cylinder([radius, radius], height);
                    let crown = beside * DAffine3::from_translation(DVec3::new(0.0, 0.0, height + 0.8));
                    let radii = DVec3::new(street.between(0.4, 2.6), street.between(0.4, 2.6), 1.5);
                    street.solid.at(crown).ellipsoid(radii);
                }
                _ => street.thing(beside, 1.2),
            }
            x += street.between(3.0, 8.0);
        }
    }
    Ok(street.solid.finish()?.0)
}
