//! All Rust tests in one binary: natively under `cargo test`, in Node under wasm-bindgen-test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// As WebAssembly, the tests' own helpers count as public.
#![allow(missing_docs)]

pub mod align;
pub mod angle;
#[cfg(feature = "baselines")]
pub mod baselines;
#[cfg(feature = "baselines")]
pub mod baselines_agreement;
#[cfg(feature = "baselines")]
pub mod baselines_solvers;
pub mod density;
pub mod determinism;
pub mod distance_transform;
#[cfg(all(feature = "samples", not(target_arch = "wasm32")))]
pub mod evaluation;
pub mod extents;
pub mod filter;
#[cfg(feature = "formats")]
pub mod formats_bindings;
#[cfg(feature = "formats")]
pub mod formats_case;
#[cfg(feature = "formats")]
pub mod formats_fixtures;
#[cfg(feature = "formats")]
pub mod formats_gltf;
#[cfg(feature = "formats")]
pub mod formats_hostile;
#[cfg(feature = "formats")]
pub mod formats_images;
#[cfg(feature = "formats")]
pub mod formats_json;
#[cfg(feature = "formats")]
pub mod formats_mesh;
pub mod fpfh;
pub mod icp;
pub mod image;
#[cfg(all(feature = "bench", not(target_arch = "wasm32")))]
pub mod imported;
pub mod kd_tree;
pub mod matching;
pub mod mesh;
pub mod metrics;
pub mod normal_equations;
pub mod normals;
pub mod number;
pub mod observe;
pub mod order;
#[cfg(all(feature = "samples", not(target_arch = "wasm32")))]
pub mod overlay;
pub mod pinhole;
pub mod pose_error;
pub mod precise;
pub mod ransac;
pub mod rasteriser;
pub mod rasteriser_oracle;
pub mod rasteriser_seams;
#[cfg(all(feature = "formats", not(target_arch = "wasm32")))]
pub mod real_cases;
#[cfg(all(feature = "samples", not(target_arch = "wasm32")))]
pub mod records;
pub mod register;
#[cfg(all(feature = "bench", not(target_arch = "wasm32")))]
pub mod registration;
#[cfg(all(feature = "bench", not(target_arch = "wasm32")))]
pub mod registration_program;
pub mod sample;
#[cfg(all(feature = "samples", not(target_arch = "wasm32")))]
pub mod samples;
#[cfg(all(feature = "samples", not(target_arch = "wasm32")))]
pub mod scenes;
pub mod search;
pub mod shapes;
pub mod silhouette;
pub mod similarity;
pub mod singular_values;
pub mod support;
pub mod surface;
pub mod symmetric_eigen;
pub mod triangle_tree;
pub mod tukey;
#[cfg(all(feature = "types", not(target_arch = "wasm32")))]
pub mod typescript;
pub mod umeyama;
pub mod voxel_grid;
