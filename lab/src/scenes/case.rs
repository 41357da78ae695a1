//! A pair of a scene with the mesh of a prior, and its folder.

use std::path::Path;

use serde_json::json;

use super::prior::Prior;
use crate::bench::benchmark::BenchCase;
use crate::case_folder::contents::{case_files, parameters_json, symmetry_json};
use crate::cases::tier::Tier;
use crate::files::write_files;
use sim3align::align::evaluate::Truth;
use sim3align::evidence::observation::Observation;
use sim3align::metrics::symmetry::Symmetry;
use sim3align_geometry::error::Result;
use sim3align_geometry::mesh::Mesh;
use sim3align_geometry::similarity::Similarity;

/// Metres per unit of the depth maps: finer than the noise, and compact as 16-bit images.
pub const DEPTH_SCALE: f64 = 0.0001;

/// What all of its cases are called.
const CLASS: &str = "scene";

/// A pair of a scene with its truth.
#[derive(Debug, Clone)]
pub struct SceneCase {
    /// See [`super::ScenePair::name`].
    pub name: String,
    /// What made the mesh.
    pub prior: Prior,
    /// How hard it is.
    pub tier: Tier,
    /// What it shows.
    pub family: String,
    /// Names of its faults.
    pub tags: Vec<&'static str>,
    /// Measures of its faults.
    pub parameters: Vec<(&'static str, f64)>,
    /// Depth, mask and camera.
    pub observation: Observation,
    /// The generated mesh, in a frame of its own.
    pub mesh: Mesh,
    /// The truth, in the depth map's own metric.
    pub camera_from_mesh: Similarity,
    /// The turns under which the object looks the same, in the mesh's frame.
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
    /// [`sim3align_geometry::error::ErrorCode::Internal`] where an encoder fails.
    pub fn files(&self) -> Result<Vec<(&'static str, Vec<u8>)>> {
        let truth = symmetry_json(&self.symmetry, &format!("{}, {}", self.name, self.prior.as_str()));
        let meta = json!({
            "tier": self.tier.as_str(),
            "class": CLASS,
            "family": self.family,
            "tags": self.tags,
            "parameters": self.parameters(),
        });
        let mut files = case_files(&self.observation, &self.mesh, &self.camera_from_mesh, truth, Some(DEPTH_SCALE))?;
        files.push(("meta.json", format!("{meta:#}\n").into_bytes()));
        Ok(files)
    }

    /// Writes the case folder, and creates it where it does not exist.
    ///
    /// # Errors
    /// [`sim3align_geometry::error::ErrorCode::InvalidArgument`] where the folder or a file can't be written, and those of
    /// [`SceneCase::files`].
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
            truth: Some(Truth { camera_from_mesh: case.camera_from_mesh, symmetry: case.symmetry }),
        }
    }
}
