//! Colours of a surface, at points on it.

use crate::cloud::Cloud;
use crate::error::{Error, ErrorCode, Result};

/// Number of points that represent the colours of a surface: about one for each cell that is compared with a photo.
pub const COLOR_SAMPLES: usize = 32_768;

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

    /// The points and their normals, in the mesh's frame.
    pub fn samples(&self) -> &Cloud {
        &self.samples
    }

    /// The colour of each point.
    pub fn colors(&self) -> &[Rgb] {
        &self.colors
    }
}
