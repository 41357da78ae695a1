//! Reads case folders, scene folders (with `objects/NAME`) and folders with `frame_*`.

use std::fs;
use std::path::Component;
use std::sync::Arc;

use serde::de::DeserializeOwned;

use super::files::{
    CAMERA, CAMERA_POSE, CameraFile, CameraPoseFile, INITIAL, META, MetaFile, OBJECTS, PoseFile, TRUTH, TruthFile,
    parsed,
};
use crate::case::{Case, CaseFrame, CaseObject};
use crate::files::{entries, listed};
use crate::prelude::*;
use sim3align_formats::depth::{DepthReadOptions, read_depth};
use sim3align_formats::mask::read_mask;
use sim3align_formats::mesh::{MeshFormat, MeshReadOptions, read_colored_mesh};
use sim3align_formats::photo::read_photo;

/// File names of each part, in order of preference.
const DEPTH_FILES: &[&str] = &["depth.npy", "depth.png"];
const MASK_FILES: &[&str] = &["mask.png", "mask.npy"];
const MESH_FILES: &[&str] = &["mesh.glb", "mesh.gltf", "mesh.obj", "mesh.ply", "mesh.stl"];
const PHOTO_FILES: &[&str] = &["rgb.png", "rgb.jpg", "rgb.jpeg", "image.png", "image.jpg", "image.jpeg"];
/// The files with a generator's placement.
const PLACEMENT_FILES: &[&str] = &[INITIAL, "sam3d.json"];

/// The kind of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FolderKind {
    /// One object in one image.
    Case,
    /// Several objects in one image.
    Scene,
    /// One object in several images.
    Frames,
}

impl FolderKind {
    /// The kind of a folder; `None` if it is no case.
    pub fn of(folder: &Path) -> Option<Self> {
        if folder.join(OBJECTS).is_dir() {
            Some(Self::Scene)
        } else if folder.join(CAMERA).is_file() {
            Some(Self::Case)
        } else {
            entries(folder).iter().any(|path| is_frame(path)).then_some(Self::Frames)
        }
    }
}

/// The cases of a folder: itself if it is one, otherwise those in it.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] if the folder cannot be read.
pub fn case_folders(folder: &Path) -> Result<Vec<PathBuf>> {
    if FolderKind::of(folder).is_some() {
        return Ok(vec![folder.into()]);
    }
    Ok(listed(folder)?.into_iter().filter(|path| path.is_dir() && FolderKind::of(path).is_some()).collect())
}

/// Reads a folder of any kind.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] for a missing file, and those of the readers; the argument names the file.
pub fn read(folder: &Path) -> Result<Case> {
    let kind = FolderKind::of(folder);
    let within = |path: PathBuf| entries(&path).into_iter().filter(|path| path.is_dir());
    let (objects, frames): (Vec<PathBuf>, Vec<PathBuf>) = match kind {
        Some(FolderKind::Scene) => (within(folder.join(OBJECTS)).collect(), vec![folder.into()]),
        Some(FolderKind::Frames) => {
            (vec![folder.into()], within(folder.into()).filter(|path| is_frame(path)).collect())
        }
        _ => (vec![folder.into()], vec![folder.into()]),
    };
    let meta: MetaFile = json(folder, META)?.unwrap_or_default();
    let class = meta.class.unwrap_or_else(|| "given".into());
    let read_frame = |path: &PathBuf| {
        let owners = if kind == Some(FolderKind::Scene) { objects.as_slice() } else { core::slice::from_ref(path) };
        frame(path, owners)
    };
    let name = folder.canonicalize().ok().map_or_else(|| folder.display().to_string(), |path| last_name(&path));
    Ok(Case {
        name,
        tier: meta.tier.unwrap_or_else(|| "given".into()),
        tags: meta.tags,
        objects: objects.iter().map(|path| object(path, frames.first(), &class)).collect::<Result<_>>()?,
        frames: frames.iter().map(read_frame).collect::<Result<_>>()?,
    })
}

fn is_frame(path: &Path) -> bool {
    path.is_dir() && last_name(path).starts_with("frame_")
}

fn last_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn frame(folder: &Path, owners: &[PathBuf]) -> Result<CaseFrame> {
    let (depth_path, depth_bytes) = required(folder, DEPTH_FILES)?;
    let camera: CameraFile = json(folder, CAMERA)?.ok_or_else(|| missing(folder, &[CAMERA], "no such file"))?;
    let options = DepthReadOptions { integer_depth_scale: camera.depth_scale, ..DepthReadOptions::default() };
    let depth = read_depth(&depth_bytes, &options).map_err(in_file(&depth_path))?;
    let size = [depth.width(), depth.height()];
    let stated = [camera.width.unwrap_or(size[0]), camera.height.unwrap_or(size[1])];
    if stated != size {
        let (found, expected) = (format!("intrinsics for {stated:?} pixels"), format!("those of the image, {size:?}"));
        let argument = folder.join(CAMERA).display().to_string();
        return Err(Error::new(ErrorCode::SizeMismatch, argument, found, expected, "Scale the intrinsics."));
    }
    let mask = |folder: &PathBuf| {
        let file = found(folder, MASK_FILES)?;
        file.map(|(path, bytes)| read_mask(&bytes).map(|mask| mask.object).map_err(in_file(&path))).transpose()
    };
    let truth = |folder: &PathBuf| -> Result<Option<Similarity>> {
        let file = truth_file(folder)?;
        file.map(|file| file.pose.similarity(&folder.join(TRUTH).display().to_string())).transpose()
    };
    let photo = found(folder, PHOTO_FILES)?;
    let photo = photo.map(|(path, bytes)| read_photo(&bytes).map_err(in_file(&path))).transpose()?;
    let pose: Option<CameraPoseFile> = json(folder, CAMERA_POSE)?;
    Ok(CaseFrame {
        name: last_name(folder),
        camera: Pinhole::new(camera.fx, camera.fy, camera.cx, camera.cy)?,
        depth,
        exact: None,
        photo: photo.map(Arc::new),
        world_from_camera: pose.map(|pose| rigid(&pose.camera_to_world)).transpose()?,
        masks: owners.iter().map(mask).collect::<Result<_>>()?,
        truths: owners.iter().map(truth).collect::<Result<_>>()?,
        visible: 1.0,
    })
}

fn object(folder: &Path, frame: Option<&PathBuf>, class: &str) -> Result<CaseObject> {
    let (path, bytes) = required(folder, MESH_FILES)?;
    let resources = |uri: &str| read_beside(folder, uri);
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let options = MeshReadOptions {
        format: Some(MeshFormat::from_name(extension)?),
        resources: Some(&resources),
        ..MeshReadOptions::default()
    };
    let read = read_colored_mesh(&bytes, &options).map_err(in_file(&path))?;
    if let Some(problem) = &read.problem {
        eprintln!("\n{}: without colours: {problem}", path.display());
    }
    let truth = match (truth_file(folder)?, frame) {
        (None, Some(frame)) => truth_file(frame)?,
        (truth, _) => truth,
    };
    let placement = PLACEMENT_FILES.iter().find_map(|name| json::<PoseFile>(folder, name).transpose());
    Ok(CaseObject {
        name: last_name(folder),
        class: class.to_owned(),
        mesh: read.mesh,
        surplus: None,
        colors: read.colors,
        symmetry: truth.map_or(Symmetry::Auto, |file| file.symmetry()),
        initial: placement.transpose()?.map(|pose| pose.similarity("placement")).transpose()?,
    })
}

/// `gt.json`, unless it says that the true pose is not available.
fn truth_file(folder: &Path) -> Result<Option<TruthFile>> {
    let file: Option<TruthFile> = json(folder, TRUTH)?;
    Ok(file.filter(|file| file.available != Some(false)))
}

/// A rigid transform from a 4 × 4 matrix by rows.
fn rigid([a, b, c, _]: &[[f64; 4]; 4]) -> Result<Similarity> {
    let rotation = Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    Similarity::from_parts(1.0, rotation, Vector3::new(a[3], b[3], c[3]))
}

fn json<T: DeserializeOwned>(folder: &Path, name: &str) -> Result<Option<T>> {
    let file = found(folder, &[name])?;
    file.map(|(path, bytes)| parsed(&path.display().to_string(), &bytes)).transpose()
}

/// Names the file of an error.
fn in_file(path: &Path) -> impl FnOnce(Error) -> Error {
    let path = path.display().to_string();
    move |error: Error| error.about(path)
}

fn missing(folder: &Path, names: &[&str], found: impl Into<String>) -> Error {
    let remedy = "A case folder holds depth, mask, camera.json and mesh; the documentation lists the names.";
    let argument = folder.display().to_string();
    Error::new(ErrorCode::InvalidArgument, argument, found.into(), names.join(" or "), remedy)
}

/// The first existing file of `names`, and its content.
fn found(folder: &Path, names: &[&str]) -> Result<Option<(PathBuf, Vec<u8>)>> {
    let Some(path) = names.iter().map(|name| folder.join(name)).find(|path| path.is_file()) else { return Ok(None) };
    let bytes = fs::read(&path).map_err(|error| missing(folder, names, error.to_string()))?;
    Ok(Some((path, bytes)))
}

fn required(folder: &Path, names: &[&str]) -> Result<(PathBuf, Vec<u8>)> {
    found(folder, names)?.ok_or_else(|| missing(folder, names, "no such file"))
}

/// A file referenced by a mesh; only files below its folder are read.
fn read_beside(folder: &Path, uri: &str) -> Option<Vec<u8>> {
    let is_below = Path::new(uri).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if is_below { fs::read(folder.join(uri)).ok() } else { None }
}
