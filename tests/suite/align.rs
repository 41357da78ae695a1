//! `align`: the pose of a rendered object, what its options promise, and the same result in parts and with helpers; the
//! preset `paper`.

use core::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use sim3align::align::evaluate::{EvaluateOptions, Truth, evaluate};
use sim3align::align::helper::Helper;
use sim3align::align::search::Request;
use sim3align::align::{align, align_paper, align_task};
use sim3align::geometry::image::bounds_of;
use sim3align::helpers::{Helpers, Link, READY};
use sim3align::paper::options::{GuardMode, PaperOptions};
use sim3align::precise::search::start::prepare_mesh;
use sim3align::report::PaperAlignment;
use sim3align::scheduler::Scheduler;

use crate::observations::{HEIGHT, WIDTH, body, camera, observe, quick, solve, truth, turn_deg};
use crate::prelude::*;
use crate::shapes::{self, view};

fn pose(result: &Alignment) -> Similarity {
    pose_of(&result.camera_from_mesh)
}

#[wasm_bindgen_test]
fn finds_the_pose_and_the_size() {
    let result = solve(&quick());
    let pose = pose(&result);
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.01, "scale {}", pose.scale);
    assert!(turn_deg(&pose, &truth()) < 1.5, "{}°", turn_deg(&pose, &truth()));
    assert!((pose.translation - truth().translation).norm() < 2e-3, "{}", pose.translation);
    assert!(result.metrics.unwrap().iou.unwrap() > 0.97 && result.warnings.is_empty(), "{:?}", result.warnings);
    let (residual, terms) = (result.diagnostics.common.residual_m, result.diagnostics.terms);
    assert!(residual > 0.0 && residual < 2e-3, "{residual}");
    assert!(terms.overlap > 0.95 && terms.depth > 0.8 && terms.outline > 0.9, "{terms:?}");
    let free = result.uncertainty.unwrap();
    assert!(free.scale > 0.0 && free.scale < 0.05);
    let fixed = AlignOptions { scale: ScaleOption::Fixed(truth().scale), ..quick() };
    let fixed = solve(&fixed).uncertainty.unwrap();
    assert!(fixed.scale == 0.0 && fixed.distance_m < free.distance_m, "{fixed:?}, free {free:?}");
    assert!(result.confidence > 0.8, "{}", result.confidence);
}

#[wasm_bindgen_test]
fn bounds_of_the_scale_hold_and_are_reported() {
    let bounded = solve(&AlignOptions { scale: ScaleOption::Between([0.175, 0.3]), ..quick() });
    assert!(bounded.camera_from_mesh.scale >= 0.175 - 1e-9, "{}", bounded.camera_from_mesh.scale);
    assert!(
        bounded.diagnostics.common.clamped && codes(&bounded.warnings).contains(&WarningCode::ScaleClamped),
        "{bounded:?}"
    );
    let wide = solve(&AlignOptions { scale: ScaleOption::Between([0.01, 3.0]), ..quick() });
    assert!(!wide.diagnostics.common.clamped);
    assert_eq!(wide.camera_from_mesh, solve(&quick()).camera_from_mesh, "bounds that hold nothing change nothing");
}

#[wasm_bindgen_test]
fn a_local_search_refines_the_pose_it_is_given() {
    let near = Similarity {
        scale: 1.08 * truth().scale,
        rotation: Rotation3::new(Vector3::new(0.1, -0.12, 0.08)) * truth().rotation,
        translation: truth().translation + Vector3::new(0.006, -0.004, 0.02),
    };
    let found = |initial| pose(&solve(&AlignOptions { initial: Some(initial), search: SearchScope::Local, ..quick() }));
    let pose = found(near);
    assert!(turn_deg(&pose, &truth()) < 1.5 && (pose.scale / truth().scale - 1.0).abs() < 0.01, "{pose:?}");
    // Far from the truth it stays there.
    let far = Similarity { rotation: Rotation3::new(Vector3::new(2.5, 0.0, 0.0)) * truth().rotation, ..truth() };
    assert!(turn_deg(&found(far), &truth()) > 30.0);
}

#[wasm_bindgen_test]
fn an_initial_pose_decides_between_turns_that_look_alike_and_no_others() {
    let brick = cuboid(Vec3::new(1.0, 0.8, 0.55));
    let observation = observe(&brick, &truth());
    let half_turns =
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| Rotation3::new(axis * core::f64::consts::PI));
    let turned = |by: &Rotation3<f64>| Similarity { rotation: truth().rotation * by, ..truth() };
    for half_turn in half_turns {
        let initial = turned(&half_turn);
        let options = AlignOptions { initial: Some(initial), symmetry: Symmetry::None, ..quick() };
        let found = pose(&align(&observation, &brick, &options, &mut Silent).unwrap());
        assert!(turn_deg(&found, &initial) < 3.0, "{} for {half_turn}", turn_deg(&found, &initial));
        // What the image tells, the initial pose does not overrule.
        let found = pose(&solve(&AlignOptions { initial: Some(initial), ..quick() }));
        assert!(turn_deg(&found, &truth()) < 1.5, "{} for {half_turn}", turn_deg(&found, &truth()));
    }
}

#[wasm_bindgen_test]
fn of_equal_poses_the_result_is_nearest_to_the_initial_pose_or_faces_the_camera() {
    let brick = cuboid(Vec3::new(1.0, 0.8, 0.55));
    let observation = observe(&brick, &truth());
    let found =
        |initial| pose(&align(&observation, &brick, &AlignOptions { initial, ..quick() }, &mut Silent).unwrap());
    let half_turns =
        [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| Rotation3::new(axis * core::f64::consts::PI));
    let equal: Vec<Similarity> = core::iter::once(Rotation3::identity())
        .chain(half_turns)
        .map(|turn| Similarity { rotation: truth().rotation * turn, ..truth() })
        .collect();
    for initial in &equal {
        let found = found(Some(*initial));
        assert!(turn_deg(&found, initial) < 3.0, "{}° from {initial:?}", turn_deg(&found, initial));
    }

    let facing = Similarity { rotation: half_turns[0], ..truth() };
    let from_facing = |pose: &&Similarity| (turn_deg(pose, &facing) * 1e6) as u64;
    let nearest = equal.iter().min_by_key(from_facing).unwrap();
    assert!(turn_deg(&found(None), nearest) < 3.0, "{:?}, not {nearest:?}", found(None));
}

#[wasm_bindgen_test]
fn an_occluder_hides_and_does_not_shrink() {
    let mesh = body();
    let whole = observe(&mesh, &truth());
    // A board before the right third of the object.
    let [[first, last], _] = bounds_of(whole.mask().data(), WIDTH, |m| *m != 0);
    let cut = first + 2 * (last + 1 - first) / 3;
    let is_object = |u, v| u < cut && whole.mask().get(u, v) != Some(0);
    let depth = |u, v| if u < cut { whole.depth().get(u, v).unwrap() } else { 0.35 };
    let observation = view(camera(), [WIDTH, HEIGHT], is_object, depth).unwrap();
    let options = AlignOptions { quality: Quality::Balanced, ..quick() };
    let result = align(&observation, &mesh, &options, &mut Silent).unwrap();
    let pose = pose(&result);
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.03, "scale {}", pose.scale);
    assert!(turn_deg(&pose, &truth()) < 4.0, "{}°", turn_deg(&pose, &truth()));
    assert!(result.diagnostics.terms.hidden > 0.1);
}

#[wasm_bindgen_test]
fn what_only_touches_an_object_takes_few_images() {
    let mesh = body();
    let whole = observe(&mesh, &truth());
    let [_, [_, last]] = bounds_of(whole.mask().data(), WIDTH, |m| *m != 0);
    let is_object = |u, v| whole.mask().get(u, v) != Some(0);
    // A table that rises towards the camera right below the object, where it could hide a part.
    let depth = |u, v| if v > last { 0.4 } else { whole.depth().get(u, v).unwrap() };
    let touched = view(camera(), [WIDTH, HEIGHT], is_object, depth).unwrap();
    let found = |quality| align(&touched, &mesh, &AlignOptions { quality, ..quick() }, &mut Silent).unwrap();
    let [all, auto] = [Quality::Fast, Quality::Auto].map(found);
    assert!(turn_deg(&pose(&auto), &truth()) < 4.0, "{}°", turn_deg(&pose(&auto), &truth()));
    let [all, auto] = [all, auto].map(|result| result.diagnostics.counts.renders);
    assert!(2 * auto < all, "{auto} of {all} images");
}

#[wasm_bindgen_test]
fn pauses_and_a_prepared_mesh_change_nothing() {
    let mesh = body();
    let prepared = PreparedMesh::new(mesh.clone());
    prepare_mesh(&prepared).unwrap();
    for quality in [Quality::Fast, Quality::Balanced] {
        let options = AlignOptions { quality, ..AlignOptions::default() };
        let whole = align(&observe(&mesh, &truth()), &mesh, &options, &mut Silent).unwrap();
        for (seed, one_in) in [(0, 0), (0, 1), (1, 50)] {
            let scheduler = Scheduler::new(pausing(seed, one_in), None);
            let mut task = align_task(observe(&mesh, &truth()), &prepared, options.clone(), Silent, scheduler).unwrap();
            let (found, steps) = stepped(&mut task, 0.0);
            assert_eq!(found, whole, "{quality:?}, seed {seed}, one pause in {one_in}");
            assert!(one_in != 1 || steps > 300, "{quality:?}: {steps} steps");
            assert_eq!(task.step(0.0).unwrap_err().code, ErrorCode::Internal, "the task is over");
        }
    }
}

/// Helpers in the same thread, which come at once and of which the last one leaves.
struct Crew {
    helpers: Vec<Helper>,
    arrived: VecDeque<Vec<f64>>,
    random: Random,
    answers: usize,
}

#[derive(Clone)]
struct Crowd(Rc<RefCell<Crew>>);

impl Link for Crowd {
    fn ask(&self) {}

    fn send(&self, helper: usize, message: &[f64]) {
        self.0.borrow_mut().helpers.get_mut(helper).into_iter().for_each(|helper| helper.receive(message));
    }

    fn receive(&self) -> Option<Vec<f64>> {
        let Crew { helpers, arrived, random, answers } = &mut *self.0.borrow_mut();
        let k = random.below(helpers.len());
        if *answers == 300 && helpers.len() > 1 {
            arrived.push_back(vec![(helpers.len() - 1) as f64]);
            helpers.pop();
            *answers += 1;
        } else if let Some(mut answer) = helpers[k].step(|| true) {
            answer[0] = k as f64;
            arrived.push_back(answer);
            *answers += 1;
        }
        arrived.pop_front()
    }

    fn wait(&self) {}
}

#[wasm_bindgen_test]
fn an_alignment_with_helpers_has_the_same_bits() {
    let mesh = body();
    let options = AlignOptions { work_budget: Some(30.0), ..AlignOptions::default() };
    let alone = align(&observe(&mesh, &truth()), &mesh, &options, &mut Silent).unwrap();
    for count in [1, 3] {
        let helper = |_| {
            let (request, prepared) = (Request::new(options.clone()).unwrap(), PreparedMesh::new(mesh.clone()));
            Helper::new(vec![Some(observe(&mesh, &truth()))], Rc::new(prepared), request, |_| ())
        };
        let helpers = (0..count).map(helper).collect();
        let arrived = (0..count).map(|k| [&[k as f64], &READY[1..]].concat()).collect();
        let crew = Crew { helpers, arrived, random: Random::new(count, 33), answers: 0 };
        let crowd = Crowd(Rc::new(RefCell::new(crew)));
        let scheduler = Scheduler::unbounded().with_helpers(Helpers::new(crowd.clone()));
        let prepared = PreparedMesh::borrowed(&mesh);
        let mut task = align_task(observe(&mesh, &truth()), prepared, options.clone(), Silent, scheduler).unwrap();
        let (found, _) = stepped(&mut task, f64::INFINITY);
        assert_eq!(found, alone, "{count} helpers");
        assert!(crowd.0.borrow().answers > 20, "they helped: {}", crowd.0.borrow().answers);
    }
}

fn paper() -> PaperOptions {
    PaperOptions::default()
}

fn solve_by_paper(options: &PaperOptions) -> PaperAlignment {
    align_paper(&shapes::observe(&shapes::body()), &shapes::body(), options, &mut Silent).unwrap()
}

#[wasm_bindgen_test]
fn the_paper_finds_a_clean_object_near_its_pose() {
    let result = solve_by_paper(&paper());
    let truth = Truth { camera_from_mesh: truth(), symmetry: Symmetry::None };
    // As many points as the paper's method has by default.
    let PaperOptions { max_observed_points, surface_samples, .. } = paper();
    let options = EvaluateOptions { max_observed_points, surface_samples, ..EvaluateOptions::against(Some(&truth)) };
    let (mesh, pose) = (shapes::body(), pose_of(&result.camera_from_mesh));
    let scored = evaluate(&shapes::observe(&mesh), &mesh, &pose, &options).unwrap();
    let errors = scored.errors.unwrap();
    // The scale is RANSAC's, locked: it is as good as a consensus of descriptors, not as a refinement.
    assert!(errors.scale_error < 0.2 && errors.rotation_error_deg < 6.0, "{errors:?}");
    // The paper's method has the normals of all points, and `evaluate` those of enough for three digits; the matrix of a
    // result has rounded once.
    let near = |a: Option<f64>, b: Option<f64>, by: f64| (a.unwrap() - b.unwrap()).abs() < by;
    let (found, again) = (result.metrics.unwrap(), scored.metrics);
    assert!(near(again.normal_consistency, found.normal_consistency, 2e-3), "{again:?}, {found:?}");
    assert!(near(again.iou, found.iou, 1e-9) && near(again.chamfer_m, found.chamfer_m, 1e-9), "{again:?}, {found:?}");
    assert!(found.iou.unwrap() > 0.7, "{found:?}");
    let common = result.diagnostics.common;
    assert!(!common.collapsed && !common.clamped && result.warnings.is_empty(), "{:?}", result.warnings);
}

#[wasm_bindgen_test]
fn a_scale_at_the_guard_of_the_paper_is_reported() {
    let clamped = solve_by_paper(&PaperOptions { guard: Some([1.0, 1.0]), guard_mode: GuardMode::Clamp, ..paper() });
    assert!(clamped.diagnostics.common.clamped, "{:?}", clamped.diagnostics);
    assert!(codes(&clamped.warnings).contains(&WarningCode::ScaleClamped), "{:?}", clamped.warnings);
    // The refinement is stopped at the guard too, and says so.
    let stopped =
        solve_by_paper(&PaperOptions { lock_scale: false, guard: Some([0.999, 1.001]), ..paper() }).diagnostics;
    assert!(stopped.common.clamped && stopped.counts.clamped == 0, "{stopped:?}");
}
