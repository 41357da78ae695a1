//! 3D Gaussian splats as meshes: files of Gaussians, and the surface that the opaque ones show. They are read by a module
//! of their own.

mod density;
mod gaussian;
mod lattice;
mod packed;
mod ply_file;
mod region;
mod ridge;
mod splat_file;
mod surface_nets;

use glam::DVec3;
use sim3align_geometry::mesh::Mesh;
use sim3align_runtime::error::{Error, ErrorCode, Result};

use crate::colored_mesh::ColoredMesh;
use crate::painted_mesh::{Paint, PaintedMesh};
use gaussian::Gaussian;

/// Reads 3D Gaussians as a closed mesh of the surface that the opaque ones show, in the unit and axes of the file: a PLY
/// file of 3D or 2D Gaussian Splatting or of SuperSplat (compressed), or else a `.splat` file. With colours, they are those of
/// the constant harmonic.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::UnsupportedFormat`], [`ErrorCode::FileTooLarge`], [`ErrorCode::NonFinite`],
/// [`ErrorCode::EmptyMesh`] without an opaque surface, [`ErrorCode::DegenerateMesh`] without an extent.
pub fn read_splats(bytes: &[u8], with_colors: bool) -> Result<ColoredMesh> {
    let is_ply = bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r");
    surface_of(if is_ply { ply_file::read(bytes) } else { splat_file::read(bytes) }?, with_colors)
}

/// The closed mesh around the opaque Gaussians, without floaters. Its vertices are on the sheet that the centres of the
/// Gaussians form; cavities that can't be seen from outside are filled.
fn surface_of(gaussians: Vec<Gaussian>, with_colors: bool) -> Result<ColoredMesh> {
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
    let vertex_colors = if with_colors { colors } else { Vec::new() };
    let paint = Paint { vertex_colors, ..Paint::default() };
    Ok(PaintedMesh { mesh, paint, origin: DVec3::ZERO }.colored(Ok(Vec::new())))
}
