//! The exports of the core module. Each reads its arguments, calls the crate `sim3align`, and returns a plain object.

pub mod render;
pub mod task;

use sim3align::align::evaluate::evaluate_prepared;
use sim3align::bindings::answer::{answer, to_js};
use sim3align::bindings::{input, mesh, options, transform};
use sim3align::precise::search::start;
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

/// Validates and decimates a mesh, and caches it under its `id`; see `Aligner.prepareMesh` in the TypeScript package.
#[wasm_bindgen(js_name = prepareMesh, skip_typescript)]
pub fn prepare_mesh(given: &JsValue) -> Result<(), JsValue> {
    mesh::mesh(given).and_then(|mesh| start::prepare_mesh(&mesh)).map_err(|error| to_js(&error))
}

/// Removes the mesh with this id from the cache, if present.
#[wasm_bindgen(js_name = dropMesh, skip_typescript)]
pub fn drop_mesh(id: u32) {
    mesh::drop_kept(id);
}
