//! Ground plate: a piece of the ground that a generator took for a part of the object which stands on it.
//!
//! Table tops, lamp feet and screens have the same form. This only finds what may be such a plate: whether it is one, the
//! image decides (see [`shown`](crate::precise::searched::shown)).

use core::ops::Range;

use glam::{DMat3, DVec3};

use super::surplus::{LeftOut, Trimmed};
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
/// Ratio of the extents of plate and object in all directions along the plate, and height of the object relative to the plate.
const LARGER: f64 = 1.2;
const HEIGHT: f64 = 0.1;
/// Least share of the surface that is the object's.
const OBJECT: f64 = 0.1;
/// Directions along the plate in which extents are compared.
const DIRECTIONS: usize = 4;

/// A mesh without its ground plate; `None` if it has nothing that looks like one.
pub fn without_plate(mesh: &Mesh) -> Option<Trimmed> {
    let faces: Vec<Face> = mesh.triangles().iter().map(|triangle| Face::of(mesh, *triangle)).collect();
    let normal = flattest(&faces)?;
    let parts = MeshParts::of(mesh);
    [normal, -normal].into_iter().find_map(|down| below(mesh, &faces, parts.as_ref(), down))
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

    /// The interval of the corners along a direction.
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

/// The mesh without a plate at its end in the direction `down`.
fn below(mesh: &Mesh, faces: &[Face], parts: Option<&MeshParts>, down: DVec3) -> Option<Trimmed> {
    let side = down.any_orthonormal_vector();
    let across = down.cross(side);
    let directions = core::array::from_fn::<_, DIRECTIONS, _>(|k| {
        let (sin, cos) = sin_cos(core::f64::consts::PI * k as f64 / DIRECTIONS as f64);
        side * cos + across * sin
    });
    let longest = |extents: [Range<f64>; DIRECTIONS]| extents.iter().fold(0.0, |most, e| (e.end - e.start).max(most));
    let lowest = interval(faces.iter(), down).end;
    let most = THICKNESS * longest(directions.map(|d| interval(faces.iter(), d)));
    let is_flat = |face: &Face| face.normal.dot(down).abs() >= FLAT;
    let mut flat: Vec<(f64, f64)> = (faces.iter())
        .filter(|face| is_flat(face))
        .map(|face| (lowest - face.along(down)[0], face.area))
        .filter(|(height, _)| *height <= most)
        .collect();
    flat.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = flat.iter().map(|(_, area)| area).sum();
    let mut sum = 0.0;
    let (thickness, _) = flat.iter().find(|(_, area)| {
        sum += area;
        sum >= WITHIN * all
    })?;
    let top = lowest - thickness - 0.1 * most;
    let is_low = |face: &Face| face.along(down)[0] >= top;

    // A part of its own, where there is one: the bottom of the object is low, too.
    let mut is_apart = vec![true; parts.map_or(0, |parts| parts.parts.len())];
    if let Some(parts) = parts {
        for (face, &part) in faces.iter().zip(&parts.of_triangle) {
            is_apart[part as usize] &= is_low(face);
        }
    }
    let of_part = |index: usize| parts.is_some_and(|parts| is_apart[parts.of_triangle[index] as usize]);
    let low: Vec<bool> = faces.iter().map(is_low).collect();
    let apart: Vec<bool> = (0..faces.len()).map(of_part).collect();
    let area: f64 = faces.iter().map(|face| face.area).sum();
    [apart, low].into_iter().find_map(|is_plate| {
        let of = |side: bool| faces.iter().zip(&is_plate).filter(move |(_, p)| **p == side).map(|(face, _)| face);
        let [plate_area, object_area] = [true, false].map(|side| of(side).map(|face| face.area).sum::<f64>());
        let flat_area: f64 = of(true).filter(|face| is_flat(face)).map(|face| face.area).sum();
        let [plate, object] = [true, false].map(|side| directions.map(|d| interval(of(side), d)));
        let length = |range: &Range<f64>| range.end - range.start;
        let is_larger = plate.iter().zip(&object).all(|(plate, object)| {
            plate.start <= object.start && object.end <= plate.end && length(plate) >= LARGER * length(object)
        });
        let rectangle = length(&plate[0]) * length(&plate[DIRECTIONS / 2]);
        let height = top - interval(of(false), down).start;
        let is_plate_below = is_larger
            && flat_area >= FULL * rectangle
            && object_area >= OBJECT * area
            && height >= HEIGHT * longest(plate);
        let left_out = LeftOut { ground: plate_area / area, ..LeftOut::default() };
        is_plate_below.then(|| Trimmed::split(mesh, left_out, |triangle| is_plate[triangle])).flatten()
    })
}

/// The interval of some triangles along a direction.
fn interval<'a>(faces: impl Iterator<Item = &'a Face>, direction: DVec3) -> Range<f64> {
    faces.fold(f64::INFINITY..f64::NEG_INFINITY, |all, face| {
        let [low, high] = face.along(direction);
        all.start.min(low)..all.end.max(high)
    })
}
