//! Known poses from JSON: a case's `gt.json`, or any file with a similarity in it.

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

use crate::error::{Error, ErrorCode, Result};
use crate::formats::json;
use crate::geometry::similarity::Similarity;

/// Reads a true pose x_cam = scale · R · p_mesh + translation (metres) and the object's declared symmetry, in words:
/// `{available, scale, rotation, translation, symmetry}` where `rotation` is 3×3 row-major, 9 numbers row-major or a
/// quaternion x, y, z, w; or `{matrix}`, 16 numbers column-major. `None` where `available` is false.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] for what is no JSON, [`ErrorCode::InvalidTransform`] for what is no similarity.
pub fn read_truth(bytes: &[u8]) -> Result<Option<(Similarity, String)>> {
    let value = json::parse("truth", bytes)?;
    if value.get("available").and_then(Value::as_bool) == Some(false) {
        return Ok(None);
    }
    let symmetry = value.get("symmetry").and_then(Value::as_str).unwrap_or("unknown");
    Ok(Some((similarity(&value)?, symmetry.into())))
}

/// The similarity that a JSON object holds, in one of the forms that [`read_truth`] lists.
fn similarity(value: &Value) -> Result<Similarity> {
    if let Some(matrix) = value.get("matrix") {
        let matrix = json::numbers(matrix).ok_or_else(|| invalid("matrix", "16 numbers, column by column"))?;
        return Similarity::from_column_major(&matrix);
    }
    let scale = value.get("scale").and_then(Value::as_f64).ok_or_else(|| invalid("scale", "a number"))?;
    let translation = value.get("translation").and_then(json::numbers::<3>);
    let translation = translation.ok_or_else(|| invalid("translation", "3 numbers, metres"))?;
    let rotation = value.get("rotation").ok_or_else(|| invalid("rotation", "a rotation"))?;
    let rotation = if let Some(rows) = json::numbers::<9>(rotation) {
        Matrix3::from_row_slice(&rows)
    } else if let Some(xyzw) = json::numbers(rotation) {
        Similarity::rotation_from_xyzw(&xyzw)?
    } else {
        return Err(invalid("rotation", "3 × 3 numbers row by row, or a quaternion x, y, z, w"));
    };
    Similarity::from_parts(scale, rotation, Vector3::from(translation))
}

fn invalid(name: &str, expected: &str) -> Error {
    Error::new(
        ErrorCode::InvalidTransform,
        format!("truth.{name}"),
        "nothing, or something else",
        expected.to_owned(),
        "Write { scale, rotation, translation } or { matrix }; x_cam = scale · R · p_mesh + translation.",
    )
}
