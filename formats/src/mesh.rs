//! Mesh files of all supported formats.

use crate::colored_mesh::{ColoredMesh, Content};
use crate::guard::{beginning, unsupported};
use crate::resources::{ExternalResources, ImageDecoder, Resources};
use crate::{gltf, obj, ply, stl, text};
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::mesh::Mesh;

/// The supported mesh formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// glTF 2.0, binary (`.glb`) or JSON (`.gltf`).
    Gltf,
    /// Wavefront OBJ: `v` and `f` lines.
    Obj,
    /// Stanford PLY: ASCII, and binary in both byte orders.
    Ply,
    /// STL: ASCII and binary.
    Stl,
}

impl MeshFormat {
    /// The format of this name or file extension, in any case: `glb`, `gltf`, `obj`, `ply`, `stl`.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`], which lists the names.
    pub fn from_name(name: &str) -> Result<Self> {
        match name.trim_start_matches('.').to_ascii_lowercase().as_str() {
            "glb" | "gltf" => Ok(Self::Gltf),
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "stl" => Ok(Self::Stl),
            _ => Err(Error::new(
                ErrorCode::InvalidOption,
                "options.format",
                format!("{name:?}"),
                "\"glb\", \"gltf\", \"obj\", \"ply\", \"stl\" or \"splat\"",
                "Omit it to detect the format from the content.",
            )),
        }
    }

    /// Detects the format from the content, or returns `None`.
    ///
    /// Binary STL is detected by its length, because its header may begin with "solid" like the text form.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        if bytes.starts_with(b"glTF") || text.starts_with(b"{") {
            return Some(Self::Gltf);
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if stl::has_binary_length(bytes) || text.starts_with(b"solid") {
            return Some(Self::Stl);
        }
        let words = text::lines(text).filter_map(|line| text::words(line).next());
        let mut statements = words.filter(|word| !word.starts_with(b"#"));
        let before_vertices: [&[u8]; 9] = [b"vn", b"vt", b"vp", b"o", b"g", b"s", b"mtllib", b"usemtl", b"cstype"];
        let first_other = statements.find(|word| !before_vertices.contains(word));
        (first_other == Some(b"v".as_slice())).then_some(Self::Obj)
    }
}

/// Options of [`read_mesh`].
#[derive(Clone, Copy, Default)]
pub struct MeshReadOptions<'a> {
    /// The format; detected from the content if `None`.
    pub format: Option<MeshFormat>,
    /// The external files, by URI or name as written in the mesh file; see [`external_resources`].
    pub resources: Option<Resources<'a>>,
    /// Decodes textures that are neither PNG nor JPEG.
    pub images: Option<ImageDecoder<'a>>,
}

/// The distinct files that a mesh file refers to. Of an `.obj`, these are its libraries; given the content of a library,
/// its textures.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::FileTooLarge`], [`ErrorCode::UnsupportedFormat`].
pub fn external_resources(bytes: &[u8]) -> Result<ExternalResources> {
    let is_text = |bytes: &[u8]| !bytes.contains(&0);
    match MeshFormat::sniff(bytes) {
        Some(MeshFormat::Gltf) => gltf::external_resources(bytes),
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
    match options.format.or_else(|| MeshFormat::sniff(bytes)) {
        Some(MeshFormat::Gltf) => gltf::read_gltf(bytes, options, content),
        Some(MeshFormat::Obj) => obj::read_obj(bytes, options, content),
        Some(MeshFormat::Ply) => ply::read_ply(bytes, content),
        Some(MeshFormat::Stl) => stl::read_stl(bytes),
        None => Err(unsupported(
            "mesh",
            beginning(bytes),
            "GLB, glTF, OBJ, PLY, STL or .splat",
            "Convert it, for example with Blender or trimesh; if it is one of these, it is damaged.",
        )),
    }
}
