//! Calibration of views: the shift, the scale and the focal length that an image was made with are found again.

use sim3align::align::align;
use sim3align::calibrate::calibration::Calibration;
use sim3align::calibrate::frames::{RawFrame, Sequence, calibrate_views};
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align::calibrate::{Calibrated, Object, calibrate};
use sim3align::error::Result;
use sim3align::evidence::frame::Frame;
use sim3align::geometry::depth_kind::DepthKind;
use sim3align::scheduler::{Scheduler, finished};
use sim3align::track::TrackOptions;
use sim3align::track::tracker::Tracker;
use sim3align::views::align_views;

use crate::observations::{body, frame_of, observe, orbit, quick, truth, views};
use crate::prelude::*;

/// The output of a model for depth z, and its shift t.
fn predicted(kind: DepthKind, z: f64) -> f64 {
    match kind {
        DepthKind::Metric => z,
        DepthKind::ScaleInvariant => 2.5 * z,
        DepthKind::AffineInvariant => 3.0 * z - 1.2,
        DepthKind::AffineInvariantDisparity => 4.0 / z - 2.0,
    }
}

fn shift(kind: DepthKind) -> f64 {
    match kind {
        DepthKind::AffineInvariant => 1.2,
        DepthKind::AffineInvariantDisparity => 2.0,
        _ => 0.0,
    }
}

/// The view of an observation, as a model of this kind returns it.
pub fn raw(seen: &Observation, kind: DepthKind, focal: Focal, factor: f64) -> RawView {
    let depth = seen.depth();
    let values = depth.data().iter().map(|z| if *z > 0.0 { predicted(kind, f64::from(*z)) as f32 } else { f32::NAN });
    let Pinhole { fx, fy, cx, cy } = seen.camera();
    let values = Image::new("depth", depth.width(), depth.height(), values.collect()).unwrap();
    RawView { values, kind, camera: Pinhole::new(factor * fx, factor * fy, cx, cy).unwrap(), focal }
}

pub fn calibrated(view: &RawView, mask: &Mask, mesh: &Mesh, options: &AlignOptions) -> Result<Calibrated> {
    let mesh = PreparedMesh::borrowed(mesh);
    let objects = [Object { mask, others: None, mesh: &mesh, options }];
    finished(calibrate(view, &objects, &mut Silent, &Scheduler::unbounded()))
}

/// How far the relief that a shift gives the body is from the true one, as the logarithm of the ratio.
fn relief_error(kind: DepthKind, found: f64) -> f64 {
    let value = predicted(kind, truth().translation.z);
    libm::log((value + found) / (value + shift(kind))).abs()
}

/// The median.
fn middle(values: impl Iterator<Item = f32>) -> f64 {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    f64::from(values[values.len() / 2])
}

#[wasm_bindgen_test]
fn the_shift_of_relative_depth_is_found() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    for kind in [DepthKind::AffineInvariant, DepthKind::AffineInvariantDisparity] {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let found = calibrated(&view, seen.mask(), &mesh, &quick()).unwrap().calibration;
        let (error, uncertainty) = (relief_error(kind, found.shift), found.uncertainty.shift);
        assert!(error < 3.0 * uncertainty + 0.02, "{kind:?}: {error} at {uncertainty}");
        assert!((0.005..0.2).contains(&uncertainty), "{kind:?}: {uncertainty}");
        assert!(!found.is_metric && !found.is_focal_estimated && found.uncertainty.focal == 0.0);
        // A fifth of the mask, at its upper end, shows what is four times as far.
        let object: Vec<usize> = (0..seen.mask().data().len()).filter(|i| seen.mask().data()[*i] != 0).collect();
        let mut values = view.values.data().to_vec();
        for i in &object[..object.len() / 5] {
            values[*i] = predicted(kind, 4.0 * truth().translation.z) as f32;
        }
        let values = Image::new("depth", view.values.width(), view.values.height(), values).unwrap();
        let found = calibrated(&RawView { values, ..view }, seen.mask(), &mesh, &quick()).unwrap().calibration;
        let (error, uncertainty) = (relief_error(kind, found.shift), found.uncertainty.shift);
        assert!(error < 3.0 * uncertainty && error < 0.3 && uncertainty < 0.3, "{kind:?}: {error} at {uncertainty}");
    }
}

#[wasm_bindgen_test]
fn a_focal_length_is_found_from_relief() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    for factor in [0.8, 1.25] {
        let view = raw(&seen, DepthKind::Metric, Focal::Guessed(0.25), factor);
        let Calibrated { camera, calibration, .. } = calibrated(&view, seen.mask(), &mesh, &quick()).unwrap();
        let error = libm::log(camera.fx / seen.camera().fx).abs();
        let uncertainty = calibration.uncertainty.focal;
        assert!(error < 3.0 * uncertainty, "{factor}: {error} at {uncertainty}");
        assert!(error < 0.5 * libm::log(factor).abs(), "{factor}: {error}");
        assert!(calibration.is_metric && calibration.is_focal_estimated && calibration.shift == 0.0);
        assert!((camera.fx / camera.fy - seen.camera().fx / seen.camera().fy).abs() < 1e-12);
    }
}

#[wasm_bindgen_test]
fn a_known_length_makes_depth_metric() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let options = AlignOptions { scale: ScaleOption::Fixed(truth().scale), ..quick() };
    for kind in [DepthKind::ScaleInvariant, DepthKind::AffineInvariantDisparity] {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let Calibrated { depth, calibration, .. } = calibrated(&view, seen.mask(), &mesh, &options).unwrap();
        assert!(calibration.is_metric, "{kind:?}");
        let is_object = |(_, mask): &(_, &u8)| **mask != 0;
        let ratios = depth.data().iter().zip(seen.depth().data()).zip(seen.mask().data()).filter(is_object);
        let median = middle(ratios.map(|((found, expected), _)| found / expected));
        assert!(libm::log(median).abs() < 0.04, "{kind:?}: {median}");
    }
}

#[wasm_bindgen_test]
fn views_and_frames_share_a_camera_and_a_unit() {
    let kind = DepthKind::AffineInvariantDisparity;
    let frame = |angle: f64, focal, factor| {
        let seen = observe(&body(), &orbit(angle));
        RawFrame { view: raw(&seen, kind, focal, factor), mask: Some(seen.mask().clone()), world_from_camera: None }
    };
    let (body, options) = (body(), quick());
    let mesh = PreparedMesh::borrowed(&body);
    let frames = [0.0, 1.2].map(|angle| frame(angle, Focal::Guessed(0.2), 1.15));
    let found = finished(calibrate_views(&frames, &mesh, &options, &mut Silent, &Scheduler::unbounded())).unwrap();
    assert_eq!(found[0].camera, found[1].camera);
    let error = libm::log(found[0].camera.fx / observe(&body, &truth()).camera().fx).abs();
    assert!(error < 0.02, "the focal length is off by {error}");
    // The object is at about the same distance in both.
    let [a, b] = [0, 1].map(|k| {
        let pixels = found[k].depth.data().iter().zip(frames[k].mask.as_ref().unwrap().data());
        middle(pixels.filter(|(_, m)| **m != 0).map(|(z, _)| *z))
    });
    assert!(libm::log(a / b).abs() < 0.08, "{a} and {b}");

    let mut sequence = Sequence::default();
    let mut next = |frame: &RawFrame| {
        finished(sequence.next(frame, &mesh, &options, &mut Silent, &Scheduler::unbounded())).unwrap().calibration
    };
    let [first, second] = [0.0, 0.07].map(|angle| next(&frame(angle, Focal::Known, 1.0)));
    let value = predicted(kind, truth().translation.z);
    let ratio = (second.scale / (value + second.shift)) / (first.scale / (value + first.shift));
    assert!((ratio - 1.0).abs() < 0.05, "{second:?} after {first:?}");
    // Without a mask, a frame is taken to be as the one before.
    let last = next(&RawFrame { mask: None, ..frame(0.14, Focal::Known, 1.0) });
    assert_eq!((last.scale, last.shift), (second.scale, second.shift));
}

/// Frames without masks from a model whose factor jumps by up to a fifth: each is in the unit of the first one. A factor that
/// hardly changes is kept, so that what moves does not add up.
#[wasm_bindgen_test]
fn the_factor_of_each_frame_follows_from_the_frame_before() {
    let (seen, body) = (observe(&body(), &truth()), body());
    let (mesh, options) = (PreparedMesh::borrowed(&body), quick());
    let mut sequence = Sequence::default();
    let mut scales = Vec::new();
    for (i, factor) in [1.0, 0.83, 1.15, 1.16, 0.9].into_iter().enumerate() {
        let mut view = raw(&seen, DepthKind::ScaleInvariant, Focal::Known, 1.0);
        let values = view.values.data().iter().map(|value| value * factor).collect();
        view.values = Image::new("depth", view.values.width(), view.values.height(), values).unwrap();
        let mask = (i == 0).then(|| seen.mask().clone());
        let frame = RawFrame { view, mask, world_from_camera: None };
        let found = finished(sequence.next(&frame, &mesh, &options, &mut Silent, &Scheduler::unbounded())).unwrap();
        scales.push(found.calibration.scale * f64::from(factor));
    }
    for (i, scale) in scales.iter().enumerate() {
        assert!((scale / scales[0] - 1.0).abs() < 0.02, "frame {i}: {scales:?}");
    }
}

#[wasm_bindgen_test]
fn the_confidence_counts_how_well_the_relief_is_known() {
    let seen = observe(&body(), &truth());
    let found = |sd: f64| align(&seen.clone().with_relief_deviation(sd), &body(), &quick(), &mut Silent).unwrap();
    let measured = found(0.0);
    for deviation in [0.05, 0.2, 0.43, 2.0] {
        let estimated = found(deviation);
        assert_eq!(estimated.camera_from_mesh, measured.camera_from_mesh);
        let most = (1.0 - (deviation / 0.43) * (deviation / 0.43)).max(0.0);
        assert!((estimated.confidence / measured.confidence - most).abs() < 1e-9, "{deviation}: {most}");
    }
}

/// Views with known cameras are as certain as the best of them; others, and frames, each on its own.
#[wasm_bindgen_test]
fn the_confidence_of_views_and_frames_counts_it_too() {
    let deviations = [0.2, 0.3];
    let certainty = deviations.map(|deviation: f64| 1.0 - (deviation / 0.43) * (deviation / 0.43));
    let confidences = |are_known: bool, is_estimated: bool| {
        let mut seen = views(&body(), &[0.0, 1.3]);
        for (view, deviation) in seen.iter_mut().zip(deviations) {
            view.frame.relief_deviation = if is_estimated { deviation } else { 0.0 };
            view.world_from_camera = view.world_from_camera.filter(|_| are_known);
        }
        let found = align_views(seen, &PreparedMesh::borrowed(&body()), &crate::views::options(), &mut Silent).unwrap();
        [found.views[0].confidence, found.views[1].confidence, found.confidence]
    };
    for (are_known, most) in [(true, [certainty[0]; 3]), (false, [certainty[0], certainty[1], certainty[1]])] {
        let (estimated, measured) = (confidences(are_known, true), confidences(are_known, false));
        for k in 0..3 {
            // The least of several is that of a view that is about as sure as the others.
            let tolerance = if k == 2 && !are_known { 0.05 } else { 1e-9 };
            assert!(
                (estimated[k] / measured[k] - most[k]).abs() < tolerance,
                "{are_known}, {k}: {estimated:?} {measured:?}"
            );
        }
    }
    let tracked = |relief_deviation: f64| {
        let mut tracker = Tracker::new(PreparedMesh::new(body()), TrackOptions::default()).unwrap();
        let frame = Frame { relief_deviation, ..frame_of(&observe(&body(), &truth())) };
        tracker.next(&frame, &mut Silent).unwrap().confidence
    };
    assert!((tracked(0.2) / tracked(0.0) - certainty[0]).abs() < 1e-9);
}

#[wasm_bindgen_test]
fn values_that_are_no_readings_have_no_depth() {
    let seen = observe(&body(), &truth());
    for kind in [DepthKind::ScaleInvariant, DepthKind::AffineInvariant, DepthKind::AffineInvariantDisparity] {
        let RawView { values, camera, focal, .. } = raw(&seen, kind, Focal::Known, 1.0);
        let none = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        let holes = values.data().iter().enumerate().map(|(i, value)| none.get(i % 7).unwrap_or(value));
        let values = Image::new("depth", values.width(), values.height(), holes.copied().collect()).unwrap();
        let depth = RawView { values, kind, camera, focal }.depth(&Calibration::default()).unwrap();
        for (i, z) in depth.data().iter().enumerate() {
            assert_eq!(*z > 0.0, i % 7 >= none.len(), "{kind:?}: pixel {i} has depth {z}");
        }
    }
}
