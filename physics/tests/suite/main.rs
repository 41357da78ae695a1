//! The tests of convex parts, mass and rest, in one binary: natively, and in Node under wasm-bindgen-test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// As WebAssembly, the tests' own helpers count as public.
#![allow(missing_docs)]

pub mod degenerate;
pub mod mass;
pub mod parts;
pub mod rest;
pub mod scene;
pub mod solids;
