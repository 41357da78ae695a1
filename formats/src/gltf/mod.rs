//! glTF 2.0: the default scene as one mesh, in the scene's frame.
//!
//! Only what is read is parsed of the JSON. Indices and offsets are resolved by checked code of this module, so that a malicious file
//! results in an error. The parts that define triangles are parsed apart from those that define
//! colours, so that an invalid material or texture does not prevent reading the mesh.

mod accessor;
mod buffers;
mod container;
mod document;
mod instancing;
mod materials;
mod scene;
mod skin;

use self::container::Container;
use self::document::{Document, parse_json};
use self::materials::Materials;
use crate::colored_mesh::{ColoredMesh, Content};
use crate::mesh_format::MeshReadOptions;
use crate::resources::{ExternalResources, distinct};
use sim3align_runtime::error::Result;

/// Reads a `.glb` or `.gltf`: the nodes of the default scene (the first scene if there is no default;
/// without scenes, all root nodes), with transforms applied and all triangles, strips and fans merged. Points and lines
/// are ignored. Skins have the pose of their joints, and instances of `EXT_mesh_gpu_instancing` are copies. Morph targets
/// have the default weights of their node or mesh. Nodes that are hidden are left out.
///
/// # Errors
/// [`ErrorCode::CorruptFile`], [`ErrorCode::FileTooLarge`], [`ErrorCode::UnsupportedFormat`] for required
/// extensions, [`ErrorCode::CompressedMesh`], [`ErrorCode::InvalidArgument`] for a buffer that `resources` lacks,
/// and those of [`Mesh::new`](sim3align_geometry::mesh::Mesh::new).
pub(crate) fn read_gltf(bytes: &[u8], options: &MeshReadOptions<'_>, content: Content) -> Result<ColoredMesh> {
    let container = Container::split(bytes)?;
    let json = parse_json(container.json)?;
    let document = Document::parse(&json)?;
    document.check_extensions()?;
    let buffers = buffers::Buffers::new(&document.buffers, container.binary, options.resources);
    let MeshReadOptions { images, color_space, .. } = *options;
    let mut reader = accessor::AccessorReader { document: &document, buffers, images, color_space, elements_read: 0 };
    let materials = match content {
        Content::Shape => None,
        Content::ShapeAndColors => Some(Materials::parse(&json)),
    };
    scene::read_scene(&mut reader, materials)
}

/// The external files of a `.gltf`: buffers, and images of base colours.
pub(crate) fn external_resources(bytes: &[u8]) -> Result<ExternalResources> {
    let json = parse_json(Container::split(bytes)?.json)?;
    let document = Document::parse(&json)?;
    let uris = document.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let shape = distinct(uris.filter(|uri| !uri.starts_with("data:")));
    let mut colors = Materials::parse(&json).map_or_else(|_| Vec::new(), |m| distinct(m.external_images()));
    colors.retain(|uri| !shape.contains(uri));
    Ok(ExternalResources { shape, colors })
}
