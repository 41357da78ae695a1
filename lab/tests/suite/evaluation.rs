//! The evaluation set: reproducible, true to its truth, as hard as it says.

use std::collections::BTreeSet;
use std::fs;

use nalgebra::Unit;
use sim3align::align::method::Method;
use sim3align::evidence::clouds::Sampling;
use sim3align::geometry::surface::SurfaceMoments;
use sim3align::metrics::evaluate;
use sim3align::metrics::pose_error::{PoseErrors, pose_errors};
use sim3align::metrics::silhouette::iou;
use sim3align_lab::bench::benchmark::{BenchCase, LOOSE, STRICT, run_case};
use sim3align_lab::case_folder::write;
use sim3align_lab::cases::case::{EvaluationCase, EvaluationSet, MIN_MASK_PX};
use sim3align_lab::cases::tier::{CaseSet, Class, Tier};
use sim3align_lab::prelude::*;

use crate::common::{assert_canonical, assert_closed, assert_read_back, fresh, mask_px, object_depth, parameter};

/// Cases that the tests look at: every class of every tier at least once.
const LOOKED_AT: usize = 36;

fn cases() -> impl Iterator<Item = EvaluationCase> {
    let set = EvaluationSet::new(7);
    (0..LOOKED_AT).map(move |index| set.case(index).unwrap())
}

/// The magnitude of a simulated error of a case.
fn of(case: &EvaluationCase, name: &str) -> f64 {
    parameter(&case.parameters, name)
}

#[test]
fn a_case_follows_from_set_seed_and_index_alone() {
    for (set, indices) in
        [(CaseSet::General, [0, 4, 5, 14]), (CaseSet::Sensors, [0, 4, 11, 15]), (CaseSet::Colors, [1, 4, 5, 6])]
    {
        for index in indices {
            let case = |seed, set| EvaluationSet::new(seed).of(set).case(index).unwrap();
            let files = |seed| case(seed, set).files().unwrap();
            assert_eq!(files(1), files(1), "{set:?} {index}");
            assert_ne!(files(1), files(2), "{set:?} {index}");
            if set != CaseSet::General {
                assert_ne!(case(1, set).object, case(1, CaseSet::General).object, "{set:?} {index}");
            }
        }
    }
    let set = EvaluationSet::new(1);
    assert_ne!(set.case(0).unwrap().object, set.case(3).unwrap().object);
}

#[test]
fn tiers_and_classes_take_turns() {
    let cells: BTreeSet<(Tier, Class)> = (0..LOOKED_AT).map(|i| (Tier::of(i), CaseSet::General.class(i))).collect();
    for class in Class::ALL {
        let others = [CaseSet::Sensors, CaseSet::Colors];
        let other_set = (0..LOOKED_AT).any(|i| others.iter().any(|set| set.class(i) == *class));
        assert!(cells.iter().any(|(_, c)| c == class) != other_set, "{class:?}");
        assert_eq!(Class::from_name(class.as_str()), Ok(*class));
    }
    for tier in Tier::ALL {
        assert_eq!((0..240).filter(|&i| Tier::of(i) == *tier).count(), 80);
        assert_eq!(Tier::from_name(tier.as_str()), Ok(*tier));
    }
    assert_eq!(Class::from_name("blurry").unwrap_err().code, ErrorCode::InvalidOption);
}

#[test]
fn every_case_keeps_to_its_tier_and_shows_what_its_class_says() {
    let mut families = BTreeSet::new();
    for case in cases() {
        let name = case.name();
        let of = |name| of(&case, name);
        let mask_px = mask_px(&case.observation);
        assert!(mask_px >= MIN_MASK_PX, "{name}: {mask_px} pixels");
        assert!(of("visible") >= case.tier.least_visible(case.class), "{name}: {} visible", of("visible"));
        let [stretch, offset, missing] = match case.tier {
            Tier::Easy => [0.01, 1.0, 0.1],
            Tier::Medium => [0.03, 2.0, 0.25],
            Tier::Hard => [0.06, 3.0, 0.4],
        };
        let resolution = case.observation.depth().width() as f64 / 640.0;
        assert!(of("stretch") <= stretch, "{name}: stretch {}", of("stretch"));
        assert!(of("maskOffsetPx").abs() <= offset * resolution, "{name}: mask off by {}", of("maskOffsetPx"));
        assert!(of("missingDepth") <= missing, "{name}: {} missing", of("missingDepth"));
        assert!((0.8..=1.25).contains(&of("depthBias")), "{name}: bias {}", of("depthBias"));
        match case.class {
            Class::Occluded => assert!((0.05..=0.45).contains(&of("hidden")), "{name}: {} hidden", of("hidden")),
            Class::BorderCut => assert!((0.04..=0.25).contains(&of("cut")), "{name}: {} cut", of("cut")),
            Class::Tiny => assert!(mask_px <= 1600, "{name}: {mask_px} pixels"),
            Class::MissingPart => assert!(case.tags.iter().any(|tag| tag.starts_with("lost-")), "{name}"),
            Class::ExtraPart => assert!(case.tags.contains(&"extra-part"), "{name}"),
            Class::SparseSensor => assert!(case.tags.contains(&"sensor") && of("missingDepth") > 0.05, "{name}"),
            _ => {}
        }
        assert_canonical(&case.mesh, &name);
        families.insert(case.family);
    }
    assert!(families.len() >= 12, "{families:?}");
}

#[test]
fn objects_are_closed_parts_that_face_outward() {
    for case in cases() {
        assert_closed(&case.object, &case.name());
    }
}

#[test]
fn the_object_is_where_the_mask_and_the_depth_say() {
    for case in cases().filter(|case| case.tier == Tier::Easy) {
        // An outline is off by a pixel at most; half of it, on average.
        let mask = case.observation.mask();
        let silhouette = object_depth(&case).iter().map(|z| u8::from(*z > 0.0)).collect();
        let overlap = iou(mask, &Mask::new("silhouette", mask.width(), mask.height(), silhouette).unwrap());
        println!("{}: IoU {overlap:.3}", case.name());
        assert!(overlap >= 0.87, "{}: {overlap}", case.name());
        let metrics =
            evaluate(&case.observation, &case.object, &case.camera_from_object, &Sampling::default()).unwrap();
        assert!(metrics.fitness.unwrap() >= 0.9, "{}: {metrics:?}", case.name());
        // In the depth map's own metric there is no bias.
        let diagonal_mm = 1000.0 * of(&case, "diagonalM") * of(&case, "depthBias");
        assert!(metrics.depth_mae_mm.unwrap() < 0.04 * diagonal_mm, "{}: {metrics:?}", case.name());
    }
}

#[test]
fn the_truth_fits_the_generated_mesh_as_well_as_its_tier_lets_it() {
    for case in cases() {
        let metrics = evaluate(&case.observation, &case.mesh, &case.camera_from_mesh, &Sampling::default()).unwrap();
        let visible = of(&case, "visible");
        println!("{}: {metrics:?}", case.name());
        let [overlap, fitness, normals] = match case.tier {
            Tier::Easy => [0.85, 0.9, 0.85],
            Tier::Medium => [0.65, 0.8, 0.7],
            Tier::Hard => [0.5, 0.6, 0.5],
        };
        assert!(metrics.iou.unwrap() >= overlap * visible, "{}: {metrics:?}", case.name());
        assert!(metrics.fitness.unwrap() >= fitness, "{}: {metrics:?}", case.name());
        assert!(metrics.normal_consistency.unwrap() >= normals, "{}: {metrics:?}", case.name());
    }
}

#[test]
fn a_turn_that_the_declared_symmetry_allows_is_no_error() {
    let mut tried = 0;
    for case in cases() {
        let Symmetry::Declared(axes) = &case.symmetry else { continue };
        if case.tags.contains(&"lost-part") {
            continue;
        }
        tried += 1;
        // About the object's own axis, which the faults of its mesh hardly move.
        let centroid = Vector3::from(SurfaceMoments::of(&case.object).centroid.to_array());
        let object_from_mesh = case.camera_from_object.inverse().compose(&case.camera_from_mesh);
        for axis in axes {
            let direction = Unit::new_normalize(object_from_mesh.rotation * axis.axis);
            let turn = Rotation3::from_axis_angle(&direction, axis.fold.map_or(2.0, |n| 2.0 * PI / f64::from(n)));
            let turned = Similarity { scale: 1.0, rotation: turn, translation: centroid - turn * centroid };
            let estimate = case.camera_from_object.compose(&turned).compose(&object_from_mesh);
            let errors = pose_errors(&case.mesh, &estimate, &case.camera_from_mesh, &case.symmetry).unwrap();
            println!("{}: {errors:?}", case.name());
            assert!(errors.rotation_error_deg < 0.01, "{}: {errors:?}", case.name());
            assert!(errors.translation_error_relative < 0.03, "{}: {errors:?}", case.name());
            // The object itself is unchanged by it.
            let surface = pose_errors(&case.object, &turned, &Similarity::identity(), &Symmetry::None).unwrap();
            assert!(surface.add_s_mm < 3.0 * of(&case, "diagonalM"), "{}: {surface:?}", case.name());
        }
    }
    assert!(tried >= 3, "{tried} symmetric cases");
}

#[test]
fn a_written_case_reads_back() {
    let folder = fresh("evaluation");
    // One without symmetry, and one with.
    let set = EvaluationSet::new(7);
    let symmetric = cases().find(|case| matches!(case.symmetry, Symmetry::Declared(_))).unwrap();
    for case in [set.case(2).unwrap(), symmetric] {
        case.write(&folder).unwrap();
        let read = BenchCase::read(&folder);
        fs::remove_dir_all(&folder).unwrap();
        assert_read_back(&read.unwrap(), &case.into());
    }
}

#[test]
fn meshes_of_a_folder_are_shown_at_the_size_of_things() {
    let folder = fresh("evaluation-meshes");
    fs::create_dir_all(&folder).unwrap();
    let mesh = EvaluationSet::new(7).case(6).unwrap().mesh;
    fs::write(folder.join("thing.glb"), write::glb(&mesh)).unwrap();
    let set = EvaluationSet::with_meshes(7, &folder);
    let missing = EvaluationSet::with_meshes(7, &folder.join("nowhere")).unwrap_err();
    fs::remove_dir_all(&folder).unwrap();
    assert_eq!(missing.code, ErrorCode::InvalidArgument);
    let set = set.unwrap();
    let shown: Vec<_> = (0..24).map(|i| set.case(i).unwrap()).filter(|case| case.family == "thing").collect();
    assert!((2..=16).contains(&shown.len()), "{} of 24", shown.len());
    for case in shown {
        let size = case.object.positions().iter().fold(0.0f64, |far, p| far.max(vector3(*p).norm()));
        assert!((0.03..1.0).contains(&size), "{size} m");
    }
}

#[test]
fn a_record_holds_what_tables_need() {
    let case = BenchCase::from(EvaluationSet::new(7).case(0).unwrap());
    let record = run_case(&case, &Method::default(), &[]);
    assert_eq!(record.alignment.is_some(), record.error.is_none());
    assert_eq!(record.alignment.is_some(), record.errors.is_some());
    assert!(record.truth_metrics.is_some() && record.seconds > 0.0);
    assert!(record.success(&STRICT).is_some());
    let json = serde_json::to_value(&record).unwrap();
    for name in ["name", "tier", "class", "alignment", "errors", "truthMetrics", "truthScaleRatio", "seconds"] {
        assert!(json.get(name).is_some(), "{name}");
    }

    // An error is a failure, and nothing is claimed without a truth.
    let failed = run_case(&case, &PaperOptions { voxel_divisions: 0.0, ..PaperOptions::default() }.into(), &[]);
    assert_eq!((failed.success(&LOOSE), failed.errors), (Some(false), None));
    assert!(failed.error.unwrap().starts_with("INVALID_OPTION"));
    let without = run_case(&BenchCase { truth: None, ..case }, &Method::default(), &[]);
    assert_eq!((without.success(&STRICT), without.truth_metrics), (None, None));
}

#[test]
fn tolerances_hold_up_to_their_bounds() {
    let errors = PoseErrors {
        scale_error: 0.05,
        rotation_error_deg: 10.0,
        translation_error_m: 1.0,
        translation_error_relative: 0.05,
        add_s_mm: 1.0,
    };
    assert!(STRICT.holds(&errors) && LOOSE.holds(&errors));
    for beyond in [
        PoseErrors { scale_error: 0.051, ..errors },
        PoseErrors { rotation_error_deg: 10.1, ..errors },
        PoseErrors { translation_error_relative: 0.051, ..errors },
    ] {
        assert!(!STRICT.holds(&beyond) && LOOSE.holds(&beyond), "{beyond:?}");
    }
}
