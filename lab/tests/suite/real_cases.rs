//! Real RGB-D cases: `SIM3ALIGN_CASES=<folder of case folders> cargo test -p sim3align-lab -- --ignored real_cases`.

use sim3align::align::align_paper;
use sim3align::align::evaluate::{EvaluateOptions, Truth, evaluate};
use sim3align::precise::drawn::surplus::LeftOut;
use sim3align_lab::case_folder::case::{Case, read_case};
use sim3align_lab::prelude::*;

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
            (0.5..=1.5).contains(&result.diagnostics.common.scale_ratio),
            "{}: scale ratio {}",
            case.name,
            result.diagnostics.common.scale_ratio
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
            result.diagnostics.common.scale_ratio,
            scored.metrics.iou.unwrap(),
            scored.errors.map(|e| (e.scale_error, e.rotation_error_deg, e.translation_error_relative)),
            result.diagnostics.counts
        );
    }
}

#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn no_mesh_of_a_real_case_has_surplus() {
    for case in cases() {
        let mesh = PreparedMesh::borrowed(&case.mesh);
        assert_eq!(mesh.left_out(), LeftOut::default(), "{}", case.name);
        assert!(mesh.without_plate().is_none(), "{}", case.name);
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

/// Where texture coordinates are upside down, or the photo is of another view, the colours have nothing in common.
#[test]
#[ignore = "needs SIM3ALIGN_CASES"]
fn the_colors_of_a_mesh_at_its_true_pose_are_those_of_the_photo() {
    let mut tried = 0;
    for case in cases() {
        let (Some((camera_from_mesh, _)), Some(colors), Some(photo)) =
            (case.truth, case.colors, case.observation.photo())
        else {
            continue;
        };
        tried += 1;
        let (depth, camera) = (case.observation.depth(), case.observation.camera());
        let mut pairs: Vec<[f64; 2]> = Vec::new();
        for (&point, color) in colors.samples().points.iter().zip(colors.colors()) {
            let p = camera_from_mesh.apply(vector3(point));
            let (u, v) = (camera.fx * p.x / p.z + camera.cx, camera.fy * p.y / p.z + camera.cy);
            let (u, v) = (u.round() as usize, v.round() as usize);
            let is_visible = depth.get(u, v).is_some_and(|z| z > 0.0 && (f64::from(z) - p.z).abs() < 0.01);
            if !is_visible || case.observation.mask().get(u, v) == Some(0) {
                continue;
            }
            let [column, row] = [u * photo.width() / depth.width(), v * photo.height() / depth.height()];
            let seen = photo.get(column, row).unwrap();
            let luma = |color: &[u8; 3]| color.iter().map(|&c| f64::from(c)).sum::<f64>();
            pairs.push([luma(color), luma(&seen)]);
        }
        let mean = |axis: usize| pairs.iter().map(|pair| pair[axis]).sum::<f64>() / pairs.len() as f64;
        let means = [mean(0), mean(1)];
        let moment = |a: usize, b: usize| pairs.iter().map(|p| (p[a] - means[a]) * (p[b] - means[b])).sum::<f64>();
        let correlation = moment(0, 1) / (moment(0, 0) * moment(1, 1)).sqrt();
        println!("{}: {} points, means {means:?}, correlation {correlation:.3}", case.name, pairs.len());
        assert!(pairs.len() > 1000 && correlation > 0.25, "{}: {correlation}", case.name);
    }
    assert!(tried > 0, "no case has a truth, a photo and colours");
}
