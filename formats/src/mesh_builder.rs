//! Builds a mesh within the size limits.

use glam::{DMat4, Vec3};

use crate::guard::{MAX_TRIANGLES, MAX_VERTICES, too_large};
use sim3align_geometry::error::Result;
use sim3align_geometry::mesh::Mesh;

/// Collects the vertices and triangles of a file.
#[derive(Debug, Default)]
pub(crate) struct MeshBuilder {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl MeshBuilder {
    /// A builder with initial vertices.
    pub fn with_positions(positions: Vec<Vec3>) -> Self {
        Self { positions, triangles: Vec::new() }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Adds a vertex and returns its index.
    pub fn push_vertex(&mut self, position: Vec3) -> Result<u32> {
        let index = self.positions.len();
        if index >= MAX_VERTICES {
            return Err(too_large("mesh", format!("more than {index} vertices"), format!("at most {MAX_VERTICES}")));
        }
        self.positions.push(position);
        Ok(index as u32)
    }

    /// Adds a triangle.
    pub fn push_triangle(&mut self, triangle: [u32; 3]) -> Result<()> {
        let count = self.triangles.len();
        if count >= MAX_TRIANGLES {
            return Err(too_large("mesh", format!("more than {count} triangles"), format!("at most {MAX_TRIANGLES}")));
        }
        self.triangles.push(triangle);
        Ok(())
    }

    /// Adds a polygon (or a triangle fan) as triangles around its first corner: exact for convex polygons.
    pub fn push_fan(&mut self, corners: &[u32]) -> Result<()> {
        let Some((&first, rest)) = corners.split_first() else { return Ok(()) };
        rest.windows(2).try_for_each(|pair| self.push_triangle([first, pair[0], pair[1]]))
    }

    /// Adds a triangle strip, with alternating orientation. Triangles with repeated corners, which only join parts of a
    /// strip, are skipped.
    pub fn push_strip(&mut self, corners: &[u32]) -> Result<()> {
        for (i, window) in corners.windows(3).enumerate() {
            let [a, b, c] = [window[0], window[1], window[2]];
            if a != b && b != c && c != a {
                self.push_triangle(if i % 2 == 0 { [a, b, c] } else { [a, c, b] })?;
            }
        }
        Ok(())
    }

    /// Adds a mesh under a transform (f64). If the transform mirrors, the orientation of the triangles is reversed, so
    /// that they still face outward.
    pub fn append(&mut self, mesh: &Mesh, transform: &DMat4) -> Result<()> {
        let offset = self.positions.len() as u32;
        for position in mesh.positions() {
            self.push_vertex(transform.transform_point3(position.as_dvec3()).as_vec3())?;
        }
        let mirrored = transform.determinant() < 0.0;
        for &[a, b, c] in mesh.triangles() {
            let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] };
            self.push_triangle([a + offset, b + offset, c + offset])?;
        }
        Ok(())
    }

    /// The mesh without unused vertices: a shared vertex buffer or a stray point must not enlarge the bounding box of
    /// the object.
    ///
    /// # Errors
    /// Those of [`Mesh::new`].
    pub fn finish(self) -> Result<Mesh> {
        let mut used = vec![false; self.positions.len()];
        for &index in self.triangles.as_flattened() {
            match used.get_mut(index as usize) {
                Some(used) => *used = true,
                None => return Mesh::new(self.positions, self.triangles),
            }
        }
        if self.triangles.is_empty() || used.iter().all(|&used| used) {
            return Mesh::new(self.positions, self.triangles);
        }
        let mut count = 0;
        let new_indices: Vec<u32> = used
            .iter()
            .map(|&used| {
                let index = count;
                count += u32::from(used);
                index
            })
            .collect();
        let positions = self.positions.iter().zip(&used).filter(|(_, used)| **used).map(|(p, _)| *p).collect();
        let renumber = |triangle: &[u32; 3]| triangle.map(|i| new_indices.get(i as usize).copied().unwrap_or(i));
        Mesh::new(positions, self.triangles.iter().map(renumber).collect())
    }
}
