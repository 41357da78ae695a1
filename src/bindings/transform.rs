//! Similarity transforms from JavaScript.

use js_sys::{Array, Float32Array, Float64Array};
use nalgebra::{Matrix3, Vector3};
use wasm_bindgen::{JsCast, JsValue};

use super::object::{get, required_number, to_numbers, wrong_type};
use crate::error::Result;
use crate::geometry::similarity::Similarity;

/// `{ scale, rotation, translation }` with a quaternion x, y, z, w or nine numbers, row-major; `{ matrix }` or a bare
/// array of 16 numbers, column-major.
pub fn similarity(value: &JsValue, argument: &str) -> Result<Similarity> {
    // The core names it "transform"; for the caller, it may be "options.truth".
    parse(value, argument).map_err(|e| {
        let renamed = e.argument.strip_prefix("transform").map(|rest| format!("{argument}{rest}"));
        let argument = renamed.map_or_else(|| e.argument.clone(), Into::into);
        e.about(argument)
    })
}

fn parse(value: &JsValue, argument: &str) -> Result<Similarity> {
    let named = |key: &str| format!("{argument}.{key}");
    let is_array =
        Array::is_array(value) || value.is_instance_of::<Float64Array>() || value.is_instance_of::<Float32Array>();
    if is_array {
        Similarity::from_column_major(&to_numbers(value, argument)?)
    } else if let Some(rotation) = get(value, "rotation").or_else(|| get(value, "rotationMatrix")) {
        let translation = get(value, "translation").unwrap_or(JsValue::UNDEFINED);
        Similarity::from_parts(
            required_number(value, argument, "scale")?,
            rotation_matrix(&rotation, &named("rotation"))?,
            Vector3::from(to_numbers::<3>(&translation, &named("translation"))?),
        )
    } else if let Some(matrix) = get(value, "matrix") {
        Similarity::from_column_major(&to_numbers(&matrix, &named("matrix"))?)
    } else {
        let remedy = "Pass a result of align(), or 16 numbers, column-major.";
        Err(wrong_type(argument, value, "{ scale, rotation, translation } or { matrix }", remedy))
    }
}

fn rotation_matrix(value: &JsValue, argument: &str) -> Result<Matrix3<f64>> {
    match to_numbers::<4>(value, argument) {
        Ok(quaternion) => Similarity::rotation_from_xyzw(&quaternion),
        Err(_) => {
            let expected = "a quaternion [x, y, z, w] or a row-major 3 × 3 matrix";
            let rows = to_numbers::<9>(value, argument);
            rows.map(|rows| Matrix3::from_row_slice(&rows)).map_err(|e| e.expecting(expected))
        }
    }
}
