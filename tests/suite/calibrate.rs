//! Calibration of views: the shift, the scale and the focal length that an image was made with are found again.

use sim3align::align::align;
use sim3align::calibrate::calibration::{Calibration, CalibrationUncertainty};
use sim3align::calibrate::frames::{RawFrame, Sequence, calibrate_views};
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align::calibrate::{Calibrated, Object, calibrate};
use sim3align::error::Result;
use sim3align::geometry::depth_kind::DepthKind;
use sim3align::pauses::{Pauses, finished};

use crate::precise::{body, observe, quick, truth};
use crate::prelude::*;

/// What a model returns for depth z, and the shift t of that.
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
fn raw(seen: &Observation, kind: DepthKind, focal: Focal, factor: f64) -> RawView {
    let depth = seen.depth();
    let values = depth.data().iter().map(|z| if *z > 0.0 { predicted(kind, f64::from(*z)) as f32 } else { f32::NAN });
    let Pinhole { fx, fy, cx, cy } = seen.camera();
    let values = Image::new("depth", depth.width(), depth.height(), values.collect()).unwrap();
    RawView { values, kind, camera: Pinhole::new(factor * fx, factor * fy, cx, cy).unwrap(), focal }
}

fn calibrated(view: &RawView, mask: &Mask, mesh: &Mesh, options: &AlignOptions) -> Result<Calibrated> {
    let mesh = PreparedMesh::borrowed(mesh);
    let objects = [Object { mask, others: None, mesh: &mesh, options }];
    finished(calibrate(view, &objects, &mut Silent, &Pauses::none()))
}

fn frame(degrees: f64, kind: DepthKind, focal: Focal, factor: f64) -> RawFrame {
    let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), degrees.to_radians());
    let pose = Similarity { rotation: turn * truth().rotation, ..truth() };
    let seen = observe(&body(), &pose);
    RawFrame { view: raw(&seen, kind, focal, factor), mask: Some(seen.mask().clone()), world_from_camera: None }
}

const RELATIVE: [DepthKind; 2] = [DepthKind::AffineInvariant, DepthKind::AffineInvariantDisparity];

#[wasm_bindgen_test(unsupported = test)]
fn the_shift_of_relative_depth_is_found() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let z = truth().translation.z;
    for kind in RELATIVE {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let found = calibrated(&view, seen.mask(), &mesh, &quick()).unwrap().calibration;
        let uncertainty = found.uncertainty.shift;
        // The relief of the object is that of its depth relative to the distance that the shift gives it.
        let value = predicted(kind, z);
        let error = libm::log((value + found.shift) / (value + shift(kind))).abs();
        assert!(error < 3.0 * uncertainty + 0.02, "{kind:?}: {error} at {uncertainty}");
        assert!((0.005..0.2).contains(&uncertainty), "{kind:?}: {uncertainty}");
        assert!(!found.is_metric && !found.is_focal_estimated && found.uncertainty.focal == 0.0);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn readings_of_what_is_behind_do_not_change_the_shift() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let kind = DepthKind::AffineInvariant;
    let mut view = raw(&seen, kind, Focal::Known, 1.0);
    let object: Vec<usize> = (0..seen.mask().data().len()).filter(|i| seen.mask().data()[*i] != 0).collect();
    // A fifth of the mask, at its upper end, shows what is four times as far.
    let far = predicted(kind, 4.0 * truth().translation.z) as f32;
    let mut values = view.values.data().to_vec();
    for i in &object[..object.len() / 5] {
        values[*i] = far;
    }
    view.values = Image::new("depth", view.values.width(), view.values.height(), values).unwrap();
    let found = calibrated(&view, seen.mask(), &mesh, &quick()).unwrap().calibration;
    let value = predicted(kind, truth().translation.z);
    let error = libm::log((value + found.shift) / (value + shift(kind))).abs();
    assert!(error < 3.0 * found.uncertainty.shift, "{error} at {}", found.uncertainty.shift);
    assert!(error < 0.3 && found.uncertainty.shift < 0.3, "{error} at {}", found.uncertainty.shift);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_flat_object_says_little_of_the_shift() {
    // A plate from the front: any shift explains it, and the uncertainty is about that of the prior.
    let plate = mapped(&ellipsoid(Vec3::new(0.5, 0.38, 0.3), 24), |p| Vec3::new(p.x, p.y, 0.1 * p.z));
    let pose = Similarity { rotation: Rotation3::identity(), ..truth() };
    let seen = observe(&plate, &pose);
    let deviation = |mesh: &Mesh, seen: &Observation| {
        let view = raw(seen, DepthKind::AffineInvariant, Focal::Known, 1.0);
        calibrated(&view, seen.mask(), mesh, &quick()).unwrap().calibration.uncertainty.shift
    };
    let (flat, deep) = (deviation(&plate, &seen), deviation(&body(), &observe(&body(), &truth())));
    assert!(flat > 2.0 * deep, "{flat} of the plate, {deep} of the body");
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_of_a_calibration_is_that_of_its_formula() {
    let seen = observe(&body(), &truth());
    for kind in DepthKind::ALL {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let scale = match kind {
            DepthKind::Metric => 1.0,
            DepthKind::ScaleInvariant => 1.0 / 2.5,
            DepthKind::AffineInvariant => 1.0 / 3.0,
            DepthKind::AffineInvariantDisparity => 4.0,
        };
        let depth = view.depth(&Calibration { scale, shift: shift(kind), focal: 1.0 }).unwrap();
        for (found, expected) in depth.data().iter().zip(seen.depth().data()) {
            assert!((found - expected).abs() < 1e-5 * expected.max(1e-3), "{kind:?}: {found} for {expected}");
        }
    }
    // What the shift puts behind infinity is far, and not behind the camera.
    let beyond = Calibration { scale: 2.0, shift: 0.0, focal: 1.0 };
    assert_eq!(beyond.depth(DepthKind::AffineInvariantDisparity, -0.1), 1000.0);
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn what_is_known_is_kept_to_the_bit() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    for kind in [DepthKind::Metric, DepthKind::ScaleInvariant] {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let Calibrated { depth, camera, calibration } = calibrated(&view, seen.mask(), &mesh, &quick()).unwrap();
        let values = view.values.data().iter().map(|d| if d.is_finite() { *d } else { 0.0 });
        assert!(depth.data().iter().copied().eq(values));
        assert_eq!(camera, view.camera);
        assert_eq!((calibration.scale, calibration.shift), (1.0, 0.0));
        assert_eq!(calibration.is_metric, kind == DepthKind::Metric);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_known_length_makes_depth_metric() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let options = AlignOptions { scale: ScaleOption::Fixed(truth().scale), ..quick() };
    for kind in [DepthKind::ScaleInvariant, DepthKind::AffineInvariant, DepthKind::AffineInvariantDisparity] {
        let view = raw(&seen, kind, Focal::Known, 1.0);
        let Calibrated { depth, calibration, .. } = calibrated(&view, seen.mask(), &mesh, &options).unwrap();
        assert!(calibration.is_metric, "{kind:?}");
        let is_object = |(_, mask): &(_, &u8)| **mask != 0;
        let ratios = depth.data().iter().zip(seen.depth().data()).zip(seen.mask().data()).filter(is_object);
        let mut ratios: Vec<f32> = ratios.map(|((found, expected), _)| found / expected).collect();
        ratios.sort_by(f32::total_cmp);
        let median = f64::from(ratios[ratios.len() / 2]);
        assert!(libm::log(median).abs() < 0.04, "{kind:?}: {median}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn views_of_one_camera_have_one_focal_length_and_one_size() {
    let kind = DepthKind::AffineInvariantDisparity;
    let frames = [0.0, 70.0].map(|degrees| frame(degrees, kind, Focal::Guessed(0.2), 1.15));
    let (body, options) = (body(), quick());
    let mesh = PreparedMesh::borrowed(&body);
    let found = finished(calibrate_views(&frames, &mesh, &options, &mut Silent, &Pauses::none())).unwrap();
    let [first, second] = [&found[0], &found[1]];
    assert_eq!(first.camera, second.camera);
    assert!(!first.calibration.is_metric && !second.calibration.is_metric);
    // The unit of both is that of the first: the object is at about the same distance in both.
    let [a, b] = [first, second].map(|view| {
        let values: Vec<f32> = view.depth.data().to_vec();
        let mask = frames[usize::from(core::ptr::eq(view, second))].mask.as_ref().unwrap();
        let mut seen: Vec<f32> = values.iter().zip(mask.data()).filter(|(_, m)| **m != 0).map(|(z, _)| *z).collect();
        seen.sort_by(f32::total_cmp);
        f64::from(seen[seen.len() / 2])
    });
    assert!(libm::log(a / b).abs() < 0.08, "{a} and {b}");
}

#[wasm_bindgen_test(unsupported = test)]
fn frames_of_a_video_follow_the_first() {
    let kind = DepthKind::AffineInvariantDisparity;
    let (body, options) = (body(), quick());
    let mesh = PreparedMesh::borrowed(&body);
    let mut sequence = Sequence::default();
    let mut next = |frame: &RawFrame| {
        finished(sequence.next(frame, &mesh, &options, &mut Silent, &Pauses::none())).unwrap().calibration
    };
    let first = next(&frame(0.0, kind, Focal::Known, 1.0));
    let second = next(&frame(4.0, kind, Focal::Known, 1.0));
    let value = predicted(kind, truth().translation.z);
    let distance = |found: &sim3align::calibrate::calibration::DepthCalibration| found.scale / (value + found.shift);
    assert!((distance(&second) / distance(&first) - 1.0).abs() < 0.05, "{second:?} after {first:?}");
    // Without a mask, a frame is taken to be as the one before.
    let last = next(&RawFrame { mask: None, ..frame(8.0, kind, Focal::Known, 1.0) });
    assert_eq!((last.scale, last.shift), (second.scale, second.shift));
}

#[wasm_bindgen_test(unsupported = test)]
fn what_cannot_be_calibrated_is_named() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let view = raw(&seen, DepthKind::AffineInvariant, Focal::Known, 1.0);
    let code = |view: &RawView, mask: &Mask| calibrated(view, mask, &mesh, &quick()).unwrap_err().code;
    let (width, height) = (seen.mask().width(), seen.mask().height());
    assert_eq!(code(&view, &Mask::filled(width, height, 0)), ErrorCode::EmptyMask);
    assert_eq!(code(&view, &Mask::filled(9, 9, 1)), ErrorCode::SizeMismatch);
    let with = |value: f32| RawView { values: Image::filled(width, height, value), ..view.clone() };
    assert_eq!(code(&with(f32::NAN), seen.mask()), ErrorCode::NoDepthInMask);
    assert_eq!(code(&with(0.5), seen.mask()), ErrorCode::FlatDepth);
    let unmasked = RawFrame { view, mask: None, world_from_camera: None };
    let prepared = PreparedMesh::borrowed(&mesh);
    let (views, options) = ([unmasked], quick());
    let error = finished(calibrate_views(&views, &prepared, &options, &mut Silent, &Pauses::none())).unwrap_err();
    assert_eq!((error.code, error.argument.as_ref()), (ErrorCode::InvalidArgument, "views[0].mask"));
}

#[wasm_bindgen_test(unsupported = test)]
fn the_confidence_counts_how_well_the_relief_is_known() {
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    let found =
        |deviation: f64| align(&seen.clone().with_relief_deviation(deviation), &mesh, &quick(), &mut Silent).unwrap();
    let measured = found(0.0);
    assert!(measured.confidence > 0.9);
    for deviation in [0.05, 0.2, 0.43, 2.0] {
        let estimated = found(deviation);
        assert_eq!(estimated.camera_from_mesh, measured.camera_from_mesh);
        let most = (1.0 - (deviation / 0.43) * (deviation / 0.43)).max(0.0);
        assert!((estimated.confidence / measured.confidence - most).abs() < 1e-9, "{deviation}: {most}");
    }
    let relief = |shift, focal| CalibrationUncertainty { shift, focal }.relief();
    assert_eq!([relief(0.0, 0.0), relief(0.2, 0.0), relief(0.0, 0.1), relief(0.1, 0.2)], [0.0, 0.2, 0.1, 0.0]);
    assert!((relief(0.5, 0.3) - 0.4).abs() < 1e-12);
}
