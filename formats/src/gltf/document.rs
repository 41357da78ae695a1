//! The parts of the JSON that define the triangles, and what makes a file unreadable.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::guard::{Unknown, corrupt, too_large, unsupported};
use crate::text::is_listed;
use sim3align_runtime::error::{Error, ErrorCode, Result};

/// Maximum number of objects in the JSON: each takes much more memory than its two characters.
const MAX_JSON_OBJECTS: usize = 1 << 19;

const DRACO: &str = "KHR_draco_mesh_compression";
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
/// 3D Gaussians, plain or compressed.
const GAUSSIANS: &str = "KHR_gaussian_splatting";

/// Extensions that are applied.
const APPLIED: &str = "KHR_mesh_quantization KHR_draco_mesh_compression EXT_meshopt_compression KHR_meshopt_compression \
    EXT_mesh_gpu_instancing KHR_node_visibility KHR_texture_transform KHR_texture_basisu EXT_texture_webp \
    KHR_materials_pbrSpecularGlossiness";

/// Extensions of no matter for shape and colour: gloss, transparency and further looks of materials, lights and cameras, animation
/// and physics, levels of detail, names and other data about the parts; and images in further formats, beside others or named as
/// those of colours that cannot be read.
const HARMLESS: &str = "KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_coat KHR_materials_diffuse_roughness \
    KHR_materials_diffuse_transmission KHR_materials_dispersion KHR_materials_emissive_strength KHR_materials_fuzz \
    KHR_materials_ior KHR_materials_iridescence KHR_materials_retroreflection KHR_materials_sheen KHR_materials_specular \
    KHR_materials_subsurface KHR_materials_subsurface_scattering KHR_materials_transmission KHR_materials_unlit \
    KHR_materials_variants KHR_materials_volume KHR_materials_volume_scatter EXT_materials_* ADOBE_materials_* \
    FB_materials_* MSFT_packing_* VRMC_* VRM KHR_texture_procedurals EXT_texture_* MSFT_texture_dds GOOGLE_texture_basis \
    KHR_lights_* EXT_lights_* EXT_light_* MSFT_lod MSFT_audio_emitter KHR_audio* OMI_* KHR_animation* \
    KHR_node_hoverability KHR_node_selectability KHR_interactivity KHR_physics_* MSFT_physics KHR_rigid_bodies \
    KHR_implicit_shapes KHR_collision_shapes MSFT_collision_primitives KHR_xmp* KHR_mesh_variants \
    EXT_mesh_features EXT_mesh_manifold EXT_mesh_primitive_edge_visibility EXT_instance_features EXT_structural_metadata \
    EXT_feature_metadata EXT_primitive_* EXT_properties_* EXT_property_* CESIUM_primitive_outline CESIUM_RTC \
    AGI_articulations AGI_stk_metadata FB_geometry_metadata FB_ngon_encoding GODOT_single_root GRIFFEL_bim_data \
    BLENDER_* NEEDLE_* WEB3D_* MOZ_* HUBS_* AVN_* UX3D_*";

/// Beginnings of the names of extensions that leave the shape as it is, also those that are not known yet.
const SHAPELESS: &str = "KHR_materials_* KHR_texture_* EXT_texture_*";

/// Parses JSON, once: types that parse text themselves are several times as large in the module.
pub(super) fn parse_json(json: &[u8]) -> Result<Value> {
    let objects = json.iter().filter(|&&b| b == b'{').count();
    if objects > MAX_JSON_OBJECTS {
        return Err(too_large("mesh", format!("{objects} JSON objects"), format!("at most {MAX_JSON_OBJECTS}")));
    }
    serde_json::from_slice(json).map_err(|error| unreadable(&error))
}

fn unreadable(error: &serde_json::Error) -> Error {
    corrupt("mesh", format!("glTF JSON that can't be read: {error}"), "glTF 2.0")
}

/// The parts of a glTF file that define its triangles.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Document {
    pub accessors: Vec<Accessor>,
    pub buffers: Vec<Buffer>,
    pub buffer_views: Vec<BufferView>,
    pub meshes: Vec<MeshJson>,
    pub nodes: Vec<Node>,
    pub skins: Vec<SkinJson>,
    pub scenes: Vec<Scene>,
    pub scene: Option<usize>,
    pub asset: Asset,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
}

/// A typed view of a buffer view; of zeros without one.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u64,
    pub count: u64,
    /// `SCALAR`, `VEC3`, …
    #[serde(rename = "type")]
    pub shape: String,
    #[serde(default)]
    pub normalized: bool,
    pub sparse: Option<Sparse>,
}

/// Elements in place of others.
#[derive(Deserialize)]
pub(super) struct Sparse {
    pub count: u64,
    pub indices: SparsePart,
    pub values: SparsePart,
}

/// The place of the indices or the values of such elements; values have the type of their accessor.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    #[serde(default)]
    pub component_type: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct MeshJson {
    pub primitives: Vec<Primitive>,
    /// The default weights of its morph targets.
    #[serde(default)]
    pub weights: Vec<f32>,
}

/// A part of a mesh, with one material.
#[derive(Deserialize)]
pub(super) struct Primitive {
    /// Accessors by name: `POSITION`, `COLOR_0`, …
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    /// Triangles by default.
    pub mode: Option<usize>,
    /// Morph targets: what is added to the attributes, by name.
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, usize>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    /// The program that wrote the file.
    pub generator: String,
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
    /// The weights of morph targets, in place of those of the mesh.
    pub weights: Vec<f32>,
    pub extensions: NodeExtensions,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instances>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
}

/// The visibility of a node and its descendants.
#[derive(Deserialize)]
pub(super) struct Visibility {
    #[serde(default = "shown")]
    pub visible: bool,
}

fn shown() -> bool {
    true
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
    pub fn parse(json: &Value) -> Result<Self> {
        Self::deserialize(json).map_err(|error| unreadable(&error))
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
        let may_change_shape = |name: &&String| !is_known(name) && !is_listed(name.as_bytes(), SHAPELESS);
        let Some(unknown) = self.extensions_required.iter().find(may_change_shape) else { return Ok(()) };
        self.refuse_gaussians()?;
        Err(unsupported(
            "mesh",
            format!("required extension {unknown}"),
            format!("no other than {APPLIED}, and those that do not change the shape"),
            "Export the mesh without it.",
        ))
    }

    /// Fails if the file holds 3D Gaussians, which are no triangles.
    pub fn refuse_gaussians(&self) -> Result<()> {
        if !self.extensions_used.iter().any(|name| name.starts_with(GAUSSIANS)) {
            return Ok(());
        }
        let remedy = "Export them as PLY from the program that made them.";
        Err(unsupported("mesh", "3D Gaussians in a glTF file", "triangles, or 3D Gaussians as PLY or .splat", remedy))
    }

    /// The sentence about extensions that are not known.
    pub fn unread(&self) -> Vec<String> {
        let mut unknown = Unknown::default();
        for name in self.extensions_used.iter().filter(|name| !is_known(name)) {
            unknown.insert(name.as_bytes());
        }
        unknown.named("the glTF extensions")
    }
}

fn is_known(extension: &str) -> bool {
    [APPLIED, HARMLESS].iter().any(|names| is_listed(extension.as_bytes(), names))
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
