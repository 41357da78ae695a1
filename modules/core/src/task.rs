//! An alignment in steps, between which the thread can do other work, and its helpers in other threads.

use core::cell::RefCell;
use std::rc::Rc;

use js_sys::Function;
use sim3align::align::align_task;
use sim3align::align::helper::Helper;
use sim3align::align::search::Request;
use sim3align::bindings::answer::step_answer;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::helpers::{JsHelpers, scheduler, step};
use sim3align::bindings::host::{JsHost, now_ms};
use sim3align::bindings::{input, mesh, options};
use sim3align::error::Error;
use sim3align::evidence::observation::Observation;
use sim3align::precise::drawing::prepared_mesh::PreparedMesh;
use sim3align::precise::options::AlignOptions;
use sim3align::report::Alignment;
use sim3align::scheduler::Task;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A running alignment.
#[wasm_bindgen(skip_typescript)]
pub struct AlignTask(RefCell<Task<'static, Alignment>>);

/// The arguments of an alignment.
#[inline(never)]
fn given(input: &JsValue, options: &JsValue) -> Result<(Observation, Rc<PreparedMesh<'static>>, AlignOptions), Error> {
    let options = options::precise(options)?;
    Ok((input::observation(input)?, mesh::mesh_of(input)?, options))
}

/// Starts an alignment; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(js_name = beginAlign, skip_typescript)]
pub fn begin_align(
    input: &JsValue,
    options: &JsValue,
    on_progress: Option<Function>,
    helpers: Option<JsHelpers>,
) -> Result<AlignTask, JsValue> {
    let begin = || {
        let (observation, mesh, options) = given(input, options)?;
        align_task(observation, mesh, options, JsHost::new(on_progress), scheduler(helpers))
    };
    begin().map(|task| AlignTask(RefCell::new(task))).map_err(|error| to_js(&error))
}

#[wasm_bindgen]
impl AlignTask {
    /// Runs for about `slice_ms` milliseconds. Returns the alignment when finished, otherwise `undefined`.
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> Result<JsValue, JsValue> {
        step_answer(self.0.borrow_mut().step(now_ms() + slice_ms))
    }
}

/// A helper of an alignment.
#[wasm_bindgen(skip_typescript)]
pub struct AlignHelper(RefCell<Helper>);

/// Prepares a helper of the alignment that [`begin_align`] starts with the same input and options.
#[wasm_bindgen(js_name = beginHelp, skip_typescript)]
pub fn begin_help(input: &JsValue, options: &JsValue) -> Result<AlignHelper, JsValue> {
    let begin = || {
        let (observation, mesh, options) = given(input, options)?;
        Ok(Helper::new(vec![Some(observation)], mesh, Request::new(options)?, |_| ()))
    };
    begin().map(|helper| AlignHelper(RefCell::new(helper))).map_err(|error: Error| to_js(&error))
}

#[wasm_bindgen]
impl AlignHelper {
    /// Reads a message of the alignment.
    #[wasm_bindgen(skip_typescript)]
    pub fn receive(&self, message: &[f64]) {
        self.0.borrow_mut().receive(message);
    }

    /// See [`step`].
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> JsValue {
        step(&mut self.0.borrow_mut(), slice_ms)
    }
}
