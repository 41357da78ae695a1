//! The Rust tests, as WebAssembly in Node. Natively, only those that are marked `unsupported = test` run: they compare bits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod align;
mod arguments;
mod calibrate;
mod color;
mod facing;
mod fingerprints;
mod fixtures;
mod geometry;
mod gltf;
mod hostile_files;
mod image_files;
mod images;
mod mesh_colors;
mod mesh_faults;
mod mesh_files;
mod metrics;
mod observations;
mod option_effects;
mod pose_errors;
mod prelude;
mod rasteriser;
mod refine;
mod register;
mod scene;
mod score;
mod shapes;
mod support;
mod track;
mod trees;
mod views;
