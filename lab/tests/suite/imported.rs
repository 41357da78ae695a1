//! Answers of other programs: read strictly, scored as our own.

use std::fs;

use serde_json::{Value, json};
use sim3align::align::evaluate::{EvaluateOptions, evaluate};
use sim3align::metrics::Metrics;
use sim3align_lab::bench::benchmark::{BenchCase, Record, STRICT};
use sim3align_lab::bench::imported::{CASE, Outcome, imported, read_answer};
use sim3align_lab::cases::case::EvaluationSet;
use sim3align_lab::prelude::*;

use crate::common::{assert_near, fresh};

const DOCUMENTATION: &str = include_str!("../../../docs/importing-results.md");

fn case() -> BenchCase {
    EvaluationSet::new(3).case(0).unwrap().into()
}

fn truth(case: &BenchCase) -> Similarity {
    case.truth.as_ref().unwrap().camera_from_mesh
}

/// What comes of a case with this answer.
fn import(test: &str, case: &BenchCase, answer: &str) -> Record {
    let folder = fresh(&format!("imported-{test}"));
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(format!("{}.json", case.name)), answer).unwrap();
    let record = imported(case, &folder);
    fs::remove_dir_all(folder).unwrap();
    record
}

fn pose_json(pose: &Similarity) -> Value {
    let rows: Vec<Vec<f64>> = pose.rotation.matrix().row_iter().map(|row| row.iter().copied().collect()).collect();
    let translation: [f64; 3] = pose.translation.into();
    json!({ "scale": pose.scale, "rotation": rows, "translation": translation })
}

fn pose_of(record: &Record) -> Similarity {
    let alignment = record.alignment.as_ref().unwrap_or_else(|| panic!("{:?}", record.error));
    Similarity::from_column_major(&alignment.camera_from_mesh().matrix).unwrap()
}

/// Vertices of the mesh and where `pose` takes them; every other one is taken somewhere else in the box of the rest.
fn half_wrong_pairs(case: &BenchCase, pose: &Similarity, seed: u64) -> Value {
    let mut random = Random::new(seed, 1);
    let positions = case.mesh.positions();
    let mut draw = || vector3(positions[(random.uniform() * positions.len() as f64) as usize]);
    let pairs: Vec<[Vector3<f64>; 2]> = (0..400)
        .map(|i| {
            let (p, other) = (draw(), draw());
            [p, pose.apply(if i % 2 == 0 { p } else { other })]
        })
        .collect();
    let points = |side: usize| -> Vec<[f64; 3]> { pairs.iter().map(|pair| pair[side].into()).collect() };
    json!({ "mesh": points(0), "camera": points(1) })
}

#[test]
fn the_documented_examples_are_imported_as_the_page_says() {
    let examples: Vec<&str> =
        DOCUMENTATION.split("```json\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    assert_eq!(examples.len(), 4, "a pose, its matrix, correspondences, an error");
    let case = case();
    let quarter_turn = Rotation3::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    let pose = Similarity { scale: 0.25, rotation: quarter_turn, translation: Vector3::new(0.1, 0.0, 0.8) };
    for (i, seconds) in [0.83, 0.83, 0.31].into_iter().enumerate() {
        let record = import("documented", &case, examples[i]);
        assert_near(&pose_of(&record), &pose, 1e-6);
        assert_eq!((record.seconds, record.error), (seconds, None));
    }
    let record = import("documented", &case, examples[3]);
    assert_eq!(record.alignment, None);
    assert!(record.error.unwrap().contains("fewer than three matches"));
    assert_eq!(record.seconds, 0.31);
}

#[test]
fn a_pose_is_scored_as_evaluate_scores_it() {
    let case = case();
    let truth = truth(&case);
    let turn = Rotation3::from_euler_angles(0.05, -0.03, 0.02);
    let near = Similarity { scale: truth.scale * 1.02, rotation: truth.rotation * turn, ..truth };
    for (pose, is_right) in [(truth, true), (near, true), (Similarity { scale: 0.5 * truth.scale, ..truth }, false)] {
        let answer = json!({ "cameraFromMesh": pose_json(&pose), "seconds": 2 }).to_string();
        let Outcome::Pose(read) = read_answer("answer", &CASE, answer.as_bytes()).unwrap().outcome else { panic!() };
        assert_near(&read, &pose, 1e-12);
        // As many samples as the paper's method has by default, whose metrics imported poses share.
        let surface_samples = PaperOptions::default().surface_samples;
        let options = EvaluateOptions { surface_samples, ..EvaluateOptions::against(case.truth.as_ref()) };
        let expected = evaluate(&case.observation, &case.mesh, &read, &options).unwrap();
        let record = import("scored", &case, &answer);
        let alignment = record.alignment.as_ref().unwrap();
        // Of the normals, `evaluate` has those of enough points for three digits.
        let metrics = alignment.metrics().unwrap();
        let normal_consistency = expected.metrics.normal_consistency;
        assert!((metrics.normal_consistency.unwrap() - normal_consistency.unwrap()).abs() < 0.01, "{metrics:?}");
        assert_eq!(Metrics { normal_consistency, ..metrics }, expected.metrics);
        assert_eq!(alignment.diagnostics().scale_ratio, expected.diagnostics.scale_ratio);
        let errors = record.errors.unwrap();
        assert!((errors.scale_error - expected.errors.unwrap().scale_error).abs() < 1e-12);
        assert_eq!(record.success(&STRICT), Some(is_right));
        assert_eq!(record.seconds, 2.0);

        let matrix = json!({ "cameraFromMesh": { "matrix": pose.to_column_major() } }).to_string();
        let record = import("scored", &case, &matrix);
        assert_near(&pose_of(&record), &pose, 1e-12);
        assert!(record.seconds.is_nan());
    }
}

#[test]
fn a_pose_is_found_among_pairs_of_which_half_are_wrong() {
    let case = case();
    let truth = truth(&case);
    for seed in 0..3 {
        println!("seed {seed}");
        let pairs = half_wrong_pairs(&case, &truth, seed);
        for scale in ["free", "bounded"] {
            let answer = json!({ "correspondences": pairs, "scale": scale, "seconds": 0.5 });
            let record = import("pairs", &case, &answer.to_string());
            let errors = record.errors.unwrap_or_else(|| panic!("{scale}: {:?}", record.error));
            assert!(errors.scale_error < 1e-3 && errors.rotation_error_deg < 0.2, "{scale}: {errors:?}");
            assert!(errors.translation_error_relative < 2e-3, "{scale}: {errors:?}");
        }
        for answer in [json!({ "correspondences": pairs }), json!({ "correspondences": pairs, "scale": "initial" })] {
            let record = import("pairs", &case, &answer.to_string());
            assert!(
                (record.alignment.unwrap().diagnostics().scale_ratio - 1.0).abs() < 1e-9,
                "the boxes' scale is kept"
            );
        }
    }
}

#[test]
fn the_guard_holds_where_pairs_are_bounded_and_not_where_they_are_free() {
    let case = case();
    let truth = truth(&case);
    let ratio = import("guard", &case, &json!({ "cameraFromMesh": pose_json(&truth) }).to_string());
    let far = Similarity { scale: truth.scale * 2.0 / ratio.alignment.unwrap().diagnostics().scale_ratio, ..truth };
    let pairs = half_wrong_pairs(&case, &far, 5);
    let ratio_of = |scale: &str| {
        let answer = json!({ "correspondences": pairs, "scale": scale, "inlierDistanceM": 0.01 * far.scale });
        import("guard", &case, &answer.to_string()).alignment.map(|alignment| alignment.diagnostics().scale_ratio)
    };
    assert!((ratio_of("free").unwrap() - 2.0).abs() < 1e-2);
    assert!(ratio_of("bounded").is_none_or(|ratio| ratio <= 1.5 + 1e-9));
}

#[test]
fn a_case_without_a_file_is_unanswered() {
    let record = imported(&case(), &std::env::temp_dir().join("sim3align-imported-nowhere"));
    assert_eq!(record.error.as_deref(), Some("no answer file"));
    assert_eq!((record.alignment.is_none(), record.success(&STRICT)), (true, Some(false)));
    assert!(record.seconds.is_nan());
    assert_eq!(serde_json::to_value(&record).unwrap()["seconds"], Value::Null);
}

#[test]
fn what_is_wrong_with_a_file_is_said() {
    let rotation = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]";
    let pose = |scale: &str, rotation: &str, translation: &str| {
        format!(
            r#"{{ "cameraFromMesh": {{ "scale": {scale}, "rotation": {rotation}, "translation": {translation} }} }}"#
        )
    };
    let pairs = |mesh: &str, camera: &str, more: &str| {
        format!(r#"{{ "correspondences": {{ "mesh": {mesh}, "camera": {camera} }}{more} }}"#)
    };
    let three = "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
    let transform = ErrorCode::InvalidTransform;
    let corrupt = ErrorCode::CorruptFile;
    let answers: Vec<(String, ErrorCode, &str)> = vec![
        ("{ \"cameraFromMesh\": ".into(), corrupt, "no JSON"),
        (pose("NaN", rotation, "[0, 0, 0]"), corrupt, "no JSON"),
        (pose("1e999", rotation, "[0, 0, 0]"), corrupt, "out of range"),
        ("[1, 2]".into(), corrupt, "found [1,2], expected a JSON object"),
        ("{}".into(), corrupt, "found an object with nothing, expected one of cameraFromMesh"),
        (r#"{ "camera_from_mesh": {} }"#.into(), corrupt, "found an object with camera_from_mesh"),
        (r#"{ "cameraFromMesh": {}, "error": "" }"#.into(), corrupt, "found an object with cameraFromMesh, error"),
        (r#"{ "error": 3 }"#.into(), corrupt, "error: found 3, expected text"),
        (r#"{ "error": "", "seconds": "2 s" }"#.into(), corrupt, "seconds: found \"2 s\", expected a number from 0"),
        (r#"{ "error": "", "seconds": -1 }"#.into(), corrupt, "seconds: found -1"),
        (pose("0", rotation, "[0, 0, 0]"), transform, "found scale 0, expected a finite scale above 0"),
        (pose("-2", rotation, "[0, 0, 0]"), transform, "found scale -2"),
        (pose("null", rotation, "[0, 0, 0]"), transform, "cameraFromMesh.scale: found null, expected a number"),
        (pose("1", "[1, 0]", "[0, 0, 0]"), transform, "cameraFromMesh.rotation: found [1,0], expected 3 × 3"),
        (pose("1", rotation, "[0, 0]"), transform, "cameraFromMesh.translation: found [0,0], expected 3 numbers"),
        (pose("1", "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]", "[0, 0, 0]"), transform, "orthonormal with determinant +1"),
        (pose("1", "[[1, 0.002, 0], [0, 1, 0], [0, 0, 1]]", "[0, 0, 0]"), transform, "orthonormal"),
        (r#"{ "cameraFromMesh": { "matrix": [1, 2] } }"#.into(), transform, "matrix: found [1,2], expected 16 numbers"),
        (r#"{ "cameraFromMesh": 5 }"#.into(), transform, "cameraFromMesh.scale: found nothing"),
        (pairs("5", three, ""), corrupt, "correspondences.mesh: found 5, expected an array of points"),
        (r#"{ "correspondences": {} }"#.into(), corrupt, "correspondences.mesh: found nothing"),
        (pairs(three, "[[0, 0, 0], [1, 0]]", ""), corrupt, "correspondences.camera: found [1,0] as point 1"),
        (pairs(three, "[[0, 0, 0]]", ""), ErrorCode::WrongLength, "3 points of mesh and 1 of camera"),
        (pairs("[]", "[]", ""), ErrorCode::TooFewPoints, "found 0 pairs, expected at least 3"),
        (pairs(three, three, r#", "scale": "fixed""#), corrupt, "scale: found \"fixed\", expected \"initial\""),
        (pairs(three, three, r#", "scale": 1"#), corrupt, "scale: found 1, expected"),
        (
            pairs(three, three, r#", "inlierDistanceM": 0"#),
            corrupt,
            "inlierDistanceM: found 0, expected a number above 0",
        ),
    ];
    let case = case();
    for (answer, code, words) in answers {
        let error = read_answer("some/answer.json", &CASE, answer.as_bytes()).unwrap_err();
        let text = error.to_string();
        assert_eq!(error.code, code, "{answer}: {text}");
        assert!(text.contains("some/answer.json"), "{answer}: {text}");
        assert!(text.contains(words), "{answer}: {text}");
        assert!(!error.remedy.is_empty());
        let record = import("wrong", &case, &answer);
        assert_eq!(record.alignment, None);
        let described = record.error.unwrap();
        assert!(described.starts_with(code.as_str()) && described.contains(&case.name), "{described}");
    }
    // Read without complaint, and no consensus to be had.
    let same = "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]";
    let record = import("wrong", &case, &pairs(three, same, ""));
    assert!(record.error.unwrap().starts_with("DEGENERATE_POINTS"));
}
