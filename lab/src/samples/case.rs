//! A generated case: the observation of an object, its generated mesh, and how the one follows from the other.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::depth::View;
use super::distortion::{canonicalise, hallucinate};
use super::shape::Kind;
use crate::case_folder::write;
use sim3align::evidence::observation::Observation;
use sim3align::metrics::symmetry::Symmetry;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

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
        let occluder = kind.occluder(seed)?.map(|thing| view.before(&object, &thing)).transpose()?;
        let seen = view.see(&object, occluder.as_ref(), seed)?;
        // In the object's frame, before the mesh gets its own: so the truth is exact.
        let generated = hallucinate(&object, &seen.vertices, kind.bulge(), seed)?;
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

    /// The files of its case folder: name and content. Depth is written as floats, or, with metres per unit, as whole
    /// numbers.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] where an encoder fails.
    pub fn files(&self, depth_scale: Option<f64>) -> Result<Vec<(&'static str, Vec<u8>)>> {
        let note =
            format!("generated: {}, seed {}; the side that was not seen is invented", self.kind.as_str(), self.seed);
        let truth = json!({ "symmetry": self.kind.symmetry(), "note": note });
        case_files(&self.observation, &self.mesh, &self.camera_from_mesh, truth, depth_scale)
    }

    /// Writes the case folder, and creates it where it does not exist. For `depth_scale` see [`SampleCase::files`].
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] where the folder or a file can't be written, and those of
    /// [`SampleCase::files`].
    pub fn write(&self, folder: &Path, depth_scale: Option<f64>) -> Result<()> {
        write_files(folder, &self.files(depth_scale)?)
    }
}

/// The files of a case folder; `truth` is what `gt.json` says besides the pose. Depth is written as floats, or, with
/// metres per unit, as whole numbers.
pub(super) fn case_files(
    observation: &Observation,
    mesh: &Mesh,
    camera_from_mesh: &Similarity,
    mut truth: Value,
    depth_scale: Option<f64>,
) -> Result<Vec<(&'static str, Vec<u8>)>> {
    let (camera, depth) = (observation.camera(), observation.depth());
    let mut camera_json = json!({
        "fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy,
        "width": depth.width(), "height": depth.height(),
    });
    let depth_file = match depth_scale {
        None => ("depth.npy", write::depth_npy(depth)),
        Some(scale) => {
            camera_json["depthScale"] = json!(scale);
            ("depth.png", write::depth_png(depth, scale)?)
        }
    };
    let Similarity { scale, rotation, translation } = camera_from_mesh;
    let row = |i: usize| [rotation[(i, 0)], rotation[(i, 1)], rotation[(i, 2)]];
    truth["available"] = json!(true);
    truth["scale"] = json!(scale);
    truth["rotation"] = json!([row(0), row(1), row(2)]);
    truth["translation"] = json!([translation.x, translation.y, translation.z]);
    Ok(vec![
        depth_file,
        ("mask.png", write::mask_png(observation.mask())?),
        ("camera.json", format!("{camera_json:#}\n").into_bytes()),
        ("mesh.glb", write::glb(mesh)),
        ("gt.json", format!("{truth:#}\n").into_bytes()),
    ])
}

/// What `gt.json` says of a symmetry: in words, as all readers understand them, and exactly, as `symmetryAxes`.
pub(super) fn symmetry_json(symmetry: &Symmetry, name: &str) -> Value {
    let axes = match symmetry {
        Symmetry::Declared(axes) => axes.as_slice(),
        _ => &[],
    };
    let words = match axes.iter().find(|axis| axis.fold.is_none()) {
        Some(_) => "continuous",
        None if axes.is_empty() => "none",
        None => "discrete",
    };
    let axes: Vec<Value> =
        axes.iter().map(|a| json!({ "axis": [a.axis.x, a.axis.y, a.axis.z], "fold": a.fold })).collect();
    json!({ "symmetry": words, "symmetryAxes": axes, "note": format!("generated: {name}") })
}

/// Measures by name, as `meta.json` has them.
pub(super) fn parameters_json(parameters: &[(&'static str, f64)]) -> Value {
    parameters.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect()
}

/// Writes files to a folder, and creates it where it does not exist.
pub(super) fn write_files(folder: &Path, files: &[(&'static str, Vec<u8>)]) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| unwritable(folder, error))?;
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| unwritable(&path, error))?;
    }
    Ok(())
}

/// The error of a path that can't be written.
pub(super) fn unwritable(path: &Path, error: std::io::Error) -> Error {
    Error::new(
        ErrorCode::InvalidArgument,
        path.display().to_string(),
        format!("a file system that says: {error}"),
        "a folder to write to",
        "Name a folder that exists or can be created, on a disk that is not full.",
    )
}
