//! A mesh with all that gives its surface colour, and the colours at points of it.

use std::rc::Rc;

use glam::DVec3;

use crate::color::{WHITE, linear, srgb};
use crate::colored_mesh::ColoredMesh;
use crate::texture::{Texture, Wrap};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::surface::{SurfaceSample, surface_area, triangle_area};
use sim3align_geometry::surface_colors::{COLOR_SAMPLES, Rgb, SurfaceColors, interpolated};
use sim3align_runtime::error::{Error, Result};

/// The sources of a mesh's surface colour.
#[derive(Debug, Default)]
pub(crate) struct Paint {
    /// sRGB-encoded colour of each vertex; empty if none has one.
    pub vertex_colors: Vec<Rgb>,
    /// Texture coordinates of the corners of each triangle; fewer than triangles if the last have none.
    pub coordinates: Vec<[[f32; 2]; 3]>,
    /// First triangle and material of each part, ascending.
    pub parts: Vec<(usize, Option<usize>)>,
    /// sRGB-encoded colours of faces, each the material of its index.
    pub face_colors: Vec<Rgb>,
}

/// A mesh and its paint.
#[derive(Debug)]
pub(crate) struct PaintedMesh {
    pub mesh: Mesh,
    pub paint: Paint,
    /// The offset subtracted from the coordinates of the file.
    pub origin: DVec3,
}

/// A material: the surface colour is vertex colour × factor × texture, in linear light.
#[derive(Debug, Clone)]
pub(crate) struct Material {
    /// Linear light.
    pub factor: [f32; 3],
    pub texture: Option<Rc<Texture>>,
    pub wrap: [Wrap; 2],
}

impl Default for Material {
    fn default() -> Self {
        Self { factor: [1.0; 3], texture: None, wrap: Default::default() }
    }
}

impl Material {
    /// Whether it has a colour other than the default.
    fn is_colored(&self) -> bool {
        self.texture.is_some() || self.factor != [1.0; 3]
    }
}

impl PaintedMesh {
    /// The mesh with its colours. `materials` are those that the parts refer to; other parts are white.
    pub fn colored(self, materials: Result<Vec<Material>>) -> ColoredMesh {
        match materials {
            Ok(materials) => {
                let read = self.paint.surface_colors(&self.mesh, &materials);
                let (colors, flipped) = read.map_or((None, Vec::new()), |(colors, flipped)| (Some(colors), flipped));
                ColoredMesh { colors, flipped, ..self.plain(None) }
            }
            Err(problem) => self.plain(Some(problem)),
        }
    }

    /// The same for a file that may have colours of vertices as well: those of a texture are finer, those of materials are not, and
    /// are often those of no surface.
    pub fn colored_by_finest(mut self, materials: Result<Vec<Material>>) -> ColoredMesh {
        let has_own = !self.paint.vertex_colors.is_empty();
        match &materials {
            Ok(materials) if materials.iter().any(|material| material.texture.is_some()) => {
                self.paint.vertex_colors.clear();
            }
            _ if has_own => return self.colored(Ok(Vec::new())),
            _ => {}
        }
        self.colored(materials)
    }

    /// The mesh with the colours of its faces, or of its vertices if these differ.
    pub fn colored_by_faces(mut self) -> ColoredMesh {
        let colors = core::mem::take(&mut self.paint.face_colors);
        if let Some((first, rest)) = self.paint.vertex_colors.split_first()
            && !colors.is_empty()
            && rest.iter().all(|other| other == first)
        {
            self.paint.vertex_colors.clear();
        }
        let material = |&color: &Rgb| Material { factor: linear(color), ..Material::default() };
        self.colored_by_finest(Ok(colors.iter().map(material).collect()))
    }

    /// The mesh without colours.
    pub fn plain(self, problem: Option<Error>) -> ColoredMesh {
        ColoredMesh {
            mesh: self.mesh,
            colors: None,
            flipped: Vec::new(),
            copies: 0,
            origin: self.origin,
            unread: Vec::new(),
            problem,
        }
    }
}

impl Paint {
    /// The indices of the materials that parts have, ascending.
    pub fn used_materials(&self) -> Vec<usize> {
        let mut used: Vec<usize> = self.parts.iter().filter_map(|part| part.1).collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// The colours of the mesh's surface, and the same with the textures upside down, if it has any; `None` if nothing gives it
    /// colours, or if it has no area.
    fn surface_colors(&self, mesh: &Mesh, materials: &[Material]) -> Option<(SurfaceColors, Vec<Rgb>)> {
        let white = Material::default();
        let parts: Vec<(usize, &Material)> = (self.parts.iter())
            .map(|&(first, index)| (first, index.and_then(|index| materials.get(index)).unwrap_or(&white)))
            .collect();
        if self.vertex_colors.is_empty() && !parts.iter().any(|(_, material)| material.is_colored()) {
            return None;
        }
        let is_textured = parts.iter().any(|(_, material)| material.texture.is_some());
        let spacing = surface_area(mesh) / COLOR_SAMPLES as f64;
        let mut flipped = Vec::new();
        let colors = SurfaceColors::sample(mesh, &mut |sample| {
            let part = parts.partition_point(|&(first, _)| first <= sample.triangle).checked_sub(1);
            let material = part.and_then(|part| parts.get(part)).map_or(&white, |(_, material)| material);
            if is_textured {
                flipped.push(self.color(mesh, material, sample, spacing, true));
            }
            self.color(mesh, material, sample, spacing, false)
        });
        Some((colors.ok()?, flipped))
    }

    /// The colour at a point, with the texture averaged over `spacing`, an area of the surface.
    #[inline(never)]
    fn color(&self, mesh: &Mesh, material: &Material, sample: &SurfaceSample, spacing: f64, is_flipped: bool) -> Rgb {
        let corners = mesh.triangles().get(sample.triangle).copied().unwrap_or_default();
        let of_vertex = |i: u32| self.vertex_colors.get(i as usize).copied().unwrap_or(WHITE);
        let vertices = interpolated(corners.map(of_vertex), sample.weights);
        let texture = material.texture.as_ref().map_or(WHITE, |texture| {
            let corners_uv = self.coordinates.get(sample.triangle).copied().unwrap_or_default();
            let [a, b, c] = corners_uv.map(|uv| uv.map(f64::from));
            let [second, third] = sample.weights;
            let at = |axis: usize| a[axis] + (b[axis] - a[axis]) * second + (c[axis] - a[axis]) * third;
            let in_texture = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() / 2.0;
            let area = in_texture / triangle_area(mesh, sample.triangle) * spacing;
            let v = if is_flipped { 1.0 - at(1) } else { at(1) };
            texture.color([at(0), v], area, material.wrap)
        });
        match (vertices == WHITE, material.factor == [1.0; 3]) {
            (true, true) => texture,
            (false, true) if texture == WHITE => vertices,
            _ => {
                let (vertices, texture) = (linear(vertices), linear(texture));
                srgb(core::array::from_fn(|i| vertices[i] * material.factor[i] * texture[i]))
            }
        }
    }
}
