//! Geometry of meshes: frames, neighbourhoods, normals, decimation.

use core::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::Axis;
use crate::prelude::*;

/// Random stream of the canonical frame.
const FRAME_STREAM: u64 = 0x6672_616d;

/// The mesh as generators deliver it, centred, its box's longest side 1, turned at random; and the way back,
/// `object_from_mesh`.
pub fn canonicalise(mesh: &Mesh, seed: u64) -> Result<(Mesh, Similarity)> {
    let mut random = Random::new(seed, FRAME_STREAM);
    let (low, high) = box_of(mesh);
    let centre = (low + high) * 0.5;
    let mesh_from_object = random_rotation(&mut random).to_rotation_matrix();
    let scale = (high - low).max_element();
    let object_from_mesh =
        Similarity::from_parts(scale, mesh_from_object.transpose().into_inner(), Vector3::from(centre.to_array()))?;
    let mesh_from_object = object_from_mesh.inverse();
    Ok((mapped(mesh, |p| vec3(&mesh_from_object.apply(vector3(*p))))?, object_from_mesh))
}

/// Evenly distributed over SO(3): Shoemake, "Uniform random rotations", Graphics Gems III.
pub fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let u = random.uniform();
    let (a, b) = (libm::sincos(TAU * random.uniform()), libm::sincos(TAU * random.uniform()));
    let (near, far) = ((1.0 - u).sqrt(), u.sqrt());
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(far * b.1, near * a.0, near * a.1, far * b.0))
}

/// Axes of symmetry in a rotated frame.
pub fn turned_axes(rotation: &Matrix3<f64>, axes: &[Axis]) -> Vec<Axis> {
    let turned = |axis: DVec3| DVec3::from_array((rotation * Vector3::from(axis.to_array())).into());
    axes.iter().map(|&(axis, fold)| (turned(axis), fold)).collect()
}

/// The symmetry in the frame of the mesh.
pub fn declared(axes: &[Axis], object_from_mesh: &Similarity) -> Symmetry {
    if axes.is_empty() {
        return Symmetry::None;
    }
    let turned = turned_axes(object_from_mesh.rotation.inverse().matrix(), axes);
    let axis = |(axis, fold): (DVec3, Option<u32>)| SymmetryAxis { axis: Vector3::from(axis.to_array()), fold };
    Symmetry::Declared(turned.into_iter().map(axis).collect())
}

/// The lowest and the highest corner of the box of a mesh.
pub fn box_of(mesh: &Mesh) -> (DVec3, DVec3) {
    bounds(mesh.positions().iter().map(|p| p.as_dvec3()))
}

/// The lowest and the highest corner of the box of points.
pub fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The normal of a triangle of a mesh, as long as twice its area.
pub fn face(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(mesh.triangles()[triangle]).map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

/// For each vertex of a mesh, whether it is a corner of one of these triangles.
pub fn corners_of(mesh: &Mesh, triangles: impl Iterator<Item = u32>) -> Vec<bool> {
    let mut corners = vec![false; mesh.positions().len()];
    for triangle in triangles {
        mesh.triangles()[triangle as usize].iter().for_each(|&vertex| corners[vertex as usize] = true);
    }
    corners
}

/// A mesh with other positions of its vertices.
pub fn with_vertices(mesh: &Mesh, positions: impl Iterator<Item = Vec3>) -> Result<Mesh> {
    Mesh::new(positions.collect(), mesh.triangles().to_vec())
}

/// A mesh whose vertices a function has moved.
pub fn mapped(mesh: &Mesh, moved: impl FnMut(&Vec3) -> Vec3) -> Result<Mesh> {
    with_vertices(mesh, mesh.positions().iter().map(moved))
}

/// A translated mesh.
pub fn shifted(mesh: &Mesh, by: DVec3) -> Result<Mesh> {
    mapped(mesh, |p| (p.as_dvec3() + by).as_vec3())
}

/// Meshes as one.
pub fn joined(meshes: &[&Mesh]) -> Result<Mesh> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|i| i + first)));
    }
    Mesh::new(positions, triangles)
}

/// The vertices that share an edge with each, in ascending order.
pub fn neighbors(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut neighbors = vec![Vec::new(); mesh.positions().len()];
    for &[a, b, c] in mesh.triangles() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            neighbors[from as usize].push(to);
            neighbors[to as usize].push(from);
        }
    }
    for around in &mut neighbors {
        around.sort_unstable();
        around.dedup();
    }
    neighbors
}

/// Unit normals of the vertices, weighted by area; 0 where a vertex has no area about it.
pub fn normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        triangle.iter().for_each(|&i| normals[i as usize] += face(mesh, t));
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Length of the shortest path along edges from each vertex to a seen one (Dijkstra); infinite where there is none.
/// Over the surface, because the back of a thin wall is far from its front.
pub fn paths(mesh: &Mesh, neighbors: &[Vec<u32>], seen: &[bool]) -> Vec<f64> {
    let mut paths: Vec<f64> = seen.iter().map(|&seen| if seen { 0.0 } else { f64::INFINITY }).collect();
    // Lengths are not negative: their bits order as they do.
    let mut queue: BinaryHeap<_> = (0..).zip(seen).filter(|(_, seen)| **seen).map(|(i, _)| Reverse((0, i))).collect();
    while let Some(Reverse((bits, i))) = queue.pop() {
        let path = f64::from_bits(bits);
        if path > paths[i as usize] {
            continue;
        }
        let from = mesh.positions()[i as usize].as_dvec3();
        for &n in &neighbors[i as usize] {
            let longer = path + from.distance(mesh.positions()[n as usize].as_dvec3());
            if longer < paths[n as usize] {
                paths[n as usize] = longer;
                queue.push(Reverse((longer.to_bits(), n)));
            }
        }
    }
    paths
}

/// Careless decimation: one vertex, the mean, per occupied cell of edge `cell`; `offset` shifts the grid. Triangles that
/// fall together disappear. The mesh as it is where nothing would be left.
pub fn clustered(mesh: &Mesh, cell: f64, offset: DVec3) -> Result<Mesh> {
    let mut cells: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut sums: Vec<(DVec3, f64)> = Vec::new();
    let index = |p: &Vec3| {
        let p = p.as_dvec3();
        let key = ((p + offset) / cell).floor().to_array().map(|x| x as i64);
        let index = *cells.entry(key).or_insert_with(|| {
            sums.push((DVec3::ZERO, 0.0));
            sums.len() as u32 - 1
        });
        let (sum, count) = &mut sums[index as usize];
        (*sum, *count) = (*sum + p, *count + 1.0);
        index
    };
    let new: Vec<u32> = mesh.positions().iter().map(index).collect();
    let positions: Vec<Vec3> = sums.iter().map(|(sum, count)| (*sum / *count).as_vec3()).collect();
    let triangles = mesh.triangles().iter().map(|t| t.map(|i| new[i as usize]));
    let triangles: Vec<[u32; 3]> = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    if triangles.is_empty() { Ok(mesh.clone()) } else { Mesh::new(positions, triangles) }
}
