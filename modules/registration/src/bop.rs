//! The pose errors of BOP.

use js_sys::{Array, Float64Array};
use sim3align::bindings::answer::answer;
use sim3align::bindings::object::{get, required_number, to_f64s};
use sim3align::bindings::{input, mesh, transform};
use sim3align::error::Result;
use sim3align::geometry::similarity::Similarity;
use sim3align::metrics::bop::{BopModel, ModelSymmetry, RevolutionAxis, bop_errors, symmetry_transformations};
use wasm_bindgen::prelude::*;

/// The errors of each estimate relative to each true pose, estimate by estimate:
/// `({ depth, …, camera, mesh, diameterM, discrete, continuous }, estimates, truths)`. `discrete` has 16 numbers for each
/// symmetry, row by row, and `continuous` six, axis and offset.
#[wasm_bindgen(js_name = bopErrors, skip_typescript)]
pub fn errors(given: &JsValue, estimates: &Array, truths: &Array) -> core::result::Result<JsValue, JsValue> {
    let run = || {
        let (depth, camera) = input::view(given)?;
        let mesh = mesh::mesh_of(given)?;
        let numbers =
            |name| to_f64s(&get(given, name).unwrap_or_else(|| Float64Array::new_with_length(0).into()), name);
        let discrete =
            numbers("discrete")?.as_chunks::<16>().0.iter().map(ModelSymmetry::from_rows).collect::<Vec<_>>();
        let continuous =
            numbers("continuous")?.as_chunks::<6>().0.iter().map(RevolutionAxis::from_numbers).collect::<Vec<_>>();
        let symmetries = symmetry_transformations(&discrete, &continuous)?;
        let diameter_m = required_number(given, "input", "diameterM")?;
        let model = BopModel { mesh: mesh.whole(), diameter_m, symmetries: &symmetries };
        bop_errors(&model, &depth, &camera, &poses(estimates, "estimates")?, &poses(truths, "truths")?)
    };
    answer(run())
}

fn poses(values: &Array, argument: &str) -> Result<Vec<Similarity>> {
    values.iter().map(|value| transform::similarity(&value, argument)).collect()
}
