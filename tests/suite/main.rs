//! All Rust tests in one binary: natively under `cargo test`, in Node under wasm-bindgen-test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod normals;
pub mod sample;
pub mod shapes;
pub mod symmetric_eigen;
