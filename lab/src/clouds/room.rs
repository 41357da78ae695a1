//! A furnished room: metres, z up, the floor's middle at the origin.

use crate::objects::solid::Solid;
use crate::prelude::*;

/// Random stream of walls and furniture.
const ROOM_STREAM: u64 = 0x726f_6f6d;

/// Thickness of walls, floor and ceiling.
const WALL_M: f64 = 0.1;

/// Walls and what stands between them.
#[derive(Debug, Clone)]
pub struct Room {
    /// Everything.
    pub mesh: Mesh,
    /// Half its width, depth and height inside.
    pub half: DVec3,
}

impl Room {
    /// The room of a seed.
    ///
    /// # Errors
    /// Those of [`Mesh::new`], which only a bug in the generator could cause.
    pub fn new(seed: u64) -> Result<Self> {
        let random = &mut Random::new(seed, ROOM_STREAM);
        let half = DVec3::new(between(random, 2.2, 3.4), between(random, 1.8, 2.8), between(random, 1.25, 1.4));
        let mut builder = Furnisher { solid: Solid::default(), random };
        builder.shell(half);
        builder.walls(half);
        builder.along_walls(half);
        for _ in 0..4 {
            let reach = half - DVec3::splat(1.1);
            let at = DVec3::new(builder.between(-reach.x, reach.x), builder.between(-reach.y, reach.y), 0.0);
            let turn = builder.between(0.0, TAU);
            builder.piece(at, turn);
        }
        for _ in 0..14 {
            let at = DVec3::new(
                builder.between(0.2 - half.x, half.x - 0.2),
                builder.between(0.2 - half.y, half.y - 0.2),
                0.0,
            );
            builder.thing(at, 0.25);
        }
        Ok(Self { mesh: builder.solid.finish()?.0, half })
    }
}

struct Furnisher<'a> {
    solid: Solid,
    random: &'a mut Random,
}

impl Furnisher<'_> {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        between(self.random, low, high)
    }

    /// A box that stands on its frame's plane z = 0.
    fn block(&mut self, frame: DAffine3, at: DVec3, size: DVec3) {
        let half = 0.5 * size;
        let middle = DAffine3::from_translation(at + DVec3::new(0.0, 0.0, half.z));
        self.solid.at(frame * middle).cuboid(half, 0.006);
    }

    fn shell(&mut self, half: DVec3) {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let (mut center, mut size) = (DVec3::ZERO, half + DVec3::splat(WALL_M));
            center[axis] = side * (half[axis] + 0.5 * WALL_M);
            size[axis] = 0.5 * WALL_M;
            center.z += half.z;
            self.solid.at(DAffine3::from_translation(center)).cuboid(size, 0.0);
        }
    }

    /// Door, windows, pictures, shelves and a radiator: what stands out from the walls. The wall's frame has x along
    /// it, y into the room.
    fn walls(&mut self, half: DVec3) {
        for (wall, frame) in walls(half) {
            let length = if wall % 2 == 0 { half.x } else { half.y };
            let mut x = -length + 0.3;
            while x < length - 0.9 {
                let width = self.between(0.5, 1.2).min(length - 0.2 - x);
                let middle = x + 0.5 * width;
                match self.random.below(5) {
                    0 => self.frame(frame, [middle, 0.0], [width, 2.05]),
                    1 => {
                        let (low, height) = (self.between(0.8, 1.0), self.between(0.9, 1.2));
                        self.frame(frame, [middle, low], [width, height]);
                        self.block(frame, DVec3::new(middle, 0.08, low - 0.05), DVec3::new(width + 0.1, 0.16, 0.04));
                        if chance(self.random, 0.5) {
                            self.block(frame, DVec3::new(middle, 0.06, 0.1), DVec3::new(width, 0.1, 0.55));
                        }
                    }
                    2 => {
                        let low = self.between(1.2, 1.6);
                        let size = DVec3::new(0.8 * width, 0.04, self.between(0.3, 0.8));
                        self.block(frame, DVec3::new(middle, 0.02, low), size);
                    }
                    3 => {
                        for level in 0..self.random.below(3) + 1 {
                            let z = 1.1 + 0.38 * level as f64;
                            self.block(frame, DVec3::new(middle, 0.12, z), DVec3::new(width, 0.24, 0.03));
                            self.row(frame, DVec3::new(x + 0.05, 0.12, z + 0.03), width - 0.1);
                        }
                    }
                    _ => {}
                }
                x += width + self.between(0.15, 0.7);
            }
        }
    }

    /// A frame of boards about a door or a window.
    fn frame(&mut self, wall: DAffine3, [x, low]: [f64; 2], [width, height]: [f64; 2]) {
        let deep = self.between(0.03, 0.07);
        for side in [-0.5, 0.5] {
            let at = DVec3::new(x + side * width, 0.5 * deep, low);
            self.block(wall, at, DVec3::new(0.08, deep, height));
        }
        self.block(wall, DVec3::new(x, 0.5 * deep, low + height - 0.04), DVec3::new(width, deep, 0.08));
        if low > 0.0 {
            self.block(wall, DVec3::new(x, 0.5 * deep, low + 0.45 * height), DVec3::new(width, 0.03, 0.05));
        }
    }

    /// Books and other things in a row.
    fn row(&mut self, frame: DAffine3, from: DVec3, length: f64) {
        let mut x = 0.0;
        while x < length {
            let size = DVec3::new(self.between(0.02, 0.09), self.between(0.12, 0.2), self.between(0.15, 0.3));
            if chance(self.random, 0.75) {
                self.block(frame, from + DVec3::new(x + 0.5 * size.x, 0.0, 0.0), size);
            }
            x += size.x + 0.01;
        }
    }

    /// Furniture with its back to each wall.
    fn along_walls(&mut self, half: DVec3) {
        for (wall, frame) in walls(half) {
            let length = if wall % 2 == 0 { half.x } else { half.y };
            let mut x = -length + self.between(0.3, 0.8);
            while x < length - 0.8 {
                let at = frame.transform_point3(DVec3::new(x, self.between(0.35, 0.5), 0.0));
                let turn = f64::from(wall) * FRAC_PI_2 + self.between(-0.06, 0.06);
                self.piece(at, turn);
                x += self.between(1.0, 1.7);
            }
        }
    }

    /// A piece of furniture, facing its own +y.
    fn piece(&mut self, at: DVec3, turn: f64) {
        let frame = DAffine3::from_rotation_translation(DQuat::from_rotation_z(turn), at);
        let along = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        match self.random.below(7) {
            0 | 1 => {
                let size = along(self.between(0.8, 1.4), self.between(0.5, 0.75), self.between(0.68, 0.78));
                self.legged(frame, size);
                for _ in 0..self.random.below(4) + 2 {
                    let (x, y) = (self.between(-0.4, 0.4) * size.x, self.between(-0.35, 0.35) * size.y);
                    self.thing(frame.transform_point3(along(x, y, size.z)), 0.13);
                }
                if chance(self.random, 0.5) {
                    self.block(frame, along(0.0, -0.12, size.z + 0.1), along(0.55, 0.05, 0.34));
                    self.block(frame, along(0.0, -0.14, size.z), along(0.08, 0.08, 0.12));
                }
            }
            2 => {
                let size = along(self.between(0.42, 0.5), self.between(0.42, 0.5), self.between(0.42, 0.48));
                self.legged(frame, size);
                let back = along(size.x, 0.04, self.between(0.35, 0.55));
                self.block(frame, along(0.0, -0.5 * size.y, size.z), back);
            }
            3 => {
                let size = along(self.between(0.6, 1.1), self.between(0.3, 0.5), self.between(0.7, 2.0));
                self.block(frame, DVec3::ZERO, size);
                self.thing(frame.transform_point3(along(0.1, 0.0, size.z)), 0.2);
                for level in 1..4 {
                    let z = size.z * f64::from(level) / 4.0;
                    self.block(frame, along(0.0, 0.5 * size.y, z), along(0.2, 0.06, 0.03));
                }
            }
            4 => {
                let width = self.between(1.2, 1.9);
                self.block(frame, along(0.0, 0.1, 0.05), along(width, 0.75, 0.37));
                self.block(frame, along(0.0, -0.3, 0.05), along(width, 0.2, 0.8));
                for side in [-0.5, 0.5] {
                    self.block(frame, along(side * width, 0.05, 0.05), along(0.18, 0.85, 0.58));
                }
                for _ in 0..self.random.below(3) {
                    let p = frame.transform_point3(along(self.between(-0.4, 0.4) * width, 0.0, 0.5));
                    self.solid.at(DAffine3::from_translation(p)).ellipsoid(along(0.22, 0.15, 0.2));
                }
            }
            5 => {
                let (foot, height) = (self.between(0.12, 0.2), self.between(0.3, 0.6));
                self.solid.at(frame).cylinder([0.8 * foot, foot], height);
                for _ in 0..7 {
                    let p = frame.transform_point3(along(
                        self.between(-0.2, 0.2),
                        self.between(-0.2, 0.2),
                        height + self.between(0.1, 0.6),
                    ));
                    let radii = along(self.between(0.08, 0.2), self.between(0.06, 0.12), self.between(0.08, 0.2));
                    self.solid.at(DAffine3::from_translation(p)).ellipsoid(radii);
                }
            }
            _ => {
                let pole = self.between(1.2, 1.6);
                self.solid.at(frame).cylinder([0.16, 0.14], 0.04);
                self.solid.at(frame).cylinder([0.02, 0.02], pole);
                self.solid.at(frame * DAffine3::from_translation(along(0.0, 0.0, pole))).cylinder([0.2, 0.13], 0.28);
            }
        }
    }

    /// A board on four legs.
    fn legged(&mut self, frame: DAffine3, size: DVec3) {
        self.block(frame, DVec3::new(0.0, 0.0, size.z - 0.04), DVec3::new(size.x, size.y, 0.04));
        for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let at = DVec3::new(x * (0.5 * size.x - 0.04), y * (0.5 * size.y - 0.04), 0.0);
            self.block(frame, at, DVec3::new(0.05, 0.05, size.z - 0.04));
        }
    }

    /// A box, a ball, a cup or a bottle of about this size.
    fn thing(&mut self, at: DVec3, size: f64) {
        let turn = DQuat::from_rotation_z(self.between(0.0, TAU));
        let frame = DAffine3::from_rotation_translation(turn, at);
        let mut part = |low: f64, high: f64| size * between(self.random, low, high);
        let (a, b, c) = (part(0.5, 1.4), part(0.5, 1.4), part(0.4, 1.6));
        match self.random.below(4) {
            0 | 1 => self.block(frame, DVec3::ZERO, DVec3::new(a, b, c)),
            2 => self.solid.at(frame).cylinder([0.4 * a, 0.4 * b], c),
            _ => {
                let lifted = frame * DAffine3::from_translation(DVec3::new(0.0, 0.0, 0.5 * c));
                self.solid.at(lifted).ellipsoid(0.5 * DVec3::new(a, b, c));
            }
        }
    }
}

/// Frames of the four walls, x along the wall and y into the room, on the floor.
fn walls(half: DVec3) -> [(u32, DAffine3); 4] {
    [0, 1, 2, 3].map(|wall| {
        let out = if wall % 2 == 0 { half.y } else { half.x };
        let turn = DAffine3::from_rotation_z(f64::from(wall) * FRAC_PI_2);
        (wall, turn * DAffine3::from_translation(DVec3::new(0.0, -out, 0.0)))
    })
}
