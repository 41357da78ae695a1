//! Reads scene folders: one view, and the masks and meshes of several objects.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::camera::{depth_scale, read_camera};
use super::case::{CAMERA_FILES, DEPTH_FILES, MASK_FILES, MESH_FILES, find, in_file, mesh_of, truth_of};
use super::json;
use sim3align::scene::plane::Plane;
use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_geometry::error::Result;
use sim3align_geometry::image::{DepthMap, Mask};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::pinhole::Pinhole;
use sim3align_geometry::similarity::Similarity;

/// The content of a scene folder.
#[derive(Debug, Clone)]
pub struct SceneFolder {
    /// Name of the folder.
    pub name: String,
    /// Depth.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// The objects, by name.
    pub objects: Vec<FolderObject>,
    /// The true support, if `plane.json` has it.
    pub plane: Option<Plane>,
}

/// An object of a scene folder.
#[derive(Debug, Clone)]
pub struct FolderObject {
    /// Name of its folder.
    pub name: String,
    /// Its mask.
    pub mask: Mask,
    /// Its mesh.
    pub mesh: Mesh,
    /// `camera_from_mesh` and the description of the symmetry, if `gt.json` has them.
    pub truth: Option<(Similarity, String)>,
}

/// Reads a scene folder: `depth.npy|png`, `camera.json`, `objects/NAME/` with `mask.png|npy`, `mesh.*` and, optionally,
/// `gt.json`; optionally `plane.json`.
///
/// # Errors
/// Those of [`super::case::read_case`].
pub fn read_scene_folder(folder: &Path) -> Result<SceneFolder> {
    let (depth_path, depth_bytes) = find(folder, DEPTH_FILES)?;
    let (camera_path, camera_bytes) = find(folder, CAMERA_FILES)?;
    let options = DepthReadOptions { depth_scale: None, integer_depth_scale: depth_scale(&camera_bytes) };
    let depth = read_depth(&depth_bytes, &options).map_err(in_file(&depth_path))?;
    let camera = read_camera(&camera_bytes, [depth.width(), depth.height()]).map_err(in_file(&camera_path))?;
    let entries = fs::read_dir(folder.join("objects")).into_iter().flatten().filter_map(core::result::Result::ok);
    let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    let object = |path: &std::path::PathBuf| {
        let (mask_path, mask_bytes) = find(path, MASK_FILES)?;
        let (mesh_path, mesh_bytes) = find(path, MESH_FILES)?;
        Ok(FolderObject {
            name: path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
            mask: read_mask(&mask_bytes).map_err(in_file(&mask_path))?,
            mesh: mesh_of(path, &mesh_path, &mesh_bytes)?.mesh,
            truth: truth_of(path)?,
        })
    };
    let objects = folders.iter().map(object).collect::<Result<_>>()?;
    let plane = fs::read(folder.join("plane.json")).ok().and_then(|bytes| {
        let value: Value = serde_json::from_slice(&bytes).ok()?;
        Plane::new(json::numbers::<3>(value.get("normal")?)?.into(), value.get("d")?.as_f64()?)
    });
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    Ok(SceneFolder { name: name.unwrap_or_else(|| folder.display().to_string()), depth, camera, objects, plane })
}
