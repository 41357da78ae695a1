//! Exports to JavaScript: conversion and validation, no logic. Only this module uses `wasm_bindgen`.

pub mod aligner;
pub mod error;
mod host;
mod input;
pub mod mesh;
mod object;
mod options;
pub mod task;
mod transform;

/// Two-level segregated fit allocator: constant time, and a fifth of the code size of the standard allocator.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: rlsf::SmallGlobalTlsf = rlsf::SmallGlobalTlsf::new();
