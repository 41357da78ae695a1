//! The observation: the evidence of a depth map and a mask.
//!
//! In: an [`Observation`](crate::evidence::observation::Observation). Out: the [`CleanObservation`](clean::CleanObservation),
//! which holds the pixels and depths that reliably belong to the object, its grids of cells at any resolution, and where
//! the mask is cut. Nothing here depends on the mesh: the evidence must not depend on the hypothesis that it judges.

pub mod box_fits;
pub mod clean;
pub mod grid;
pub mod mask_boundary;
pub mod ramp;
pub mod thinning;

/// Grids of the search, coarse to fine.
pub const GRIDS: usize = 5;
/// The grid on which every rotation is rendered.
pub const SIEVE: usize = 0;
/// The grid on which promising poses, and the neighbourhood of a given pose, are rendered.
pub const COARSE: usize = 1;
/// The grid of the first refinements.
pub const MIDDLE: usize = 2;
/// The grid of the final ranking.
pub const FINE: usize = 3;
/// The grid of the final refinement.
pub const FINEST: usize = 4;

/// The resolution of a grid and of the mesh rendered on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Approximate number of cells of the mask, at most its number of pixels.
    pub cells: usize,
    /// Number of triangles of the decimated mesh.
    pub triangles: usize,
    /// Depth error that halves the credit of a cell, relative to the observed diagonal.
    pub depth_error: f64,
    /// Factor of the weight of the normals.
    pub normals: f32,
    /// Factor of the weight of the outline, which is not informative on cells as wide as the errors of the rotation
    /// grid.
    pub outline: f32,
}
