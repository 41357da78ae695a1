//! A generated case: the observation of an object, its generated mesh, and how the one follows from the other.

use serde_json::json;

use super::depth::RoomView;
use super::shape::Kind;
use crate::case_folder::contents::{case_files, glb_file};
use crate::cases::distortion::{canonicalise, hallucinate};
use crate::files::{NamedFile, write_files};
use crate::prelude::*;

/// A generated case.
#[derive(Debug, Clone)]
pub struct SampleCase {
    /// The object.
    pub kind: Kind,
    /// All that is random follows from it.
    pub seed: u64,
    /// Depth, mask and camera.
    pub observation: Observation,
    /// The generated mesh, in its canonical frame.
    pub mesh: Mesh,
    /// The truth: puts what is right of `mesh` where it was seen.
    pub camera_from_mesh: Similarity,
    /// The true object: metres, z up, on the plane z = 0.
    pub object: Mesh,
    /// Where the object was seen.
    pub camera_from_object: Similarity,
}

impl SampleCase {
    /// The case of a kind and a seed; the same ones give the same bits.
    ///
    /// # Errors
    /// Only in case of a bug in the generator.
    pub fn new(kind: Kind, seed: u64) -> Result<Self> {
        let object = kind.mesh(seed)?;
        let view = RoomView::new(&object, seed)?;
        let occluder = kind.occluder(seed)?.map(|thing| view.before(&object, &thing)).transpose()?;
        let seen = view.see(&object, occluder.as_ref(), seed)?;
        // In the object's frame, before the mesh gets its own: so the truth is exact.
        let generated = hallucinate(&object, &seen.vertices, kind.bulge(), seed)?;
        let (mesh, object_from_mesh) = canonicalise(&generated, seed)?;
        Ok(Self {
            kind,
            seed,
            observation: Observation::new(seen.depth, seen.mask, view.view.camera)?,
            mesh,
            camera_from_mesh: view.view.camera_from_world.compose(&object_from_mesh),
            object,
            camera_from_object: view.view.camera_from_world,
        })
    }

    /// The files of its case folder: name and content. Depth is written as floats, or, with metres per unit, as whole
    /// numbers.
    ///
    /// # Errors
    /// [`ErrorCode::Internal`] if an encoder fails.
    pub fn files(&self, depth_scale: Option<f64>) -> Result<Vec<NamedFile>> {
        let note =
            format!("generated: {}, seed {}; the side that was not seen is invented", self.kind.as_str(), self.seed);
        let truth = json!({ "symmetry": "none", "note": note });
        case_files(&self.observation, vec![glb_file(&self.mesh)], &self.camera_from_mesh, truth, depth_scale)
    }

    /// Writes the case folder, and creates it if necessary. For `depth_scale` see [`SampleCase::files`].
    ///
    /// # Errors
    /// [`ErrorCode::InvalidArgument`] if the folder or a file cannot be written, and those of
    /// [`SampleCase::files`].
    pub fn write(&self, folder: &Path, depth_scale: Option<f64>) -> Result<()> {
        write_files(folder, &self.files(depth_scale)?)
    }
}
