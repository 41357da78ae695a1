//! File readers: meshes and their colours, photos, depth maps, masks, cameras and true poses.
//!
//! Readers take bytes. For malicious input, they return a value or an error, and allocate memory in proportion to the
//! input or up to a stated limit.

pub use sim3align_runtime::error;

pub mod bindings;
mod color;
pub mod colored_mesh;
mod cursor;
mod data_uri;
pub mod depth;
mod depth_image;
pub mod exif;
mod exr;
mod file_camera;
mod gltf;
pub mod guard;
mod jpeg;
pub mod mask;
pub mod mesh;
mod mesh_builder;
mod mesh_format;
mod mtl;
mod npy;
mod npz;
mod obj;
pub mod orientation;
mod painted_mesh;
mod pfm;
pub mod photo;
pub mod ply;
mod ply_header;
mod ply_names;
mod png;
mod point_map;
mod polygon;
mod reducer;
pub mod resources;
pub mod splats;
mod stl;
pub mod text;
mod texture;
mod tiff;
pub mod webp;
