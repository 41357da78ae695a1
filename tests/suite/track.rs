//! Tracking: videos of a turning object, corrections, losses, and the size that frames share.

use sim3align::evidence::frame::Frame;
use sim3align::scheduler::{Scheduler, Task};
use sim3align::track::TrackOptions;
use sim3align::track::history::{History, MAX_FRAMES};
use sim3align::track::report::{TrackState, TrackedFrame};
use sim3align::track::tracker::Tracker;
use sim3align::views::world_pose::WorldPose;

use crate::observations::{assert_right, body, frame_of, observe, orbit, truth};
use crate::prelude::*;

/// The pose in frame `k` of a video: the object turns by 3° a frame, and drifts.
pub fn place(k: usize) -> Similarity {
    let drift = Vector3::new(0.002 * k as f64, -0.001 * k as f64, 0.003 * k as f64);
    let pose = orbit(0.05 * k as f64);
    Similarity { translation: pose.translation + drift, ..pose }
}

fn frame(k: usize) -> Frame {
    frame_of(&observe(&body(), &place(k)))
}

fn without_mask(frame: Frame) -> Frame {
    Frame { mask: None, ..frame }
}

fn pose(found: &TrackedFrame) -> Similarity {
    pose_of(&found.camera_from_mesh)
}

fn tracker(options: TrackOptions) -> Tracker<PreparedMesh<'static>> {
    Tracker::new(PreparedMesh::new(body()), options).unwrap()
}

#[wasm_bindgen_test]
fn a_video_is_tracked_with_all_masks_and_with_the_first_alone() {
    for has_masks in [true, false] {
        let mut tracker = tracker(TrackOptions::default());
        for k in 0..10 {
            let seen = if has_masks || k == 0 { frame(k) } else { without_mask(frame(k)) };
            let found = tracker.next(&seen, &mut Silent).unwrap();
            assert_right(&body(), &pose(&found), &place(k), &format!("masks {has_masks}, frame {k}"));
            assert_eq!((found.frame, found.state, found.is_detected), (k, TrackState::Tracking, k == 0), "frame {k}");
        }
    }
}

#[wasm_bindgen_test]
fn a_known_size_stays_and_an_initial_pose_needs_no_mask() {
    let scale = ScaleOption::Fixed(truth().scale);
    let mut tracker = tracker(TrackOptions { initial: Some(place(0)), scale, ..TrackOptions::default() });
    for k in 0..4 {
        let found = tracker.next(&without_mask(frame(k)), &mut Silent).unwrap();
        assert!((found.camera_from_mesh.scale / truth().scale - 1.0).abs() < 1e-6, "frame {k}");
        assert!(found.is_scale_settled && found.scale_sd == 0.0);
        assert_right(&body(), &pose(&found), &place(k), &format!("frame {k}"));
    }
}

#[wasm_bindgen_test]
fn the_deviation_of_the_size_covers_wrong_proportions_of_the_mesh() {
    let [of_true, of_flat] = [1.0, 0.85].map(|height| {
        let mesh = body();
        let positions = mesh.positions().iter().map(|p| Vec3::new(p.x, p.y, height * p.z)).collect();
        let mesh = Mesh::new(positions, mesh.triangles().to_vec()).unwrap();
        let mut tracker = Tracker::new(PreparedMesh::new(mesh), TrackOptions::default()).unwrap();
        let found = [0, 2, 4, 6].map(|k| tracker.next(&frame(k), &mut Silent).unwrap());
        let error = (found[3].camera_from_mesh.scale / truth().scale).ln().abs();
        (found[3].scale_sd, error)
    });
    assert!(of_true.0 < 0.01, "deviation {}", of_true.0);
    assert!(of_flat.0 > 2.0 * of_true.0, "deviations {} and {}", of_flat.0, of_true.0);
    for (sd, error) in [of_true, of_flat] {
        assert!(error < 2.0 * sd, "an error of {error} with a deviation of {sd}");
    }
}

#[wasm_bindgen_test]
fn an_object_that_is_gone_is_lost_and_found_again() {
    let mut tracker = tracker(TrackOptions::default());
    let states = [0, 1, 2, 3, 4, 5].map(|k| {
        let mut seen = frame(k);
        if k == 2 || k == 3 {
            seen.mask.iter_mut().for_each(|mask| mask.data_mut().fill(0));
        }
        let found = tracker.next(&seen, &mut Silent).unwrap();
        if k == 5 {
            assert_right(&body(), &pose(&found), &place(k), "found again");
        }
        assert_eq!(found.state == TrackState::Lost, found.confidence == 0.0, "frame {k}");
        found.state
    });
    let [yes, no] = [TrackState::Tracking, TrackState::Lost];
    assert_eq!(states, [yes, yes, no, no, yes, yes]);
}

#[wasm_bindgen_test]
fn an_object_that_comes_back_beside_its_place_is_found_without_a_mask() {
    let mut tracker = tracker(TrackOptions::default());
    let away = |k: usize| {
        let moved = Vector3::new(0.07, -0.02, 0.0);
        Similarity { translation: place(k).translation + moved, ..place(k) }
    };
    for k in 0..6 {
        let seen = match k {
            0 => frame(0),
            1 => without_mask(frame(1)),
            // Gone: the wall behind it is seen.
            2 | 3 => {
                let Frame { depth, mask, .. } = frame(k);
                let mask = mask.unwrap();
                let wall = |(z, mask): (&f32, &u8)| if *mask == 0 { *z } else { 1.8 };
                let values = depth.data().iter().zip(mask.data()).map(wall).collect();
                let depth = DepthMap::from_metres(depth.width(), depth.height(), values).unwrap();
                Frame { depth, mask: None, ..frame(k) }
            }
            _ => without_mask(frame_of(&observe(&body(), &away(1)))),
        };
        let found = tracker.next(&seen, &mut Silent).unwrap();
        assert_eq!(found.state == TrackState::Lost, k == 2 || k == 3, "frame {k}");
        if k == 5 {
            assert_right(&body(), &pose(&found), &away(1), "beside its place");
        }
    }
}

#[wasm_bindgen_test]
fn a_correction_moves_all_frames_of_its_stretch() {
    let mut tracker = tracker(TrackOptions::default());
    let found = [0, 1, 2, 3].map(|k| pose(&tracker.next(&frame(k), &mut Silent).unwrap()));
    // A quarter turn of the mesh about its own axis, which no evidence supports.
    let by = Similarity { rotation: Rotation3::new(Vector3::new(0.0, 0.0, 1.5)), ..Similarity::identity() };
    let fixed = found[1].compose(&by);
    let changed = tracker.correct(&fixed, Some(1)).unwrap();
    assert_eq!(changed.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [0, 1, 2, 3]);
    for (frame, before) in changed.iter().zip(&found) {
        let turned = before.rotation.inverse() * pose_of(&frame.camera_from_mesh).rotation;
        assert!((turned.angle() - 1.5).abs() < 1e-6, "frame {}: turned by {}", frame.frame, turned.angle());
    }
    let of_fix = pose_of(&changed[1].camera_from_mesh);
    assert!((of_fix.translation - fixed.translation).norm() < 1e-9);
    // Back again, and on to the next frame.
    tracker.correct(&found[1], Some(1)).unwrap();
    let next = tracker.next(&frame(4), &mut Silent).unwrap();
    assert_right(&body(), &pose(&next), &place(4), "after the corrections");
    assert_eq!(tracker.correct(&fixed, Some(9)).unwrap_err().code, ErrorCode::InvalidArgument);
    let behind = Similarity { translation: Vector3::new(0.0, 0.0, -9.0), ..fixed };
    assert_eq!(tracker.correct(&behind, None).unwrap_err().code, ErrorCode::InvalidTransform);
}

#[wasm_bindgen_test]
fn the_newest_frames_are_remembered() {
    let (mut history, mesh) = (History::default(), MeshFrame::NORMALIZED);
    let place = |k: usize| WorldPose {
        rotation: DQuat::IDENTITY,
        log_scale: 0.0,
        center: DVec3::new(0.0, 0.0, 1.0 + k as f64),
    };
    let count = MAX_FRAMES + 3;
    (0..count).for_each(|k| history.add(place(k), k == count - 2));
    assert_eq!((history.frames(), history.last()), (count, Some(place(count - 1))));
    for forgotten in [0, 2, count] {
        assert!(history.correct(forgotten, place(0), &mesh).is_none(), "frame {forgotten}");
    }
    let (changed, is_present) = history.correct(count - 1, place(7), &mesh).unwrap();
    assert_eq!(changed.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [count - 2, count - 1]);
    assert!(is_present && history.last() == Some(place(7)));
    assert_eq!(history.correct(3, place(8), &mesh).unwrap().0.len(), MAX_FRAMES - 2);
}

#[wasm_bindgen_test]
fn equivalent_turns_are_no_doubt_with_the_symmetry_of_the_object() {
    let mesh = || cuboid(Vec3::new(0.9, 0.6, 0.4));
    let seen = frame_of(&observe(&mesh(), &place(0)));
    let [with, without] = [Symmetry::Auto, Symmetry::None].map(|symmetry| {
        let options = TrackOptions { symmetry, ..TrackOptions::default() };
        Tracker::new(PreparedMesh::new(mesh()), options).unwrap().next(&seen, &mut Silent).unwrap().confidence
    });
    assert!(1.0 - with < 0.3 * (1.0 - without), "{with} with its symmetry, {without} without");
}

/// A frame in as many steps as there are yields; given up after `most` of them.
fn in_steps(tracker: &mut Tracker<PreparedMesh<'static>>, frame: &Frame, most: usize) -> (usize, Option<TrackedFrame>) {
    let mut task = Task::new(Scheduler::new(|| 1.0, None), |scheduler| async move {
        let mut host = Silent;
        tracker.next_in_steps(frame, &mut host, &scheduler).await
    });
    let mut steps = 0;
    while steps < most {
        steps += 1;
        if let Some(found) = task.step(0.0).unwrap() {
            return (steps, Some(found));
        }
    }
    (steps, None)
}

#[wasm_bindgen_test]
fn a_search_pauses_and_a_frame_that_is_given_up_does_not_count() {
    let whole = tracker(TrackOptions::default()).next(&frame(0), &mut Silent).unwrap();
    let mut tracker = tracker(TrackOptions::default());
    assert_eq!(in_steps(&mut tracker, &frame(0), 40), (40, None));
    let (steps, found) = in_steps(&mut tracker, &frame(0), usize::MAX);
    assert!(steps > 100, "{steps}");
    assert_eq!(found.unwrap(), whole);
}

#[wasm_bindgen_test]
fn what_is_refused_leaves_the_tracker_usable() {
    let mut tracker = tracker(TrackOptions::default());
    let other = Frame { mask: Some(Mask::filled(3, 3, 1)), ..frame(0) };
    assert_eq!(tracker.next(&without_mask(frame(0)), &mut Silent).unwrap_err().code, ErrorCode::InvalidArgument);
    assert_eq!(tracker.correct(&Similarity::identity(), None).unwrap_err().code, ErrorCode::InvalidArgument);
    for k in 0..2 {
        assert_eq!(tracker.next(&other, &mut Silent).unwrap_err().code, ErrorCode::SizeMismatch, "frame {k}");
        assert_eq!(tracker.next(&frame(k), &mut Silent).unwrap().state, TrackState::Tracking, "frame {k}");
    }
}
