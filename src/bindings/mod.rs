//! What JavaScript sees. Converts and checks; holds no logic. The only place that knows `wasm_bindgen`.

#[cfg(feature = "aligner")]
pub mod aligner;
pub mod error;
#[cfg(feature = "formats")]
pub mod formats;
#[cfg(feature = "aligner")]
mod host;
#[cfg(feature = "aligner")]
mod input;
#[cfg(feature = "aligner")]
mod object;
#[cfg(feature = "aligner")]
mod options;
#[cfg(feature = "aligner")]
mod transform;

/// Two-level segregated fit, constant time to get and to give back: a fifth of the standard allocator's bytes.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: rlsf::SmallGlobalTlsf = rlsf::SmallGlobalTlsf::new();
