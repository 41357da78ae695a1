//! The parts of the JSON that define the triangles, and what makes a file unreadable.

use ::gltf::json;
use serde::Deserialize;

use crate::guard::{corrupt, too_large, unsupported};
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Maximum number of objects in the JSON: each takes much more memory than its two characters.
const MAX_JSON_OBJECTS: usize = 1 << 20;

const DRACO: &str = "KHR_draco_mesh_compression";
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Supported required extensions: they are applied, or do not affect the shape.
const SUPPORTED_EXTENSIONS: &str = "KHR_mesh_quantization, KHR_materials_*, KHR_texture_*, EXT_texture_*, \
    MSFT_texture_dds, EXT_mesh_gpu_instancing, KHR_lights_punctual, KHR_animation_pointer and KHR_xmp_json_ld";

/// The parts of a glTF file that define its triangles.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub accessors: Vec<json::Accessor>,
    pub buffers: Vec<json::Buffer>,
    pub buffer_views: Vec<json::buffer::View>,
    pub meshes: Vec<json::Mesh>,
    pub nodes: Vec<Node>,
    pub skins: Vec<SkinJson>,
    pub scenes: Vec<Scene>,
    pub scene: Option<usize>,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub children: Vec<usize>,
    /// 16 numbers, or none; `translation`, `rotation` and `scale` likewise.
    pub matrix: Vec<f32>,
    pub translation: Vec<f32>,
    pub rotation: Vec<f32>,
    pub scale: Vec<f32>,
    pub extensions: NodeExtensions,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instances>,
}

#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SkinJson {
    pub joints: Vec<usize>,
    pub inverse_bind_matrices: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

/// The instances of a node.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Instances {
    pub(super) attributes: InstanceAttributes,
}

/// Accessors with an element per instance.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

impl Document {
    pub fn parse(json: &[u8]) -> Result<Self> {
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

    /// Fails if the file uses Draco: geometry without data is then compressed with it.
    pub fn refuse_draco(&self) -> Result<()> {
        if self.uses(DRACO) { Err(compressed(DRACO)) } else { Ok(()) }
    }

    /// The same for meshopt.
    pub fn refuse_meshopt(&self) -> Result<()> {
        MESHOPT.iter().find(|name| self.uses(name)).map_or(Ok(()), |name| Err(compressed(name)))
    }

    /// Rejects required extensions that may change the shape. Compression is checked when data are missing, because
    /// files may contain an uncompressed fallback.
    pub fn check_extensions(&self) -> Result<()> {
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
                    INSTANCING,
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
    let (command, decoder) = match extension {
        DRACO => ("@gltf-transform/cli copy in.glb out.glb", "dracoDecoder"),
        "EXT_meshopt_compression" => ("@gltf-transform/cli copy in.glb out.glb", "meshoptDecoder"),
        // glTF-Transform 4 has no decoder of it.
        _ => ("gltfpack -noq -i in.glb -o out.glb", "meshoptDecoder"),
    };
    Error::new(
        ErrorCode::CompressedMesh,
        "mesh",
        format!("geometry compressed with {extension}"),
        "uncompressed or quantised geometry",
        format!("Decompress it: npx {command}. Or pass {decoder} to readMesh()."),
    )
}
