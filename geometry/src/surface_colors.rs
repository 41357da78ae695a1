//! Colours of a surface, at points on it.

use crate::cloud::Cloud;
use crate::error::{Error, ErrorCode, Result};
use crate::mesh::Mesh;
use crate::surface::{SurfaceSample, each_surface_sample};

/// Number of points that represent the colours of a surface: about one for each cell that is compared with a photo.
pub const COLOR_SAMPLES: usize = 32_768;

/// Seed of the points.
const SEED: u64 = 0;

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

    /// The points and their normals, in the mesh's frame.
    pub fn samples(&self) -> &Cloud {
        &self.samples
    }

    /// The colour of each point.
    pub fn colors(&self) -> &[Rgb] {
        &self.colors
    }
}

/// The colour at a point of a triangle, from those of its corners.
pub fn interpolated(corners: [Rgb; 3], [second, third]: [f64; 2]) -> Rgb {
    let [a, b, c] = corners.map(|color| color.map(f64::from));
    core::array::from_fn(|i| (a[i] + (b[i] - a[i]) * second + (c[i] - a[i]) * third + 0.5) as u8)
}
