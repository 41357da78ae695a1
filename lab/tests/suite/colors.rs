//! The generated set of coloured objects: each class shows its effect, and colour decides where shape does not.

use std::sync::OnceLock;

use sim3align::align::align_prepared;
use sim3align::align::evaluate::{EvaluateOptions, evaluate_prepared};
use sim3align::align::search::Request;
use sim3align::metrics::pose_error::pose_errors;
use sim3align_geometry::surface_colors::COLOR_SAMPLES;
use sim3align_lab::bench::benchmark::BenchCase;
use sim3align_lab::cases::case::{EvaluationCase, EvaluationSet};
use sim3align_lab::cases::tier::{CaseSet, Class, Tier};
use sim3align_lab::prelude::*;

use crate::common::{assert_read_back, fresh, parameter};

/// Every class of every tier.
const LOOKED_AT: usize = 24;

/// A case of the set that the tests look at. Their photos take seconds to render, so that the tests share them.
fn case(index: usize) -> &'static EvaluationCase {
    static CASES: [OnceLock<EvaluationCase>; LOOKED_AT] = [const { OnceLock::new() }; LOOKED_AT];
    CASES[index].get_or_init(|| EvaluationSet::new(11).of(CaseSet::Colors).case(index).unwrap())
}

fn of_class(class: Class) -> impl Iterator<Item = &'static EvaluationCase> {
    (0..LOOKED_AT).filter(move |&index| CaseSet::Colors.class(index) == class).map(case)
}

fn agreement(case: &EvaluationCase, pose: &Similarity) -> f64 {
    let mesh = PreparedMesh::borrowed(&case.mesh).with_colors(case.colors.clone());
    let metrics = evaluate_prepared(&case.observation, &mesh, pose, &EvaluateOptions::default()).unwrap().metrics;
    metrics.color_agreement.unwrap()
}

#[test]
fn the_print_agrees_at_the_true_pose_and_only_where_it_is_the_objects() {
    for class in [Class::Printed, Class::Blotted, Class::PrintedShape] {
        for case in of_class(class) {
            let true_pose = agreement(case, &case.camera_from_mesh);
            let least = case.tier.pick(0.7, 0.5, 0.2);
            // A shape with a print may turn its blank side to the camera.
            assert!(
                true_pose > if class == Class::PrintedShape { -0.2 } else { least },
                "{}: {true_pose}",
                case.name()
            );
        }
    }
    for class in [Class::WrongColors, Class::OneColor] {
        for case in of_class(class) {
            let true_pose = agreement(case, &case.camera_from_mesh);
            assert!(true_pose < 0.3, "{}: {true_pose}", case.name());
        }
    }
}

#[test]
fn a_grey_photo_has_no_colour_and_others_have() {
    for class in [Class::GreyPhoto, Class::Printed] {
        for case in of_class(class) {
            let photo = case.observation.photo().unwrap();
            let is_grey = photo.data().iter().all(|[r, g, b]| r == g && g == b);
            assert_eq!(is_grey, class == Class::GreyPhoto, "{}", case.name());
        }
    }
}

#[test]
fn what_the_print_tells_has_no_symmetry_and_what_it_does_not_has_that_of_its_shape() {
    for class in [Class::Printed, Class::Blotted, Class::GreyPhoto] {
        assert!(of_class(class).all(|case| case.symmetry == Symmetry::None));
    }
    for class in [Class::OneColor, Class::WrongColors] {
        assert!(of_class(class).all(|case| case.symmetry != Symmetry::None));
    }
}

#[test]
fn colour_finds_the_right_turn() {
    for case in of_class(Class::Printed).filter(|case| case.tier != Tier::Hard) {
        let mesh = PreparedMesh::borrowed(&case.mesh).with_colors(case.colors.clone());
        let request = Request::new(AlignOptions::default()).unwrap();
        let found = align_prepared(&case.observation, &mesh, request, &mut Silent).unwrap();
        let pose = Similarity::from_column_major(&found.camera_from_mesh.matrix).unwrap();
        let errors = pose_errors(&case.mesh, &pose, &case.camera_from_mesh, &case.symmetry).unwrap();
        assert!(errors.rotation_error_deg < 10.0, "{}: {errors:?}, {:?}", case.name(), found.diagnostics.color);
    }
}

#[test]
fn photos_have_several_sizes_and_formats_and_are_read_from_files() {
    let cases: Vec<&EvaluationCase> = (0..LOOKED_AT).map(case).collect();
    let parameter = |case: &EvaluationCase, name| parameter(&case.parameters, name);
    for case in &cases {
        let (photo, depth) = (case.observation.photo().unwrap(), case.observation.depth());
        let size = parameter(case, "photoSize");
        // Photos of more than two megapixels are reduced by a whole number.
        let ratio = size * depth.width() as f64 / photo.width() as f64;
        assert!((ratio - ratio.round()).abs() < 1e-9, "{}: {ratio}", case.name());
        let name = if parameter(case, "photoJpegQuality") > 0.0 { "rgb.jpg" } else { "rgb.png" };
        assert!(case.color_files.iter().any(|file| file.0 == name), "{}", case.name());
        assert_eq!(case.colors.as_ref().unwrap().colors().len(), COLOR_SAMPLES);
    }
    for size in [0.5, 1.0, 1.5, 2.0] {
        assert!(cases.iter().any(|case| parameter(case, "photoSize") == size), "{size}");
    }
    let has = |name| cases.iter().any(|case| case.color_files.iter().any(|file| file.0 == name));
    assert!(["rgb.jpg", "rgb.png", "texture.jpg", "texture.png"].into_iter().all(has));
}

#[test]
fn a_written_case_has_the_same_photo_mesh_and_colours() {
    let folder = fresh("colors");
    for index in 0..6 {
        let case = case(index);
        case.write(&folder).unwrap();
        let read = BenchCase::read(&folder);
        std::fs::remove_dir_all(&folder).unwrap();
        assert_read_back(&read.unwrap(), &case.clone().into());
    }
}
