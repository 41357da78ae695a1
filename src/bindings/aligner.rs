//! The aligner's exports: each reads its arguments, calls the core, and hands back a plain object.

use js_sys::Function;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::prelude::*;

use super::error::to_js;
use super::host::JsHost;
use super::value::Value;
use super::{input, object, options, transform};
use crate::align::evaluate::EvaluateOptions;
use crate::align::options::{AlignOptions, EstimateOptions, RegisterOptions};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::Observation;
use crate::geometry::mesh::Mesh;
use crate::{align, register};

/// Aligns a mesh to an observation; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn align(
    input: &JsValue,
    options: &JsValue,
    on_progress: Option<Function>,
) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let (observation, mesh, options) = case(input, options)?;
        align::align(&observation, &mesh, &options, &mut JsHost::new(on_progress))
    };
    answer(run())
}

/// What an alignment is about.
#[inline(never)]
pub(super) fn case(input: &JsValue, options: &JsValue) -> Result<(Observation, Mesh, AlignOptions)> {
    let options = options::options(options, &[])?;
    Ok((input::observation(input)?, input::mesh(input)?, options))
}

/// Scores a transform; see `Aligner.evaluate` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn evaluate(input: &JsValue, transform: &JsValue, options: &JsValue) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let truth = options::truth(options)?;
        let options: EvaluateOptions = options::options(options, &["truth", "symmetry"])?;
        let camera_from_mesh = transform::similarity(transform, "transform")?;
        let (observation, mesh) = (input::observation(input)?, input::mesh(input)?);
        align::evaluate::evaluate(&observation, &mesh, &camera_from_mesh, truth.as_ref(), &options)
    };
    answer(run())
}

/// Aligns two point clouds; see `Aligner.register` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn register(source: &JsValue, target: &JsValue, options: &JsValue) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let scale = options::scale(options)?;
        let options: RegisterOptions = options::options(options, &["scale"])?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        register::register(&source, &target, scale, &options, &mut JsHost::new(None))
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
        let scale = options::scale(options)?;
        let options: EstimateOptions = options::options(options, &["scale"])?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        let correspondences = object::to_u32s(correspondences, "correspondences")?;
        register::estimate_sim3(&source, &target, &correspondences, scale, &options, &mut JsHost::new(None))
    };
    answer(run())
}

/// The default options of every entry point.
#[wasm_bindgen(skip_typescript)]
pub fn defaults() -> JsValue {
    options::object_of([
        ("align", options::defaults::<AlignOptions>()),
        ("evaluate", options::defaults::<EvaluateOptions>()),
        ("register", options::defaults::<RegisterOptions>()),
        ("estimateSim3", options::defaults::<EstimateOptions>()),
    ])
}

/// The crate's version.
#[wasm_bindgen(skip_typescript)]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// What JavaScript gets: the result as a plain object, or the error to be thrown.
pub(super) fn answer<T: Serialize>(result: Result<T>) -> core::result::Result<JsValue, JsValue> {
    to_object(result.map(|value| Value::of(&value)))
}

#[inline(never)]
fn to_object(result: Result<Value>) -> core::result::Result<JsValue, JsValue> {
    let serializer = Serializer::json_compatible();
    result
        .and_then(|value| {
            value.serialize(&serializer).map_err(|e| {
                let remedy = "This is a fault of the package: please report it.";
                Error::new(ErrorCode::Internal, "result", e.to_string(), "a serialisable result", remedy)
            })
        })
        .map_err(|e| to_js(&e))
}
