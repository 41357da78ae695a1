//! All Rust tests in one binary: natively under `cargo test`, in Node under wasm-bindgen-test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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
