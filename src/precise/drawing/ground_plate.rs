//! Ground plate: a piece of the ground that a generator took for a part of the object which stands on it.
//!
//! Table tops, lamp feet and screens have the same form. This only finds what may be such a plate: whether it is one, the
//! image decides (see [`plate`](crate::precise::search::plate)).

use glam::{DMat3, DVec3, Vec3};

use super::removed_parts::{RemovedParts, Trimmed};
use crate::geometry::angle::sin_cos;
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh_parts::MeshParts;
use crate::geometry::symmetric_eigen::{SymmetricEigen, outer};

/// Cosines of the angle up to which triangles count for the normal of the plate, pass by pass, and up to which one is flat.
const NARROWER: [f64; 3] = [0.0, 0.9, 0.97];
const FLAT: f64 = 0.95;
/// Largest thickness of a plate relative to its largest extent, and the share of the flat surface there that is within its
/// thickness.
const THICKNESS: f64 = 0.06;
const WITHIN: f64 = 0.98;
/// Least flat area of a plate relative to its rectangle: a disc with one face has 0.79, with a hole below the object less.
const FULL: f64 = 0.5;
/// Flat area of the decimated mesh, relative to that of a plate, below which the mesh has no plate: decimation rounds edges.
const ROUGHLY: f64 = 0.7;
/// Ratio of the extents of plate and object in all directions along the plate, and height of the object relative to the plate.
const LARGER: f64 = 1.2;
const HEIGHT: f64 = 0.1;
/// Least share of the surface that is the object's.
const OBJECT: f64 = 0.1;
/// Ratio of the extents from which a part of its own is the floor of a scene, whatever the share and the height of the object.
const FLOOR: f64 = 3.0;
/// Directions along the plate in which extents are compared.
const DIRECTIONS: usize = 4;
/// Heights by which the thickness of a plate is measured.
const BINS: usize = 64;
/// The interval of no point.
const EMPTY: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// A mesh without its ground plate; `None` if it has nothing that looks like one. `decimated` is the mesh with fewer triangles,
/// which show that most meshes have too little surface in one direction.
pub fn without_plate(mesh: &Mesh, decimated: &Mesh) -> Option<Trimmed> {
    let few = faces_of(decimated);
    let level = Level::of(decimated, &few)?;
    if level.flat_area(&few) < ROUGHLY * level.least_area() {
        return None;
    }
    let faces = faces_of(mesh);
    let level = Level::of(mesh, &faces)?;
    if level.flat_area(&faces) < level.least_area() {
        return None;
    }
    let parts = MeshParts::of(mesh);
    [1.0, -1.0].into_iter().find_map(|sign| level.plate(sign, mesh, &faces, parts.as_ref()))
}

fn faces_of(mesh: &Mesh) -> Vec<Face> {
    mesh.triangles().iter().map(|triangle| Face::of(mesh, *triangle)).collect()
}

/// A triangle: its corners, its unit normal and its area.
struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
    area: f64,
}

impl Face {
    fn of(mesh: &Mesh, triangle: [u32; 3]) -> Self {
        let corners = mesh.corners(triangle).map(|p| p.as_dvec3());
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let twice = cross.length_squared().sqrt();
        Self { corners, normal: if twice > 0.0 { cross / twice } else { DVec3::ZERO }, area: 0.5 * twice }
    }

    fn is_flat(&self, down: DVec3) -> bool {
        self.normal.dot(down).abs() >= FLAT
    }

    /// The interval of the corners along a direction.
    #[inline(never)]
    fn along(&self, direction: DVec3) -> [f64; 2] {
        let [a, b, c] = self.corners.map(|p| p.dot(direction));
        [a.min(b).min(c), a.max(b).max(c)]
    }
}

/// The direction that most of the surface faces, or faces away from.
fn flattest(faces: &[Face]) -> Option<DVec3> {
    let mut normal = DVec3::ZERO;
    for least in NARROWER {
        let counted = faces.iter().filter(|face| face.normal.dot(normal).abs() >= least);
        let squares = counted.fold(DMat3::ZERO, |sum, face| sum + outer(face.normal) * face.area);
        normal = SymmetricEigen::of(squares).vectors[2];
    }
    normal.is_finite().then_some(normal)
}

/// The direction that most of a mesh faces, and others across it.
struct Level {
    normal: DVec3,
    directions: [DVec3; DIRECTIONS],
    /// Lengths of the mesh in these directions.
    lengths: [f64; DIRECTIONS],
}

impl Level {
    fn of(mesh: &Mesh, faces: &[Face]) -> Option<Self> {
        let normal = flattest(faces)?;
        let side = normal.any_orthonormal_vector();
        let directions = core::array::from_fn(|k| {
            let (sin, cos) = sin_cos(core::f64::consts::PI * k as f64 / DIRECTIONS as f64);
            side * cos + normal.cross(side) * sin
        });
        let lengths = directions.map(|direction| length(extent(mesh, direction)));
        Some(Self { normal, directions, lengths })
    }

    /// Area of the faces that are flat.
    fn flat_area(&self, faces: &[Face]) -> f64 {
        faces.iter().filter(|face| face.is_flat(self.normal)).map(|face| face.area).sum()
    }

    /// The least flat area of a plate, which is as long as all of the mesh.
    fn least_area(&self) -> f64 {
        FULL * self.lengths[0] * self.lengths[DIRECTIONS / 2]
    }

    /// The mesh without a plate at its end in the direction of the normal, or in the opposite one.
    fn plate(&self, sign: f64, mesh: &Mesh, faces: &[Face], parts: Option<&MeshParts>) -> Option<Trimmed> {
        let (down, least, lengths, directions) = (self.normal * sign, self.least_area(), self.lengths, self.directions);
        let [_, lowest] = extent(mesh, down);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let most = THICKNESS * longest;
        // The flat area by the height of its upper side.
        let mut flat = [0.0; BINS];
        for face in faces.iter().filter(|face| face.is_flat(down)) {
            let height = BINS as f64 * (lowest - face.along(down)[0]) / most;
            if height < BINS as f64 {
                flat[height as usize] += face.area;
            }
        }
        let total: f64 = flat.iter().sum();
        let mut sum = 0.0;
        let filled = flat.iter().position(|area| {
            sum += area;
            sum >= WITHIN * total
        })?;
        let top = lowest - most * (filled + 2) as f64 / BINS as f64;
        let low: Vec<bool> = faces.iter().map(|face| face.along(down)[0] >= top).collect();

        // A part of its own, where there is one: the bottom of the object is low, too.
        let mut is_apart = vec![true; parts.map_or(0, |parts| parts.parts.len())];
        let part_of = || parts.into_iter().flat_map(|parts| mesh.triangles().iter().map(|t| parts.of_triangle(*t)));
        low.iter().zip(part_of()).for_each(|(low, part)| is_apart[part] &= low);
        let apart: Vec<bool> = part_of().map(|part| is_apart[part]).collect();
        [(&apart, true), (&low, false)].into_iter().find_map(|(is_plate, is_own_part)| {
            if is_plate.is_empty() {
                return None;
            }
            let [mut object, mut plate, mut flat] = [0.0; 3];
            for (face, is_plate) in faces.iter().zip(is_plate) {
                if *is_plate {
                    plate += face.area;
                    flat += if face.is_flat(down) { face.area } else { 0.0 };
                } else {
                    object += face.area;
                }
            }
            let share = plate / (plate + object);
            if flat < least {
                return None;
            }
            // How many times as long as the object it is, along all directions; 0 if the object reaches beyond it.
            let mut ratio = f64::INFINITY;
            for direction in &directions {
                let [own, other] = [true, false].map(|side| interval(faces, is_plate, side, *direction));
                let is_beyond = own[0] <= other[0] && other[1] <= own[1];
                ratio = ratio.min(if is_beyond { length(own) / length(other) } else { 0.0 });
            }
            let is_high = top - interval(faces, is_plate, false, down)[0] >= HEIGHT * longest;
            let is_ground = ratio >= LARGER && share <= 1.0 - OBJECT && is_high || ratio >= FLOOR && is_own_part;
            let removed_parts = RemovedParts { ground: share, ..RemovedParts::default() };
            is_ground.then(|| Trimmed::split(mesh, removed_parts, &|triangle| is_plate[triangle])).flatten()
        })
    }
}

/// The interval of a mesh along a direction.
fn extent(mesh: &Mesh, direction: DVec3) -> [f64; 2] {
    let along = |[low, high]: [f64; 2], p: &Vec3| {
        let at = p.as_dvec3().dot(direction);
        [low.min(at), high.max(at)]
    };
    mesh.positions().iter().fold(EMPTY, along)
}

/// The interval along a direction of the triangles for which `of` is `side`.
#[inline(never)]
fn interval(faces: &[Face], of: &[bool], side: bool, direction: DVec3) -> [f64; 2] {
    let mut all = EMPTY;
    for (face, _) in faces.iter().zip(of).filter(|(_, of)| **of == side) {
        let [low, high] = face.along(direction);
        all = [all[0].min(low), all[1].max(high)];
    }
    all
}

fn length([low, high]: [f64; 2]) -> f64 {
    high - low
}
