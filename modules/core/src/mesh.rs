//! The cache of prepared meshes.

use sim3align::bindings::error::to_js;
use sim3align::bindings::mesh::{drop_kept, mesh};
use sim3align::precise::search::start;
use wasm_bindgen::prelude::*;

/// Validates and decimates a mesh, and caches it under its `id`; see `Aligner.prepareMesh` in the TypeScript package.
#[wasm_bindgen(js_name = prepareMesh, skip_typescript)]
pub fn prepare_mesh(given: &JsValue) -> Result<(), JsValue> {
    mesh(given).and_then(|mesh| start::prepare_mesh(&mesh)).map_err(|error| to_js(&error))
}

/// Removes the mesh with this id from the cache, if present.
#[wasm_bindgen(js_name = dropMesh, skip_typescript)]
pub fn drop_mesh(id: u32) {
    drop_kept(id);
}
