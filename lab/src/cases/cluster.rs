//! Vertex clustering: what a mesh looks like after careless decimation.

use std::collections::BTreeMap;

use crate::prelude::*;

/// One vertex, the mean, per occupied cell of edge `cell`; `offset` shifts the grid. Triangles that fall together
/// disappear. The mesh as it is where nothing would be left.
pub fn cluster(mesh: &Mesh, cell: f64, offset: DVec3) -> Result<Mesh> {
    let mut cells: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut sums: Vec<(DVec3, f64)> = Vec::new();
    let new: Vec<u32> = mesh
        .positions()
        .iter()
        .map(|p| {
            let p = p.as_dvec3();
            let key = ((p + offset) / cell).floor().to_array().map(|x| x as i64);
            let index = *cells.entry(key).or_insert_with(|| {
                sums.push((DVec3::ZERO, 0.0));
                sums.len() as u32 - 1
            });
            let (sum, count) = &mut sums[index as usize];
            *sum += p;
            *count += 1.0;
            index
        })
        .collect();
    let positions: Vec<Vec3> = sums.iter().map(|(sum, count)| (*sum / *count).as_vec3()).collect();
    let triangles: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .map(|t| t.map(|i| new[i as usize]))
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    if triangles.is_empty() { Ok(mesh.clone()) } else { Mesh::new(positions, triangles) }
}
