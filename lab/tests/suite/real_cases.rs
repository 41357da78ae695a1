//! Real RGB-D cases: `SIM3ALIGN_CASES=<folder of case folders> cargo test -p sim3align-lab -- --ignored real_cases`.

use std::path::PathBuf;

use sim3align::align::align_paper;
use sim3align::align::evaluate::{EvaluateOptions, Truth, evaluate};
use sim3align::metrics::symmetry::Symmetry;
use sim3align::paper::options::PaperOptions;
use sim3align::progress::Silent;
use sim3align_geometry::similarity::Similarity;
use sim3align_lab::case_folder::case::{Case, read_case};

fn cases() -> Vec<Case> {
    let folder = std::env::var_os("SIM3ALIGN_CASES").expect("SIM3ALIGN_CASES names no folder of cases");
    let mut folders: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.retain(|folder| folder.is_dir());
    folders.sort();
    assert!(!folders.is_empty(), "SIM3ALIGN_CASES names a folder without cases");
    folders.iter().map(|folder| read_case(folder).unwrap()).collect()
}

#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn the_paper_preset_runs_on_every_case_and_its_scale_stays_inside_the_guard() {
    for case in cases() {
        let result = align_paper(&case.observation, &case.mesh, &PaperOptions::default(), &mut Silent).unwrap();
        assert!(
            (0.5..=1.5).contains(&result.diagnostics.scale_ratio),
            "{}: scale ratio {}",
            case.name,
            result.diagnostics.scale_ratio
        );
        let camera_from_mesh = Similarity::from_column_major(&result.camera_from_mesh.matrix).unwrap();
        let truth = case.truth.map(|(camera_from_mesh, symmetry)| Truth {
            camera_from_mesh,
            symmetry: Symmetry::from_description(&symmetry),
        });
        let options = EvaluateOptions::against(truth.as_ref());
        let scored = evaluate(&case.observation, &case.mesh, &camera_from_mesh, &options).unwrap();
        println!(
            "{}: scale ratio {:.3}, IoU {:.3}, errors {:?}, {:?}",
            case.name,
            result.diagnostics.scale_ratio,
            scored.metrics.iou.unwrap(),
            scored.errors.map(|e| (e.scale_error, e.rotation_error_deg, e.translation_error_relative)),
            result.diagnostics.counts
        );
    }
}

#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn the_true_pose_scores_as_a_perfect_one() {
    let mut tried = 0;
    for case in cases() {
        let Some((camera_from_mesh, _)) = case.truth else { continue };
        tried += 1;
        let scored = evaluate(&case.observation, &case.mesh, &camera_from_mesh, &EvaluateOptions::default()).unwrap();
        let metrics = scored.metrics;
        println!("{}: {metrics:?}", case.name);
        assert!(metrics.iou.unwrap() >= 0.92, "{}: IoU {:?}", case.name, metrics.iou);
        assert!(metrics.normal_consistency.unwrap() >= 0.8, "{}: {:?}", case.name, metrics.normal_consistency);
        assert_eq!(metrics.fitness.map(|f| f > 0.93), Some(true), "{}: {:?}", case.name, metrics.fitness);
    }
    assert!(tried > 0, "no case has a truth");
}
