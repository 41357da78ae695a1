//! The exports of the registration module: `register`, `estimateSim3` and the preset `paper`, which all match descriptors,
//! and the pose errors of BOP.
//! Each reads its arguments, calls the crate `sim3align`, and returns a plain object.

pub mod bop;

use js_sys::Function;
use sim3align::align;
use sim3align::bindings::answer::answer;
use sim3align::bindings::host::JsHost;
use sim3align::bindings::{input, mesh, object, options};
use sim3align::register;
use wasm_bindgen::prelude::*;

/// Aligns a mesh with an observation by the method of the paper; see `Aligner.align` in the TypeScript package.
#[wasm_bindgen(js_name = alignPaper, skip_typescript)]
pub fn align_paper(input: &JsValue, options: &JsValue, on_progress: Option<Function>) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::paper(options)?;
        let (observation, mesh) = (input::observation(input)?, mesh::mesh_of(input)?);
        align::align_paper(&observation, mesh.mesh(), &options, &mut JsHost::new(on_progress))
    };
    answer(run())
}

/// Aligns two point clouds; see `Aligner.register` in the TypeScript package.
#[wasm_bindgen(skip_typescript)]
pub fn register(source: &JsValue, target: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
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
) -> Result<JsValue, JsValue> {
    let run = || {
        let options = options::options(options, &options::OF_CALLS, |_| None)?;
        let (source, target) = (object::to_f64s(source, "source")?, object::to_f64s(target, "target")?);
        let correspondences = object::to_u32s(correspondences, "correspondences")?;
        register::estimate_sim3(&source, &target, &correspondences, &options, &mut JsHost::new(None))
    };
    answer(run())
}
