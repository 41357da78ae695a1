//! Meshes from JavaScript objects, and those that are kept for many calls.

use core::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use super::error::to_js;
use super::object::{get, to_f32s, to_u32s, wrong_type};
use crate::error::Result;
use crate::geometry::mesh::Mesh;
use crate::precise::prepared_mesh::PreparedMesh;

thread_local! {
    /// The meshes that are kept, by the number that the caller gave them.
    static KEPT: RefCell<BTreeMap<u32, Rc<PreparedMesh<'static>>>> = const { RefCell::new(BTreeMap::new()) };
}

/// `{ positions, indices? }`; with `id`, the mesh is kept under this number, and the arrays are read only where it is not
/// there yet.
#[inline(never)]
pub fn mesh(mesh: &JsValue) -> Result<Rc<PreparedMesh<'static>>> {
    if !mesh.is_object() {
        let remedy = "Pass typed arrays, or a file's bytes to the package's align().";
        return Err(wrong_type("mesh", mesh, "{ positions, indices }", remedy));
    }
    let id = get(mesh, "id").and_then(|id| id.as_f64()).map(|id| id as u32);
    let kept = id.and_then(|id| KEPT.with_borrow(|kept| kept.get(&id).cloned()));
    if let Some(kept) = kept {
        return Ok(kept);
    }
    let positions = to_f32s(&get(mesh, "positions").unwrap_or(JsValue::UNDEFINED), "mesh.positions")?;
    let indices = get(mesh, "indices").map(|indices| to_u32s(&indices, "mesh.indices")).transpose()?;
    let mesh = Rc::new(PreparedMesh::new(Mesh::from_flat(&positions, indices.as_deref())?));
    if let Some(id) = id {
        KEPT.with_borrow_mut(|kept| kept.insert(id, mesh.clone()));
    }
    Ok(mesh)
}

/// `{ mesh }`.
pub fn mesh_of(input: &JsValue) -> Result<Rc<PreparedMesh<'static>>> {
    mesh(&get(input, "mesh").unwrap_or(JsValue::UNDEFINED))
}

/// Checks and decimates a mesh, and keeps it under its `id`; see `Aligner.prepareMesh` in the TypeScript package.
#[wasm_bindgen(js_name = prepareMesh, skip_typescript)]
pub fn prepare_mesh(given: &JsValue) -> core::result::Result<(), JsValue> {
    mesh(given).and_then(|mesh| mesh.prepare()).map_err(|error| to_js(&error))
}

/// Drops the mesh that is kept under this number, if there is one.
#[wasm_bindgen(js_name = dropMesh, skip_typescript)]
pub fn drop_mesh(id: u32) {
    KEPT.with_borrow_mut(|kept| kept.remove(&id));
}
