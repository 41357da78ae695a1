//! Procedural objects: metres, z up, standing on the plane z = 0 about the origin.

use crate::cases::families;
use crate::cases::scene::put_down_turned;
use crate::cases::solid::{Solid, circle};
use crate::prelude::*;

/// Random stream of the dimensions.
const SHAPE_STREAM: u64 = 0x7368_6170;

named! {
    /// Kinds of generated objects.
    pub enum Kind: "kind" {
        /// A mug: a hollow cup, some 10 cm tall, with a handle towards +x.
        Mug = "mug",
        /// A hammer that lies on the table.
        Hammer = "hammer",
        /// A spoon that lies on the table: a few millimetres thin.
        Spoon = "spoon",
        /// A teapot, of which a mug that stands before it hides a good part.
        Occluded = "occluded",
    }
}

impl Kind {
    /// How far the side that nobody sees bulges at most, as a share of the box diagonal: what is thin has little room
    /// for inventions.
    pub fn bulge(self) -> f64 {
        match self {
            Self::Mug => 0.085,
            Self::Hammer => 0.03,
            Self::Spoon => 0.015,
            Self::Occluded => 0.05,
        }
    }

    /// An object of this kind; the seed varies its dimensions.
    ///
    /// # Errors
    /// Those of [`Mesh::new`], which only a bug in the generator could cause.
    pub fn mesh(self, seed: u64) -> Result<Mesh> {
        let mut random = Random::new(seed, SHAPE_STREAM);
        match self {
            Self::Mug => mug(&mut random),
            Self::Hammer => lying("hammer", between(&mut random, 0.2, 0.6), &mut random),
            Self::Spoon => lying("spoon", between(&mut random, 0.2, 0.6), &mut random),
            Self::Occluded => lying("teapot", 0.0, &mut random),
        }
    }

    /// What stands before an object of this kind and hides a part of it, about the origin of a frame of its own.
    ///
    /// # Errors
    /// Those of [`Kind::mesh`].
    pub fn occluder(self, seed: u64) -> Result<Option<Mesh>> {
        match self {
            Self::Occluded => Self::Mug.mesh(seed).map(Some),
            Self::Mug | Self::Hammer | Self::Spoon => Ok(None),
        }
    }
}

/// One of the evaluation set's objects as it is made to lie or stand, turned about the vertical, radians.
fn lying(family: &'static str, heading: f64, random: &mut Random) -> Result<Mesh> {
    let object = families::draw_from(family, random)?;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
    Ok(put_down_turned(&object, turn.matrix())?.0)
}

/// A cup as surface of revolution and a handle as tube, whose ends are hidden in the cup's wall.
fn mug(random: &mut Random) -> Result<Mesh> {
    let radius = between(random, 0.037, 0.043);
    let height = between(random, 0.094, 0.104);
    let wall = between(random, 0.0035, 0.005);
    let taper = between(random, 0.94, 1.0);
    let mut solid = Solid::default();

    // Outside: the bottom from its middle, a rounded edge, the wall upwards.
    let edge = 0.004;
    let outer = |z: f64| radius * (taper + (1.0 - taper) * z / height);
    let foot = outer(edge) - edge;
    let mut profile: Vec<[f64; 2]> = (0..6).map(|i| [foot * f64::from(i) / 6.0, 0.0]).collect();
    profile.extend(arc([foot, edge], edge, -0.5 * PI, 0.0, 3));
    let rim_z = height - 0.5 * wall;
    profile.extend((1..20).map(|i| edge + (rim_z - edge) * f64::from(i) / 20.0).map(|z| [outer(z), z]));
    // The rim, and the inside down to the middle of the floor.
    let inner = |z: f64| outer(z) - wall;
    profile.extend(arc([outer(rim_z) - 0.5 * wall, rim_z], 0.5 * wall, 0.0, PI, 6));
    let floor_z = wall + edge;
    profile.extend((1..20).map(|i| rim_z + (floor_z - rim_z) * f64::from(i) / 20.0).map(|z| [inner(z), z]));
    let floor = inner(floor_z) - edge;
    profile.extend(arc([floor, floor_z], edge, 0.0, -0.5 * PI, 3));
    profile.extend((0..6).rev().map(|i| [floor * f64::from(i) / 6.0, wall]));
    solid.lathe(&profile, 64);
    let cup = solid.len();

    // Half an ellipse, beginning and ending in the middle of the wall and at right angles to it.
    let (middle, reach) = (height * between(random, 0.5, 0.56), between(random, 0.026, 0.032));
    let half_height = height * between(random, 0.26, 0.32);
    let path: Vec<[DVec3; 2]> = (0..=32)
        .map(|i| {
            let (sine, cosine) = libm::sincos(PI * f64::from(i) / 32.0);
            let x = inner(middle + half_height * cosine) + 0.5 * wall;
            let point = DVec3::new(x + reach * sine, 0.0, middle + half_height * cosine);
            [point, DVec3::new(reach * cosine, 0.0, -half_height * sine).normalize()]
        })
        .collect();
    let (half_width, half_thickness) = (between(random, 0.0055, 0.007), between(random, 0.0035, 0.0045));
    let ring = |&[point, tangent]: &[DVec3; 2]| {
        // Backwards about the tangent, so that the skin faces outward.
        let upwards = tangent.cross(DVec3::Y);
        let at = |[x, y]: [f64; 2]| point + upwards * (x * half_thickness) - DVec3::Y * (y * half_width);
        circle(14).map(at).collect()
    };
    let rings: Vec<Vec<DVec3>> = path.iter().map(ring).collect();
    solid.skin(&rings, Some([path[0][0], path[32][0]]));
    let handle = solid.len();
    begun(solid, [cup, handle])
}

/// Points on an arc about `centre`, both ends included.
fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, steps: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..=steps).map(move |i| {
        let (sine, cosine) = libm::sincos(from + (to - from) * f64::from(i) / f64::from(steps));
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    })
}

/// The mesh of skins, the vertices of each of which end at an index. The point at which a skin begins comes before its
/// rings and not behind them: so the committed samples have it.
fn begun(solid: Solid, ends: [usize; 2]) -> Result<Mesh> {
    let mesh = solid.finish()?.0;
    let (mut positions, mut triangles) = (mesh.positions().to_vec(), mesh.triangles().to_vec());
    for (begin, end) in [(0, ends[0]), (ends[0], ends[1])] {
        let last_ring = end - 2;
        positions[begin..=last_ring].rotate_right(1);
        for vertex in triangles.as_flattened_mut().iter_mut().filter(|i| (begin..=last_ring).contains(&(**i as usize)))
        {
            *vertex = if *vertex as usize == last_ring { begin as u32 } else { *vertex + 1 };
        }
    }
    Mesh::new(positions, triangles)
}
