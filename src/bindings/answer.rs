//! Results in the form that the modules return.

use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::JsValue;

use super::error::to_js;
use crate::error::Result;

/// The result as a plain object, or the error to throw.
pub fn answer<T: Serialize>(result: Result<T>) -> core::result::Result<JsValue, JsValue> {
    let value = result.map_err(|error| to_js(&error))?;
    value.serialize(&Serializer::json_compatible()).map_err(Into::into)
}

/// The result of a step of a task: `undefined` until the task has ended.
pub fn step_answer<T: Serialize>(step: Result<Option<T>>) -> core::result::Result<JsValue, JsValue> {
    step.transpose().map_or(Ok(JsValue::UNDEFINED), answer)
}
