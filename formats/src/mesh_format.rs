//! The formats of mesh files, and the options of their readers.

use crate::resources::{ImageDecoder, Resources};
use crate::{stl, text};
use sim3align_runtime::error::{Error, ErrorCode, Result};

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
        let text = text::unmarked(bytes).trim_ascii_start();
        if bytes.starts_with(b"glTF") || text.starts_with(b"{") {
            return Some(Self::Gltf);
        }
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if stl::has_binary_length(bytes) || stl::begins_as_text(bytes) {
            return Some(Self::Stl);
        }
        let words = text::lines(text).filter_map(|line| text::words(line).next());
        let mut statements = words.filter(|word| !word.starts_with(b"#"));
        let before_vertices: [&[u8]; 9] = [b"vn", b"vt", b"vp", b"o", b"g", b"s", b"mtllib", b"usemtl", b"cstype"];
        let first_other = statements.find(|word| !before_vertices.contains(word));
        (first_other == Some(b"v".as_slice())).then_some(Self::Obj)
    }
}

/// Options of [`read_mesh`](crate::mesh::read_mesh).
#[derive(Clone, Copy, Default)]
pub struct MeshReadOptions<'a> {
    /// The format of a file whose content does not tell it.
    pub format: Option<MeshFormat>,
    /// The external files, by URI or name as written in the mesh file; see [`external_resources`](crate::mesh::external_resources).
    pub resources: Option<Resources<'a>>,
    /// Decodes textures that are neither PNG nor JPEG.
    pub images: Option<ImageDecoder<'a>>,
    /// What the vertex colours of a glTF file are; by default, bytes are sRGB-encoded and others mostly linear.
    pub color_space: Option<ColorSpace>,
}

/// The meaning of colour numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorSpace {
    /// Codes for display.
    Srgb,
    /// Linear light.
    Linear,
}

impl ColorSpace {
    /// The space of this name: `srgb` or `linear`.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidOption`].
    pub fn from_name(name: &str) -> Result<Self> {
        match name {
            "srgb" => Ok(Self::Srgb),
            "linear" => Ok(Self::Linear),
            _ => Err(Error::new(
                ErrorCode::InvalidOption,
                "options.colorSpace",
                format!("{name:?}"),
                "\"srgb\" or \"linear\"",
                "Omit it unless the colours of the mesh come out too dark or too bright.",
            )),
        }
    }
}
