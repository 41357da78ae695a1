//! Arguments and options that are refused, by a code and by name; and inputs in doubt, which are warned of.

use std::sync::Arc;

use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::align::warnings::about_observation;
use sim3align::align::{align, align_paper};
use sim3align::calibrate::frames::{RawFrame, calibrate_views};
use sim3align::calibrate::raw_view::{Focal, RawView};
use sim3align::error::Result;
use sim3align::evidence::observation::{MAX_PIXELS, MIN_POINTS, from_point_map};
use sim3align::evidence::photo::Photo;
use sim3align::geometry::depth_kind::DepthKind;
use sim3align::options::Options;
use sim3align::paper::options::PaperOptions;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::{estimate_sim3, register};
use sim3align::scheduler::{Scheduler, finished};
use sim3align::views::{View, align_views};

use crate::calibrate::{calibrated, raw};
use crate::observations::{HEIGHT, WIDTH, body, observe, quick, truth, views};
use crate::prelude::*;
use crate::shapes::{view, with_depth};

#[track_caller]
fn refused<T>(result: Result<T>, code: ErrorCode, argument: &str) {
    let Err(error) = result else { panic!("{argument}: accepted") };
    assert_eq!((error.code, &*error.argument), (code, argument), "{error}");
    assert!([&error.found, &error.expected, &error.remedy].iter().all(|text| !text.is_empty()), "{error}");
}

/// Good options, and what is wrong with those that are not: the option at fault, and words of its error.
#[wasm_bindgen_test]
fn options_out_of_range_and_in_contradiction_are_refused() {
    let base = AlignOptions::default;
    let (up, pose) = (Some([0.0, 1.0, 0.0]), Some(truth()));
    let scaled = |scale, initial| AlignOptions { scale, initial, ..base() };
    let good = [
        base(),
        AlignOptions { search: SearchScope::Local, initial: pose, ..base() },
        AlignOptions { camera_up: Some([0.0, -2.0, 0.1]), mesh_up: up, ..base() },
        scaled(ScaleOption::Between([0.1, 0.2]), pose),
        // What went through 32-bit floats is not outside.
        scaled(ScaleOption::Fixed(0.17 * (1.0 + 1e-7)), pose),
        scaled(ScaleOption::Fixed(0.17 * (1.0 - 1e-7)), pose),
    ];
    for options in good {
        assert_eq!(options.validate(), Ok(()), "{options:?}");
    }
    let behind = Similarity { translation: -truth().translation, ..truth() };
    let bad = [
        (AlignOptions { max_observed_points: 3, ..base() }, "maxObservedPoints", "3"),
        (scaled(ScaleOption::Between([2.0, 1.0]), None), "scale", "[2, 1]"),
        (scaled(ScaleOption::Fixed(0.0), None), "scale", "0"),
        (scaled(ScaleOption::Between([1.0, f64::INFINITY]), None), "scale", "Infinity"),
        (AlignOptions { known_extent_m: Some(-0.1), ..base() }, "knownExtentM", "-0.1"),
        (AlignOptions { camera_up: Some([0.0; 3]), mesh_up: up, ..base() }, "cameraUp", "0"),
        (AlignOptions { work_budget: Some(f64::NAN), ..base() }, "workBudget", "NaN"),
        (AlignOptions { search: SearchScope::Local, ..base() }, "search", "without an initial pose"),
        (AlignOptions { camera_up: up, ..base() }, "meshUp", "`cameraUp` alone"),
        (AlignOptions { mesh_up: up, ..base() }, "cameraUp", "`meshUp` alone"),
        (
            AlignOptions { known_extent_m: Some(0.095), ..scaled(ScaleOption::Between([0.5, 2.0]), None) },
            "knownExtentM",
            "0.095 m and a scale of [0.5, 2]",
        ),
        (scaled(ScaleOption::Between([0.2, 0.3]), pose), "initial", "[0.2, 0.3]"),
        (scaled(ScaleOption::Between([0.1, 0.16]), pose), "initial", "0.17"),
        (scaled(ScaleOption::Fixed(0.2), pose), "initial", "`scale`: 0.2."),
        (AlignOptions { initial: Some(behind), ..base() }, "initial", ""),
    ];
    let (mesh, seen) = (body(), observe(&body(), &truth()));
    for (options, argument, words) in bad {
        let error = align(&seen, &mesh, &options, &mut Silent).unwrap_err();
        assert!(error.to_string().contains(words), "{words}: {error}");
        refused::<()>(Err(error), ErrorCode::InvalidOption, &format!("options.{argument}"));
    }
    for axes in [vec![([0.0; 3], 2)], vec![([0.0, 0.0, 1.0], 0)], vec![([0.0, 0.0, 1.0], 7), ([0.0, 1.0, 1.0], 7)]] {
        let axes = axes.into_iter().map(|(axis, fold)| SymmetryAxis { axis: axis.into(), fold: Some(fold) });
        let options = AlignOptions { symmetry: Symmetry::Declared(axes.collect()), ..base() };
        refused(align(&seen, &mesh, &options, &mut Silent), ErrorCode::InvalidOption, "symmetry");
    }
    let paper = PaperOptions::default;
    for (options, argument) in [
        (PaperOptions { voxel_divisions: f64::NAN, ..paper() }, "options.voxelDivisions"),
        (PaperOptions { guard: Some([1.5, 2.0]), ..paper() }, "options.guard"),
        (PaperOptions { surface_samples: 99, ..paper() }, "options.surfaceSamples"),
        (PaperOptions { ransac_confidence: 1.0, ..paper() }, "options.ransacConfidence"),
    ] {
        let found = align_paper(&seen, &mesh, &options, &mut Silent);
        refused(found, ErrorCode::InvalidOption, argument);
    }
}

const SIZE: [usize; 2] = [40, 30];

fn pinhole() -> Pinhole {
    Pinhole::new(50.0, 50.0, 20.0, 15.0).unwrap()
}

/// An observation of the pixels that `mask` selects, of depths that differ, or are this one.
fn seen(
    camera: Pinhole,
    size: [usize; 2],
    depth: Option<f32>,
    mask: impl Fn(usize, usize) -> bool,
) -> Result<Observation> {
    view(camera, size, mask, |u, v| depth.unwrap_or(1.0 + 0.01 * (u + 2 * v) as f32))
}

#[wasm_bindgen_test]
fn images_and_cameras_that_show_no_object_are_refused() {
    use ErrorCode::{DegenerateMask, EmptyMask, FlatDepth, InvalidCamera, NoDepthInMask, TooFewPoints};
    let with = |depth, mask: fn(usize, usize) -> bool| seen(pinhole(), SIZE, depth, mask);
    assert!(with(None, |_, _| true).is_ok());
    refused(with(None, |_, _| false), EmptyMask, "mask");
    refused(with(Some(0.0), |_, _| true), NoDepthInMask, "depth");
    refused(with(Some(1e-40), |_, _| true), NoDepthInMask, "depth");
    refused(with(Some(1e37), |_, _| true), NoDepthInMask, "depth");
    refused(with(Some(0.7), |_, _| true), FlatDepth, "depth");
    refused(with(None, |u, v| v == 3 && u + 1 < MIN_POINTS), TooFewPoints, "depth");
    refused(with(None, |_, v| v == 12 || v == 13), DegenerateMask, "mask");
    refused(with(None, |u, _| u == 12 || u == 13), DegenerateMask, "mask");
    // A diagonal line is as wide as high, but no cell of a grid is inside it.
    let camera = Pinhole::new(500.0, 500.0, 320.0, 240.0).unwrap();
    let diagonal = seen(camera, [640, 480], None, |u, v| u == v).unwrap();
    refused(align(&diagonal, &body(), &quick(), &mut Silent), DegenerateMask, "mask");
    for focal in [[1e9, 500.0], [500.0, 1e-3], [1e8, 1e8], [0.1, 0.1]] {
        let camera = Pinhole::new(focal[0], focal[1], 20.0, 15.0);
        refused(camera.and_then(|camera| seen(camera, SIZE, None, |_, _| true)), InvalidCamera, "camera");
    }
    // The principal point of a crop is outside it.
    let beside = |cx: f64, cy: f64| Pinhole::new(500.0, 500.0, cx, cy).unwrap().check_field_of_view(640, 480);
    assert!(beside(-5000.0, 3000.0).is_ok() && beside(1e12, 240.0).is_err() && beside(320.0, -1e6).is_err());
    let mask = Mask::filled(30, 40, 1);
    let depth = DepthMap::from_metres(40, 30, vec![1.0; 1200]).unwrap();
    refused(Observation::new(depth, mask, pinhole()), ErrorCode::SizeMismatch, "mask");
    let (width, height) = (MAX_PIXELS / 4, 5);
    let depth = DepthMap::from_metres(width, height, vec![1.0; width * height]).unwrap();
    let large = Observation::new(depth, Mask::filled(width, height, 1), Pinhole::new(1e6, 1e6, 0.0, 0.0).unwrap());
    assert_eq!(large.unwrap_err().code, ErrorCode::FileTooLarge);
}

#[wasm_bindgen_test]
fn point_maps_tell_their_camera_or_are_refused() {
    let draw = &mut Draw::new(1);
    let map: Vec<f32> = (0..1200)
        .flat_map(|i| {
            let p = pinhole().back_project((i % 40) as f64, (i / 40) as f64, draw.between(1.0, 3.0)).to_array();
            if draw.below(5) == 0 { [f32::NAN, 0.0, f32::INFINITY] } else { p }
        })
        .collect();
    let (depth, found) = from_point_map(40, 30, &map).unwrap();
    let (found, truth) = ([found.fx, found.fy, found.cx, found.cy], [50.0, 50.0, 20.0, 15.0]);
    assert!(found.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-4 * b), "{found:?}");
    let z = map.chunks_exact(3).map(|p| if p[0].is_nan() { 0.0 } else { p[2] });
    assert!(depth.data().iter().copied().eq(z));
    let signed = |signs: [f32; 3]| -> Vec<f32> { map.iter().enumerate().map(|(i, x)| x * signs[i % 3]).collect() };
    for (width, height, points, code) in [
        (40, 30, signed([-1.0, -1.0, 1.0]), ErrorCode::InvalidCamera),
        (40, 30, signed([1.0, -1.0, 1.0]), ErrorCode::InvalidCamera),
        (40, 30, signed([1.0, -1.0, -1.0]), ErrorCode::NoDepthInMask),
        (40, 30, vec![1.0; 3600], ErrorCode::InvalidCamera),
        (40, 30, map[..3599].to_vec(), ErrorCode::WrongLength),
        (0, 30, Vec::new(), ErrorCode::EmptyImage),
        // One column: no telling the focal length.
        (1, 30, map[..90].to_vec(), ErrorCode::InvalidCamera),
    ] {
        refused(from_point_map(width, height, &points), code, "pointMap");
    }
}

#[wasm_bindgen_test]
fn clouds_and_pairs_that_can_not_be_registered_are_refused() {
    let good: Vec<f64> = (0..300).map(|i| f64::from(i * 7919 % 101)).collect();
    let line: Vec<f64> = (0..300).map(|i| f64::from((i / 3 + 1) * (i % 3 + 1))).collect();
    for (cloud, code) in [
        (good[..100].to_vec(), ErrorCode::WrongLength),
        (good[..30].to_vec(), ErrorCode::TooFewPoints),
        (vec![f64::NAN; 300], ErrorCode::TooFewPoints),
        (vec![1.0; 300], ErrorCode::DegeneratePoints),
    ] {
        let options = RegisterOptions::default();
        refused(register(&good, &cloud, &options, &mut Silent), code, "target");
        refused(register(&cloud, &good, &options, &mut Silent), code, "source");
    }
    // On one line, and beyond the squares that are numbers.
    let huge = good.iter().map(|x| x * 1e200).collect();
    for (cloud, code) in [(line, ErrorCode::NoConsensus), (huge, ErrorCode::DegeneratePoints)] {
        let found = [(&good, &cloud), (&cloud, &good), (&cloud, &cloud)].map(|(source, target)| {
            register(source, target, &RegisterOptions::default(), &mut Silent).map_err(|error| error.code).err()
        });
        assert_eq!(found, [Some(code); 3], "{:?}", &cloud[..6]);
    }
    for (pairs, code) in [
        (vec![0, 1, 2], ErrorCode::WrongLength),
        (vec![0, 0, 1, 1], ErrorCode::TooFewPoints),
        (vec![0, 0, 1, 1, 2, 400], ErrorCode::IndexOutOfRange),
        (vec![0, 0, 0, 0, 0, 0], ErrorCode::NoConsensus),
    ] {
        let found = estimate_sim3(&good, &good, &pairs, &EstimateSim3Options::default(), &mut Silent);
        assert_eq!(found.unwrap_err().code, code, "{pairs:?}");
    }
}

#[wasm_bindgen_test]
fn views_and_calibrations_that_can_not_be_are_refused() {
    use ErrorCode::{EmptyMask, FlatDepth, InvalidArgument, InvalidCamera, NoDepthInMask, SizeMismatch};
    let mesh = body();
    let mesh = PreparedMesh::borrowed(&mesh);
    type Change = fn(&mut Vec<View>);
    let cases: [(Change, ErrorCode, &str); 7] = [
        (Vec::clear, InvalidArgument, "views"),
        (|views| views[1].world_from_camera = None, InvalidArgument, "views"),
        (|views| views.iter_mut().for_each(|view| view.frame.mask = None), InvalidArgument, "views"),
        (|views| views[1].frame.camera.fx = 1e-3, InvalidCamera, "views[1].camera"),
        (
            |views| views.iter_mut().for_each(|view| view.frame.depth.data_mut().fill(0.0)),
            NoDepthInMask,
            "views[0].depth",
        ),
        (|views| views[1].frame.photo = Some(Arc::new(Photo::filled(30, 90, [9; 3]))), SizeMismatch, "views[1].image"),
        (
            |views| {
                views.iter_mut().for_each(|view| view.world_from_camera = None);
                views[1].frame.mask = None;
            },
            InvalidArgument,
            "views",
        ),
    ];
    for (change, code, argument) in cases {
        let mut seen = views(&body(), &[0.0, 1.0]);
        change(&mut seen);
        let error = align_views(seen, &mesh, &crate::views::options(), &mut Silent).unwrap_err();
        assert!(error.code == code && error.argument.starts_with(argument), "{argument}: {error}");
    }
    let seen = observe(&body(), &truth());
    let good = raw(&seen, DepthKind::AffineInvariant, Focal::Known, 1.0);
    let (width, height) = (seen.mask().width(), seen.mask().height());
    let of = |value: f32| RawView { values: Image::filled(width, height, value), ..good.clone() };
    for (view, mask, code) in [
        (good.clone(), Mask::filled(width, height, 0), EmptyMask),
        (good.clone(), Mask::filled(9, 9, 1), SizeMismatch),
        (of(f32::NAN), seen.mask().clone(), NoDepthInMask),
        (of(0.5), seen.mask().clone(), FlatDepth),
    ] {
        assert_eq!(calibrated(&view, &mask, &body(), &quick()).unwrap_err().code, code);
    }
    let unmasked = [RawFrame { view: good, mask: None, world_from_camera: None }];
    let (options, scheduler) = (quick(), Scheduler::unbounded());
    let found = finished(calibrate_views(&unmasked, &mesh, &options, &mut Silent, &scheduler));
    refused(found, InvalidArgument, "views[0].mask");
}

#[wasm_bindgen_test]
fn meshes_beyond_the_numbers_are_refused() {
    let observation = observe(&body(), &truth());
    let scaled = |unit: f32| mapped(&body(), |p| p * unit);
    for unit in [1e20, 1e30, 1e-20, 1e-30] {
        let (mesh, pose) = (scaled(unit), Similarity { scale: 1.0 / f64::from(unit), ..truth() });
        refused(align(&observation, &mesh, &quick(), &mut Silent), ErrorCode::DegenerateMesh, "mesh");
        let evaluated = evaluate(&observation, &mesh, &pose, &EvaluateOptions::default());
        refused(evaluated, ErrorCode::DegenerateMesh, "mesh");
    }
    // Nanometres and kilometres.
    for unit in [1e9, 1e-3] {
        let alignment = align(&observation, &scaled(unit), &quick(), &mut Silent).unwrap();
        assert!((alignment.camera_from_mesh.scale * f64::from(unit) / truth().scale - 1.0).abs() < 0.05, "{unit}");
    }
}

#[wasm_bindgen_test]
fn depths_of_any_unit_and_with_odd_readings_are_aligned() {
    let ordinary = observe(&body(), &truth());
    // Some of the readings are beyond the numbers: they count as none.
    let mixed = with_depth(&ordinary, |i, z| if i % 3 == 0 { f32::MIN_POSITIVE } else { z });
    let alignment = align(&mixed.unwrap(), &body(), &quick(), &mut Silent).unwrap();
    assert!(alignment.diagnostics.score.is_finite() && alignment.confidence > 0.0);
    for unit in [1e-9, 1e9] {
        let seen = with_depth(&ordinary, |_, z| z * unit).unwrap();
        let alignment = align(&seen, &body(), &quick(), &mut Silent).unwrap();
        assert!((alignment.camera_from_mesh.scale / f64::from(unit) / truth().scale - 1.0).abs() < 0.05, "{unit}");
    }
}

#[wasm_bindgen_test]
fn a_mask_at_the_border_is_warned_of_where_the_pose_is_in_doubt() {
    let whole = observe(&body(), &truth());
    let mut mask = whole.mask().clone();
    mask.data_mut()[0] = 1;
    let observation = Observation::new(whole.depth().clone(), mask, whole.camera()).unwrap();
    assert_eq!(codes(&about_observation(&observation)), [WarningCode::MaskTouchesBorder]);
    let with = |mesh: &Mesh| align(&observation, mesh, &quick(), &mut Silent).unwrap();
    let right = with(&body());
    assert!(right.confidence > 0.5 && right.warnings.is_empty(), "{} {:?}", right.confidence, right.warnings);
    let other = with(&cuboid(Vec3::new(0.2, 0.3, 1.4)));
    assert!(other.confidence < 0.5, "{}", other.confidence);
    for code in [WarningCode::MaskTouchesBorder, WarningCode::MeshDoubtful] {
        assert!(codes(&other.warnings).contains(&code), "{code:?}: {:?}", other.warnings);
    }
}

#[wasm_bindgen_test]
fn doubtful_depth_and_masks_are_warned_of() {
    let whole = observe(&body(), &truth());
    let is_object = |i: usize| whole.mask().data()[i] != 0;
    let seen = |value: &dyn Fn(usize, f32) -> f32| codes(&about_observation(&with_depth(&whole, value).unwrap()));
    // Depth of the object, of a wall behind it, and of an object that hides all but a share of the columns.
    let hidden = |hidden: usize, value: fn(f32) -> f32| {
        seen(&|i, z| match (is_object(i), i % WIDTH < hidden) {
            (true, _) => value(z),
            (false, true) => value(0.3),
            (false, false) => value(1.8),
        })
    };
    let [metres, disparity]: [fn(f32) -> f32; 2] = [|z| z, |z| 1.0 / z];
    // Depth from 0, of a single pixel, to 1; the same in integers of 16 bits that are taken for millimetres.
    let nearest = whole.depth().data().iter().copied().fold(f32::INFINITY, f32::min);
    let normalised = |i: usize, z: f32| if i == 0 { 0.0 } else { 0.05 + 0.95 * (z - nearest) / (0.9 - nearest) };
    // The same of a sensor that lacks readings; a single pixel has the largest value.
    let lacking = |i: usize, z: f32| match i {
        1 => 1.0,
        _ if i.is_multiple_of(50) => 0.0,
        _ => 0.9 * normalised(i, z),
    };
    let integers = |i: usize, z: f32| (f64::from((normalised(i, z) * 65535.0).round()) * 0.001) as f32;
    const LARGER: f32 = 5.0;
    let cases: [(&str, Vec<WarningCode>, &[WarningCode]); 15] = [
        ("metres", hidden(0, metres), &[]),
        ("disparity", hidden(0, disparity), &[WarningCode::DepthLooksInverted]),
        ("hidden by half", hidden(WIDTH / 2, metres), &[]),
        ("at the bottom of a box", hidden(WIDTH, metres), &[WarningCode::DepthLooksInverted]),
        ("disparity at the bottom of a box", hidden(WIDTH, disparity), &[]),
        ("normalised", seen(&normalised), &[WarningCode::DepthLooksNormalised]),
        ("normalised integers", seen(&integers), &[WarningCode::DepthLooksNormalised]),
        ("normalised, of a sensor that lacks readings", seen(&lacking), &[WarningCode::DepthLooksNormalised]),
        ("a sensor that lacks readings", seen(&|i, z| (1000.0 * lacking(i, z)).round() / 1000.0), &[]),
        ("a map that ends elsewhere", seen(&|i, z| 1.1 * normalised(i, z)), &[]),
        ("centimetres", seen(&|_, z| 100.0 * z), &[WarningCode::DepthLooksLikeMillimetres]),
        ("metres of something large", seen(&|_, z| LARGER * z), &[]),
        ("whole millimetres of it", seen(&|_, z| (1000.0 * LARGER * z).round() / 1000.0), &[WarningCode::SizeDoubtful]),
        ("millimetres", seen(&|_, z| 1000.0 * z), &[WarningCode::DepthLooksLikeMillimetres]),
        ("thousandths", seen(&|_, z| 0.001 * z), &[WarningCode::DepthLooksTooSmall]),
    ];
    for (what, mut found, expected) in cases {
        // Of values that are no lengths, the size may be anything.
        found.retain(|code| what.contains("metres") || *code != WarningCode::SizeDoubtful);
        assert_eq!(found, expected, "{what}");
    }
    let mask = Mask::filled(WIDTH, HEIGHT, 1);
    let covered = Observation::new(whole.depth().clone(), mask, whole.camera()).unwrap();
    assert!(codes(&about_observation(&covered)).contains(&WarningCode::MaskCoversImage));
    let background = whole.mask().data().iter().map(|pixel| u8::from(*pixel == 0)).collect();
    let background = Mask::new("mask", WIDTH, HEIGHT, background).unwrap();
    let slope = with_depth(&whole, |i, z| z + 0.001 * (i % WIDTH) as f32).unwrap();
    let inverted = Observation::new(slope.depth().clone(), background, whole.camera()).unwrap();
    let found = codes(&about_observation(&inverted));
    assert!(found.contains(&WarningCode::MaskLooksInverted), "{found:?}");
    assert!(!found.contains(&WarningCode::DepthLooksInverted), "{found:?}");
}
