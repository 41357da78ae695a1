//! Solid: whether the back faces of a mesh are always hidden by front faces.
//!
//! A ray enters a closed surface as often as it leaves it, so that front faces alone draw the silhouette of both. Vertices
//! snapped to steps are those of a closed surface, too. The nearest face of a solid is a front face; where a coarse mesh
//! intersects itself, the front face behind it is drawn.

use crate::geometry::mesh::Mesh;
use crate::geometry::mesh_parts::MeshParts;

/// Whether every edge is used as often in one direction as in the other. Clustering vertices does not change that.
pub fn is_closed(mesh: &Mesh) -> bool {
    // A sum of one number per edge, with the sign of its direction. Numbers that are not of opposite edges cancel out by
    // chance only, of one in 2⁶⁴.
    let edge = |a: u32, b: u32| {
        let mix = |x: u64| (x ^ (x >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let number = mix(mix(mix(u64::from(a.min(b)) << 32 | u64::from(a.max(b)))));
        if a < b { number } else { number.wrapping_neg() }
    };
    let edges = |&[a, b, c]: &[u32; 3]| edge(a, b).wrapping_add(edge(b, c)).wrapping_add(edge(c, a));
    mesh.triangles().iter().fold(0, |sum: u64, triangle| sum.wrapping_add(edges(triangle))) == 0
}

/// Whether each part of a closed mesh encloses a volume, with its normals outwards.
pub fn faces_outward(mesh: &Mesh) -> bool {
    let parts = MeshParts::of(mesh);
    let mut volumes = vec![0.0; parts.as_ref().map_or(1, |parts| parts.parts.len())];
    for (i, &triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
        volumes[parts.as_ref().map_or(0, |parts| parts.of_triangle[i] as usize)] += a.dot(b.cross(c));
    }
    volumes.into_iter().all(|volume| volume > 0.0)
}
