//! Colours of a surface, at points on it.

use glam::Vec3;

use crate::cloud::Cloud;
use crate::mesh::Mesh;
use crate::surface::{SurfaceSample, each_surface_sample};
use crate::triangle_tree::TriangleTree;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Number of points that represent the colours of a surface: about one for each cell that is compared with a photo.
pub const COLOR_SAMPLES: usize = 32_768;

/// Seed of the points.
const SEED: u64 = 0;

/// Distance up to which a point is on a surface, relative to its diagonal: the rounding of f32.
const ON_SURFACE: f64 = 1e-5;

/// A colour: red, green and blue, sRGB-encoded.
pub type Rgb = [u8; 3];

/// Colours of a mesh's surface at points spread evenly by area, whether they come from vertices, materials or textures.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceColors {
    samples: Cloud,
    colors: Vec<Rgb>,
}

impl SurfaceColors {
    /// Points with unit normals that face outward, both in the mesh's frame, and the colour of each.
    ///
    /// # Errors
    /// [`ErrorCode::WrongLength`] unless there are as many normals and colours as points, [`ErrorCode::NonFinite`].
    pub fn new(samples: Cloud, colors: Vec<Rgb>) -> Result<Self> {
        let count = samples.points.len();
        for (name, length) in [("normals", samples.normals.len()), ("colors", colors.len())] {
            if length != count {
                return Err(Error::new(
                    ErrorCode::WrongLength,
                    "mesh.colors",
                    format!("{length} {name} for {count} points"),
                    "one of each per point",
                    "Pass arrays of the same mesh.",
                ));
            }
        }
        if !samples.points.iter().chain(&samples.normals).all(|p| p.is_finite()) {
            return Err(Error::new(
                ErrorCode::NonFinite,
                "mesh.colors",
                "a point that is not finite",
                "finite numbers",
                "Remove or repair the vertex before passing the mesh.",
            ));
        }
        Ok(Self { samples, colors })
    }

    /// The colours of a mesh at [`COLOR_SAMPLES`] points. `color_at` returns the colour of a point.
    ///
    /// # Errors
    /// As [`each_surface_sample`].
    pub fn sample(mesh: &Mesh, color_at: &mut dyn FnMut(&SurfaceSample) -> Rgb) -> Result<Self> {
        let mut samples =
            Cloud { points: Vec::with_capacity(COLOR_SAMPLES), normals: Vec::with_capacity(COLOR_SAMPLES) };
        let mut colors = Vec::with_capacity(COLOR_SAMPLES);
        each_surface_sample(mesh, COLOR_SAMPLES, SEED, &mut |sample| {
            samples.points.push(sample.point);
            samples.normals.push(sample.normal);
            colors.push(color_at(&sample));
        })?;
        Ok(Self { samples, colors })
    }

    /// The colours of a mesh's vertices, interpolated over its triangles.
    ///
    /// # Errors
    /// [`ErrorCode::WrongLength`] unless there is a colour for each vertex, and as [`SurfaceColors::sample`].
    pub fn of_vertices(mesh: &Mesh, colors: &[Rgb]) -> Result<Self> {
        let count = mesh.positions().len();
        if colors.len() != count {
            return Err(Error::new(
                ErrorCode::WrongLength,
                "mesh.colors",
                format!("{} colours for {count} vertices", colors.len()),
                "one colour per vertex",
                "Pass the colours of the same mesh, vertex by vertex.",
            ));
        }
        Self::sample(mesh, &mut |sample| {
            let corners = mesh.triangles()[sample.triangle].map(|i| colors[i as usize]);
            interpolated(corners, sample.weights)
        })
    }

    /// The colours of all points that are not on the surface of `other`, a part of the mesh.
    pub fn beside(self, other: &Mesh) -> Self {
        let tree = TriangleTree::new(other);
        let reach = (ON_SURFACE * other.diagonal()) as f32;
        let is_apart = |point: Vec3| tree.nearest(point).is_none_or(|near| near.distance_squared > reach * reach);
        let kept: Vec<bool> = self.samples.points.iter().map(|point| is_apart(*point)).collect();
        let Cloud { points, normals } = self.samples;
        Self {
            samples: Cloud { points: retained(points, &kept), normals: retained(normals, &kept) },
            colors: retained(self.colors, &kept),
        }
    }

    /// The points and their normals, in the mesh's frame.
    pub fn samples(&self) -> &Cloud {
        &self.samples
    }

    /// The colour of each point.
    pub fn colors(&self) -> &[Rgb] {
        &self.colors
    }
}

fn retained<T>(values: Vec<T>, kept: &[bool]) -> Vec<T> {
    values.into_iter().zip(kept).filter(|(_, kept)| **kept).map(|(value, _)| value).collect()
}

/// The colour at a point of a triangle, from those of its corners.
pub fn interpolated(corners: [Rgb; 3], [second, third]: [f64; 2]) -> Rgb {
    let [a, b, c] = corners.map(|color| color.map(f64::from));
    core::array::from_fn(|i| (a[i] + (b[i] - a[i]) * second + (c[i] - a[i]) * third + 0.5) as u8)
}
