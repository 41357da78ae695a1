//! Geometry that the aligner and the file readers share: meshes, clouds, images, cameras, transforms, search trees and
//! the rasteriser.
//!
//! Two linear algebra crates divide the work. glam: f32 and f64 vectors in the hot loops over pixels, points and
//! triangles, and all stored coordinates. nalgebra: transforms ([`similarity::Similarity`]), and solvers
//! ([`normal_equations`], [`singular_values`]). Both run without platform mathematics (`libm`), so that native and
//! WebAssembly results have the same bits.

pub mod angle;
pub mod clip;
pub mod cloud;
pub mod components;
pub mod curve;
pub mod decimate;
pub mod depth_kind;
pub mod disjoint_sets;
pub mod distance_transform;
pub mod image;
mod kd_nodes;
pub mod kd_tree;
pub mod mesh;
pub mod mesh_parts;
pub mod normal_equations;
pub mod order;
pub mod pinhole;
pub mod random;
pub mod rasteriser;
pub mod rotations;
pub mod similarity;
pub mod singular_values;
pub mod surface;
pub mod surface_colors;
pub mod symmetric_eigen;
mod triangle_block;
pub mod triangle_tree;
pub mod voxel_grid;

#[cfg(not(any(target_arch = "wasm32", target_arch = "x86_64", target_arch = "aarch64")))]
compile_error!("the results are tested to have the same bits on wasm32, x86_64 and aarch64 only");
#[cfg(target_feature = "relaxed-simd")]
compile_error!("relaxed SIMD gives other bits on other machines: build with simd128 alone");
