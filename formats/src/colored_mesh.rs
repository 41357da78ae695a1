//! The content of a mesh file: a mesh and its colours.

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::surface_colors::{Rgb, SurfaceColors};
use sim3align_runtime::error::Error;

/// A mesh and its colours.
#[derive(Debug, Clone, PartialEq)]
pub struct ColoredMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// The colours of its surface; `None` if the file has none, or none that can be read.
    pub colors: Option<SurfaceColors>,
    /// The colours of the same points if the textures were stored upside down; empty without textures.
    pub flipped: Vec<Rgb>,
    /// How many copies of one mesh the file places, if it has no other; otherwise zero.
    pub copies: usize,
    /// The offset subtracted from the coordinates of the file if 32 bits are too coarse for these; otherwise zero.
    pub origin: DVec3,
    /// Content of the file that its reader does not know.
    pub unread: Vec<String>,
    /// Why the colours can't be read; the mesh can be used without them.
    pub problem: Option<Error>,
}

/// The parts of a mesh file to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    Shape,
    ShapeAndColors,
}
