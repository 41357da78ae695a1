//! Meshes from JavaScript objects, and the cache of prepared meshes.

use core::cell::RefCell;
use std::rc::Rc;

use glam::Vec3;
use wasm_bindgen::JsValue;

use super::object::{get, to_colors, to_f32s, to_u32s, wrong_type};
use crate::error::Result;
use crate::geometry::cloud::Cloud;
use crate::geometry::mesh::Mesh;
use crate::geometry::surface::check_triangles;
use crate::geometry::surface_colors::SurfaceColors;
use crate::precise::drawing::prepared_mesh::PreparedMesh;

thread_local! {
    /// The cached meshes, each with the id of the caller. There are few: a tree would be more code than data.
    static KEPT: RefCell<Vec<(u32, Rc<PreparedMesh<'static>>)>> = const { RefCell::new(Vec::new()) };
    /// The mesh of the last call without an id.
    static LAST: RefCell<Option<Rc<PreparedMesh<'static>>>> = const { RefCell::new(None) };
}

/// `{ positions, indices?, colors? | samples? | lacksColors? }`; with `id`, the mesh is cached under this number, and the arrays are only read if it is
/// not cached yet. Without, it is cached until the next one, which is the same if its contents are.
#[inline(never)]
pub fn mesh(mesh: &JsValue) -> Result<Rc<PreparedMesh<'static>>> {
    if !mesh.is_object() {
        let remedy = "Pass typed arrays, or the bytes of a file to align() of the package.";
        return Err(wrong_type("mesh", mesh, "{ positions, indices }", remedy));
    }
    let id = get(mesh, "id").and_then(|id| id.as_f64()).map(|id| id as u32);
    let kept = id.and_then(|id| {
        KEPT.with_borrow(|kept| kept.iter().find(|(known, _)| *known == id).map(|(_, mesh)| mesh.clone()))
    });
    if let Some(kept) = kept {
        return Ok(kept);
    }
    let positions = get(mesh, "positions").unwrap_or(JsValue::UNDEFINED);
    let indices = get(mesh, "indices");
    // Before the arrays are copied.
    let length = |array: &JsValue| get(array, "length").and_then(|length| length.as_f64()).unwrap_or_default() as usize;
    check_triangles(indices.as_ref().map_or(0, |indices| length(indices) / 3).max(length(&positions) / 9))?;
    let positions = to_f32s(&positions, "mesh.positions")?;
    let indices = indices.map(|indices| to_u32s(&indices, "mesh.indices")).transpose()?;
    let triangles = Mesh::from_flat(&positions, indices.as_deref())?;
    let colors = colors(mesh, &triangles)?;
    let lacks_colors = get(mesh, "lacksColors").is_some_and(|lacks| lacks.is_truthy());
    let Some(id) = id else { return Ok(as_before(triangles, colors, lacks_colors)) };
    let mesh = Rc::new(PreparedMesh::new(triangles).with_colors(colors).lacking_colors(lacks_colors));
    KEPT.with_borrow_mut(|kept| kept.push((id, mesh.clone())));
    Ok(mesh)
}

/// The mesh of the last call, if it was the same, otherwise a new one.
fn as_before(mesh: Mesh, colors: Option<SurfaceColors>, lacks_colors: bool) -> Rc<PreparedMesh<'static>> {
    LAST.with_borrow_mut(|last| {
        // Two of them would take twice the memory.
        last.take_if(|last| {
            *last.whole() != mesh || last.all_colors() != colors.as_ref() || last.lacks_colors() != lacks_colors
        });
        let new = || Rc::new(PreparedMesh::new(mesh).with_colors(colors).lacking_colors(lacks_colors));
        last.get_or_insert_with(new).clone()
    })
}

/// `colors`, sRGB-encoded red, green and blue per vertex, or `samples`, `{ positions, normals, colors }`, what the readers
/// of files make of textures.
#[inline(never)]
fn colors(mesh: &JsValue, triangles: &Mesh) -> Result<Option<SurfaceColors>> {
    let argument = "mesh.colors";
    if let Some(samples) = get(mesh, "samples") {
        let part = |name| get(&samples, name).unwrap_or(JsValue::UNDEFINED);
        let points = |name| -> Result<Vec<Vec3>> {
            Ok(to_f32s(&part(name), argument)?.chunks_exact(3).map(Vec3::from_slice).collect())
        };
        let cloud = Cloud { points: points("positions")?, normals: points("normals")? };
        return SurfaceColors::new(cloud, to_colors(&part("colors"), argument)?).map(Some);
    }
    let Some(colors) = get(mesh, "colors") else { return Ok(None) };
    SurfaceColors::of_vertices(triangles, &to_colors(&colors, argument)?).map(Some)
}

/// `{ mesh }`.
pub fn mesh_of(input: &JsValue) -> Result<Rc<PreparedMesh<'static>>> {
    mesh(&get(input, "mesh").unwrap_or(JsValue::UNDEFINED))
}

/// Removes the mesh with this id from the cache, if present.
pub fn drop_kept(id: u32) {
    KEPT.with_borrow_mut(|kept| kept.retain(|(known, _)| *known != id));
}
