//! Generated cases: reproducible, true to their truth, wrong where they say so.

use std::fs;

use sim3align::align::{align, align_paper};
use sim3align::evidence::clouds::Sampling;
use sim3align::metrics::evaluate;
use sim3align_geometry::triangle_tree::TriangleTree;
use sim3align_lab::case_folder::case::read_case;
use sim3align_lab::prelude::*;

use crate::common::{assert_canonical, assert_closed, assert_near, depth_of, fresh};
use sim3align_lab::samples::case::SampleCase;
use sim3align_lab::samples::shape::Kind;

const SEEDS: std::ops::Range<u64> = 1..9;

fn cases() -> impl Iterator<Item = SampleCase> {
    Kind::ALL.iter().flat_map(|&kind| SEEDS.map(move |seed| SampleCase::new(kind, seed).unwrap()))
}

/// Mean of the readings inside the mask, metres.
fn mean_depth(case: &SampleCase) -> f64 {
    let masked = case.observation.depth().data().iter().zip(case.observation.mask().data());
    let z: Vec<f64> = masked.filter(|(z, m)| **m != 0 && **z > 0.0).map(|(z, _)| f64::from(*z)).collect();
    z.iter().sum::<f64>() / z.len() as f64
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    for &kind in Kind::ALL {
        let files = |seed| SampleCase::new(kind, seed).unwrap().files(None).unwrap();
        let (one, again, other) = (files(1), files(1), files(2));
        assert_eq!(one, again);
        for ((name, bytes), (_, others)) in one.iter().zip(&other) {
            assert_ne!(bytes, others, "{name}");
        }
    }
}

#[test]
fn the_truth_scores_as_one() {
    for case in cases() {
        let metrics = evaluate(&case.observation, &case.mesh, &case.camera_from_mesh, &Sampling::default()).unwrap();
        let depth_mm = 1000.0 * mean_depth(&case);
        println!("{:?} {}: at {depth_mm:.0} mm, {metrics:?}", case.kind, case.seed);
        // What hides it is no part of the mask, but the whole mesh is drawn.
        let least = match case.kind {
            Kind::Mug => 0.95,
            Kind::Hammer | Kind::Spoon => 0.9,
            Kind::Occluded => 0.6,
        };
        assert!(metrics.iou.unwrap() >= least, "{:?} {}: {metrics:?}", case.kind, case.seed);
        assert!(metrics.depth_mae_mm.unwrap() < 0.01 * depth_mm, "seed {}: {metrics:?}", case.seed);
        assert!(metrics.normal_consistency.unwrap() >= 0.85, "seed {}: {metrics:?}", case.seed);
    }
}

#[test]
fn what_was_seen_is_right_and_what_was_not_is_invented() {
    for case in cases() {
        let (width, height) = (case.observation.depth().width(), case.observation.depth().height());
        let mut rasteriser = Rasteriser::new();
        rasteriser.render(&case.mesh, &case.camera_from_mesh, &case.observation.camera(), width, height);
        let mut visible = vec![false; case.mesh.positions().len()];
        let shown = rasteriser.triangles().iter().zip(case.observation.mask().data()).filter(|(_, m)| **m != 0);
        for &id in shown.map(|(id, _)| id).filter(|&&id| id != NO_TRIANGLE) {
            for i in case.mesh.triangles()[id as usize] {
                visible[i as usize] = true;
            }
        }
        let box_of = |axis: usize| {
            let along = || case.object.positions().iter().map(|p| p[axis]);
            along().fold(f32::MIN, f32::max) - along().fold(f32::MAX, f32::min)
        };
        let diagonal = (0..3).map(|axis| box_of(axis) * box_of(axis)).sum::<f32>().sqrt();
        let object_from_mesh = case.camera_from_object.inverse().compose(&case.camera_from_mesh);
        let surface = TriangleTree::new(&case.object);
        let (mut seen, mut unseen) = (0.0f32, 0.0f32);
        for (p, visible) in case.mesh.positions().iter().zip(visible) {
            let p = vec3(&object_from_mesh.apply(vector3(*p)));
            let off = surface.nearest(p).unwrap().distance_squared.sqrt() / diagonal;
            let worst = if visible { &mut seen } else { &mut unseen };
            *worst = worst.max(off);
        }
        println!("{:?} {}: {seen:.4} seen, {unseen:.4} unseen", case.kind, case.seed);
        assert!(seen <= 0.005, "{:?} {}: {seen} of the diagonal", case.kind, case.seed);
        // Of what lies flat, nothing is far from what was seen.
        let invented = if case.kind == Kind::Mug { 0.05 } else { 3.0 * seen };
        assert!(unseen >= invented, "{:?} {}: {unseen} of the diagonal", case.kind, case.seed);
    }
}

#[test]
fn the_depth_map_has_a_depth_models_faults_and_no_scale_of_its_own() {
    for case in cases() {
        let depth = case.observation.depth();
        let alone = depth_of(&case.object, &case.camera_from_object, &case.observation);
        let ratios = || {
            let pixels = depth.data().iter().zip(&alone).zip(case.observation.mask().data());
            let pixels = pixels.filter(|((z, rendered), m)| **m != 0 && **z > 0.0 && **rendered > 0.0);
            pixels.map(|((z, rendered), _)| f64::from(z / rendered))
        };
        let mut sorted: Vec<f64> = ratios().collect();
        sorted.sort_by(f64::total_cmp);
        let quantile = |q: f64| sorted[(q * (sorted.len() - 1) as f64) as usize];
        let (low, median, high) = (quantile(0.01), quantile(0.5), quantile(1.0));
        // Of what is thin, many pixels are at the rim, and fly.
        let off = if case.kind == Kind::Mug { 0.002 } else { 0.004 };
        assert!((median - 1.0).abs() < off, "{:?} {}: median {median}", case.kind, case.seed);
        assert!(low > 0.98 && low < 0.9995, "seed {}: nearest {low}", case.seed);
        // What lies on the table has nothing far behind it.
        let flies = if matches!(case.kind, Kind::Hammer | Kind::Spoon) { 1.005 } else { 1.03 };
        assert!(high > flies, "{:?} {}: no pixel flies, {high}", case.kind, case.seed);
        let mask = case.observation.mask().data();
        let silhouette = alone.iter().filter(|z| **z > 0.0).count() as f64;
        let visible = mask.iter().zip(&alone).filter(|(m, z)| **m != 0 && **z > 0.0).count();
        assert_eq!(visible, mask.iter().filter(|m| **m != 0).count(), "{:?} {}", case.kind, case.seed);
        let hidden = 1.0 - visible as f64 / silhouette;
        let expected = if case.kind == Kind::Occluded { 0.15..=0.35 } else { 0.0..=0.0 };
        assert!(expected.contains(&hidden), "{:?} {}: {hidden} is hidden", case.kind, case.seed);
        let holes = |z: &DepthMap| z.data().iter().zip(mask).filter(|(z, m)| **m != 0 && **z == 0.0).count();
        assert!((4..200).contains(&holes(depth)), "seed {}: {} pixels without depth", case.seed, holes(depth));
    }
}

#[test]
fn the_meshes_are_whole_and_delivered_in_a_unit_box() {
    for case in cases() {
        let count = case.mesh.triangles().len();
        let least = if case.kind == Kind::Mug { 5_000 } else { 2_000 };
        assert!((least..=10_000).contains(&count), "{:?}: {count} triangles", case.kind);
        for mesh in [&case.object, &case.mesh] {
            assert_closed(mesh, &format!("{:?} {}", case.kind, case.seed));
        }
        assert_canonical(&case.mesh, &format!("{:?} {}", case.kind, case.seed));
    }
}

#[test]
fn a_written_case_reads_back_and_the_paper_preset_aligns_it() {
    let folder = fresh("samples");
    let sample = SampleCase::new(Kind::Mug, 1).unwrap();
    sample.write(&folder, None).unwrap();
    let case = read_case(&folder);
    // A file is no folder.
    let refused = sample.write(&folder.join("gt.json"), None).unwrap_err();
    fs::remove_dir_all(&folder).unwrap();
    let case = case.unwrap();
    assert_eq!(refused.code, ErrorCode::InvalidArgument);
    assert!(refused.argument.ends_with("gt.json"), "{refused}");
    assert_eq!(case.observation.depth(), sample.observation.depth());
    let (camera, written) = (case.observation.camera(), sample.observation.camera());
    assert!((camera.fx - written.fx).abs() < 1e-9 && (camera.cy - written.cy).abs() < 1e-9, "{camera:?}");
    assert_eq!(case.mesh, sample.mesh);
    let (camera_from_mesh, symmetry) = case.truth.unwrap();
    assert_near(&camera_from_mesh, &sample.camera_from_mesh, 1e-12);
    assert_eq!(symmetry, "none");

    let result = align_paper(&case.observation, &case.mesh, &PaperOptions::default(), &mut Silent).unwrap();
    let ratio = result.diagnostics.common.scale_ratio;
    assert!((0.5..=1.5).contains(&ratio), "scale ratio {ratio}");
}

#[test]
fn an_unknown_kind_is_refused_by_name() {
    let error = Kind::from_name("teapot").unwrap_err();
    assert_eq!((error.code, &*error.expected), (ErrorCode::InvalidOption, "mug or hammer or spoon or occluded"));
    assert!(error.found.contains("teapot"));
}

#[test]
fn the_page_s_samples_align_by_either_quality() {
    // The seeds are those of scripts/lib/sample.mjs.
    for (kind, seed) in [(Kind::Mug, 1), (Kind::Hammer, 2), (Kind::Spoon, 2), (Kind::Occluded, 4)] {
        let case = SampleCase::new(kind, seed).unwrap();
        for quality in [Quality::Fast, Quality::Balanced] {
            let options = AlignOptions { quality, ..AlignOptions::default() };
            let result = align(&case.observation, &case.mesh, &options, &mut Silent).unwrap();
            let found = &result.camera_from_mesh;
            let rotation = Rotation3::from_matrix_unchecked(Similarity::rotation_from_xyzw(&found.rotation).unwrap());
            let turn_deg = rotation.angle_to(&case.camera_from_mesh.rotation).to_degrees();
            let scale = found.scale / case.camera_from_mesh.scale;
            let offset_m = (Vector3::from(found.translation) - case.camera_from_mesh.translation).norm();
            println!("{kind:?} {quality:?}: {turn_deg:.2} deg, scale {scale:.3}, {:.2} mm", 1000.0 * offset_m);
            assert!(turn_deg < 3.0, "{kind:?} {quality:?}: {turn_deg}");
            assert!((0.98..=1.02).contains(&scale), "{kind:?} {quality:?}: {scale}");
            assert!(offset_m < 0.003, "{kind:?} {quality:?}: {offset_m}");
        }
    }
}
