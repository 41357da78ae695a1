//! The Rust tests, as WebAssembly in Node. `tests/native` has those that run natively.
#![cfg(target_arch = "wasm32")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// As WebAssembly, the tests' helpers count as public.
#![allow(missing_docs)]

pub mod align;
pub mod arguments;
pub mod calibrate;
pub mod color;
pub mod fingerprints;
pub mod fixtures;
pub mod geometry;
pub mod gltf;
pub mod hostile_files;
pub mod image_files;
pub mod images;
pub mod mesh_colors;
pub mod mesh_faults;
pub mod mesh_files;
pub mod metrics;
pub mod observations;
pub mod option_effects;
pub mod pose_errors;
pub mod prelude;
pub mod rasteriser;
pub mod refine;
pub mod register;
pub mod scene;
pub mod score;
pub mod shapes;
pub mod support;
pub mod track;
pub mod trees;
pub mod views;
