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
