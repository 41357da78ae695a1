//! Procedural objects: metres, z up, standing on the plane z = 0 about the origin.

use crate::cases::families;
use crate::cases::scene::put_down_turned;
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
    /// The kind's symmetry, in the words of a case's `gt.json`.
    pub fn symmetry(self) -> &'static str {
        match self {
            Self::Mug | Self::Hammer | Self::Spoon | Self::Occluded => "none",
        }
    }

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
    let mut builder = Builder::default();

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
    builder.revolve(&profile, 64);

    // Half an ellipse, beginning and ending in the middle of the wall and at right angles to it.
    let (middle, reach) = (height * between(random, 0.5, 0.56), between(random, 0.026, 0.032));
    let half_height = height * between(random, 0.26, 0.32);
    let path: Vec<[DVec3; 2]> = (0..=32)
        .map(|i| {
            let (sine, cosine) = libm::sincos(PI * f64::from(i) / 32.0);
            let x = inner(middle + half_height * cosine) + 0.5 * wall;
            let point = DVec3::new(x + reach * sine, 0.0, middle + half_height * cosine);
            (point, DVec3::new(reach * cosine, 0.0, -half_height * sine).normalize()).into()
        })
        .collect();
    builder.sweep(&path, DVec3::Y, between(random, 0.0055, 0.007), between(random, 0.0035, 0.0045), 14);
    builder.mesh()
}

/// Points on an arc about `centre`, both ends included.
fn arc(centre: [f64; 2], radius: f64, from: f64, to: f64, steps: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..=steps).map(move |i| {
        let (sine, cosine) = libm::sincos(from + (to - from) * f64::from(i) / f64::from(steps));
        [centre[0] + radius * cosine, centre[1] + radius * sine]
    })
}

/// Vertices and triangles, put together part by part; all triangles face outward.
#[derive(Debug, Default)]
struct Builder {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Builder {
    fn vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        self.positions.len() as u32 - 1
    }

    /// Turns a profile of (radius, z) about the z axis. It begins and ends on the axis and runs with the solid to
    /// its left.
    fn revolve(&mut self, profile: &[[f64; 2]], segments: u32) {
        let [[_, first_z], middle @ .., [_, last_z]] = profile else { return };
        let first = self.vertex(DVec3::new(0.0, 0.0, *first_z));
        let rings: Vec<u32> = middle
            .iter()
            .map(|&[radius, z]| {
                let start = self.positions.len() as u32;
                for k in 0..segments {
                    let (sine, cosine) = libm::sincos(TAU * f64::from(k) / f64::from(segments));
                    self.positions.push(DVec3::new(radius * cosine, radius * sine, z));
                }
                start
            })
            .collect();
        let last = self.vertex(DVec3::new(0.0, 0.0, *last_z));
        self.close(&rings, segments, first, last);
    }

    /// Moves an ellipse along a path of (point, unit tangent) in the plane that `across` is normal to; `half_width`
    /// is along `across`, `half_thickness` at right angles to it. Both ends are closed.
    fn sweep(&mut self, path: &[[DVec3; 2]], across: DVec3, half_width: f64, half_thickness: f64, segments: u32) {
        let (Some(&[begin, _]), Some(&[end, _])) = (path.first(), path.last()) else { return };
        let first = self.vertex(begin);
        let rings: Vec<u32> = path
            .iter()
            .map(|&[point, tangent]| {
                let start = self.positions.len() as u32;
                let upwards = tangent.cross(across);
                for k in 0..segments {
                    // Backwards about the tangent, as `close` has it.
                    let (sine, cosine) = libm::sincos(TAU * f64::from(k) / f64::from(segments));
                    self.positions.push(point + upwards * (cosine * half_thickness) - across * (sine * half_width));
                }
                start
            })
            .collect();
        let last = self.vertex(end);
        self.close(&rings, segments, first, last);
    }

    /// Joins rings of `segments` vertices to each other, and the outermost ones to a vertex each. From ring to ring
    /// by the right hand, the vertices of a ring run so that (along the ring) × (to the next ring) faces outward.
    fn close(&mut self, rings: &[u32], segments: u32, first: u32, last: u32) {
        for k in 0..segments {
            let next = (k + 1) % segments;
            if let (Some(low), Some(high)) = (rings.first(), rings.last()) {
                self.triangles.push([first, low + next, low + k]);
                self.triangles.push([last, high + k, high + next]);
            }
            for ring in rings.windows(2) {
                let [a, b, c, d] = [ring[0] + k, ring[0] + next, ring[1] + k, ring[1] + next];
                self.triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
    }

    fn mesh(self) -> Result<Mesh> {
        Mesh::new(self.positions.iter().map(|p| p.as_vec3()).collect(), self.triangles)
    }
}
