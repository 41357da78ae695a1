//! Calibration of a view whose depth or lens is not fully known: the shift of a relative depth map, its scale and the focal
//! length, from the objects in it.
//!
//! In: a [`RawView`] and its objects. Out: the depth map and the camera that all other parts take, and how well they are
//! determined.

pub mod calibration;
pub mod estimate;
pub mod frames;
pub mod prior;
pub mod profile;
pub mod raw_view;
pub mod unknowns;

use calibration::{Calibration, DepthCalibration};
use estimate::{Estimate, estimate};
use profile::CalibrationObject;
use raw_view::{Focal, RawView};

use crate::error::Result;
use crate::evidence::observation::check_mask_size;
use crate::geometry::depth_kind::DepthKind;
use crate::geometry::image::{DepthMap, Mask};
use crate::geometry::order::median;
use crate::geometry::pinhole::Pinhole;
use crate::precise::drawing::pose::MeshFrame;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::precise::scoring::prior::Prior as ScalePrior;
use crate::progress::{Host, Stage, Stopwatch};
use crate::scheduler::Scheduler;

/// Progress at the start of each stage.
const PLAN: &[(Stage, f64)] = &[(Stage::Prepare, 0.0), (Stage::Search, 0.0), (Stage::Refine, 0.0)];

/// An object of a view.
pub struct Object<'a> {
    /// Its pixels.
    pub mask: &'a Mask,
    /// The pixels of the others, if there are any.
    pub others: Option<Mask>,
    /// Its mesh.
    pub mesh: &'a PreparedMesh<'a>,
    /// Its options.
    pub options: &'a AlignOptions,
}

/// A calibrated view.
#[derive(Debug, Clone)]
pub struct Calibrated {
    /// Its depth: in metres if the calibration is metric.
    pub depth: DepthMap,
    /// Its camera.
    pub camera: Pinhole,
    /// The calibration.
    pub calibration: DepthCalibration,
}

/// Calibrates a view by its objects: at once if nothing is unknown.
///
/// # Errors
/// Those of [`Observation::new`](crate::evidence::observation::Observation::new), of meshes, and
/// [`NoConsensus`](crate::error::ErrorCode::NoConsensus).
pub async fn calibrate(
    view: &RawView,
    objects: &[Object<'_>],
    host: &mut dyn Host,
    scheduler: &Scheduler,
) -> Result<Calibrated> {
    for object in objects {
        check_mask_size([view.values.width(), view.values.height()], object.mask)?;
        object.mesh.check()?;
    }
    let mut stages = Stopwatch::new(host, PLAN);
    let is_metric = view.kind == DepthKind::Metric;
    let lengths: Vec<Option<f64>> = objects.iter().map(|object| known_scale(object.mesh, object.options)).collect();
    let is_scaled = !is_metric && lengths.iter().any(Option::is_some);
    if !view.kind.is_affine() && view.focal == Focal::Known && !is_scaled {
        return calibrated(view, Calibration::default(), None, is_metric);
    }
    let subjects: Vec<CalibrationObject<'_>> = objects.iter().map(|object| subject(object, is_metric)).collect();
    let estimate = estimate(view, &subjects, None, scheduler, &mut stages).await?;
    let factors = lengths.iter().zip(&estimate.poses).filter_map(|(length, pose)| {
        let (length, pose) = length.as_ref().zip(pose.as_ref())?;
        Some((length / pose.scale()) as f32)
    });
    let factor = if is_metric { None } else { median(factors).map(f64::from) };
    let calibration = Calibration { scale: estimate.calibration.scale * factor.unwrap_or(1.0), ..estimate.calibration };
    calibrated(view, calibration, Some(&estimate), is_metric || factor.is_some())
}

fn calibrated(
    view: &RawView,
    calibration: Calibration,
    estimate: Option<&Estimate>,
    is_metric: bool,
) -> Result<Calibrated> {
    let camera = view.camera(&calibration);
    let uncertainty = estimate.map(Estimate::uncertainty).unwrap_or_default();
    Ok(Calibrated {
        depth: view.depth(&calibration)?,
        camera,
        calibration: DepthCalibration::new(view.kind, calibration, camera, uncertainty, is_metric),
    })
}

/// The scale that is known of an object, metres per unit of its normalised mesh.
fn known_scale(mesh: &PreparedMesh<'_>, options: &AlignOptions) -> Option<f64> {
    ScalePrior::of(options, mesh.mesh(), &MeshFrame::of(mesh.mesh())).fixed_scale()
}

/// An object for the estimate. Lengths in metres are no help while the unit of the depth is unknown.
fn subject<'a>(object: &Object<'a>, is_metric: bool) -> CalibrationObject<'a> {
    let Object { mask, others, mesh, options } = object;
    let has_length = known_scale(mesh, options).is_some();
    let mut options = (*options).clone();
    if !is_metric {
        (options.scale, options.known_extent_m) = Default::default();
    }
    CalibrationObject { mask, others: others.clone(), mesh, options, has_length }
}
