//! The JSON files of a case folder.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::prelude::*;

/// Names of the files of a case folder, and of the folder of the objects of a scene.
pub const CAMERA: &str = "camera.json";
pub const TRUTH: &str = "gt.json";
pub const CAMERA_POSE: &str = "pose.json";
pub const META: &str = "meta.json";
pub const INITIAL: &str = "initial.json";
pub const OBJECTS: &str = "objects";

/// The content of [`CAMERA`].
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CameraFile {
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    pub width: Option<usize>,
    pub height: Option<usize>,
    /// Metres per unit of integer depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth_scale: Option<f64>,
}

/// A similarity, in one of two forms: a matrix, or scale, rotation and translation.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct PoseFile {
    /// 16 numbers, column by column.
    #[serde(skip_serializing_if = "Option::is_none")]
    matrix: Option<[f64; 16]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<RotationFile>,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum RotationFile {
    Rows([[f64; 3]; 3]),
    /// Quaternion x, y, z, w.
    Quaternion([f64; 4]),
}

/// The content of [`TRUTH`]: the true pose and the symmetry, in words that all readers understand and, exactly, as axes.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct TruthFile {
    pub available: Option<bool>,
    #[serde(flatten)]
    pub pose: PoseFile,
    pub symmetry: Option<String>,
    pub symmetry_axes: Option<Vec<AxisFile>>,
}

/// An axis of symmetry; `fold` is `null` for a continuous one.
#[derive(Debug, Serialize, Deserialize)]
pub struct AxisFile {
    pub axis: [f64; 3],
    pub fold: Option<u32>,
}

/// The content of [`META`] of a generated case.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MetaFile {
    pub tier: Option<String>,
    pub class: Option<String>,
    pub tags: Vec<String>,
}

/// The content of [`CAMERA_POSE`] of a frame.
#[derive(Debug, Serialize, Deserialize)]
pub struct CameraPoseFile {
    /// 4 × 4, by rows.
    pub camera_to_world: [[f64; 4]; 4],
}

/// The content of a JSON file.
///
/// # Errors
/// [`ErrorCode::CorruptFile`] for other content.
pub fn parsed<T: DeserializeOwned>(argument: &str, bytes: &[u8]) -> Result<T> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(text).map_err(|error| {
        let (found, remedy) = (error.to_string(), "Write the file as the guide describes it.");
        Error::new(ErrorCode::CorruptFile, argument.to_owned(), found, "the JSON of a case folder", remedy)
    })
}

impl From<&Similarity> for PoseFile {
    fn from(pose: &Similarity) -> Self {
        Self { matrix: Some(pose.to_column_major()), ..Self::default() }
    }
}

impl PoseFile {
    /// The similarity.
    ///
    /// # Errors
    /// [`ErrorCode::InvalidTransform`] for missing parts, and for parts of no similarity.
    pub fn similarity(&self, argument: &str) -> Result<Similarity> {
        if let Some(matrix) = &self.matrix {
            return Similarity::from_column_major(matrix);
        }
        let (Some(scale), Some(rotation), Some(translation)) = (self.scale, &self.rotation, self.translation) else {
            let expected = "{ scale, rotation, translation } or { matrix }";
            let remedy = "Write all parts of x_cam = scale · R · p_mesh + translation.";
            let argument = argument.to_owned();
            return Err(Error::new(ErrorCode::InvalidTransform, argument, "a part of a pose", expected, remedy));
        };
        let rotation = match rotation {
            RotationFile::Rows(rows) => Matrix3::from_row_slice(rows.as_flattened()),
            RotationFile::Quaternion(xyzw) => Similarity::rotation_from_xyzw(xyzw)?,
        };
        Similarity::from_parts(scale, rotation, Vector3::from(translation))
    }
}

impl TruthFile {
    /// The file of a true pose.
    pub fn new(pose: &Similarity, symmetry: &Symmetry) -> Self {
        let axes = if let Symmetry::Declared(axes) = symmetry { axes.as_slice() } else { &[] };
        let words = match axes.iter().find(|axis| axis.fold.is_none()) {
            Some(_) => "continuous",
            None if axes.is_empty() => "none",
            None => "discrete",
        };
        let file = |axis: &SymmetryAxis| AxisFile { axis: axis.axis.into(), fold: axis.fold };
        Self {
            available: Some(true),
            pose: pose.into(),
            symmetry: Some(words.into()),
            symmetry_axes: Some(axes.iter().map(file).collect()),
        }
    }

    /// The symmetry.
    pub fn symmetry(&self) -> Symmetry {
        let words = self.symmetry.as_deref().unwrap_or_default().trim().to_ascii_lowercase();
        match &self.symmetry_axes {
            None if ["discrete", "continuous"].iter().any(|kind| words.starts_with(kind)) => Symmetry::Auto,
            None => Symmetry::None,
            Some(axes) if axes.is_empty() => Symmetry::None,
            Some(axes) => {
                let axis = |file: &AxisFile| SymmetryAxis { axis: Vector3::from(file.axis), fold: file.fold };
                Symmetry::Declared(axes.iter().map(axis).collect())
            }
        }
    }
}
