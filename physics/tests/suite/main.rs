//! The tests of convex parts, mass and rest, as WebAssembly in Node.
#![cfg(target_arch = "wasm32")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
// As WebAssembly, the tests' helpers count as public.
#![allow(missing_docs)]

pub mod bodies;
pub mod scene;
pub mod solids;
