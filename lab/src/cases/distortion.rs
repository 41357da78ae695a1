//! Simulates a generator that saw an object from one side: the visible part is accurate, the other part is
//! hallucinated, and the mesh is in a canonical frame.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::prelude::*;

/// Random stream of the hallucinated geometry.
const DISTORTION_STREAM: u64 = 0x6469_7374;

/// Random stream of the canonical frame.
const FRAME_STREAM: u64 = 0x6672_616d;

/// Path over the surface, from what was seen, up to which the invention agrees with it, and from which on it is
/// invention altogether; shares of the box diagonal.
const AGREES: f64 = 0.02;
const INVENTED: f64 = 0.38;
/// Passes of smoothing, and how far a vertex moves towards its neighbours' mean in each: where seen, where invented.
const SMOOTHING_PASSES: usize = 2;
const SMOOTHING: [f64; 2] = [0.04, 0.5];

/// The mesh with a hallucinated back: vertices far from the `seen` ones, over the surface, move outwards by a smooth
/// amount, at most by `bulge` as a share of the box diagonal, and what is invented is smoother than what is not.
/// Vertices and triangles keep their order.
///
/// # Errors
/// Those of [`Mesh::new`], which only a bug in the generator could cause.
pub fn hallucinate(mesh: &Mesh, seen: &[bool], bulge: f64, seed: u64) -> Result<Mesh> {
    let mut random = Random::new(seed, DISTORTION_STREAM);
    let (low, high) = bounds(mesh);
    let diagonal = (high - low).length();
    let neighbors = neighbors(mesh);
    let invented: Vec<f64> = paths(mesh, &neighbors, seen)
        .iter()
        .map(|path| {
            let t = ((path / diagonal - AGREES) / (INVENTED - AGREES)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        })
        .collect();
    let strength = between(&mut random, 0.85, 1.0) * bulge * diagonal;
    let wave = DVec3::new(random.uniform(), random.uniform(), random.uniform()) * (TAU / diagonal);
    let phase = TAU * random.uniform();
    let mut positions: Vec<DVec3> = mesh
        .positions()
        .iter()
        .zip(normals(mesh))
        .zip(&invented)
        .map(|((p, normal), share)| {
            let p = p.as_dvec3();
            let wavy = 0.9 + 0.1 * libm::cos(wave.dot(p) + phase);
            p + normal * (strength * share * wavy)
        })
        .collect();
    for _ in 0..SMOOTHING_PASSES {
        let smooth = |(i, share): (usize, &f64)| {
            let around = &neighbors[i];
            if around.is_empty() {
                return positions[i];
            }
            let mean = around.iter().map(|&n| positions[n as usize]).sum::<DVec3>() / around.len() as f64;
            positions[i].lerp(mean, SMOOTHING[0] + (SMOOTHING[1] - SMOOTHING[0]) * share)
        };
        positions = invented.iter().enumerate().map(smooth).collect();
    }
    with_vertices(mesh, positions.iter().map(|p| p.as_vec3()))
}

/// The mesh as generators deliver it, centred, its box's longest side 1, turned at random; and the way back,
/// `object_from_mesh`.
///
/// # Errors
/// Those of [`Mesh::new`] and [`Similarity::from_parts`], which only a bug in the generator could cause.
pub fn canonicalise(mesh: &Mesh, seed: u64) -> Result<(Mesh, Similarity)> {
    let mut random = Random::new(seed, FRAME_STREAM);
    let (low, high) = bounds(mesh);
    let centre = (low + high) * 0.5;
    let mesh_from_object = random_rotation(&mut random).to_rotation_matrix();
    let scale = (high - low).max_element();
    let object_from_mesh =
        Similarity::from_parts(scale, mesh_from_object.transpose().into_inner(), Vector3::from(centre.to_array()))?;
    let canonical = |p: &Vec3| {
        let p = vector3(*p) - object_from_mesh.translation;
        vec3(&(object_from_mesh.rotation.inverse() * p / scale))
    };
    Ok((mapped(mesh, canonical)?, object_from_mesh))
}

/// Evenly distributed over SO(3): Shoemake, "Uniform random rotations", Graphics Gems III.
pub(crate) fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let u = random.uniform();
    let (a, b) = (libm::sincos(TAU * random.uniform()), libm::sincos(TAU * random.uniform()));
    let (near, far) = ((1.0 - u).sqrt(), u.sqrt());
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(far * b.1, near * a.0, near * a.1, far * b.0))
}

fn bounds(mesh: &Mesh) -> (DVec3, DVec3) {
    box_of(mesh.positions().iter().map(|p| p.as_dvec3()))
}

/// The lowest and the highest corner of the box of some points.
pub(crate) fn box_of(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// The normal of a triangle of a mesh, as long as twice its area.
pub(crate) fn face(mesh: &Mesh, triangle: usize) -> DVec3 {
    let [a, b, c] = mesh.corners(mesh.triangles()[triangle]).map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

/// For each vertex of a mesh, whether it is a corner of one of these triangles.
pub(crate) fn corners_of(mesh: &Mesh, triangles: impl Iterator<Item = u32>) -> Vec<bool> {
    let mut corners = vec![false; mesh.positions().len()];
    for triangle in triangles {
        mesh.triangles()[triangle as usize].iter().for_each(|&vertex| corners[vertex as usize] = true);
    }
    corners
}

/// A mesh with other positions of its vertices.
///
/// # Errors
/// Those of [`Mesh::new`], which only a bug in the generator could cause.
pub(crate) fn with_vertices(mesh: &Mesh, positions: impl Iterator<Item = Vec3>) -> Result<Mesh> {
    Mesh::new(positions.collect(), mesh.triangles().to_vec())
}

/// A mesh whose vertices a function has moved.
///
/// # Errors
/// As [`with_vertices`].
pub(crate) fn mapped(mesh: &Mesh, moved: impl FnMut(&Vec3) -> Vec3) -> Result<Mesh> {
    with_vertices(mesh, mesh.positions().iter().map(moved))
}

/// The vertices that share an edge with each, in ascending order.
pub(crate) fn neighbors(mesh: &Mesh) -> Vec<Vec<u32>> {
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
pub(crate) fn normals(mesh: &Mesh) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; mesh.positions().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        triangle.iter().for_each(|&i| normals[i as usize] += face(mesh, t));
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

/// Length of the shortest path along edges from each vertex to a seen one (Dijkstra); infinite where there is none.
/// Over the surface, because the back of a thin wall is far from its front.
pub(crate) fn paths(mesh: &Mesh, neighbors: &[Vec<u32>], seen: &[bool]) -> Vec<f64> {
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
