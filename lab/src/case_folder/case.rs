//! Reads case folders: one observation, one mesh and optionally the true pose.

use std::fs;
use std::path::Component;

use super::camera::{depth_scale, read_camera};
use super::pose::read_truth;
use crate::prelude::*;
use sim3align_formats::colored_mesh::ColoredMesh;
use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_colored_mesh};
use sim3align_formats::photo::read_photo;

/// File names of each part, in order of preference.
const DEPTH_FILES: &[&str] = &["depth.npy", "depth.png"];
const MASK_FILES: &[&str] = &["mask.png", "mask.npy"];
const MESH_FILES: &[&str] = &["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl"];
const CAMERA_FILES: &[&str] = &["camera.json"];
const PHOTO_FILES: &[&str] = &["rgb.png", "rgb.jpg", "rgb.jpeg", "image.png", "image.jpg", "image.jpeg"];

/// The content of a case folder.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the folder.
    pub name: String,
    /// Depth, mask and camera, and the photo if there is one.
    pub observation: Observation,
    /// The mesh, in the mesh frame.
    pub mesh: Mesh,
    /// The colours of the mesh, if it has any.
    pub colors: Option<SurfaceColors>,
    /// Why the mesh has no colours, if they can't be read.
    pub color_problem: Option<Error>,
    /// `camera_from_mesh` and the description of the symmetry, if `gt.json` has them.
    pub truth: Option<(Similarity, String)>,
}

/// Reads a case folder: `depth.npy|png`, `mask.png|npy`, `mesh.glb|gltf|obj|ply|stl`, `camera.json`
/// and, optionally, `rgb.png|jpg`, `image.png|jpg` and `gt.json`. Integer depth has the unit of the camera file, by
/// default millimetres.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] for a missing file, and those of the readers and of
/// [`Observation::new`]; the argument names the file.
pub fn read_case(folder: &Path) -> Result<Case> {
    let (depth, camera) = depth_and_camera(folder)?;
    let mask = mask_in(folder)?;
    let (mesh_path, mesh_bytes) = find(folder, MESH_FILES)?;
    let read = mesh_of(folder, &mesh_path, &mesh_bytes)?;
    let (mesh, colors) = (read.mesh, read.colors);
    let color_problem = read.problem.map(in_file(&mesh_path));
    let truth = truth_of(folder)?;
    let in_folder = |error: Error| {
        let argument = format!("{}: {}", folder.display(), error.argument);
        error.about(argument)
    };
    let mut observation = Observation::new(depth, mask, camera).map_err(in_folder)?;
    if let Some(photo) = photo_of(folder)? {
        observation = observation.with_photo(photo).map_err(in_folder)?;
    }
    Ok(Case { name: name_of(folder), observation, mesh, colors, color_problem, truth })
}

/// The name of a folder, through links and relative paths; the path if it has none.
pub(crate) fn name_of(folder: &Path) -> String {
    let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
    name.unwrap_or_else(|| folder.display().to_string())
}

/// The last part of a path.
pub(crate) fn last_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The depth of a folder, and its camera.
pub(crate) fn depth_and_camera(folder: &Path) -> Result<(DepthMap, Pinhole)> {
    let (depth_path, depth_bytes) = find(folder, DEPTH_FILES)?;
    let (camera_path, camera_bytes) = find(folder, CAMERA_FILES)?;
    let options = DepthReadOptions { depth_scale: None, integer_depth_scale: depth_scale(&camera_bytes) };
    let depth = read_depth(&depth_bytes, &options).map_err(in_file(&depth_path))?;
    let size = [depth.width(), depth.height()];
    let camera = read_camera(&camera_bytes, size).map_err(in_file(&camera_path))?;
    Ok((depth, camera))
}

/// The mask of a folder.
pub(crate) fn mask_in(folder: &Path) -> Result<Mask> {
    let (path, bytes) = find(folder, MASK_FILES)?;
    read_mask(&bytes).map_err(in_file(&path))
}

/// Whether a folder has a mask.
pub(crate) fn has_mask(folder: &Path) -> bool {
    has_any(folder, MASK_FILES)
}

/// Names the file of an error.
fn in_file(path: &Path) -> impl FnOnce(Error) -> Error {
    let path = path.display().to_string();
    move |error: Error| error.about(path)
}

/// The mesh of a file in a folder, with its colours.
fn mesh_of(folder: &Path, path: &Path, bytes: &[u8]) -> Result<ColoredMesh> {
    let resources = |uri: &str| read_beside(folder, uri);
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let options = MeshReadOptions { format: Some(MeshFormat::from_name(extension)?), resources: Some(&resources) };
    read_colored_mesh(bytes, &options).map_err(in_file(path))
}

/// The photo in a folder, if there is one.
pub(crate) fn photo_of(folder: &Path) -> Result<Option<Photo>> {
    if !has_any(folder, PHOTO_FILES) {
        return Ok(None);
    }
    let (path, bytes) = find(folder, PHOTO_FILES)?;
    read_photo(&bytes).map_err(in_file(&path)).map(Some)
}

/// The true pose in a folder, if there is one.
pub(crate) fn truth_of(folder: &Path) -> Result<Option<(Similarity, String)>> {
    let path = folder.join("gt.json");
    match fs::read(&path) {
        Ok(bytes) => read_truth(&bytes).map_err(in_file(&path)),
        Err(_) => Ok(None),
    }
}

/// The mesh of a folder: `mesh.glb|gltf|obj|ply|stl`.
pub(crate) fn mesh_in(folder: &Path) -> Result<ColoredMesh> {
    let (path, bytes) = find(folder, MESH_FILES)?;
    mesh_of(folder, &path, &bytes)
}

fn has_any(folder: &Path, names: &[&str]) -> bool {
    names.iter().any(|name| folder.join(name).is_file())
}

/// The first existing file of `names`, and its content.
fn find(folder: &Path, names: &[&str]) -> Result<(PathBuf, Vec<u8>)> {
    let missing = |found: String| {
        Error::new(
            ErrorCode::InvalidArgument,
            folder.display().to_string(),
            found,
            names.join(" or "),
            "A case folder holds depth, mask, camera.json and mesh; the documentation lists the names.",
        )
    };
    let Some(path) = names.iter().map(|name| folder.join(name)).find(|path| path.is_file()) else {
        return Err(missing("no such file".into()));
    };
    let bytes = fs::read(&path).map_err(|error| missing(format!("{}: {error}", path.display())))?;
    Ok((path, bytes))
}

/// A file referenced by a `.gltf`; only files below its folder are read.
fn read_beside(folder: &Path, uri: &str) -> Option<Vec<u8>> {
    let is_below = Path::new(uri).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if is_below { fs::read(folder.join(uri)).ok() } else { None }
}
