//! The exports of the registration module: `register`, `estimateSim3` and the preset `paper`, which all match descriptors.
//! Each reads its arguments, calls the crate `sim3align`, and returns a plain object.

use core::cell::RefCell;

use js_sys::Function;
use sim3align::align;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::answer::{answer, step_answer};
use sim3align::bindings::host::{JsHost, now_ms};
use sim3align::bindings::{input, mesh, object, options};
use sim3align::register;
use sim3align::register::report::Registration;
use sim3align::scheduler::Task;
use wasm_bindgen::prelude::*;

/// Aligns a mesh with an observation by the method of the paper; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(js_name = alignPaper, skip_typescript)]
pub fn align_paper(input: &JsValue, options: &JsValue, on_progress: Option<Function>) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::paper(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        align::align_paper(&observation, mesh.whole(), &options, &mut JsHost::new(on_progress))
    };
    answer(run())
}

/// A running registration.
#[wasm_bindgen(skip_typescript)]
pub struct RegistrationTask(RefCell<Task<'static, Registration>>);

/// Starts to align two point clouds; see `Aligner.register` in the TypeScript package.
#[wasm_bindgen(js_name = beginRegister, skip_typescript)]
pub fn begin_register(source: &JsValue, target: &JsValue, options: &JsValue) -> Result<RegistrationTask, JsValue> {
    let begin = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        register::register_task(source, target, options, JsHost::new(None), now_ms)
    };
    begin().map(|task| RegistrationTask(RefCell::new(task))).map_err(|error| to_js(&error))
}

/// Starts to estimate a similarity from correspondences; see `Aligner.estimateSim3` in the TypeScript package.
#[wasm_bindgen(js_name = beginEstimateSim3, skip_typescript)]
pub fn begin_estimate_sim3(
    source: &JsValue,
    target: &JsValue,
    correspondences: &JsValue,
    options: &JsValue,
) -> Result<RegistrationTask, JsValue> {
    let begin = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        let correspondences = object::to_u32s(correspondences, "correspondences")?;
        register::estimate_sim3_task(source, target, correspondences, options, JsHost::new(None), now_ms)
    };
    begin().map(|task| RegistrationTask(RefCell::new(task))).map_err(|error| to_js(&error))
}

#[wasm_bindgen]
impl RegistrationTask {
    /// Runs for about `slice_ms` milliseconds. Returns the result when finished, otherwise `undefined`.
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> Result<JsValue, JsValue> {
        step_answer(self.0.borrow_mut().step(now_ms() + slice_ms))
    }
}
