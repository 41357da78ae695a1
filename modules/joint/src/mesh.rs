//! The cache of prepared meshes, which this module fills when it first reads them.

use sim3align::bindings::mesh::drop_kept;
use wasm_bindgen::prelude::*;

/// Removes the mesh with this id from the cache, if present.
#[wasm_bindgen(js_name = dropMesh, skip_typescript)]
pub fn drop_mesh(id: u32) {
    drop_kept(id);
}
