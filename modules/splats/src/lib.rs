//! The export of the module that makes meshes of 3D Gaussian splats.

use sim3align_formats::bindings::{mesh_arrays, to_bytes, to_js};
use sim3align_formats::splats::read_splats as mesh_from_bytes;
use wasm_bindgen::prelude::*;

/// Reads a PLY or `.splat` file of 3D Gaussians as a mesh of their surface:
/// `(bytes, withColors) → { positions, indices, samples, warnings }`.
#[wasm_bindgen(js_name = readSplats, skip_typescript)]
pub fn read_splats(bytes: &JsValue, with_colors: bool) -> Result<JsValue, JsValue> {
    let read = || mesh_from_bytes(&to_bytes("mesh", bytes)?, with_colors);
    read().map(|mesh| mesh_arrays(&mesh)).map_err(|error| to_js(&error))
}
