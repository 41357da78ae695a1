//! The tests of convex parts, mass and rest, as WebAssembly in Node.
#![cfg(target_arch = "wasm32")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bodies;
mod scene;
mod solids;
