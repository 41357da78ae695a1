//! glTF 2.0: the default scene as one mesh, in the scene's frame.
//!
//! The types of the `gltf-json` crate parse the JSON. Indices and offsets are resolved by checked code of this module,
//! so that a malicious file results in an error. The parts that define triangles are parsed apart from those that define
//! colours, so that an invalid material or texture does not prevent reading the mesh.

mod accessor;
mod buffers;
mod container;
mod materials;
mod scene;

use ::gltf::json;
use serde::Deserialize;

use self::container::Container;
use self::materials::Materials;
use crate::guard::{corrupt, too_large, unsupported};
use crate::mesh::{ColoredMesh, Content, ExternalResources};
use crate::resources::{Resources, distinct};
use sim3align_geometry::error::{Error, ErrorCode, Result};

/// Maximum number of objects in the JSON: each takes much more memory than its two characters.
const MAX_JSON_OBJECTS: usize = 1 << 20;

const DRACO: &str = "KHR_draco_mesh_compression";

const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Supported required extensions: they are applied, or do not affect the shape.
const SUPPORTED_EXTENSIONS: &str = "KHR_mesh_quantization, KHR_materials_*, KHR_texture_*, EXT_texture_*, \
    MSFT_texture_dds, KHR_lights_punctual, KHR_animation_pointer and KHR_xmp_json_ld";

/// The parts of a glTF file that define its triangles.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    #[serde(default)]
    accessors: Vec<json::Accessor>,
    #[serde(default)]
    buffers: Vec<json::Buffer>,
    #[serde(default)]
    buffer_views: Vec<json::buffer::View>,
    #[serde(default)]
    meshes: Vec<json::Mesh>,
    #[serde(default)]
    nodes: Vec<json::Node>,
    #[serde(default)]
    scenes: Vec<Scene>,
    scene: Option<usize>,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

impl Document {
    fn parse(json: &[u8]) -> Result<Self> {
        let objects = json.iter().filter(|&&b| b == b'{').count();
        if objects > MAX_JSON_OBJECTS {
            return Err(too_large("mesh", format!("{objects} JSON objects"), format!("at most {MAX_JSON_OBJECTS}")));
        }
        json::deserialize::from_slice(json)
            .map_err(|error| corrupt("mesh", format!("glTF JSON that can't be read: {error}"), "glTF 2.0"))
    }

    fn uses(&self, extension: &str) -> bool {
        self.extensions_used.iter().chain(&self.extensions_required).any(|name| name == extension)
    }

    /// Whether geometry without data is Draco-compressed.
    fn refuse_draco(&self) -> Result<()> {
        if self.uses(DRACO) { Err(compressed(DRACO)) } else { Ok(()) }
    }

    /// Whether geometry without data is meshopt-compressed.
    fn refuse_meshopt(&self) -> Result<()> {
        MESHOPT.iter().find(|name| self.uses(name)).map_or(Ok(()), |name| Err(compressed(name)))
    }

    /// Rejects required extensions that may change the shape. Compression is checked when data are missing, because
    /// files may contain an uncompressed fallback.
    fn check_extensions(&self) -> Result<()> {
        let harmless = |name: &str| {
            name.starts_with("KHR_materials_")
                || name.starts_with("KHR_texture_")
                || name.starts_with("EXT_texture_")
                || [
                    "KHR_mesh_quantization",
                    "MSFT_texture_dds",
                    "KHR_lights_punctual",
                    "KHR_animation_pointer",
                    "KHR_xmp_json_ld",
                    DRACO,
                    MESHOPT[0],
                    MESHOPT[1],
                ]
                .contains(&name)
        };
        let unknown: Vec<&str> = self.extensions_required.iter().map(String::as_str).filter(|n| !harmless(n)).collect();
        if unknown.is_empty() {
            return Ok(());
        }
        Err(unsupported(
            "mesh",
            format!("required extension {}", unknown.join(", ")),
            format!("none but {SUPPORTED_EXTENSIONS}"),
            "Export the mesh without it.",
        ))
    }
}

fn compressed(extension: &str) -> Error {
    Error::new(
        ErrorCode::CompressedMesh,
        "mesh",
        format!("geometry compressed with {extension}"),
        "uncompressed or quantised geometry",
        "Decompress it with glTF-Transform: npx @gltf-transform/cli copy in.glb out.glb.",
    )
}

/// Reads a `.glb` or `.gltf`: the nodes of the default scene (the first scene if there is no default;
/// without scenes, all root nodes), with transforms applied and all triangles, strips and fans merged. Points and lines
/// are ignored. Skins and morph targets are not applied.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::FileTooLarge`], [`ErrorCode::UnsupportedFormat`] for required
/// extensions, [`ErrorCode::CompressedMesh`], [`ErrorCode::InvalidArgument`] for a buffer that `resources` lacks,
/// and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub(crate) fn read_gltf(bytes: &[u8], resources: Option<Resources<'_>>, content: Content) -> Result<ColoredMesh> {
    let container = Container::split(bytes)?;
    let document = Document::parse(container.json)?;
    document.check_extensions()?;
    let buffers = buffers::Buffers::new(&document.buffers, container.binary, resources);
    let mut reader = accessor::AccessorReader { document: &document, buffers, elements_read: 0 };
    let materials = match content {
        Content::Shape => None,
        Content::ShapeAndColors => Some(Materials::parse(container.json)),
    };
    scene::read_scene(&mut reader, materials)
}

/// The external files of a `.gltf`: buffers, and images of base colours.
pub(crate) fn external_resources(bytes: &[u8]) -> Result<ExternalResources> {
    let json = Container::split(bytes)?.json;
    let document = Document::parse(json)?;
    let uris = document.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let shape = distinct(uris.filter(|uri| !uri.starts_with("data:")));
    let mut colors = Materials::parse(json).map_or_else(|_| Vec::new(), |m| distinct(m.external_images()));
    colors.retain(|uri| !shape.contains(uri));
    Ok(ExternalResources { shape, colors })
}
