//! Evaluation, and the version.

use sim3align::align::evaluate::evaluate_prepared;
use sim3align::bindings::answer::answer;
use sim3align::bindings::{input, mesh, options, transform};
use wasm_bindgen::prelude::*;

/// Computes the metrics of a transform; see `Aligner.evaluate` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn evaluate(input: &JsValue, transform: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let camera_from_mesh = transform::similarity(transform, "transform")?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        evaluate_prepared(&observation, &mesh, &camera_from_mesh, &options)
    };
    answer(run())
}

/// The version of the crate.
#[wasm_bindgen(skip_typescript)]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}
