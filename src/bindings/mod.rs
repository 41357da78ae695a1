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
