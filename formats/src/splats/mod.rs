//! 3D Gaussian splats as meshes: files of Gaussians, and the surface that the opaque ones show.

mod density;
mod gaussian;
mod lattice;
mod ply_file;
mod region;
mod ridge;
mod splat_file;
mod surface_nets;

use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::mesh::Mesh;

use crate::colored_mesh::{ColoredMesh, Content};
use crate::painted_mesh::{Paint, PaintedMesh};
use gaussian::Gaussian;

pub(crate) use ply_file::{has_gaussians, read_gaussians};
pub(crate) use splat_file::{is_splat_file, read_splat_file};

/// The closed mesh around the opaque Gaussians, without floaters. Its vertices are on the sheet that the centres of the
/// Gaussians form; cavities that can't be seen from outside are filled.
///
/// # Errors
/// [`ErrorCode::EmptyMesh`] without an opaque surface, [`ErrorCode::DegenerateMesh`].
fn surface_of(gaussians: Vec<Gaussian>, content: Content) -> Result<ColoredMesh> {
    let count = gaussians.len();
    let transparent = || {
        Error::new(
            ErrorCode::EmptyMesh,
            "mesh",
            format!("{count} Gaussians without an opaque surface"),
            "Gaussians that hide what is behind them",
            "Check that opacities are stored as logits in a PLY file, and from 0 to 255 in a .splat file.",
        )
    };
    let (lattice, blobs) = region::blobs_of(gaussians)?.ok_or_else(transparent)?;
    let solid = density::Solid::of(&lattice, &blobs);
    let (mut vertices, triangles) = surface_nets::surface(&lattice, &solid);
    if triangles.is_empty() {
        return Err(transparent());
    }
    let colors = ridge::fit(&lattice, &blobs, &mut vertices, &triangles);
    let mesh = Mesh::new(vertices.into_iter().map(|vertex| lattice.point(vertex)).collect(), triangles)?;
    let vertex_colors = if content == Content::Shape { Vec::new() } else { colors };
    let paint = Paint { vertex_colors, ..Paint::default() };
    Ok(PaintedMesh { mesh, paint }.colored(Ok(Vec::new())))
}
