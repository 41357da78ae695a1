//! The drawing of a mesh: its resolutions, its poses, and their images.
//!
//! In: a mesh and a [`CropPose`](pose::CropPose). Out: its image on the cells of a [`CropGrid`](super::observation::grid::CropGrid),
//! depth and triangle by cell, in a [`Canvas`](render::Canvas). A cell is filled if the ray through its centre meets a
//! triangle; images have the same bits natively and in WebAssembly, with and without SIMD.

pub mod equivalence;
pub mod facing;
mod fill;
pub mod ground_plate;
pub(super) mod lanes;
pub mod mesh_pyramid;
pub mod pose;
pub mod prepared_mesh;
pub mod removed_parts;
pub mod render;
pub mod stable_poses;
pub mod turns;
