//! Calibrations of several frames of one object: each frame has a scale and a shift of its own, the object one size.

use super::calibration::Calibration;
use super::estimate::{Estimate, Start, estimate};
use super::profile::{CalibrationObject, RefinedPose};
use super::raw_view::{Focal, RawView};
use super::{Calibrated, Object, calibrated, known_scale, subject};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::observation::check_mask_size;
use crate::geometry::depth_kind::DepthKind;
use crate::geometry::image::Mask;
use crate::geometry::order::median;
use crate::geometry::similarity::Similarity;
use crate::precise::drawing::prepared_mesh::PreparedMesh;
use crate::precise::options::AlignOptions;
use crate::progress::{Host, Stopwatch};
use crate::scheduler::Scheduler;
use glam::DVec3;

/// A frame of the caller.
pub struct RawFrame {
    /// Its depth and its camera.
    pub view: RawView,
    /// The pixels of the object.
    pub mask: Option<Mask>,
    /// World from camera, of scale 1, if it is known.
    pub world_from_camera: Option<Similarity>,
}

/// A frame whose unit has not been compared with that of the others.
struct FrameEstimate {
    estimate: Estimate,
    pose: RefinedPose,
}

/// Calibrates several views of an object. Their units are made one by the size of the object: in metres if that is known, if
/// the depth is metric, or if the poses of the cameras determine their distances.
///
/// # Errors
/// As [`calibrate`](super::calibrate), with the argument of the view; [`ErrorCode::InvalidArgument`] for a view without a
/// mask.
pub async fn calibrate_views(
    frames: &[RawFrame],
    mesh: &PreparedMesh<'_>,
    options: &AlignOptions,
    host: &mut dyn Host,
    scheduler: &Scheduler,
) -> Result<Vec<Calibrated>> {
    let mut stages = Stopwatch::new(host, super::PLAN);
    mesh.check()?;
    let mut all = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let own = estimate_frame(frame, mesh, options, None, scheduler, &mut stages).await;
        all.push(own.map_err(|error| error.in_view(k))?);
    }
    share_focal(frames, &mut all);
    let is_metric = frames.iter().all(|frame| frame.view.kind.is_metric());
    let known = known_scale(mesh, options);
    let size = if is_metric { None } else { known.or_else(|| size_between(frames, &all)) };
    let first = all.first().map_or(1.0, |own| own.pose.scale());
    let calibrated = frames.iter().zip(&all).map(|(frame, FrameEstimate { estimate, pose })| {
        let factor = if is_metric { 1.0 } else { size.unwrap_or(first) / pose.scale() };
        scaled(&frame.view, estimate, factor, is_metric || size.is_some())
    });
    calibrated.collect()
}

/// Change of the median ratio of two depth maps from which on it is that of the model's factor, not of what moved.
const JUMP: f64 = 0.03;
/// Distance in pixels between the depths that are compared with those of the next frame.
const STRIDE: usize = 7;

/// The calibrations of the frames of a video, one after the other.
#[derive(Debug, Clone, Default)]
pub struct Sequence {
    last: Option<Last>,
}

/// The state after a frame.
#[derive(Debug, Clone)]
struct Last {
    /// Size of the object in the unit of the results.
    size: f64,
    is_metric: bool,
    /// The focal length, relative to that of the guess.
    focal: f64,
    focal_deviation: f64,
    /// The estimate of the last frame with a mask, its pose, and its scale in the unit of the results.
    estimate: Estimate,
    pose: RefinedPose,
    calibration: Calibration,
    /// Depths of the last frame in the unit of the results, see [`STRIDE`].
    depths: Vec<f32>,
}

impl Sequence {
    /// Calibrates the next frame: the first one as a view, the later ones from the pose in the one before, at its focal
    /// length and its size. A frame without a mask, or in which the object is not found, is taken to be as the one before, but for
    /// a jump of the factor of scale-invariant depth, which most of the image shows.
    ///
    /// # Errors
    /// As [`calibrate`](super::calibrate) for the first frame.
    pub async fn next(
        &mut self,
        frame: &RawFrame,
        mesh: &PreparedMesh<'_>,
        options: &AlignOptions,
        host: &mut dyn Host,
        scheduler: &Scheduler,
    ) -> Result<Calibrated> {
        let mut stages = Stopwatch::new(host, super::PLAN);
        let Some(last) = &mut self.last else {
            mesh.check()?;
            let FrameEstimate { estimate, pose } =
                estimate_frame(frame, mesh, options, None, scheduler, &mut stages).await?;
            let is_metric = frame.view.kind.is_metric();
            let known = known_scale(mesh, options).filter(|_| !is_metric);
            let factor = known.map_or(1.0, |known| known / pose.scale());
            let is_metric = is_metric || known.is_some();
            let result = scaled(&frame.view, &estimate, factor, is_metric)?;
            let calibration = times(estimate.calibration, factor);
            let (focal, focal_deviation) = (calibration.focal, estimate.focal_deviation);
            let (size, pose) = (factor * pose.scale(), pose.rebased(focal));
            let depths = depths_of(&result);
            self.last = Some(Last { size, is_metric, focal, focal_deviation, estimate, pose, calibration, depths });
            return Ok(result);
        };
        let view = RawView {
            camera: frame.view.camera(&Calibration { focal: last.focal, ..Calibration::default() }),
            focal: Focal::Known,
            ..frame.view.clone()
        };
        let (is_metric, size) = (last.is_metric, last.size);
        if !view.kind.is_metric() && frame.mask.is_some() {
            let at = super::unknowns::Unknowns { focal: 0.0, ..last.estimate.unknowns };
            let start = Start { at, poses: vec![vec![last.pose]] };
            let next = RawFrame { view: view.clone(), mask: frame.mask.clone(), world_from_camera: None };
            if let Ok(FrameEstimate { estimate, pose }) =
                estimate_frame(&next, mesh, options, Some(start), scheduler, &mut stages).await
            {
                last.calibration = times(estimate.calibration, size / pose.scale());
                (last.estimate, last.pose) = (estimate, pose);
            }
        }
        if view.kind == DepthKind::ScaleInvariant && frame.mask.is_none() {
            let values = view.values.data().iter().step_by(STRIDE);
            let pairs = last.depths.iter().zip(values).filter(|(last, value)| **last > 0.0 && **value > 0.0);
            if let Some(factor) = median(pairs.map(|(last, value)| *last / *value)).map(f64::from)
                && (factor / last.calibration.scale - 1.0).abs() > JUMP
            {
                last.calibration.scale = factor;
            }
        }
        let calibration = Calibration { focal: 1.0, ..last.calibration };
        let mut estimate = last.estimate.clone();
        estimate.focal_deviation = last.focal_deviation;
        let result = calibrated(&view, calibration, Some(&estimate), is_metric)?;
        last.depths = depths_of(&result);
        Ok(result)
    }
}

fn depths_of(Calibrated { depth, .. }: &Calibrated) -> Vec<f32> {
    depth.data().iter().step_by(STRIDE).copied().collect()
}

/// The estimate of a frame alone, and the pose of the object.
async fn estimate_frame(
    frame: &RawFrame,
    mesh: &PreparedMesh<'_>,
    options: &AlignOptions,
    start: Option<Start>,
    scheduler: &Scheduler,
    stages: &mut Stopwatch<'_>,
) -> Result<FrameEstimate> {
    let view = &frame.view;
    let Some(mask) = &frame.mask else {
        return Err(Error::new(
            ErrorCode::InvalidArgument,
            "mask",
            "no mask",
            "a mask where depth or focal length are not known",
            "They are estimated from the object: pass its mask, or leave the view out.",
        ));
    };
    check_mask_size([view.values.width(), view.values.height()], mask)?;
    let object = Object { mask, others: None, mesh, options };
    let subjects: [CalibrationObject<'_>; 1] = [subject(&object, view.kind.is_metric())];
    let estimate = estimate(view, &subjects, start, scheduler, stages).await?;
    let pose = estimate.poses.first().copied().flatten().ok_or_else(crate::precise::no_candidate)?;
    Ok(FrameEstimate { estimate, pose })
}

/// Gives views of the same camera, whose focal length is a guess, the mean of their estimates. Each of these includes the guess,
/// which counts once.
fn share_focal(frames: &[RawFrame], all: &mut [FrameEstimate]) {
    let Some(RawFrame { view: first, .. }) = frames.first() else { return };
    let is_shared = |view: &RawView| view.camera == first.camera && view.focal == first.focal;
    let Focal::Guessed(deviation) = first.focal else { return };
    if !frames.iter().all(|frame| is_shared(&frame.view)) {
        return;
    }
    let inverse_square = |deviation: f64| 1.0 / (deviation * deviation);
    let (guess, weight) =
        (inverse_square(deviation), |own: &FrameEstimate| inverse_square(own.estimate.focal_deviation));
    let weights = guess + all.iter().map(|own| (weight(own) - guess).max(0.0)).sum::<f64>();
    let focal = all.iter().map(|own| weight(own) * own.estimate.unknowns.focal).sum::<f64>() / weights;
    for (own, frame) in all.iter_mut().zip(frames) {
        own.estimate.set_focal(frame.view.kind, focal, libm::sqrt(1.0 / weights));
        own.pose = own.pose.at_focal(own.estimate.calibration.focal);
    }
}

/// The size of the object that puts it to one place in the world: in each view i it is at C_i + S·d_i, with the centre C_i of
/// the camera and the direction d_i of the object per unit of its size. The least squares over all pairs of views. `None`
/// without camera poses that differ.
fn size_between(frames: &[RawFrame], all: &[FrameEstimate]) -> Option<f64> {
    let lines = frames.iter().zip(all).map(|(frame, FrameEstimate { pose, .. })| {
        let pose_of_camera = frame.world_from_camera.as_ref()?;
        let direction = pose.center() / pose.scale();
        let turned = pose_of_camera.rotation * nalgebra::Vector3::from(direction.to_array());
        Some([DVec3::from_slice(pose_of_camera.translation.as_slice()), DVec3::from_slice(turned.as_slice())])
    });
    let lines: Vec<[DVec3; 2]> = lines.collect::<Option<_>>()?;
    let (mut along, mut squares) = (0.0, 0.0);
    for (k, [center, direction]) in lines.iter().enumerate() {
        for [other_center, other_direction] in lines.iter().skip(k + 1) {
            let (apart, turned) = (*center - *other_center, *direction - *other_direction);
            along -= apart.dot(turned);
            squares += turned.length_squared();
        }
    }
    let size = along / squares;
    (size.is_finite() && size > 0.0).then_some(size)
}

fn times(calibration: Calibration, factor: f64) -> Calibration {
    Calibration { scale: calibration.scale * factor, ..calibration }
}

fn scaled(view: &RawView, estimate: &Estimate, factor: f64, is_metric: bool) -> Result<Calibrated> {
    calibrated(view, times(estimate.calibration, factor), Some(estimate), is_metric)
}
