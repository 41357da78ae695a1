//! Poses as results state them.

use serde::Serialize;

use crate::geometry::similarity::Similarity;
use crate::metrics::symmetry::SymmetryAxis;

/// A similarity y = s·R·x + t in the forms that applications use.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Sim3 {
    /// s, target units per source unit; for `align`, metres per mesh unit.
    pub scale: f64,
    /// R as a unit quaternion [x, y, z, w], w ≥ 0 (three.js, glTF).
    pub rotation: [f64; 4],
    /// R as three rows of three.
    pub rotation_matrix: [[f64; 3]; 3],
    /// t, in target units; for `align`, metres.
    pub translation: [f64; 3],
    /// The 4×4 matrix, 16 numbers **column by column** (three.js `Matrix4.elements`, glTF `node.matrix`, WebGPU).
    #[cfg_attr(feature = "types", ts(type = "number[]"))]
    pub matrix: [f64; 16],
}

impl From<&Similarity> for Sim3 {
    fn from(similarity: &Similarity) -> Self {
        let row = |i: usize| similarity.rotation.matrix().row(i).transpose().into();
        Self {
            scale: similarity.scale,
            rotation: similarity.quaternion_xyzw(),
            rotation_matrix: [row(0), row(1), row(2)],
            translation: similarity.translation.into(),
            matrix: similarity.to_column_major(),
        }
    }
}

/// A mesh in the proportions that the image shows: x_cam = s·R·S·p_mesh + t. The image determines less of them the less it
/// shows of a side; what it does not show stays as the mesh has it, and is uncertain.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Stretch {
    /// s, R and t: the similarity of the stretched mesh S·p.
    #[serde(flatten)]
    pub camera_from_stretched: Sim3,
    /// S as three rows of three: symmetric, of determinant 1, in the frame of the mesh.
    pub stretch: [[f64; 3]; 3],
    /// Lengths of the box around the stretched mesh along x, y and z of its frame, in metres.
    pub size_m: [f64; 3],
    /// Standard deviations of the lengths along x, y and z of the mesh, relative: 0.01 is one per cent.
    pub uncertainty: [f64; 3],
}

impl Stretch {
    /// The same, moved in the frame of the camera.
    pub fn shifted(mut self, by: [f64; 3]) -> Self {
        let Sim3 { translation, matrix, .. } = &mut self.camera_from_stretched;
        for (k, by) in by.into_iter().enumerate() {
            translation[k] += by;
            matrix[12 + k] = translation[k];
        }
        self
    }
}

/// An axis of a symmetry of the shape, in the form that the option `symmetry` takes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct FoundSymmetry {
    /// The axis in the mesh's frame, through the centroid of the surface.
    pub axis: [f64; 3],
    /// The number of equivalent positions in a full rotation; missing for a surface of revolution.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub fold: Option<u32>,
}

impl From<&SymmetryAxis> for FoundSymmetry {
    fn from(&SymmetryAxis { axis, fold }: &SymmetryAxis) -> Self {
        Self { axis: axis.into(), fold }
    }
}

/// Another pose that explains the observation: a transform like the alignment's own.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Alternative {
    /// The transform from the mesh's frame to the camera's.
    #[serde(flatten)]
    pub camera_from_mesh: Sim3,
    /// Its score, which compares with the alignment's `diagnostics.score`.
    pub score: f64,
    /// The angle between its rotation and the alignment's, in degrees, 0 to 180.
    pub turn_deg: f64,
    /// The correlation of the alignment's colours with the photo, minus that of this pose; present where colours were
    /// compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "types", ts(optional))]
    pub color_margin: Option<f64>,
}

/// Standard deviations of the pose's parts, as the observation determines them. Parts that a single view leaves open have
/// large ones.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(ts_rs::TS))]
#[serde(rename_all = "camelCase")]
pub struct Uncertainty {
    /// Of the scale, relative: 0.01 is one per cent.
    pub scale: f64,
    /// Of the rotation about the least determined axis, in degrees, up to the symmetry of the mesh.
    pub rotation_deg: f64,
    /// That axis: a unit vector in the camera's frame.
    pub rotation_axis: [f64; 3],
    /// The axis of revolution of the mesh, a unit vector in the camera's frame: any turn about it leaves its shape as it is,
    /// and does not count as uncertain. `null` if it has none.
    pub free_axis: Option<[f64; 3]>,
    /// Of the mesh centre's position across the line of sight, in metres.
    pub lateral_m: f64,
    /// Of the mesh centre's distance from the camera, in metres.
    pub distance_m: f64,
}
