//! The exports of the joint module: several objects in one view, one object in several views, and through a video. Each reads
//! its arguments, calls the crate `sim3align`, and returns a plain object.

pub mod calibrate;
pub mod scene;
pub mod task;
pub mod track;
pub mod views;

use sim3align::bindings::mesh::drop_kept;
use wasm_bindgen::prelude::*;

/// Removes the mesh with this id from the cache, if present: this module fills it when it first reads a mesh.
#[wasm_bindgen(js_name = dropMesh, skip_typescript)]
pub fn drop_mesh(id: u32) {
    drop_kept(id);
}
