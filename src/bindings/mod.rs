//! Conversion and validation of arguments and results, for the exports in `modules/`; no logic. Only this module uses
//! `wasm_bindgen`.

pub mod answer;
pub mod helpers;
pub mod host;
pub mod input;
pub mod mesh;
pub mod object;
pub mod options;
pub mod transform;
