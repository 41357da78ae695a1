//! What JavaScript sees. Converts and checks; holds no logic. The only place that knows `wasm_bindgen`.

pub mod error;
#[cfg(feature = "formats")]
pub mod formats;
