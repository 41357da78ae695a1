//! Alignment with several views: generated rigs, views without mask, wrong views, unknown cameras, and what is refused.

use std::sync::Arc;

use sim3align::evidence::photo::Photo;
use sim3align::metrics::pose_error::pose_errors;
use sim3align::pauses::Pauses;
use sim3align::views::common_size::{SizeEvidence, common_size};
use sim3align::views::options::ViewsOptions;
use sim3align::views::report::{ViewRole, ViewsAlignment, WorldFrame};
use sim3align::views::{View, align_views, align_views_task};
use sim3align_lab::sequences::Sequence;
use sim3align_lab::sequences::rig::RigSet;

use crate::prelude::*;

/// Case 0 of a set is easy and has exact camera poses, case 5 is hard and has a wrong view.
fn rig(seed: u64, views: usize, index: usize) -> Sequence {
    RigSet { seed, views: Some(views), is_printed: false, is_small: false }.case(index).unwrap()
}

fn views_of(sequence: &Sequence) -> Vec<View> {
    sequence.frames.iter().map(|frame| frame.view.clone()).collect()
}

fn options(sequence: &Sequence) -> ViewsOptions {
    ViewsOptions { metrics: false, symmetry: sequence.symmetry.clone(), ..ViewsOptions::default() }
}

fn align(sequence: &Sequence, views: Vec<View>) -> ViewsAlignment {
    align_views(views, &sequence.prepared(), &options(sequence), &mut Silent).unwrap()
}

/// Checks the poses in all views but the wrong ones.
fn assert_right(sequence: &Sequence, found: &ViewsAlignment, what: &str) {
    for (view, frame) in found.views.iter().zip(&sequence.frames).filter(|(_, frame)| !frame.is_wrong) {
        let pose = pose_of(&view.camera_from_mesh);
        let truth = frame.camera_from_mesh.unwrap();
        let errors = pose_errors(&sequence.mesh, &pose, &truth, &sequence.symmetry).unwrap();
        let strict =
            errors.scale_error < 0.05 && errors.rotation_error_deg < 10.0 && errors.translation_error_relative < 0.05;
        assert!(strict, "{what}, {}: {errors:?}", frame.name);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn three_views_with_known_cameras() {
    for seed in [41, 42] {
        let sequence = rig(seed, 3, 0);
        let found = align(&sequence, views_of(&sequence));
        assert_right(&sequence, &found, &format!("seed {seed}"));
        assert_eq!(found.world, WorldFrame::Given);
        assert!(found.views.iter().all(|view| view.role == ViewRole::Used), "seed {seed}");
        let world = pose_of(&found.world_from_mesh);
        for (view, frame) in found.views.iter().zip(&sequence.frames) {
            let given = frame.view.world_from_camera.unwrap();
            let seen = given.inverse().compose(&world);
            let pose = pose_of(&view.camera_from_mesh);
            assert!((seen.translation - pose.translation).norm() < 1e-9, "seed {seed}: one pose for all views");
            assert!((seen.scale - pose.scale).abs() < 1e-9, "seed {seed}: one size for all views");
        }
        // More views leave less uncertain.
        let one = align(&sequence, vec![views_of(&sequence)[0].clone()]);
        let [one, all] = [&one, &found].map(|found| found.uncertainty.unwrap().scale);
        assert!(all < one, "seed {seed}: {all} for {one}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_view_without_a_mask_counts_by_its_depth() {
    let sequence = rig(43, 3, 0);
    let mut views = views_of(&sequence);
    views[2].frame.mask = None;
    let found = align(&sequence, views);
    assert_right(&sequence, &found, "without the last mask");
    assert_eq!(found.views[2].role, ViewRole::Used);
    assert!(found.views[2].score > 1.0, "{}", found.views[2].score);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_view_that_shows_nothing_is_blind() {
    let sequence = rig(43, 3, 0);
    let mut views = views_of(&sequence);
    views[2].frame.mask = None;
    views[2].frame.depth.data_mut().fill(0.0);
    let found = align(&sequence, views);
    assert_right(&sequence, &found, "with a blind view");
    assert_eq!(found.views[2].role, ViewRole::Blind);
    assert!(found.warnings.iter().any(|warning| warning.code == WarningCode::ViewShowsNothing), "{:?}", found.warnings);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_wrong_view_is_left_out() {
    let sequence = rig(46, 4, 5);
    let wrong = sequence.frames.iter().position(|frame| frame.is_wrong).unwrap();
    let found = align(&sequence, views_of(&sequence));
    assert_right(&sequence, &found, "with a wrong view");
    let roles: Vec<bool> = found.views.iter().map(|view| view.role == ViewRole::Contradicting).collect();
    assert_eq!(roles, (0..4).map(|k| k == wrong).collect::<Vec<_>>());
    assert!(found.warnings.iter().any(|warning| warning.code == WarningCode::ViewContradicts), "{:?}", found.warnings);
}

#[wasm_bindgen_test(unsupported = test)]
fn unknown_cameras_share_one_size_and_follow_from_the_object() {
    let sequence = rig(46, 3, 0);
    let mut views = views_of(&sequence);
    views.iter_mut().for_each(|view| view.world_from_camera = None);
    let found = align(&sequence, views);
    assert_right(&sequence, &found, "with unknown cameras");
    assert_eq!(found.world, WorldFrame::Camera);
    let poses: Vec<Similarity> = found.views.iter().map(|view| pose_of(&view.camera_from_mesh)).collect();
    for (view, pose) in found.views.iter().zip(&poses) {
        assert!((pose.scale / poses[0].scale - 1.0).abs() < 1e-9, "one size for all views");
        let camera = pose_of(&view.camera.world_from_camera);
        let placed = camera.compose(pose);
        assert!((placed.translation - poses[0].translation).norm() < 1e-9, "the object is in one place");
        assert!(view.camera.rotation_sd_deg >= Some(0.0) && view.camera.position_sd_m.is_some_and(f64::is_finite));
    }
    assert_eq!(found.views[0].camera.rotation_sd_deg, Some(0.0));
    assert!(found.views[1].camera.rotation_sd_deg > Some(0.0));
}

/// Objects whose print alone tells how they are turned, in three views with photos.
fn printed(seed: u64) -> Sequence {
    RigSet { seed, views: Some(3), is_printed: true, is_small: false }.case(0).unwrap()
}

fn without_photos(mut views: Vec<View>) -> Vec<View> {
    views.iter_mut().for_each(|view| view.frame.photo = None);
    views
}

fn without_cameras(mut views: Vec<View>) -> Vec<View> {
    views.iter_mut().for_each(|view| view.world_from_camera = None);
    views
}

fn turn_deg(sequence: &Sequence, found: &ViewsAlignment, k: usize) -> f64 {
    let pose = pose_of(&found.views[k].camera_from_mesh);
    let truth = sequence.frames[k].camera_from_mesh.unwrap();
    pose_errors(&sequence.mesh, &pose, &truth, &sequence.symmetry).unwrap().rotation_error_deg
}

#[wasm_bindgen_test(unsupported = test)]
fn photos_of_several_views_tell_the_turn_that_shape_leaves_open() {
    // A can, which shape takes upside down.
    let sequence = printed(505);
    let by_shape = align(&sequence, without_photos(views_of(&sequence)));
    assert!(turn_deg(&sequence, &by_shape, 0) > 90.0);
    assert!(by_shape.views.iter().all(|view| view.color.is_none()));
    let found = align(&sequence, views_of(&sequence));
    assert_right(&sequence, &found, "known cameras");
    let color = found.views[0].color.unwrap();
    assert!(color.agreement > 0.5 && color.margin.unwrap() > 0.1, "{color:?}");
    assert!(found.views.iter().all(|view| view.color == Some(color)), "one decision for all views");
    // The turn that shape had taken is an alternative, unless colour has clearly refuted it.
    let upside_down = found.alternatives.iter().find(|other| other.turn_deg > 150.0);
    assert!(upside_down.is_none_or(|other| other.color_margin.unwrap() > 0.0), "{upside_down:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn photos_of_unrelated_views_tell_the_turn_in_each() {
    // Objects that shape takes the wrong way round in one of the views.
    for seed in [502, 503] {
        let sequence = printed(seed);
        let by_shape = align(&sequence, without_cameras(without_photos(views_of(&sequence))));
        assert!((0..3).any(|k| turn_deg(&sequence, &by_shape, k) > 90.0), "seed {seed}");
        let found = align(&sequence, without_cameras(views_of(&sequence)));
        assert_right(&sequence, &found, &format!("seed {seed}"));
        assert!(found.views.iter().all(|view| view.color.is_some()), "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_photo_of_another_shape_is_refused_by_its_view() {
    let sequence = rig(41, 2, 0);
    let mut views = views_of(&sequence);
    views[1].frame.photo = Some(Arc::new(Photo::filled(30, 90, [9; 3])));
    let options = options(&sequence);
    for has_mask in [true, false] {
        let mut views = views.clone();
        views[1].frame.mask = views[1].frame.mask.take().filter(|_| has_mask);
        let error = align_views(views, &sequence.prepared(), &options, &mut Silent).unwrap_err();
        assert_eq!((error.code, error.argument.as_ref()), (ErrorCode::SizeMismatch, "views[1].image"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn pauses_and_repeats_change_no_bit() {
    let sequence = rig(46, 2, 0);
    let bits = |found: &ViewsAlignment| fingerprint(found.world_from_mesh.matrix.map(f64::to_bits));
    let whole = align(&sequence, views_of(&sequence));
    let mesh = PreparedMesh::borrowed(&sequence.mesh);
    let mut task = align_views_task(views_of(&sequence), &mesh, options(&sequence), Silent, Pauses::none()).unwrap();
    let mut steps = 0;
    let paused = loop {
        steps += 1;
        if let Some(found) = task.step(0.0).unwrap() {
            break found;
        }
    };
    assert!(steps > 20, "{steps} steps");
    assert_eq!(bits(&whole), bits(&paused));
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_refused() {
    let sequence = rig(46, 2, 0);
    let refused =
        |views: Vec<View>| align_views(views, &sequence.prepared(), &options(&sequence), &mut Silent).unwrap_err();
    let views = views_of(&sequence);
    assert_eq!(refused(Vec::new()).code, ErrorCode::InvalidArgument);
    let mut mixed = views.clone();
    mixed[1].world_from_camera = None;
    assert_eq!(refused(mixed).code, ErrorCode::InvalidArgument);
    let mut impossible = views.clone();
    impossible[1].frame.mask = None;
    impossible[1].frame.camera.fx = 1e-3;
    let error = refused(impossible);
    assert_eq!((error.code, error.argument.as_ref()), (ErrorCode::InvalidCamera, "views[1].camera"));
    let mut unmasked = views.clone();
    unmasked.iter_mut().for_each(|view| view.frame.mask = None);
    assert_eq!(refused(unmasked).code, ErrorCode::InvalidArgument);
    let mut unknown = views.clone();
    unknown.iter_mut().for_each(|view| view.world_from_camera = None);
    unknown[1].frame.mask = None;
    assert_eq!(refused(unknown).code, ErrorCode::InvalidArgument);
    let mut empty = views;
    if let Some(mask) = &mut empty[1].frame.mask {
        mask.data_mut().fill(0);
    }
    let error = refused(empty);
    assert_eq!((error.code, error.argument.to_string().as_str()), (ErrorCode::EmptyMask, "views[1].mask"));
}

#[wasm_bindgen_test(unsupported = test)]
fn the_common_size_is_where_most_views_agree() {
    for seed in 0..20 {
        let draw = &mut Draw::new(600 + seed);
        let truth = draw.between(-2.0, 2.0);
        // Each view has a pose of the true size, and a better one of another size that no other view has.
        let views: Vec<Vec<SizeEvidence>> = (0..4)
            .map(|k| {
                let right = SizeEvidence { log_scale: truth + draw.between(-0.005, 0.005), sd: 0.01, score: 1.5 };
                let other = SizeEvidence { log_scale: truth + 0.1 + 0.07 * f64::from(k), sd: 0.01, score: 1.6 };
                vec![other, right]
            })
            .collect();
        let (size, sd, chosen) = common_size(&views).unwrap();
        assert!((size - truth).abs() < 0.006 && sd < 0.01, "seed {seed}: {size} for {truth}");
        assert!(chosen.iter().all(|chosen| *chosen == Some(1)), "seed {seed}: {chosen:?}");
        // A view of something else is left out.
        let mut views = views;
        views[2] = vec![SizeEvidence { log_scale: truth + 0.9, sd: 0.01, score: 1.9 }];
        let (size, _, chosen) = common_size(&views).unwrap();
        assert!((size - truth).abs() < 0.006, "seed {seed}: {size} for {truth}");
        assert_eq!(chosen[2], None, "seed {seed}");
    }
}
