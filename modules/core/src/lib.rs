//! The exports of the core module. Each reads its arguments, calls the crate `sim3align`, and returns a plain object.

pub mod aligner;
pub mod mesh;
pub mod render;
pub mod task;
