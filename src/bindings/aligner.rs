//! The exports of the aligner. Each reads its arguments, calls the core, and returns a plain object.

use js_sys::Function;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::prelude::*;

use super::error::to_js;
use super::host::JsHost;
use super::{input, mesh, object, options, transform};
use crate::align::task::AlignTask;
use crate::error::Result;
use crate::{align, register};

/// Aligns a mesh with an observation; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn align(
    input: &JsValue,
    options: &JsValue,
    on_progress: Option<Function>,
) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let method = options::method(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        AlignTask::new(observation, mesh, method, JsHost::new(on_progress))?.finish()
    };
    answer(run())
}

/// Computes the metrics of a transform; see `Aligner.evaluate` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn evaluate(input: &JsValue, transform: &JsValue, options: &JsValue) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let camera_from_mesh = transform::similarity(transform, "transform")?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        align::evaluate::evaluate_prepared(&observation, &mesh, &camera_from_mesh, &options)
    };
    answer(run())
}

/// Aligns two point clouds; see `Aligner.register` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn register(source: &JsValue, target: &JsValue, options: &JsValue) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        register::register(&source, &target, &options, &mut JsHost::new(None))
    };
    answer(run())
}

/// Estimates a similarity from correspondences; see `Aligner.estimateSim3` in the TypeScript package.
#[wasm_bindgen(js_name = estimateSim3, skip_typescript)]
pub fn estimate_sim3(
    source: &JsValue,
    target: &JsValue,
    correspondences: &JsValue,
    options: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        let correspondences = object::to_u32s(correspondences, "correspondences")?;
        register::estimate_sim3(&source, &target, &correspondences, &options, &mut JsHost::new(None))
    };
    answer(run())
}

/// The version of the crate.
#[wasm_bindgen(skip_typescript)]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// The result as a plain object, or the error to throw.
pub(super) fn answer<T: Serialize>(result: Result<T>) -> core::result::Result<JsValue, JsValue> {
    let value = result.map_err(|error| to_js(&error))?;
    value.serialize(&Serializer::json_compatible()).map_err(Into::into)
}
