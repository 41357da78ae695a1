//! Results and errors in the form that the modules return and throw.

use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

use crate::error::{Error, Result};

/// The result as a plain object, or the error to throw.
pub fn answer<T: Serialize>(result: Result<T>) -> core::result::Result<JsValue, JsValue> {
    let value = result.map_err(|error| to_js(&error))?;
    value.serialize(&Serializer::json_compatible()).map_err(Into::into)
}

/// The result of a step of a task: `undefined` until the task has ended.
pub fn step_answer<T: Serialize>(step: Result<Option<T>>) -> core::result::Result<JsValue, JsValue> {
    step.transpose().map_or(Ok(JsValue::UNDEFINED), answer)
}

/// A plain object `{ code, argument, found, expected, remedy }`, which the TypeScript package converts to a
/// `Sim3AlignError`.
pub fn to_js(error: &Error) -> JsValue {
    error.serialize(&Serializer::json_compatible()).unwrap_or_else(Into::into)
}
