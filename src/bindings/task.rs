//! An alignment in steps, between which the thread can do other work.

use core::cell::RefCell;
use std::rc::Rc;

use js_sys::Function;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use super::aligner::answer;
use super::error::to_js;
use super::host::{JsHost, now_ms};
use super::{input, mesh, options};
use crate::align::task::AlignTask as Task;
use crate::evidence::observation::Observation;
use crate::precise::prepared_mesh::PreparedMesh;

/// A running alignment.
#[wasm_bindgen(skip_typescript)]
pub struct AlignTask(RefCell<Task<'static, Observation, Rc<PreparedMesh<'static>>>>);

/// Starts an alignment; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(js_name = beginAlign, skip_typescript)]
pub fn begin_align(input: &JsValue, options: &JsValue, on_progress: Option<Function>) -> Result<AlignTask, JsValue> {
    let begin = || {
        let method = options::method(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        Task::new(observation, mesh, method, JsHost::new(on_progress))
    };
    begin().map(|task| AlignTask(RefCell::new(task))).map_err(|error| to_js(&error))
}

#[wasm_bindgen]
impl AlignTask {
    /// Runs for about `slice_ms` milliseconds. Returns the alignment when finished, otherwise `undefined`.
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> Result<JsValue, JsValue> {
        let end = now_ms() + slice_ms;
        let stepped = self.0.borrow_mut().step(&mut || now_ms() >= end);
        match stepped {
            Ok(None) => Ok(JsValue::UNDEFINED),
            Ok(Some(alignment)) => answer(Ok(alignment)),
            Err(error) => Err(to_js(&error)),
        }
    }
}
