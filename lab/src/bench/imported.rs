//! Answers of other programs, one JSON file per case or pair of clouds. `docs/importing-results.md` describes the files.

use std::io::ErrorKind;

use serde::Deserialize;

use super::result::described;
use crate::case_folder::{PoseFile, parsed};
use crate::prelude::*;

/// The content of an answer file.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct AnswerFile {
    #[serde(alias = "targetFromSource")]
    camera_from_mesh: Option<PoseFile>,
    error: Option<String>,
    seconds: Option<f64>,
}

/// The pose of a case in the file of its name in a folder, or the reason why there is none; and the seconds that it took,
/// if the file states them.
pub fn imported(case: &str, folder: &Path) -> (Result<Similarity, String>, Option<f64>) {
    let path = folder.join(format!("{case}.json"));
    let argument = path.display().to_string();
    let bytes = match std::fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return (Err("no answer file".into()), None),
        Err(error) => return (Err(format!("{argument}: {error}")), None),
    };
    let file: AnswerFile = match parsed(&argument, &bytes) {
        Ok(file) => file,
        Err(error) => return (Err(described(&error)), None),
    };
    let seconds = file.seconds.filter(|seconds| seconds.is_finite() && *seconds >= 0.0);
    let pose = match (file.camera_from_mesh, file.error) {
        (Some(pose), None) => pose.similarity(&argument).map_err(|error| described(&error)),
        (None, Some(error)) => Err(format!("the method's own error: {error}")),
        _ => Err(format!("{argument}: expected one of cameraFromMesh, targetFromSource and error")),
    };
    (pose, seconds)
}
