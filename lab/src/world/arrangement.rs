//! Arrangements of objects on a desk: they stand close to each other without intersection, stand on each other, lean and
//! hang.

use super::{Placed, Stance, World, center_of, things, unit};
use crate::conditions::Tier;
use crate::objects::mesh::{box_of, mapped, random_rotation, shifted, turned_axes};
use crate::objects::solid::Solid;
use crate::objects::{Object, Pool};
use crate::prelude::*;

/// Directions in which footprints are measured.
const DIRECTIONS: usize = 64;
/// The step of a thing outwards to find room, and the distance at which it gives up, metres.
const STEP_M: f64 = 0.004;
const FARTHEST_M: f64 = 3.0;
/// Share of the objects that are put behind or before another one.
const IN_A_LINE: f64 = 0.7;
/// Scenes whose depth map shows nothing but the objects.
const BARE: f64 = 0.1;
/// Largest distance between the table and where the depth map shows it, metres.
const OFFSET_M: f64 = 0.01;

impl Stance {
    /// Half of the objects stand on the desk.
    fn draw(random: &mut Random) -> Self {
        match random.uniform() {
            u if u < 0.5 => Self::Stands,
            u if u < 0.65 => Self::Leans,
            u if u < 0.75 => Self::Hangs,
            _ => Self::OnTop,
        }
    }
}

/// The convex hull of what a thing covers of the plane: its reach from the thing's origin in each direction.
struct Footprint(Vec<f64>);

/// Footprints at their places.
#[derive(Default)]
struct Floor(Vec<(Footprint, DVec2)>);

fn directions() -> impl Iterator<Item = DVec2> {
    (0..DIRECTIONS).map(|k| unit(TAU * k as f64 / DIRECTIONS as f64))
}

impl Footprint {
    fn of(mesh: &Mesh) -> Self {
        let reach = |d: DVec2| {
            let along = mesh.positions().iter().map(|p| p.as_dvec3().truncate().dot(d));
            along.fold(f64::NEG_INFINITY, f64::max)
        };
        Self(directions().map(reach).collect())
    }

    /// Width of the widest strip between two footprints, a lower bound of their distance; negative where they may
    /// overlap.
    fn gap(&self, other: &Self, offset: DVec2) -> f64 {
        let strips = directions().enumerate().map(|(k, d)| {
            let opposite = (k + DIRECTIONS / 2) % DIRECTIONS;
            offset.dot(d) - other.0[opposite] - self.0[k]
        });
        strips.fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Floor {
    /// One of the occupied places, at random; the origin if there is none.
    fn any_place(&self, random: &mut Random) -> DVec2 {
        if self.0.is_empty() { DVec2::ZERO } else { self.0[random.below(self.0.len())].1 }
    }

    /// Places an object that stands on z = 0 at the origin.
    fn place(
        &mut self,
        stance: Stance,
        placed: Placed,
        objects: &[Placed],
        front: f64,
        random: &mut Random,
    ) -> Result<Placed> {
        let resting: Vec<&Placed> = objects.iter().filter(|other| other.stance == Stance::Stands).collect();
        let mut placed = match stance {
            Stance::Leans | Stance::Hangs => held(stance, placed, random)?,
            Stance::Stands | Stance::OnTop => placed,
        };
        if let (Stance::OnTop, Some(base)) = (stance, resting.get(random.below(resting.len().max(1)))) {
            let top = base.mesh.positions().iter().copied().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or_default();
            placed.shift(top.as_dvec3())?;
            return Ok(Placed { stance, ..placed });
        }
        let from = self.any_place(random);
        // Mostly behind or before another, seen from the camera.
        let side = if chance(random, IN_A_LINE) {
            front + if chance(random, 0.5) { PI } else { 0.0 } + between(random, -0.6, 0.6)
        } else {
            TAU * random.uniform()
        };
        let place = self.take(&placed.mesh, from, unit(side), between(random, 0.003, 0.02));
        placed.shift(place.extend(0.0))?;
        Ok(placed)
    }

    /// Takes the place nearest to `from`, in a direction, that is `gap` metres away from everything else.
    fn take(&mut self, mesh: &Mesh, from: DVec2, direction: DVec2, gap: f64) -> DVec2 {
        let footprint = Footprint::of(mesh);
        let is_free = |at: &DVec2| self.0.iter().all(|(other, place)| other.gap(&footprint, *at - *place) >= gap);
        let steps = (FARTHEST_M / STEP_M) as usize;
        let places = (0..=steps).map(|i| from + direction * (STEP_M * i as f64));
        let place = places.clone().find(is_free).or_else(|| places.clone().next_back()).unwrap_or(from);
        self.0.push((footprint, place));
        place
    }
}

impl World {
    /// This many objects on a desk with clutter. Those of an arranged world have any stance, and the depth map shows its
    /// table up to a centimetre too high or too low, or not at all.
    pub fn desk(count: usize, is_arranged: bool, random: &mut Random) -> Result<Self> {
        let front = TAU * random.uniform();
        let mut floor = Floor::default();
        let is_bare = is_arranged && chance(random, BARE);
        let mut objects: Vec<Placed> = Vec::new();
        for k in 0..count {
            let placed = Placed::put_down(Object::draw(Pool::Desk, random)?, Tier::Easy, random)?;
            let stance = match (k, is_bare) {
                (_, true) => Stance::Hangs,
                (0, _) => Stance::Stands,
                _ if !is_arranged => Stance::Stands,
                _ => Stance::draw(random),
            };
            objects.push(floor.place(stance, placed, &objects, front, random)?);
        }
        let middle = center_of(&objects).truncate();
        let mut others = Vec::new();
        let things = if is_bare { 0 } else { 1 + random.below(5) };
        for _ in 0..things {
            let mut solid = Solid::default();
            let (half, height) = (between(random, 0.03, 0.12), between(random, 0.03, 0.25));
            things::block(&mut solid, DVec3::ZERO, 0.0, half, height, random);
            let mesh = solid.finish()?.0;
            let place = floor.take(&mesh, middle, unit(TAU * random.uniform()), between(random, 0.006, 0.06));
            others.push(shifted(&mesh, place.extend(0.0))?);
        }
        let mut world = Self::new(objects, others, front, between(random, 0.02, 1.0));
        if is_arranged {
            let offset = if chance(random, 0.7) { between(random, -OFFSET_M, OFFSET_M) } else { 0.0 };
            world.table = (!is_bare).then_some(offset);
        }
        Ok(world)
    }
}

/// An object that is tilted, or turned and lifted.
fn held(stance: Stance, placed: Placed, random: &mut Random) -> Result<Placed> {
    let (turn, lift) = if stance == Stance::Hangs {
        (random_rotation(random).to_rotation_matrix(), between(random, 0.05, 0.2))
    } else {
        let axis = unit(TAU * random.uniform());
        let axis = nalgebra::Unit::new_normalize(Vector3::new(axis.x, axis.y, 0.0));
        (Rotation3::from_axis_angle(&axis, between(random, 0.25, 0.6)), 0.0)
    };
    let turned = mapped(&placed.mesh, |p| vec3(&(turn * vector3(*p))))?;
    let mesh = shifted(&turned, DVec3::Z * (lift - box_of(&turned).0.z))?;
    let symmetry = turned_axes(turn.matrix(), &placed.symmetry);
    Ok(Placed { mesh, symmetry, stance, ..placed })
}
