//! The tests of convex parts, mass and rest, as WebAssembly in Node.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bodies;
mod masses;
mod scene;
mod solids;
