//! Alignment and evaluation.

use js_sys::Function;
use sim3align::align;
use sim3align::align::task::AlignTask;
use sim3align::bindings::answer::answer;
use sim3align::bindings::host::JsHost;
use sim3align::bindings::{input, mesh, options, transform};
use wasm_bindgen::prelude::*;

/// Aligns a mesh with an observation; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn align(input: &JsValue, options: &JsValue, on_progress: Option<Function>) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::precise(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        AlignTask::new(observation, mesh, options, JsHost::new(on_progress))?.finish()
    };
    answer(run())
}

/// Computes the metrics of a transform; see `Aligner.evaluate` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn evaluate(input: &JsValue, transform: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let camera_from_mesh = transform::similarity(transform, "transform")?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        align::evaluate::evaluate_prepared(&observation, &mesh, &camera_from_mesh, &options)
    };
    answer(run())
}

/// The version of the crate.
#[wasm_bindgen(skip_typescript)]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}
