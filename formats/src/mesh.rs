//! Mesh files of all supported formats.

use crate::colored_mesh::{ColoredMesh, Content};
use crate::guard::{beginning, unsupported};
pub use crate::mesh_format::{ColorSpace, MeshFormat, MeshReadOptions};
use crate::ply_header::Header;
use crate::resources::{ExternalResources, distinct};
use crate::{gltf, obj, ply, stl};
use sim3align_geometry::mesh::Mesh;
use sim3align_runtime::error::Result;

/// The distinct files that a mesh file refers to. Of an `.obj`, these are its libraries; given the content of a library,
/// its textures.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::FileTooLarge`], [`ErrorCode::UnsupportedFormat`].
pub fn external_resources(bytes: &[u8]) -> Result<ExternalResources> {
    let is_text = |bytes: &[u8]| !bytes.contains(&0);
    match MeshFormat::sniff(bytes) {
        Some(MeshFormat::Gltf) => gltf::external_resources(bytes),
        Some(MeshFormat::Ply) => {
            let textures = Header::read(bytes)?.0.textures;
            Ok(ExternalResources { shape: Vec::new(), colors: distinct(textures.iter().map(String::as_str)) })
        }
        // A library looks like other text.
        Some(MeshFormat::Obj) | None if is_text(bytes) => {
            Ok(ExternalResources { shape: Vec::new(), colors: obj::external_resources(bytes)? })
        }
        _ => Ok(ExternalResources::default()),
    }
}

/// Reads the shape of a mesh: all parts merged, node transforms applied, in the unit and axes of the file. Unused
/// vertices are removed; normals, colours and textures are not read. Skins and instances of glTF are applied.
///
/// # Errors
/// [`ErrorCode::UnsupportedFormat`], [`ErrorCode::CorruptFile`], [`ErrorCode::FileTooLarge`],
/// [`ErrorCode::CompressedMesh`], [`ErrorCode::InvalidArgument`] for a missing external buffer,
/// and those of [`Mesh::new`].
pub fn read_mesh(bytes: &[u8], options: &MeshReadOptions<'_>) -> Result<Mesh> {
    read_shape(bytes, options).map(|read| read.mesh)
}

/// [`read_mesh`] with the origin of the mesh in its file, see [`ColoredMesh::origin`].
///
/// # Errors
/// As [`read_mesh`].
pub fn read_shape(bytes: &[u8], options: &MeshReadOptions<'_>) -> Result<ColoredMesh> {
    read(bytes, options, Content::Shape)
}

/// Reads a mesh with the colours of its surface: the same mesh as [`read_mesh`], with colours from vertices (glTF
/// `COLOR_0`, PLY, OBJ), base colour factors and base colour textures (glTF) or an MTL (OBJ). In glTF they are multiplied.
/// Parts without colour are white. If any texture or attribute of the colours can't be read, there are no colours but a
/// [`problem`](ColoredMesh::problem): a part painted wrong would mislead.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_colored_mesh(bytes: &[u8], options: &MeshReadOptions<'_>) -> Result<ColoredMesh> {
    read(bytes, options, Content::ShapeAndColors)
}

fn read(bytes: &[u8], options: &MeshReadOptions<'_>, content: Content) -> Result<ColoredMesh> {
    // Files are named wrongly more often than they begin wrongly.
    match MeshFormat::sniff(bytes).or(options.format) {
        Some(MeshFormat::Gltf) => gltf::read_gltf(bytes, options, content),
        Some(MeshFormat::Obj) => obj::read_obj(bytes, options, content),
        Some(MeshFormat::Ply) => ply::read_ply(bytes, options, content),
        Some(MeshFormat::Stl) => stl::read_stl(bytes, content),
        None => Err(unsupported(
            "mesh",
            beginning(bytes),
            "GLB, glTF, OBJ, PLY, STL or .splat",
            "Convert it to GLB or PLY; if it is one of these, it is damaged.",
        )),
    }
}
