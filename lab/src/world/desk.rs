//! Objects that stand on a desk, close to each other, among clutter.

use super::{Placed, World, center_of, unit};
use crate::conditions::Tier;
use crate::objects::mesh::shifted;
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
    /// Takes the place nearest to `from`, in a direction, that is `gap` metres away from everything else.
    fn take(&mut self, mesh: &Mesh, from: DVec2, direction: DVec2, gap: f64) -> DVec3 {
        let footprint = Footprint::of(mesh);
        let is_free = |at: &DVec2| self.0.iter().all(|(other, place)| other.gap(&footprint, *at - *place) >= gap);
        let steps = (FARTHEST_M / STEP_M) as usize;
        let places = (0..=steps).map(|i| from + direction * (STEP_M * i as f64));
        let place = places.clone().find(is_free).or_else(|| places.clone().next_back()).unwrap_or(from);
        self.0.push((footprint, place));
        place.extend(0.0)
    }
}

impl World {
    /// This many objects on a desk with clutter.
    pub fn desk(count: usize, random: &mut Random) -> Result<Self> {
        let front = TAU * random.uniform();
        let mut floor = Floor::default();
        let mut objects: Vec<Placed> = Vec::new();
        for _ in 0..count {
            let mut placed = Placed::put_down(Object::draw(Pool::All, random)?, Tier::Easy, random)?;
            let from = if floor.0.is_empty() { DVec2::ZERO } else { floor.0[random.below(floor.0.len())].1 };
            // Mostly behind or before another, seen from the camera.
            let side = if chance(random, IN_A_LINE) {
                front + if chance(random, 0.5) { PI } else { 0.0 } + between(random, -0.6, 0.6)
            } else {
                TAU * random.uniform()
            };
            let place = floor.take(&placed.mesh, from, unit(side), between(random, 0.003, 0.02));
            placed.mesh = shifted(&placed.mesh, place)?;
            objects.push(placed);
        }
        let middle = center_of(&objects).truncate();
        let mut others = Vec::new();
        for _ in 0..1 + random.below(5) {
            let mut solid = Solid::default();
            let (half, height) = (between(random, 0.03, 0.12), between(random, 0.03, 0.25));
            solid.block(DVec3::ZERO, 0.0, half, height, random);
            let mesh = solid.finish()?.0;
            let place = floor.take(&mesh, middle, unit(TAU * random.uniform()), between(random, 0.006, 0.06));
            others.push(shifted(&mesh, place)?);
        }
        Ok(Self::new(objects, others, front, between(random, 0.02, 1.0)))
    }
}
