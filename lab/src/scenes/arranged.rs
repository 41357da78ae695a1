//! Arranged scenes: objects that stand on each other and on boards, lean, hang and lie in piles.

use super::clutter;
use super::heap::{Below, Heap};
use super::layout::{
    Floor, Footprint, Layout, Placed, Stance, deepest, held, joined, moved, put_down, reach_of, shifted, unit,
};
use crate::cases::distortion::box_of;
use crate::cases::draft::Axis;
use crate::cases::scene::turned_axis;
use crate::cases::solid::Solid;
use crate::prelude::*;

/// Scenes with a board over the table, and scenes whose depth map shows nothing but the objects.
const BOARDS: f64 = 0.3;
const BARE: f64 = 0.1;
/// Largest distance between the table and where the depth map shows it, metres.
const OFFSET_M: f64 = 0.01;
/// Distance of what no camera sees, metres.
const FAR_M: f64 = 20.0;
/// Objects whose underside is invented.
const INVENTED: f64 = 0.5;

/// A board: its middle, its half length along the picture, and its height.
struct Board {
    middle: DVec2,
    half: f64,
    height: f64,
}

/// An object, and its surface in the world's frame.
struct Thing {
    mesh: Mesh,
    symmetry: Vec<Axis>,
    below: Below,
}

/// What stands in the world so far.
struct World {
    floor: Floor,
    heap: Heap,
    shelf: Option<(Board, Floor)>,
    front: f64,
}

impl Layout {
    /// This many objects in any stance, and their surroundings.
    pub(super) fn arranged(
        count: usize,
        random: &mut Random,
        object_random: &mut Random,
        stances: &mut Random,
    ) -> Result<Self> {
        let front = TAU * random.uniform();
        let mut world = World { floor: Floor::default(), heap: Heap::default(), shelf: None, front };
        let is_bare = chance(stances, BARE);
        let has_board = chance(stances, BOARDS) && !is_bare;
        let mut objects: Vec<Placed> = Vec::new();
        let mut meshes = Vec::new();
        for k in 0..count {
            let (object, mesh, symmetry) = put_down(object_random)?;
            let stance = match (k, is_bare) {
                (0, false) => Stance::Stands,
                (_, true) => Stance::Hangs,
                _ => Stance::draw(stances, world.shelf.is_some()),
            };
            let thing = Thing { mesh, symmetry, below: Below::Table };
            let placed = world.place(stance, thing, &objects, random, stances)?;
            let (stance, Thing { mesh, symmetry, below }) = placed;
            if stance != Stance::Hangs {
                world.heap.put(&mesh, Below::Object(k));
            }
            let is_invented = chance(stances, INVENTED);
            objects.push(Placed { stance, below, is_invented, object, mesh, symmetry });
            if k == 0 && has_board {
                meshes.push(world.put_board(stances)?);
            }
        }
        let (centre, reach) = reach_of(&objects);
        let middle = centre.truncate().as_dvec2();
        if is_bare {
            // Behind the camera.
            meshes.push(moved(&clutter::thing(random)?, unit(front) * FAR_M)?);
        } else {
            for _ in 0..1 + random.below(3) {
                let mesh = clutter::thing(random)?;
                let gap = between(random, 0.006, 0.06);
                let place = world.floor.take(Footprint::of(&mesh), middle, unit(TAU * random.uniform()), gap);
                meshes.push(moved(&mesh, place)?);
            }
        }
        let clutter = joined(&meshes)?;
        let wall = deepest(&objects, &clutter, middle, -unit(front)) + between(random, 0.02, 1.0);
        let table =
            (!is_bare).then(|| between(stances, -OFFSET_M, OFFSET_M) * f64::from(u8::from(chance(stances, 0.7))));
        Ok(Self { objects, clutter, centre, reach, front, wall, table })
    }
}

impl World {
    /// Places an object that stands on z = 0 at the origin.
    fn place(
        &mut self,
        stance: Stance,
        thing: Thing,
        objects: &[Placed],
        random: &mut Random,
        stances: &mut Random,
    ) -> Result<(Stance, Thing)> {
        let resting: Vec<&Placed> = objects.iter().filter(|placed| placed.stance != Stance::Hangs).collect();
        match stance {
            Stance::OnTop | Stance::InPile if !resting.is_empty() => {
                let base = resting[stances.below(resting.len())];
                let (middle, radius) = middle_of(&base.mesh);
                if stance == Stance::OnTop {
                    let mesh = moved(&thing.mesh, middle)?;
                    let (lift, below) = self.heap.drop(&mesh);
                    let mesh = shifted(&mesh, up(lift))?;
                    return Ok((stance, Thing { mesh, below, ..thing }));
                }
                let off = unit(TAU * stances.uniform()) * (radius * between(stances, 0.3, 1.2));
                // Tilted first, so that it does not come to lie as it stood.
                let (tilted, symmetry) = held(Stance::Leans, &thing.mesh, &thing.symmetry, stances)?;
                let mesh = moved(&tilted, middle + off)?;
                let (mesh, turn, below) = self.heap.settle(&mesh, stances)?;
                let turn = Rotation3::from(UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(
                    turn.w, turn.x, turn.y, turn.z,
                )));
                let symmetry = symmetry.iter().map(|&(axis, fold)| (turned_axis(turn.matrix(), axis), fold)).collect();
                Ok((stance, Thing { mesh, symmetry, below }))
            }
            Stance::OnBoard => {
                let Some((board, floor)) = &mut self.shelf else {
                    return self.place(Stance::Stands, thing, objects, random, stances);
                };
                let along = unit(self.front + 0.5 * PI) * if chance(stances, 0.5) { 1.0 } else { -1.0 };
                let place = floor.take(Footprint::of(&thing.mesh), board.middle, along, between(stances, 0.005, 0.03));
                if (place - board.middle).length() + middle_of(&thing.mesh).1 > board.half {
                    return self.place(Stance::Stands, thing, objects, random, stances);
                }
                let mesh = shifted(&moved(&thing.mesh, place)?, up(board.height))?;
                Ok((stance, Thing { mesh, below: Below::Board, ..thing }))
            }
            Stance::Stands | Stance::Leans | Stance::Hangs | Stance::OnTop | Stance::InPile => {
                let (mesh, symmetry) = match stance {
                    Stance::Leans | Stance::Hangs => held(stance, &thing.mesh, &thing.symmetry, stances)?,
                    _ => (thing.mesh, thing.symmetry),
                };
                let from = self.floor.any_place(random);
                let side = self.front + PI * f64::from(u8::from(chance(random, 0.3))) + between(random, -1.3, 1.3);
                let place = self.floor.take(Footprint::of(&mesh), from, unit(side), between(random, 0.003, 0.02));
                let below = if stance == Stance::Hangs { Below::Air } else { Below::Table };
                let stance = if matches!(stance, Stance::Leans | Stance::Hangs) { stance } else { Stance::Stands };
                Ok((stance, Thing { mesh: moved(&mesh, place)?, symmetry, below }))
            }
        }
    }

    /// Puts a board behind what stands there, and returns its mesh: solid down to the table, or thin.
    fn put_board(&mut self, random: &mut Random) -> Result<Mesh> {
        let height = between(random, 0.06, 0.3);
        let half = DVec3::new(between(random, 0.1, 0.16), between(random, 0.25, 0.4), 0.5 * height);
        let half = if chance(random, 0.5) { half } else { half.with_z(0.009) };
        let mut solid = Solid::default();
        let frame = DAffine3::from_rotation_z(self.front);
        solid.at(frame * DAffine3::from_translation(DVec3::Z * (height - half.z))).cuboid(half, 0.001);
        let mesh = solid.finish()?.0;
        let gap = between(random, 0.02, 0.08);
        let middle = self.floor.take(Footprint::of(&mesh), DVec2::ZERO, -unit(self.front), gap);
        let mesh = moved(&mesh, middle)?;
        self.heap.put(&mesh, Below::Board);
        self.shelf = Some((Board { middle, half: half.y, height }, Floor::default()));
        Ok(mesh)
    }
}

fn up(height: f64) -> Vec3 {
    Vec3::Z * height as f32
}

/// The middle of the box of a mesh on the plane, and half of its diagonal there.
fn middle_of(mesh: &Mesh) -> (DVec2, f64) {
    let (low, high) = box_of(mesh.positions().iter().map(|p| p.as_dvec3()));
    let (low, high) = (low.truncate(), high.truncate());
    ((low + high) * 0.5, (high - low).length() * 0.5)
}
