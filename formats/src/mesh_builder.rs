//! Builds a mesh within the size limits.

use std::collections::HashMap;

use glam::{DMat4, DVec3, Vec3};

use crate::color::WHITE;
use crate::guard::{MAX_TRIANGLES, MAX_VERTICES, too_large};
use crate::painted_mesh::{Paint, PaintedMesh};
use crate::polygon::Polygon;
use sim3align_geometry::mesh::{Mesh, UsedVertices};
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::Result;

/// Distance of a mesh from zero, in its diagonals, from which 32 bits would round its vertices by more than 6e-5 diagonals.
const FAR: f64 = 1000.0;

/// Collects the vertices and triangles of a file. Coordinates are in 64 bits until all are known: those of maps are far from
/// zero.
#[derive(Debug, Default)]
pub(crate) struct MeshBuilder {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The triangles of the last polygon.
    polygon: Polygon,
    /// Of the vertices and triangles so far, or fewer: the rest has no colour or coordinates of its own.
    paint: Paint,
    /// Colours of the first vertices, and the distinct colours of faces, each a material; the indices of these by the bits of their
    /// numbers.
    vertex_codes: Vec<Codes>,
    face_codes: Vec<Codes>,
    materials: HashMap<[u64; 3], u32>,
    /// The largest number of the colours of vertices, and of those of faces.
    most: [f64; 2],
}

/// An sRGB-encoded colour by numbers, if they are from 0 to 1, and if they are from 0 to 255.
type Codes = [Rgb; 2];

/// Largest number of colours from 0 to 1: some are slightly too bright.
const MOST_OF_ONE: f64 = 2.0;

impl MeshBuilder {
    /// A builder with initial vertices.
    pub fn with_positions(positions: Vec<Vec3>) -> Self {
        Self { positions: positions.into_iter().map(Vec3::as_dvec3).collect(), ..Self::default() }
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
    pub fn push_vertex(&mut self, position: DVec3) -> Result<u32> {
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

    /// Adds a polygon as triangles. Corners that are not known yet make it a fan.
    pub fn push_polygon(&mut self, corners: &[u32]) -> Result<()> {
        let known = || corners.iter().map(|i| self.positions.get(*i as usize).copied()).collect();
        let points: Option<Vec<DVec3>> = if corners.len() > 3 { known() } else { None };
        self.polygon.cut(&points.unwrap_or_default(), corners.len());
        for i in 0..self.polygon.triangles.len() {
            self.push_triangle(self.polygon.triangles[i].map(|place| corners[place]))?;
        }
        Ok(())
    }

    /// Adds a triangle fan around its first corner.
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

    /// Sets the sRGB-encoded colour of the last vertex. Its numbers are from 0 to 1, or from 0 to 255 if any of the file is larger.
    pub fn color_vertex(&mut self, color: [f64; 3]) {
        let codes = codes(color, &mut self.most[0]);
        self.vertex_codes.resize(self.positions.len().saturating_sub(1), [WHITE; 2]);
        self.vertex_codes.push(codes);
    }

    /// The same for the triangles that follow.
    pub fn color_faces(&mut self, color: [f64; 3]) {
        let next = self.face_codes.len();
        let material = *self.materials.entry(color.map(f64::to_bits)).or_insert(next as u32) as usize;
        if material == next {
            self.face_codes.push(codes(color, &mut self.most[1]));
        }
        self.use_material(Some(material));
    }

    /// Sets the sRGB-encoded colours of all vertices.
    pub fn color_vertices(&mut self, colors: Vec<Rgb>) {
        self.paint.vertex_colors = colors;
    }

    /// Sets the texture coordinates of all triangles, from those of the vertices.
    pub fn map_vertices(&mut self, coordinates: &[[f32; 2]]) {
        let of_corner = |corner: u32| coordinates.get(corner as usize).copied().unwrap_or_default();
        self.paint.coordinates = self.triangles.iter().map(|triangle| triangle.map(of_corner)).collect();
    }

    /// Sets the texture coordinates of the last polygon, which begins with the triangle of index `first`, from those of its
    /// corners.
    pub fn map_polygon(&mut self, first: usize, coordinates: &[[f32; 2]]) {
        self.paint.coordinates.resize(first, Default::default());
        let of_triangle = |triangle: &[usize; 3]| triangle.map(|place| coordinates[place]);
        self.paint.coordinates.extend(self.polygon.triangles.iter().map(of_triangle));
    }

    /// The triangles that follow have the material of this index.
    pub fn use_material(&mut self, material: Option<usize>) {
        let first = self.triangles.len();
        while self.paint.parts.last().is_some_and(|part| part.0 >= first) {
            self.paint.parts.pop();
        }
        if self.paint.parts.last().map(|part| part.1) != Some(material) {
            self.paint.parts.push((first, material));
        }
    }

    /// Adds a mesh under a transform (f64). If the transform mirrors, the orientation of the triangles is reversed, so
    /// that they still face outward.
    pub fn append(&mut self, part: &PaintedMesh, transform: &DMat4) -> Result<()> {
        let PaintedMesh { mesh, paint, origin } = part;
        let offset = self.positions.len() as u32;
        for position in mesh.positions() {
            self.push_vertex(transform.transform_point3(position.as_dvec3() + origin))?;
        }
        let mirrored = transform.determinant() < 0.0;
        if !paint.vertex_colors.is_empty() {
            self.paint.vertex_colors.resize(offset as usize, WHITE);
            self.paint.vertex_colors.extend(&paint.vertex_colors);
        }
        if !paint.coordinates.is_empty() {
            self.paint.coordinates.resize(self.triangles.len(), Default::default());
            let turned = |&[a, b, c]: &[[f32; 2]; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
            self.paint.coordinates.extend(paint.coordinates.iter().map(turned));
        }
        self.use_material(paint.parts.first().and_then(|part| part.1));
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
    pub fn finish(self) -> Result<PaintedMesh> {
        let Self { positions, triangles, mut paint, vertex_codes, face_codes, most, .. } = self;
        let [of_vertices, of_faces] = most.map(|most| usize::from(most > MOST_OF_ONE));
        paint.vertex_colors.extend(vertex_codes.iter().map(|codes| codes[of_vertices]));
        paint.face_colors = face_codes.iter().map(|codes| codes[of_faces]).collect();
        if !paint.vertex_colors.is_empty() {
            paint.vertex_colors.resize(positions.len(), WHITE);
        }
        let used = UsedVertices::of(&triangles, positions.len());
        let Some(used) = used.filter(|used| !triangles.is_empty() && !used.are_all()) else {
            let (positions, origin) = centred(&positions);
            return Ok(PaintedMesh { mesh: Mesh::new(positions, triangles)?, paint, origin });
        };
        paint.vertex_colors = used.select(&paint.vertex_colors);
        let (positions, origin) = centred(&used.select(&positions));
        let mesh = Mesh::new(positions, used.renumbered(&triangles))?;
        Ok(PaintedMesh { mesh, paint, origin })
    }
}

/// The codes of a colour, whose numbers count for the largest one.
fn codes(color: [f64; 3], most: &mut f64) -> Codes {
    *most = color.into_iter().fold(*most, f64::max);
    [255.0, 1.0].map(|factor| color.map(|x| (x * factor).round() as u8))
}

/// The positions relative to an origin: the centre of their bounding box if they are far from zero, otherwise zero.
fn centred(positions: &[DVec3]) -> (Vec<Vec3>, DVec3) {
    let mut finite = positions.iter().copied().filter(|position| position.is_finite());
    let first = finite.next().unwrap_or_default();
    let (low, high) = finite.fold((first, first), |(low, high), position| (low.min(position), high.max(position)));
    let centre = 0.5 * (low + high);
    let is_far = centre.length() > FAR * low.distance(high) && low != high;
    let origin = if is_far { centre } else { DVec3::ZERO };
    (positions.iter().map(|position| (position - origin).as_vec3()).collect(), origin)
}
