//! Errors as the modules throw them.

use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

use crate::error::Error;

/// A plain object `{ code, argument, found, expected, remedy }`, of which the TypeScript package makes its
/// `Sim3AlignError`.
pub fn to_js(error: &Error) -> JsValue {
    error.serialize(&Serializer::json_compatible()).unwrap_or_else(Into::into)
}
