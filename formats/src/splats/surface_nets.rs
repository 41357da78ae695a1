//! The surface of a solid on a lattice by surface nets (Gibson 1998, "Constrained elastic surface nets"): a vertex in each
//! cell that the surface crosses, and a quadrilateral around each edge of the lattice that crosses the surface.

use glam::Vec3;

use super::density::Solid;
use super::lattice::Lattice;

const NONE: u32 = u32::MAX;

/// Vertices in the coordinates of the lattice, and triangles that face outward.
pub(super) fn surface(lattice: &Lattice, solid: &Solid) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let [across, down, deep] = lattice.size;
    let steps = lattice.steps();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    // The vertex of a cell, by its node of smallest coordinates.
    let mut of_cell = vec![NONE; lattice.len()];
    for k in 1..deep - 1 {
        for j in 1..down - 1 {
            let row = (k * down + j) * across;
            for i in 1..across - 1 {
                let node = row + i;
                let inside = solid.is_inside[node];
                for axis in 0..3 {
                    if solid.is_inside[node + steps[axis]] == inside {
                        continue;
                    }
                    let (second, third) = (steps[(axis + 1) % 3], steps[(axis + 2) % 3]);
                    // The cells around the edge, counter-clockwise seen from its end.
                    let around = [node - second - third, node - third, node, node - second];
                    let [a, b, c, d] = around.map(|cell| {
                        if of_cell[cell] == NONE {
                            of_cell[cell] = vertices.len() as u32;
                            vertices.push(crossing(lattice, solid, cell));
                        }
                        of_cell[cell]
                    });
                    triangles.extend(if inside { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
                }
            }
        }
    }
    (vertices, triangles)
}

/// The mean of the points where the surface crosses the edges of a cell.
fn crossing(lattice: &Lattice, solid: &Solid, cell: usize) -> Vec3 {
    let [across, down, _] = lattice.size;
    let steps = lattice.steps();
    let corner = |bits: usize| (0..3).map(|axis| (bits >> axis & 1) * steps[axis]).sum::<usize>() + cell;
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for axis in 0..3 {
        for bits in (0..8).filter(|bits| bits >> axis & 1 == 0) {
            let [from, to] = [bits, bits | 1 << axis].map(|bits| solid.excess[corner(bits)]);
            if (from > 0.0) != (to > 0.0) {
                let mut at = Vec3::from_array([0, 1, 2].map(|i| (bits >> i & 1) as f32));
                at[axis] = from / (from - to);
                sum += at;
                count += 1.0;
            }
        }
    }
    let first = [cell % across, cell / across % down, cell / across / down].map(|x| x as f32);
    Vec3::from_array(first) + if count > 0.0 { sum / count } else { Vec3::splat(0.5) }
}
