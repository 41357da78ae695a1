//! Triangle meshes, validated on construction.

use glam::{DVec3, Vec3};

use crate::cloud::Bounds;
use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::numbers;

/// A triangle mesh with at least one triangle, finite coordinates, and indices in range.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh from vertices and triangles.
    ///
    /// # Errors
    /// [`ErrorCode::EmptyMesh`], [`ErrorCode::NonFinite`], [`ErrorCode::IndexOutOfRange`].
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        if triangles.is_empty() {
            return Err(Error::new(
                ErrorCode::EmptyMesh,
                "mesh",
                format!("{} vertices and no triangle", positions.len()),
                "a triangle mesh",
                "A point cloud can't be rendered: mesh it first, or use register() for two clouds.",
            ));
        }
        if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
            return Err(Error::new(
                ErrorCode::NonFinite,
                "mesh.positions",
                format!("{} at vertex {i}", numbers(&positions[i].to_array().map(f64::from))),
                "finite numbers",
                "Remove or repair the vertex before passing the mesh.",
            ));
        }
        let count = positions.len();
        for (t, triangle) in triangles.iter().enumerate() {
            if let Some(&index) = triangle.iter().find(|&&i| i as usize >= count) {
                return Err(Error::new(
                    ErrorCode::IndexOutOfRange,
                    "mesh.indices",
                    format!("index {index} in triangle {t}"),
                    format!("indices below the number of vertices, {count}"),
                    "Indices count vertices (x, y, z), not numbers, and start at 0.",
                ));
            }
        }
        Ok(Self { positions, triangles })
    }

    /// A mesh from flat arrays: interleaved x, y, z per vertex, and three indices per triangle. Without indices, every
    /// three vertices form a triangle.
    ///
    /// # Errors
    /// [`ErrorCode::WrongLength`] and those of [`Mesh::new`].
    pub fn from_flat(positions: &[f32], indices: Option<&[u32]>) -> Result<Self> {
        let multiple = if indices.is_some() { 3 } else { 9 };
        if !positions.len().is_multiple_of(multiple) {
            return Err(Error::new(
                ErrorCode::WrongLength,
                "mesh.positions",
                format!("{} numbers", positions.len()),
                if multiple == 3 { "a multiple of 3 (x, y, z)" } else { "a multiple of 9 (three vertices a triangle)" },
                "Pass x, y, z per vertex, and indices unless every three vertices form a triangle.",
            ));
        }
        if let Some(indices) = indices
            && !indices.len().is_multiple_of(3)
        {
            return Err(Error::new(
                ErrorCode::WrongLength,
                "mesh.indices",
                format!("{} indices", indices.len()),
                "a multiple of 3",
                "Pass a triangle list; convert strips and fans.",
            ));
        }
        let positions: Vec<Vec3> = positions.chunks_exact(3).map(Vec3::from_slice).collect();
        let triangles = match indices {
            Some(indices) => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            None => (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        };
        Self::new(positions, triangles)
    }

    /// The vertices.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Three vertex indices per triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle of this mesh.
    #[inline(always)]
    pub fn corners(&self, [a, b, c]: [u32; 3]) -> [Vec3; 3] {
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The diagonal of the bounding box of the vertices.
    pub fn diagonal(&self) -> f64 {
        Bounds::of(&self.positions).map_or(0.0, |bounds| f64::from(bounds.diagonal()))
    }

    /// The mesh without the vertices that no triangle uses; `None` if there are none.
    pub fn without_unused_vertices(&self) -> Option<Self> {
        let used = UsedVertices::of(&self.triangles, self.positions.len())?;
        if used.are_all() { None } else { Some(self.part(&self.triangles, &used)) }
    }

    /// The mesh of only these of its triangles, and the vertices that they use.
    pub fn of_triangles(&self, triangles: &[[u32; 3]]) -> Self {
        let used = UsedVertices::of(triangles, self.positions.len());
        used.map_or_else(|| self.clone(), |used| self.part(triangles, &used))
    }

    fn part(&self, triangles: &[[u32; 3]], used: &UsedVertices) -> Self {
        Self { positions: used.select(&self.positions), triangles: used.renumbered(triangles) }
    }

    /// Six times the signed enclosed volume: negative if the triangles face inward. 0 is inconclusive. Computed
    /// relative to the first vertex, so that a mesh far from the origin loses no precision.
    pub fn signed_volume6(&self) -> f64 {
        let Some(&origin) = self.positions.first() else { return 0.0 };
        let volume = |t: &[u32; 3]| volume6(self.corners(*t).map(|p| p.as_dvec3()), origin.as_dvec3());
        self.triangles.iter().map(volume).sum()
    }

    /// Whether triangles pass each edge as often in one direction as in the other. A ray that meets such a surface meets as many
    /// fronts as backs. Vertices of one `place` are one; `hash` is that of an edge between two places.
    pub fn is_closed<P: PartialOrd + Copy>(&self, place: impl Fn(u32) -> P, hash: impl Fn(P, P) -> u64) -> bool {
        // Sums of hashes are equal if the edges are, and otherwise by a chance of 2⁻⁶⁴.
        let mut sum = 0_u64;
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)].map(|(from, to)| (place(from), place(to))) {
                sum = if from < to { sum.wrapping_add(hash(from, to)) } else { sum.wrapping_sub(hash(to, from)) };
            }
        }
        sum == 0
    }
}

/// Six times the signed volume of the tetrahedron that a triangle spans with a point.
#[inline(always)]
pub(crate) fn volume6(corners: [DVec3; 3], origin: DVec3) -> f64 {
    let [a, b, c] = corners.map(|p| p - origin);
    a.dot(b.cross(c))
}

/// The vertices that are corners of triangles.
#[derive(Debug, Clone)]
pub struct UsedVertices(Vec<bool>);

impl UsedVertices {
    /// Those of `count` vertices that these triangles use; `None` if an index is out of range.
    pub fn of(triangles: &[[u32; 3]], count: usize) -> Option<Self> {
        let mut used = vec![false; count];
        for &index in triangles.as_flattened() {
            *used.get_mut(index as usize)? = true;
        }
        Some(Self(used))
    }

    /// Whether all vertices are used.
    pub fn are_all(&self) -> bool {
        self.0.iter().all(|&used| used)
    }

    /// The values of the used vertices, from those of all.
    pub fn select<T: Copy>(&self, values: &[T]) -> Vec<T> {
        values.iter().zip(&self.0).filter(|(_, used)| **used).map(|(value, _)| *value).collect()
    }

    /// The triangles with indices that count only the used vertices.
    pub fn renumbered(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let mut count = 0;
        let mut number = |used: &bool| {
            let index = count;
            count += u32::from(*used);
            index
        };
        let numbers: Vec<u32> = self.0.iter().map(&mut number).collect();
        let new_index = |i: u32| numbers.get(i as usize).copied().unwrap_or(i);
        triangles.iter().map(|triangle| triangle.map(new_index)).collect()
    }
}
