//! Coarser meshes by vertex clustering with quadrics (Lindstrom, "Out-of-Core Simplification of Large Polygonal
//! Models", SIGGRAPH 2000): linear in the size of the mesh, whatever its topology.

use glam::{DMat3, DVec3, Vec3};

use super::cloud::Bounds;
use super::mesh::Mesh;
use super::order;
use super::symmetric_eigen::{SymmetricEigen, outer};

/// Limit on the cells along the longest side; the table has this many cubed.
const MAX_CELLS: usize = 112;
/// Passes of the search for the cell size.
const PASSES: usize = 4;
/// Eigenvalues below this fraction of the largest do not constrain the vertex along their direction.
const RANK: f64 = 1e-3;

/// Clusters cannot thin out triangles that all span many cells, or that each lie within one. Where such a mesh has more
/// than this many times the triangles wanted, only its largest are kept.
const MAX_EXCESS: usize = 4;

/// The mesh with about `triangles` triangles, at most a quarter more, or [`MAX_EXCESS`] times as many if they are
/// unconnected. A mesh that has no more than that is returned unchanged.
pub fn decimate(mesh: &Mesh, triangles: usize) -> Mesh {
    if mesh.triangles().len() <= triangles {
        return mesh.clone();
    }
    let Some(bounds) = Bounds::of(mesh.positions()) else { return mesh.clone() };
    let side = bounds.extent().max_element();
    // A closed surface that fills its box occupies about 6 n² cells, with two triangles per cell.
    let mut cells = ((triangles as f64 / 8.0).sqrt()).clamp(2.0, MAX_CELLS as f64);
    let mut best: Option<Clusters> = None;
    for _ in 0..PASSES {
        let clusters = Clusters::new(mesh, &bounds, side / cells as f32);
        let count = clusters.triangles.len();
        let fits = count > 0 && count as f64 <= 1.25 * triangles as f64;
        if fits && best.as_ref().is_none_or(|b| count > b.triangles.len()) {
            best = Some(clusters);
        }
        let ratio = triangles as f64 / count.max(1) as f64;
        if fits && ratio < 1.25 {
            break;
        }
        let next = (cells * ratio.sqrt()).clamp(2.0, MAX_CELLS as f64);
        if (next - cells).abs() < 0.25 {
            break;
        }
        cells = next;
    }
    let clustered = best.and_then(|clusters| clusters.into_mesh(mesh));
    clustered.or_else(|| largest_triangles(mesh, triangles)).unwrap_or_else(|| mesh.clone())
}

/// The `count` triangles with the largest area, in their order; `None` for a mesh with few more than that.
fn largest_triangles(mesh: &Mesh, count: usize) -> Option<Mesh> {
    if mesh.triangles().len() <= MAX_EXCESS * count {
        return None;
    }
    let area = |triangle: [u32; 3]| {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
        (b - a).cross(c - a).length() as f32
    };
    let largest = order::largest(mesh.triangles().iter().map(|&triangle| area(triangle)), count);
    let mut kept: Vec<u64> = largest.into_iter().map(u64::from).collect();
    order::sort(&mut kept);
    let triangles: Vec<[u32; 3]> = kept.into_iter().map(|i| mesh.triangles()[i as usize]).collect();
    Some(mesh.of_triangles(&triangles))
}

/// The cluster of each vertex, and the triangles whose corners are in three clusters.
struct Clusters {
    of_vertex: Vec<u32>,
    count: usize,
    triangles: Vec<[u32; 3]>,
    cell: f32,
}

impl Clusters {
    fn new(mesh: &Mesh, bounds: &Bounds, cell: f32) -> Self {
        let size = (bounds.extent() / cell).to_array().map(|x| x as usize + 1);
        let mut table = vec![u32::MAX; size.iter().product()];
        let mut count = 0;
        let of_vertex = (mesh.positions().iter())
            .map(|p| {
                let at = ((*p - bounds.min) / cell).to_array();
                let at = [0, 1, 2].map(|i| (at[i] as usize).min(size[i] - 1));
                let entry = &mut table[(at[2] * size[1] + at[1]) * size[0] + at[0]];
                if *entry == u32::MAX {
                    *entry = count;
                    count += 1;
                }
                *entry
            })
            .collect::<Vec<u32>>();
        let mut triangles = Vec::with_capacity(3 * count as usize);
        let clustered = mesh.triangles().iter().map(|t| t.map(|i| of_vertex[i as usize]));
        triangles.extend(clustered.filter(|[a, b, c]| a != b && b != c && c != a));
        Self { of_vertex, count: count as usize, triangles, cell }
    }

    /// Moves the vertex of each cluster to the intersection of the planes of its triangles. Along directions that these
    /// do not constrain, it keeps the mean of the cluster.
    fn into_mesh(self, mesh: &Mesh) -> Option<Mesh> {
        let mut quadrics = vec![Quadric::default(); self.count];
        for (&cluster, p) in self.of_vertex.iter().zip(mesh.positions()) {
            let quadric = &mut quadrics[cluster as usize];
            quadric.sum += p.as_dvec3();
            quadric.points += 1;
        }
        for &triangle in mesh.triangles() {
            let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a);
            let planes = outer(normal);
            let clusters = triangle.map(|i| self.of_vertex[i as usize]);
            for (i, &cluster) in clusters.iter().enumerate() {
                // A triangle within one cluster contributes once.
                if !clusters[..i].contains(&cluster) {
                    let quadric = &mut quadrics[cluster as usize];
                    quadric.planes += planes;
                    quadric.offset += normal * normal.dot(a);
                }
            }
        }
        let reach = f64::from(self.cell);
        let positions = quadrics.iter().map(|q| q.vertex(reach)).collect();
        let mesh = Mesh::new(positions, self.triangles).ok()?;
        // Where triangles are unconnected, many clusters keep no triangle.
        let is_sparse = mesh.positions().len() > 3 * mesh.triangles().len();
        is_sparse.then(|| mesh.without_unused_vertices()).flatten().or(Some(mesh))
    }
}

/// Planes n·x = d as Σ n nᵀ and Σ n d, weighted by their triangles' squared area; and the points of a cluster.
#[derive(Debug, Clone, Copy, Default)]
struct Quadric {
    planes: DMat3,
    offset: DVec3,
    sum: DVec3,
    points: u32,
}

impl Quadric {
    fn vertex(&self, reach: f64) -> Vec3 {
        let mean = self.sum / f64::from(self.points.max(1));
        let residual = self.offset - self.planes * mean;
        let eigen = SymmetricEigen::of(self.planes);
        let mut shift = DVec3::ZERO;
        for (value, vector) in eigen.values.iter().zip(eigen.vectors) {
            if *value > RANK * eigen.values[2] {
                shift += vector * (vector.dot(residual) / value);
            }
        }
        // Nearly parallel planes intersect far away.
        let near = shift.is_finite() && shift.length() <= reach;
        (if near { mean + shift } else { mean }).as_vec3()
    }
}
