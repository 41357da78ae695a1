//! Depth images of posed meshes, for pictures of results.

use js_sys::Float32Array;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::object::{get, size};
use sim3align::bindings::{input, mesh, transform};
use sim3align::geometry::image::check_size;
use sim3align::geometry::rasteriser::Rasteriser;
use wasm_bindgen::prelude::*;

/// Most pixels of an image: 64 MB of depth, and as much for the copy.
const MAX_PIXELS: usize = 1 << 24;

/// The depth of a mesh at a pose: `({ mesh, width, height, camera }, transform) → Float32Array`, in metres, 0 where no
/// mesh is.
#[wasm_bindgen(js_name = renderDepth, skip_typescript)]
pub fn render_depth(view: &JsValue, transform: &JsValue) -> Result<Float32Array, JsValue> {
    let run = || {
        let camera = input::camera(&get(view, "camera").unwrap_or(JsValue::UNDEFINED))?;
        let side = |name| size(view, name).map(Option::unwrap_or_default);
        let (width, height) = (side("width")?, side("height")?);
        check_size("image", width, height, width.saturating_mul(height).min(MAX_PIXELS))?;
        let camera_from_mesh = transform::similarity(transform, "transform")?;
        let prepared = mesh::mesh_of(view)?;
        let mut rasteriser = Rasteriser::new();
        rasteriser.render(prepared.whole(), &camera_from_mesh, &camera, width, height);
        Ok(Float32Array::from(rasteriser.depth()))
    };
    run().map_err(|error| to_js(&error))
}
