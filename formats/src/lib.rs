//! Files in, core types out: meshes, depth maps, masks, cameras, true poses.
//!
//! Every reader takes bytes and is safe on hostile ones: it ends in a value or a typed error, and allocates in
//! proportion to the bytes it was given or up to a stated limit.

pub mod bindings;
pub mod camera;
mod cursor;
pub mod depth;
pub mod gltf;
pub mod guard;
pub mod json;
pub mod mask;
pub mod mesh;
mod mesh_builder;
mod npy;
mod obj;
pub mod ply;
mod ply_header;
mod png;
pub mod rle;
mod stl;
pub mod text;
pub mod truth;
