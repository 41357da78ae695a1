//! A pair of a scene with the mesh of a prior, and its folder.

use serde_json::json;

use super::prior::Prior;
use crate::bench::benchmark::BenchCase;
use crate::case_folder::contents::{case_files, glb_file, parameters_json, symmetry_json};
use crate::cases::tier::Tier;
use crate::files::{NamedFile, write_files};
use crate::prelude::*;
use sim3align::align::evaluate::Truth;

/// Metres per unit of the depth maps: finer than the noise, and compact as 16-bit images.
pub const DEPTH_SCALE: f64 = 0.0001;

/// What all of its cases are called.
const CLASS: &str = "scene";

/// A pair of a scene with its truth.
#[derive(Debug, Clone)]
pub struct SceneCase {
    /// See [`super::ScenePair::name`].
    pub name: String,
    /// The generator of the mesh.
    pub prior: Prior,
    /// Difficulty.
    pub tier: Tier,
    /// The object.
    pub family: String,
    /// Names of the simulated errors.
    pub tags: Vec<&'static str>,
    /// Magnitudes of the simulated errors.
    pub parameters: Vec<(&'static str, f64)>,
    /// Depth, mask and camera.
    pub observation: Observation,
    /// The generated mesh, in its canonical frame.
    pub mesh: Mesh,
    /// The true pose, in the scale of the depth map.
    pub camera_from_mesh: Similarity,
    /// Rotational symmetries of the object, in the frame of the mesh.
    pub symmetry: Symmetry,
}

impl SceneCase {
    fn parameters(&self) -> serde_json::Value {
        let mut parameters = parameters_json(&self.parameters);
        parameters["prior"] = json!(self.prior.as_str());
        parameters
    }

    /// The files of its case folder: name and content. `meta.json` has the prior among the parameters.
    ///
    /// # Errors
    /// [`sim3align_geometry::error::ErrorCode::Internal`] if an encoder fails.
    pub fn files(&self) -> Result<Vec<NamedFile>> {
        let truth = symmetry_json(&self.symmetry, &format!("{}, {}", self.name, self.prior.as_str()));
        let meta = json!({
            "tier": self.tier.as_str(),
            "class": CLASS,
            "family": self.family,
            "tags": self.tags,
            "parameters": self.parameters(),
        });
        let mesh_files = vec![glb_file(&self.mesh)];
        let mut files = case_files(&self.observation, mesh_files, &self.camera_from_mesh, truth, Some(DEPTH_SCALE))?;
        files.push(("meta.json", format!("{meta:#}\n").into_bytes()));
        Ok(files)
    }

    /// Writes the case folder, and creates it if necessary.
    ///
    /// # Errors
    /// [`sim3align_geometry::error::ErrorCode::InvalidArgument`] if the folder or a file cannot be written, and those
    /// of [`SceneCase::files`].
    pub fn write(&self, folder: &Path) -> Result<()> {
        write_files(folder, &self.files()?)
    }
}

impl From<SceneCase> for BenchCase {
    fn from(case: SceneCase) -> Self {
        Self {
            parameters: case.parameters(),
            name: case.name,
            tier: case.tier.as_str().into(),
            class: CLASS.into(),
            family: case.family,
            tags: case.tags.iter().map(|tag| (*tag).to_owned()).collect(),
            observation: case.observation,
            mesh: case.mesh,
            colors: None,
            truth: Some(Truth { camera_from_mesh: case.camera_from_mesh, symmetry: case.symmetry }),
        }
    }
}
