//! `camera.json` of a case folder. Other camera files are read by the package's TypeScript alone.

use serde_json::Value;

use super::json;
use crate::prelude::*;

/// The intrinsics in pixels, and metres per unit of integer depth, where the file states it.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] for other content than `{fx, fy, cx, cy, width?, height?, depthScale?}`,
/// [`ErrorCode::InvalidCamera`], [`ErrorCode::SizeMismatch`] for another size than that of the image, in pixels.
pub fn read_camera(bytes: &[u8], [width, height]: [usize; 2]) -> Result<Pinhole> {
    let value = json::parse("camera", bytes)?;
    let number = |name: &str| value.get(name).and_then(Value::as_f64);
    let stated = [("width", width), ("height", height)].map(|(name, side)| number(name).unwrap_or(side as f64));
    if stated != [width as f64, height as f64] {
        return Err(Error::new(
            ErrorCode::SizeMismatch,
            "camera",
            format!("intrinsics for {} × {} pixels", stated[0], stated[1]),
            format!("intrinsics of the image, {width} × {height}"),
            "Scale fx, cx by the ratio of the widths and fy, cy by that of the heights.",
        ));
    }
    let [Some(fx), Some(fy), Some(cx), Some(cy)] = ["fx", "fy", "cx", "cy"].map(number) else {
        return Err(json::corrupt("camera", json::found(Some(&value)), "{ fx, fy, cx, cy, width, height }"));
    };
    Pinhole::new(fx, fy, cx, cy)
}

/// Metres per unit of integer depth: `depthScale`, or BOP's `depth_scale`, which is in millimetres. `None` where the file
/// states neither.
pub fn depth_scale(bytes: &[u8]) -> Option<f64> {
    let value = json::parse("camera", bytes).ok()?;
    let number = |name: &str| value.get(name).and_then(Value::as_f64);
    number("depthScale").or_else(|| number("depth_scale").map(|millimetres| millimetres / 1000.0))
}
