//! Alignment with several views: views without mask, wrong views, unknown cameras, and photos.

use std::sync::Arc;

use sim3align::views::ViewsOptions;
use sim3align::views::report::{ViewRole, ViewsAlignment, WorldFrame};
use sim3align::views::{View, align_views};

use sim3align::evidence::frame::Frame;

use crate::color::{carton, label, photo, printed_mesh};
use crate::observations::{assert_right, body, frame_of, observe, orbit, truth, turn_deg, views};
use crate::prelude::*;

const ANGLES: [f64; 3] = [0.0, 1.3, 4.0];

pub fn options() -> ViewsOptions {
    ViewsOptions { metrics: false, symmetry: Symmetry::None, ..ViewsOptions::default() }
}

fn align(views: Vec<View>) -> ViewsAlignment {
    align_views(views, &PreparedMesh::borrowed(&body()), &options(), &mut Silent).unwrap()
}

/// Checks the poses in all views but the wrong one, if there is one.
fn assert_all_right(found: &ViewsAlignment, wrong: Option<usize>, what: &str) {
    for (k, angle) in ANGLES.iter().enumerate().filter(|(k, _)| Some(*k) != wrong) {
        let pose = pose_of(&found.views[k].camera_from_mesh);
        assert_right(&body(), &pose, &orbit(*angle), &format!("{what}, view {k}"));
    }
}

#[wasm_bindgen_test]
fn views_with_known_cameras_have_one_pose() {
    let seen = || views(&body(), &ANGLES);
    let found = align(seen());
    assert_all_right(&found, None, "three views");
    assert_eq!(found.world, WorldFrame::Given);
    assert!(found.views.iter().all(|view| view.role == ViewRole::Used));
    for (view, given) in found.views.iter().zip(seen()) {
        let placed = given.world_from_camera.unwrap().inverse().compose(&pose_of(&found.world_from_mesh));
        let pose = pose_of(&view.camera_from_mesh);
        assert!((placed.translation - pose.translation).norm() < 1e-9 && (placed.scale - pose.scale).abs() < 1e-9);
    }
    // More views leave less uncertain.
    let one = align(seen()[..1].to_vec());
    assert!(found.uncertainty.unwrap().scale < one.uncertainty.unwrap().scale, "{found:?}");
}

#[wasm_bindgen_test]
fn views_without_a_mask_unusable_ones_and_wrong_ones_have_their_roles() {
    type Case = (ViewRole, Option<WarningCode>, fn(&mut View));
    let cases: [Case; 5] = [
        (ViewRole::Used, None, |view| view.frame.mask = None),
        (ViewRole::Unusable, Some(WarningCode::ViewShowsNothing), |view| {
            view.frame.mask = None;
            view.frame.depth.data_mut().fill(0.0);
        }),
        (ViewRole::Unusable, Some(WarningCode::ViewShowsNothing), |view| {
            view.frame.mask.iter_mut().for_each(|mask| mask.data_mut().fill(0));
        }),
        // Lines that are thinner than the cells of a search.
        (ViewRole::Unusable, Some(WarningCode::ViewShowsNothing), |view| {
            let mask = view.frame.mask.as_mut().unwrap();
            let width = mask.width();
            mask.data_mut().iter_mut().enumerate().for_each(|(i, m)| *m = u8::from(i % width % 8 == i / width % 8));
        }),
        (ViewRole::Contradicting, Some(WarningCode::ViewContradicts), |view| {
            let wrong = Similarity { rotation: Rotation3::new(Vector3::new(0.4, 1.0, 0.2)), ..Similarity::identity() };
            view.world_from_camera = view.world_from_camera.map(|camera| wrong.compose(&camera));
        }),
    ];
    for (role, warning, change) in cases {
        let mut seen = views(&body(), &ANGLES);
        change(&mut seen[2]);
        let found = align(seen);
        assert_all_right(&found, (role != ViewRole::Used).then_some(2), &format!("{role:?}"));
        assert_eq!(found.views[2].role, role, "{found:?}");
        let codes = codes(&found.warnings);
        assert!(warning.is_none_or(|code| codes.contains(&code)), "{role:?}: {codes:?}");
    }
}

#[wasm_bindgen_test]
fn unknown_cameras_share_one_size_and_follow_from_the_object() {
    let mut seen = views(&body(), &ANGLES);
    seen.iter_mut().for_each(|view| view.world_from_camera = None);
    let found = align(seen);
    assert_all_right(&found, None, "with unknown cameras");
    assert_eq!(found.world, WorldFrame::Camera);
    let poses: Vec<Similarity> = found.views.iter().map(|view| pose_of(&view.camera_from_mesh)).collect();
    for (view, pose) in found.views.iter().zip(&poses) {
        assert!((pose.scale / poses[0].scale - 1.0).abs() < 1e-9, "one size for all views");
        let placed = pose_of(&view.camera.world_from_camera).compose(pose);
        assert!((placed.translation - poses[0].translation).norm() < 1e-9, "the object is in one place");
    }
    assert_eq!(found.views[0].camera.rotation_sd_deg, Some(0.0));
    assert!(found.views[1].camera.rotation_sd_deg > Some(0.0) && found.views[1].camera.position_sd_m > Some(0.0));
}

#[wasm_bindgen_test]
fn a_fixed_size_is_kept_and_leaves_no_doubt_of_it() {
    for are_known in [true, false] {
        let mut seen = views(&body(), &ANGLES);
        seen.iter_mut().filter(|_| !are_known).for_each(|view| view.world_from_camera = None);
        let options = ViewsOptions { scale: ScaleOption::Fixed(1.01 * truth().scale), ..options() };
        let fixed = align_views(seen, &PreparedMesh::borrowed(&body()), &options, &mut Silent).unwrap();
        for view in &fixed.views {
            let scale = view.camera_from_mesh.scale / truth().scale;
            assert!((scale - 1.01).abs() < 1e-9, "cameras known: {are_known}, scale {scale}");
        }
        let sd = fixed.uncertainty.unwrap();
        assert!(sd.scale == 0.0 && sd.position_m < 1e-3, "cameras known: {are_known}: {sd:?}");
        assert!(fixed.confidence > 0.9, "cameras known: {are_known}: {}", fixed.confidence);
    }
}

#[wasm_bindgen_test]
fn a_view_with_an_unusable_mask_is_left_out_of_unknown_cameras() {
    let mut seen = views(&body(), &ANGLES);
    seen.iter_mut().for_each(|view| view.world_from_camera = None);
    seen[0].frame.mask.iter_mut().for_each(|mask| mask.data_mut().fill(0));
    let found = align(seen);
    for k in [1, 2] {
        assert_right(&body(), &pose_of(&found.views[k].camera_from_mesh), &orbit(ANGLES[k]), &format!("view {k}"));
    }
    let unusable = &found.views[0];
    assert_eq!((unusable.role, unusable.confidence, unusable.camera.position_sd_m), (ViewRole::Unusable, 0.0, None));
    assert!(found.warnings.iter().any(|warning| warning.message.contains("views[0].mask")), "{:?}", found.warnings);
    assert!(found.confidence > 0.5, "{}", found.confidence);
}

/// Views of a printed carton, turned over by half a turn.
pub fn printed(turn: Rotation3<f64>, are_cameras_known: bool) -> Vec<View> {
    let view = |angle: f64| {
        let pose = Similarity { rotation: orbit(angle).rotation * turn, ..orbit(angle) };
        let photo = photo(&carton(), &pose, label, (Vec3::new(0.8, 0.9, 1.0), 0.3), 0);
        let frame = Frame { photo: Some(Arc::new(photo)), ..frame_of(&observe(&carton(), &pose)) };
        let world_from_camera = truth().compose(&orbit(angle).inverse());
        View { frame, world_from_camera: are_cameras_known.then_some(world_from_camera) }
    };
    ANGLES.map(view).into()
}

#[wasm_bindgen_test]
fn photos_of_several_views_tell_the_turn_that_shape_leaves_open() {
    let mesh = printed_mesh();
    let mut misled = 0;
    for axis in [Vector3::zeros(), Vector3::x(), Vector3::y()] {
        let turn = Rotation3::new(axis * core::f64::consts::PI);
        for are_cameras_known in [true, false] {
            let turns = |views: Vec<View>| {
                let found = align_views(views, &mesh, &options(), &mut Silent).unwrap();
                let turns = ANGLES.iter().zip(&found.views).map(|(angle, view)| {
                    let truth = Similarity { rotation: orbit(*angle).rotation * turn, ..orbit(*angle) };
                    turn_deg(&pose_of(&view.camera_from_mesh), &truth)
                });
                (turns.fold(0.0, f64::max), found)
            };
            let mut plain = printed(turn, are_cameras_known);
            plain.iter_mut().for_each(|view| view.frame.photo = None);
            let (by_shape, found) = turns(plain);
            assert!(found.views.iter().all(|view| view.color.is_none()));
            misled += usize::from(by_shape > 90.0);
            let (by_color, found) = turns(printed(turn, are_cameras_known));
            assert!(by_color < 5.0, "{turn}, known {are_cameras_known}: {by_color}°");
            assert!(found.views.iter().all(|view| view.color.is_some_and(|color| color.agreement > 0.5)), "{found:?}");
        }
    }
    assert!(misled >= 3, "shape alone is wrong: {misled} times of 6");
}
