//! Known poses from JSON: a case's `gt.json`, or any file with a similarity in it.

use serde_json::Value;

use super::json;
use crate::prelude::*;

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
    Ok(Some((similarity("truth", &value)?, symmetry.into())))
}

/// The similarity that a JSON object holds, in one of the forms that [`read_truth`] lists. `argument` names the object
/// in errors.
///
/// # Errors
/// [`ErrorCode::InvalidTransform`].
pub fn similarity(argument: &str, value: &Value) -> Result<Similarity> {
    let part = |name: &str| value.get(name);
    let invalid = |name, expected| invalid(argument, name, part(name), expected);
    if let Some(matrix) = part("matrix") {
        let matrix = json::numbers(matrix).ok_or_else(|| invalid("matrix", "16 numbers, column by column"))?;
        return Similarity::from_column_major(&matrix);
    }
    let scale = part("scale").and_then(Value::as_f64).ok_or_else(|| invalid("scale", "a number"))?;
    let translation = part("translation").and_then(json::numbers::<3>);
    let translation = translation.ok_or_else(|| invalid("translation", "3 numbers, metres"))?;
    let rotation = if let Some(rows) = part("rotation").and_then(json::numbers::<9>) {
        Matrix3::from_row_slice(&rows)
    } else if let Some(xyzw) = part("rotation").and_then(json::numbers) {
        Similarity::rotation_from_xyzw(&xyzw)?
    } else {
        return Err(invalid("rotation", "3 × 3 numbers row by row, or a quaternion x, y, z, w"));
    };
    Similarity::from_parts(scale, rotation, Vector3::from(translation))
}

fn invalid(argument: &str, name: &str, found: Option<&Value>, expected: &str) -> Error {
    Error::new(
        ErrorCode::InvalidTransform,
        format!("{argument}.{name}"),
        json::found(found),
        expected.to_owned(),
        "Write { scale, rotation, translation } or { matrix }; x_cam = scale · R · p_mesh + translation.",
    )
}
