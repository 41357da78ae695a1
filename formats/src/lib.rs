//! File readers: meshes, depth maps, masks, cameras and true poses.
//!
//! Readers take bytes. For malicious input, they return a value or an error, and allocate memory in proportion to the
//! input or up to a stated limit.

pub mod bindings;
mod cursor;
pub mod depth;
pub mod gltf;
pub mod guard;
pub mod mask;
pub mod mesh;
mod mesh_builder;
mod npy;
mod obj;
pub mod ply;
mod ply_header;
mod png;
mod stl;
pub mod text;
