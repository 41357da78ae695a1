//! How well an object of a monocular image was aligned.

use serde::Serialize;

use super::calibration::Calibration;
use super::picture::Thing;
use crate::prelude::*;
use sim3align::align::evaluate::Truth;
use sim3align::geometry::surface::SurfaceMoments;
use sim3align::report::Sim3;

/// Maximum errors of a pose that is right: what shows in the image, whatever the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Degrees.
    pub rotation_deg: f64,
    /// Of the apparent size, as a share.
    pub size: f64,
    /// Of the position in the image, as a share of the apparent diameter.
    pub direction: f64,
}

/// Rotation within 10°, apparent size and direction within 5 %.
pub const STRICT: Tolerance = Tolerance { rotation_deg: 10.0, size: 0.05, direction: 0.05 };
/// Twice the errors of [`STRICT`].
pub const LOOSE: Tolerance = Tolerance { rotation_deg: 20.0, size: 0.1, direction: 0.1 };

/// Errors of a pose, up to the symmetry of the object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Errors {
    /// Degrees.
    pub rotation_deg: f64,
    /// Of focal length · scale / distance, as a share, with its sign.
    pub apparent_size: f64,
    /// Shift of the object's centre in the image, as a share of its apparent diameter.
    pub direction: f64,
    /// Of the size in metres, as a share, with its sign.
    pub size: f64,
    /// Of the shift of the map at the object, see [`Calibration::shift_error`].
    pub shift: f64,
    /// Of the focal length, as a share, with its sign.
    pub focal: f64,
}

/// The record of an object.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Record {
    /// The row.
    pub row: &'static str,
    /// A [`Way`](super::runs::Way) by name.
    pub way: &'static str,
    /// The image.
    pub picture: String,
    /// The object.
    pub object: String,
    /// The pose.
    pub pose: Option<Sim3>,
    /// Its confidence.
    pub confidence: f64,
    /// Scale, shift and camera as they were assumed or estimated.
    pub calibration: Option<Calibration>,
    /// The true ones.
    pub truth: Calibration,
    /// Errors relative to the truth, if it is known.
    pub errors: Option<Errors>,
    /// Whether the true pose is known.
    pub has_truth: bool,
    /// Whether sizes are said to be in metres.
    pub is_metric: bool,
    /// Standard deviations of shift and focal length, relative, as they were estimated.
    pub deviations: Option<[f64; 2]>,
    /// Whether the length of this object was told.
    pub is_told: bool,
    /// Why there is no pose.
    pub error: Option<String>,
}

impl Tolerance {
    /// Whether the errors of a pose are within the tolerance.
    pub fn holds(&self, errors: &Errors) -> bool {
        errors.rotation_deg <= self.rotation_deg
            && errors.apparent_size.abs() <= self.size
            && errors.direction <= self.direction
    }
}

/// A record in a file: also whether it is right, by [`STRICT`] and by [`LOOSE`].
#[derive(Debug, Serialize)]
pub struct JudgedRecord<'a> {
    #[serde(flatten)]
    record: &'a Record,
    strict: Option<bool>,
    loose: Option<bool>,
}

impl<'a> From<&'a Record> for JudgedRecord<'a> {
    fn from(record: &'a Record) -> Self {
        Self { record, strict: record.success(&STRICT), loose: record.success(&LOOSE) }
    }
}

impl Record {
    /// Whether the pose is within a tolerance; `None` if the true pose is unknown. An error is a failure.
    pub fn success(&self, tolerance: &Tolerance) -> Option<bool> {
        self.has_truth.then(|| self.errors.is_some_and(|errors| tolerance.holds(&errors)))
    }
}

impl Errors {
    /// The errors of a pose that was found with a calibration.
    ///
    /// # Errors
    /// Those of [`Symmetry::group`].
    pub fn of(thing: &Thing, truth: &Truth, found: &Similarity, calibrations: [&Calibration; 2]) -> Result<Self> {
        let [assumed, true_one] = calibrations;
        let truth = nearest_truth(&thing.mesh, truth, found)?;
        let center = Bounds::of(thing.mesh.positions()).map_or_else(Vector3::zeros, |b| vector3(b.center()));
        let [seen, wanted] = [found, &truth].map(|pose| pose.apply(center));
        // Of both axes, as pixels may not be square.
        let focal = |camera: &Pinhole| (camera.fx * camera.fy).sqrt();
        let apparent = |pose: &Similarity, z: f64, camera: &Pinhole| focal(camera) * pose.scale / z;
        let wanted_size = apparent(&truth, wanted.z, &true_one.camera);
        let pixel = |point: &Vector3<f64>, camera: &Pinhole| {
            DVec2::new(camera.fx * point.x / point.z + camera.cx, camera.fy * point.y / point.z + camera.cy)
        };
        let moved = pixel(&seen, &assumed.camera).distance(pixel(&wanted, &true_one.camera));
        Ok(Self {
            rotation_deg: truth.rotation_angle_to(found).to_degrees(),
            apparent_size: apparent(found, seen.z, &assumed.camera) / wanted_size - 1.0,
            direction: moved / (wanted_size * thing.mesh.diagonal()),
            size: found.scale / truth.scale - 1.0,
            shift: assumed.shift_error(true_one, wanted.z),
            focal: assumed.focal_error(true_one),
        })
    }
}

/// Among the equivalent true poses under the symmetry of the object, that with the nearest rotation.
fn nearest_truth(mesh: &Mesh, truth: &Truth, found: &Similarity) -> Result<Similarity> {
    let pose = &truth.camera_from_mesh;
    let relative = UnitQuaternion::from_rotation_matrix(&(pose.rotation.inverse() * found.rotation));
    let rotation = truth.symmetry.group(mesh)?.nearest(&relative);
    let center = Vector3::from(SurfaceMoments::of(mesh).centroid.to_array());
    let turned =
        Similarity { scale: 1.0, rotation: rotation.to_rotation_matrix(), translation: center - rotation * center };
    Ok(pose.compose(&turned))
}
