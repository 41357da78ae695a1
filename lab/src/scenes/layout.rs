//! Layout: objects placed close to each other without intersection.

use super::clutter;
use super::heap::Below;
use crate::cases::distortion::{mapped, random_rotation};
use crate::cases::draft::{Axis, Object};
use crate::cases::families;
use crate::cases::scene::{put_down_turned, turned_axis};
use crate::prelude::*;
use sim3align::geometry::surface::SurfaceMoments;

/// Directions in which footprints are measured.
const DIRECTIONS: usize = 64;
/// How far a thing moves outwards at a time to find room, and when it gives up, metres.
const STEP_M: f64 = 0.004;
const FARTHEST_M: f64 = 3.0;
/// Of the objects, how many have been put down on any side.
const TUMBLED: f64 = 0.25;
/// Of the objects, how many are put behind or before another one.
const IN_A_LINE: f64 = 0.7;
/// What would never be left lying on its shade.
const UPRIGHT: &[&str] = &["lamp", "teapot"];

/// Steps of the descent to the resting pose, the angle of the first step in radians, and the ratio of successive steps:
/// half a turn in total, down to 10⁻⁵ rad.
const STEPS: usize = 400;
const FIRST_STEP: f64 = 0.03;
const SHORTER: f64 = 0.98;

named! {
    /// How an object is held.
    pub enum Stance: "stance" {
        /// It stands on the desk.
        Stands = "stands",
        /// It touches the desk, tilted, and leans on something that is not seen.
        Leans = "leans",
        /// It hangs over the desk.
        Hangs = "hangs",
        /// It stands on another object.
        OnTop = "on top",
        /// It stands on a board over the desk.
        OnBoard = "on board",
        /// It lies as it fell, on or against other objects.
        InPile = "in pile",
    }
}

impl Stance {
    /// Half of them stand on the desk or, if there is one, on a board.
    pub(super) fn draw(random: &mut Random, has_board: bool) -> Self {
        match random.uniform() {
            u if u < 0.25 && has_board => Self::OnBoard,
            u if u < 0.5 => Self::Stands,
            u if u < 0.6 => Self::Leans,
            u if u < 0.7 => Self::Hangs,
            u if u < 0.85 => Self::OnTop,
            _ => Self::InPile,
        }
    }
}

/// An object at its place.
#[derive(Debug, Clone)]
pub struct Placed {
    /// How it is held.
    pub stance: Stance,
    /// What it touches below.
    pub below: Below,
    /// Whether the generator, which has not seen its underside, gives it another one.
    pub is_invented: bool,
    /// The object in its own frame.
    pub object: Object,
    /// Its surface in the world's frame, resting on z = 0.
    pub mesh: Mesh,
    /// Its axes of symmetry there.
    pub symmetry: Vec<Axis>,
}

/// A scene before anyone looks at it: metres, z up.
#[derive(Debug)]
pub struct Layout {
    /// What will be masked.
    pub objects: Vec<Placed>,
    /// What else there is, in one mesh.
    pub clutter: Mesh,
    /// The middle of the objects, and how far they reach from it.
    pub centre: Vec3,
    /// See `centre`.
    pub reach: f64,
    /// Where the camera stands, about: its angle about z.
    pub front: f64,
    /// How far behind the centre the wall is.
    pub wall: f64,
    /// At which height the depth map shows the desk, metres; `None` if it shows nothing but the objects.
    pub table: Option<f64>,
}

/// The convex hull of what a thing covers of the plane: its reach from the thing's origin in each direction.
#[derive(Debug, Clone)]
pub(super) struct Footprint(Vec<f64>);

/// Footprints at their places.
#[derive(Debug, Default)]
pub(super) struct Floor(Vec<(Footprint, DVec2)>);

fn directions() -> impl Iterator<Item = DVec2> {
    (0..DIRECTIONS).map(|k| unit(TAU * k as f64 / DIRECTIONS as f64))
}

impl Footprint {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let reach = |d: DVec2| {
            let along = mesh.positions().iter().map(|p| p.as_dvec3().truncate().dot(d));
            along.fold(f64::NEG_INFINITY, f64::max)
        };
        Self(directions().map(reach).collect())
    }

    /// The widest strip between two footprints, at most as wide as they are far from each other; negative where they
    /// may overlap.
    fn gap(&self, other: &Self, offset: DVec2) -> f64 {
        let strips = directions().enumerate().map(|(k, d)| {
            let opposite = (k + DIRECTIONS / 2) % DIRECTIONS;
            offset.dot(d) - other.0[opposite] - self.0[k]
        });
        strips.fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Floor {
    /// Any of the places taken; the origin if there is none.
    pub(super) fn any_place(&self, random: &mut Random) -> DVec2 {
        match self.0.len() {
            0 => DVec2::ZERO,
            n => self.0[random.below(n)].1,
        }
    }

    /// The place nearest to `from`, in a direction, that is `gap` metres away from everything else; takes it.
    pub(super) fn take(&mut self, footprint: Footprint, from: DVec2, direction: DVec2, gap: f64) -> DVec2 {
        let is_free = |at: DVec2| self.0.iter().all(|(other, place)| other.gap(&footprint, at - *place) >= gap);
        let steps = (FARTHEST_M / STEP_M) as usize;
        let places = (0..=steps).map(|i| from + direction * (STEP_M * i as f64));
        let place = places.clone().find(|at| is_free(*at)).or_else(|| places.clone().next_back()).unwrap_or(from);
        self.0.push((footprint, place));
        place
    }
}

impl Layout {
    /// This many objects that stand on a desk, and their surroundings.
    pub fn draw(count: usize, random: &mut Random, object_random: &mut Random) -> Result<Self> {
        let front = TAU * random.uniform();
        let mut floor = Floor::default();
        let mut objects: Vec<Placed> = Vec::new();
        for _ in 0..count {
            let (object, mesh, symmetry) = put_down(object_random)?;
            let from = floor.any_place(random);
            // Mostly behind or before another, seen from the camera.
            let side = if chance(random, IN_A_LINE) {
                front + if chance(random, 0.5) { PI } else { 0.0 } + between(random, -0.6, 0.6)
            } else {
                TAU * random.uniform()
            };
            let place = floor.take(Footprint::of(&mesh), from, unit(side), between(random, 0.003, 0.02));
            let mesh = moved(&mesh, place)?;
            let (stance, below) = (Stance::Stands, Below::Table);
            objects.push(Placed { stance, below, is_invented: false, object, mesh, symmetry });
        }
        let (centre, reach) = reach_of(&objects);
        let middle = centre.truncate().as_dvec2();
        let mut meshes = Vec::new();
        for _ in 0..2 + random.below(4) {
            let mesh = clutter::thing(random)?;
            let gap = between(random, 0.006, 0.06);
            let place = floor.take(Footprint::of(&mesh), middle, unit(TAU * random.uniform()), gap);
            meshes.push(moved(&mesh, place)?);
        }
        let back = -unit(front);
        if chance(random, 0.35) {
            let mesh = clutter::monitor(front, random)?;
            let place = floor.take(Footprint::of(&mesh), middle, back, between(random, 0.03, 0.2));
            meshes.push(moved(&mesh, place)?);
        }
        let clutter = joined(&meshes)?;
        // Behind everything.
        let wall = deepest(&objects, &clutter, middle, back) + between(random, 0.02, 1.0);
        Ok(Self { objects, clutter, centre, reach, front, wall, table: Some(0.0) })
    }
}

/// How far objects and clutter reach backwards from the middle.
pub(super) fn deepest(objects: &[Placed], clutter: &Mesh, middle: DVec2, back: DVec2) -> f64 {
    let depth = |p: &Vec3| (p.truncate().as_dvec2() - middle).dot(back);
    let points = objects.iter().flat_map(|placed| placed.mesh.positions()).chain(clutter.positions());
    points.fold(0.0f64, |far, p| far.max(depth(p)))
}

/// The middle of the box of all objects, and how far they reach from it.
pub(super) fn reach_of(objects: &[Placed]) -> (Vec3, f64) {
    let points = || objects.iter().flat_map(|placed| placed.mesh.positions());
    let (low, high) = points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
    let centre = (low + high) * 0.5;
    (centre, f64::from(points().fold(0.0f32, |far, p| far.max((*p - centre).length()))))
}

pub(super) fn unit(angle: f64) -> DVec2 {
    let (sine, cosine) = libm::sincos(angle);
    DVec2::new(cosine, sine)
}

/// An object at rest above the origin: mostly as it is made to stand, some on any side that they come to lie on.
pub(super) fn put_down(random: &mut Random) -> Result<(Object, Mesh, Vec<Axis>)> {
    let object = families::draw_for_desk(random)?;
    let (tumbled, drawn) = (chance(random, TUMBLED), random_rotation(random));
    let heading = TAU * random.uniform();
    let upright = DVec3::NEG_Z;
    let down = if UPRIGHT.contains(&object.family.as_str()) {
        upright
    } else {
        let drawn = DVec3::from_array((drawn * Vector3::z()).into());
        resting(&object.mesh, if tumbled { drawn } else { upright })
    };
    let (mesh, symmetry) = put_down_turned(&object, &turn_down(down, heading))?;
    Ok((object, mesh, symmetry))
}

/// A mesh tilted, or turned and lifted.
pub(super) fn held(stance: Stance, mesh: &Mesh, symmetry: &[Axis], random: &mut Random) -> Result<(Mesh, Vec<Axis>)> {
    let (turn, lift) = if stance == Stance::Leans {
        let (sine, cosine) = libm::sincos(TAU * random.uniform());
        let axis = nalgebra::Unit::new_normalize(Vector3::new(cosine, sine, 0.0));
        (Rotation3::from_axis_angle(&axis, between(random, 0.25, 0.6)), 0.0)
    } else {
        (random_rotation(random).to_rotation_matrix(), between(random, 0.05, 0.2))
    };
    let turned: Vec<Vector3<f64>> = mesh.positions().iter().map(|p| turn * vector3(*p)).collect();
    let low = turned.iter().fold(f64::INFINITY, |low, p| low.min(p.z));
    let positions = turned.iter().map(|p| DVec3::new(p.x, p.y, p.z - low + lift).as_vec3()).collect();
    let symmetry = symmetry.iter().map(|&(axis, fold)| (turned_axis(turn.matrix(), axis), fold)).collect();
    Ok((Mesh::new(positions, mesh.triangles().to_vec())?, symmetry))
}

pub(super) fn moved(mesh: &Mesh, place: DVec2) -> Result<Mesh> {
    shifted(mesh, place.extend(0.0).as_vec3())
}

pub(super) fn shifted(mesh: &Mesh, offset: Vec3) -> Result<Mesh> {
    mapped(mesh, |p| *p + offset)
}

pub(super) fn joined(meshes: &[Mesh]) -> Result<Mesh> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    Mesh::new(positions, triangles)
}

/// The direction, in the object's frame, that points down once the object, put on a plane with `down` downwards, has
/// rolled to rest: there its centroid is as low as it gets by small turns.
fn resting(mesh: &Mesh, down: DVec3) -> DVec3 {
    let centroid = SurfaceMoments::of(mesh).centroid;
    let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3() - centroid).collect();
    let mut down = down.normalize_or(DVec3::NEG_Z);
    let mut step = FIRST_STEP;
    for _ in 0..STEPS {
        let lowest = points.iter().copied().max_by(|a, b| a.dot(down).total_cmp(&b.dot(down)));
        // Towards the lowest point the centroid stands higher: it rolls the other way.
        let Some(uphill) = lowest.map(|p| p - down * p.dot(down)).and_then(DVec3::try_normalize) else { break };
        down = (down - uphill * step).normalize_or(down);
        step *= SHORTER;
    }
    down
}

/// The turn that brings a direction down and then the object round by `heading` radians.
fn turn_down(down: DVec3, heading: f64) -> Matrix3<f64> {
    let below = -Vector3::z();
    let down = Vector3::from(down.to_array());
    let upside_down = || Rotation3::from_axis_angle(&Vector3::x_axis(), PI);
    let lain = Rotation3::rotation_between(&down, &below).unwrap_or_else(upside_down);
    *(Rotation3::from_axis_angle(&Vector3::z_axis(), heading) * lain).matrix()
}
