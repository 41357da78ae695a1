//! A generated case: the observation of an object, its generated mesh, and how the one follows from the other.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::depth::View;
use super::distortion::{canonicalise, hallucinate};
use super::shape::Kind;
use crate::error::{Error, ErrorCode, Result};
use crate::formats::write;
use crate::geometry::mesh::Mesh;
use crate::geometry::similarity::Similarity;
use crate::stages::observe::Observation;

/// A generated case.
#[derive(Debug, Clone)]
pub struct SampleCase {
    /// What it shows.
    pub kind: Kind,
    /// All that is random follows from it.
    pub seed: u64,
    /// Depth, mask and camera.
    pub observation: Observation,
    /// The generated mesh, in a frame of its own.
    pub mesh: Mesh,
    /// The truth: puts what is right of `mesh` where it was seen.
    pub camera_from_mesh: Similarity,
    /// The object as it is: metres, z up, on the plane z = 0.
    pub object: Mesh,
    /// Where the object was seen.
    pub camera_from_object: Similarity,
}

impl SampleCase {
    /// The case of a kind and a seed; the same ones give the same bits.
    ///
    /// # Errors
    /// None that its input could cause.
    pub fn new(kind: Kind, seed: u64) -> Result<Self> {
        let object = kind.mesh(seed)?;
        let view = View::new(&object, seed)?;
        let seen = view.see(&object, seed)?;
        // In the object's frame, before the mesh gets its own: so the truth is exact.
        let generated = hallucinate(&object, &seen.vertices, seed)?;
        let (mesh, object_from_mesh) = canonicalise(&generated, seed)?;
        Ok(Self {
            kind,
            seed,
            observation: Observation::new(seen.depth, seen.mask, view.camera)?,
            mesh,
            camera_from_mesh: view.camera_from_object.compose(&object_from_mesh),
            object,
            camera_from_object: view.camera_from_object,
        })
    }

    /// The files of its case folder: name and content.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] where an encoder fails.
    pub fn files(&self) -> Result<[(&'static str, Vec<u8>); 5]> {
        let note =
            format!("generated: {}, seed {}; the side that was not seen is invented", self.kind.as_str(), self.seed);
        let truth = json!({ "symmetry": self.kind.symmetry(), "note": note });
        case_files(&self.observation, &self.mesh, &self.camera_from_mesh, truth)
    }

    /// Writes the case folder, and creates it where it does not exist.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the folder or a file can't be written, and those of
    /// [`SampleCase::files`].
    pub fn write(&self, folder: &Path) -> Result<()> {
        write_files(folder, &self.files()?)
    }
}

/// The files of a case folder; `truth` is what `gt.json` says besides the pose.
pub(super) fn case_files(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    mut truth: Value,
) -> Result<[(&'static str, Vec<u8>); 5]> {
    let (camera, depth) = (observation.camera(), observation.depth());
    let camera = json!({
        "fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy,
        "width": depth.width(), "height": depth.height(),
    });
    let Similarity { scale, rotation, translation } = camera_from_mesh;
    let row = |i: usize| [rotation[(i, 0)], rotation[(i, 1)], rotation[(i, 2)]];
    truth["available"] = json!(true);
    truth["scale"] = json!(scale);
    truth["rotation"] = json!([row(0), row(1), row(2)]);
    truth["translation"] = json!([translation.x, translation.y, translation.z]);
    Ok([
        ("depth.npy", write::depth_npy(depth)),
        ("mask.png", write::mask_png(observation.mask())?),
        ("camera.json", format!("{camera:#}\n").into_bytes()),
        ("mesh.glb", write::glb(mesh)),
        ("gt.json", format!("{truth:#}\n").into_bytes()),
    ])
}

/// Writes files to a folder, and creates it where it does not exist.
pub(super) fn write_files(folder: &Path, files: &[(&'static str, Vec<u8>)]) -> Result<()> {
    let failed = |path: &Path, error: std::io::Error| {
        Error::new(
            ErrorCode::InvalidArgument,
            path.display().to_string(),
            format!("a file system that says: {error}"),
            "a folder to write to",
            "Name a folder that exists or can be created, on a disk that is not full.",
        )
    };
    fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| failed(&path, error))?;
    }
    Ok(())
}
