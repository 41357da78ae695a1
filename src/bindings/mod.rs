//! What JavaScript sees. Converts and checks; holds no logic. The only place that knows `wasm_bindgen`.

pub mod aligner;
pub mod error;
mod host;
mod input;
pub mod mesh;
mod object;
mod options;
pub mod task;
mod transform;

/// Two-level segregated fit, constant time to get and to give back: a fifth of the standard allocator's bytes.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: rlsf::SmallGlobalTlsf = rlsf::SmallGlobalTlsf::new();
