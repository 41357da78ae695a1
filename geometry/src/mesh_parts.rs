//! The parts of a mesh: the triangles that hang together.

use glam::Vec3;

use super::cloud::Bounds;
use super::disjoint_sets::DisjointSets;
use super::mesh::Mesh;
use super::surface::triangle_area;

/// The parts of a mesh. Vertices at the same position hang together, because the seams of textures double them.
#[derive(Debug, Clone)]
pub struct MeshParts {
    /// The part of each vertex.
    pub of_vertex: Vec<u32>,
    /// The parts, in the order of their first vertices.
    pub parts: Vec<MeshPart>,
}

/// A part of a mesh.
#[derive(Debug, Clone, Copy)]
pub struct MeshPart {
    /// The area of its surface.
    pub area: f64,
    /// The box around it.
    pub bounds: Bounds,
}

impl MeshParts {
    /// The parts of a mesh whose vertices are all used; `None` if it is in one piece.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        let positions = mesh.positions();
        let mut sets = DisjointSets::new(positions.len());
        for &[a, b, c] in mesh.triangles() {
            sets.join(a, b);
            sets.join(b, c);
        }
        let is_whole = |sets: &mut DisjointSets| (0..positions.len() as u32).all(|vertex| sets.find(vertex) == 0);
        if is_whole(&mut sets) {
            return None;
        }
        weld(positions, &mut sets);
        if is_whole(&mut sets) {
            return None;
        }
        let (of_vertex, count) = sets.numbered();
        let mut parts = vec![MeshPart { area: 0.0, bounds: Bounds::NOTHING }; count];
        for (&position, &part) in positions.iter().zip(&of_vertex) {
            let MeshPart { bounds, .. } = &mut parts[part as usize];
            *bounds = bounds.union(Bounds { min: position, max: position });
        }
        for (index, [first, ..]) in mesh.triangles().iter().enumerate() {
            parts[of_vertex[*first as usize] as usize].area += triangle_area(mesh, index);
        }
        Some(Self { of_vertex, parts })
    }

    /// The part of a triangle.
    pub fn of_triangle(&self, triangle: [u32; 3]) -> usize {
        self.of_vertex[triangle[0] as usize] as usize
    }
}

/// Joins the vertices at the same position, by a table of positions.
fn weld(positions: &[Vec3], sets: &mut DisjointSets) {
    let size = (2 * positions.len()).next_power_of_two();
    let mut table = vec![u32::MAX; size];
    for (i, position) in (0..).zip(positions) {
        let mut at = hash(*position) as usize & (size - 1);
        loop {
            let known = table[at];
            if known == u32::MAX {
                table[at] = i;
                break;
            }
            if positions[known as usize] == *position {
                sets.join(known, i);
                break;
            }
            at = (at + 1) & (size - 1);
        }
    }
}

/// A hash of a position; −0 and 0 are the same.
fn hash(position: Vec3) -> u64 {
    let mix = |hash: u64, x: f32| {
        let mixed = (hash ^ u64::from((x + 0.0).to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 32)
    };
    position.to_array().into_iter().fold(0, mix)
}
