//! Errors in the form that the modules throw.

use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

use crate::error::Error;

/// A plain object `{ code, argument, found, expected, remedy }`, which the TypeScript package converts to a
/// `Sim3AlignError`.
pub fn to_js(error: &Error) -> JsValue {
    error.serialize(&Serializer::json_compatible()).unwrap_or_else(Into::into)
}
