//! Preset `precise`: the pose of a rendered object, what the options promise, and the same bits everywhere.

use sim3align::align::align;
use sim3align::geometry::image::bounds_of;
use sim3align::precise::searched::efforts;

use crate::prelude::*;
pub use crate::shapes::truth;
use crate::shapes::{rendered, view};

const WIDTH: usize = 200;
const HEIGHT: usize = 160;

/// A body that no turn maps onto itself.
pub fn body() -> Mesh {
    let wave = |x: f32| libm::sinf(x);
    mapped(&ellipsoid(Vec3::new(0.5, 0.38, 0.3), 24), |p| {
        p * (1.0 + 0.5 * wave(4.0 * p.x + 1.0) * wave(5.0 * p.y + 0.5) + 0.3 * wave(9.0 * p.z + 5.0 * p.x - 1.0))
    })
}

fn camera() -> Pinhole {
    Pinhole::new(350.0, 350.0, 99.5, 79.5).unwrap()
}

/// The mesh as `pose` puts it, 15 cm or more before a wall.
pub fn observe(mesh: &Mesh, pose: &Similarity) -> Observation {
    rendered(mesh, pose, camera(), [WIDTH, HEIGHT], |z| if z > 0.0 { z } else { 0.9 })
}

/// Few rotations and few candidates: the body is clear.
pub fn quick() -> AlignOptions {
    AlignOptions {
        quality: Quality::Fast,
        surface_samples: 500,
        max_observed_points: 500,
        symmetry: Symmetry::None,
        ..AlignOptions::default()
    }
}

fn solve(options: &AlignOptions) -> Alignment {
    let mesh = body();
    align(&observe(&mesh, &truth()), &mesh, options, &mut Silent).unwrap()
}

fn pose(result: &Alignment) -> Similarity {
    pose_of(&result.camera_from_mesh)
}

fn turn_deg(a: &Similarity, b: &Similarity) -> f64 {
    a.rotation_angle_to(b).to_degrees()
}

#[wasm_bindgen_test(unsupported = test)]
fn finds_the_pose_and_the_size() {
    let result = solve(&quick());
    let pose = pose(&result);
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.01, "scale {}", pose.scale);
    assert!(turn_deg(&pose, &truth()) < 1.5, "{}°", turn_deg(&pose, &truth()));
    assert!((pose.translation - truth().translation).norm() < 2e-3, "{}", pose.translation);
    assert!(result.metrics.unwrap().iou.unwrap() > 0.97);
    assert!(
        result.diagnostics.common.residual_m > 0.0 && result.diagnostics.common.residual_m < 2e-3,
        "{}",
        result.diagnostics.common.residual_m
    );
    assert!(result.diagnostics.counts.renders > 500);
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    assert!(solve(&AlignOptions { quality: Quality::Balanced, ..quick() }).diagnostics.common.converged);
    let terms = result.diagnostics.terms;
    assert!(terms.overlap > 0.95 && terms.depth > 0.8 && terms.outline > 0.9, "{terms:?}");
    let uncertainty = result.uncertainty.unwrap();
    assert!(uncertainty.scale > 0.0 && uncertainty.scale < 0.05, "{uncertainty:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn gives_the_same_bits_everywhere_and_whatever_the_seed_of_the_samples() {
    let result = solve(&quick());
    let bits = fingerprint(result.camera_from_mesh.matrix.map(f64::to_bits));
    // The native build's; changes with the method.
    assert_eq!(bits, FINGERPRINT, "{bits:#x}");
    let other = solve(&AlignOptions { seed: 7, ..quick() });
    assert_eq!(other.camera_from_mesh, result.camera_from_mesh, "the search draws nothing at random");
}

const FINGERPRINT: u64 = 0x8072_abc4_0bb4_1d7e;

#[wasm_bindgen_test(unsupported = test)]
fn the_pose_follows_a_turned_mesh() {
    // The mesh in another frame: the same object in the same place.
    for seed in 0..3 {
        let mut draw = Draw::new(seed);
        let frame = draw.similarity([2.0, 4.0], 5.0);
        let turned = mapped(&body(), |p| vec3(&frame.apply(vector3(p))));
        let result = align(&observe(&body(), &truth()), &turned, &quick(), &mut Silent).unwrap();
        let pose = pose(&result).compose(&frame);
        assert!((pose.scale / truth().scale - 1.0).abs() < 0.015, "seed {seed}: scale {}", pose.scale);
        assert!(turn_deg(&pose, &truth()) < 2.5, "seed {seed}: {}°", turn_deg(&pose, &truth()));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_fixed_scale_stays_and_bounds_hold() {
    let fixed = solve(&AlignOptions { scale: ScaleOption::Fixed(0.16), ..quick() });
    assert!((fixed.camera_from_mesh.scale - 0.16).abs() < 1e-9, "{}", fixed.camera_from_mesh.scale);
    let bounded = solve(&AlignOptions { scale: ScaleOption::Between([0.175, 0.3]), ..quick() });
    assert!(bounded.camera_from_mesh.scale >= 0.175 - 1e-9, "{}", bounded.camera_from_mesh.scale);
    assert!(bounded.diagnostics.common.clamped, "the truth is below");
    assert!(bounded.warnings.iter().any(|w| w.message.contains("options.scale")), "{:?}", bounded.warnings);
    let wide = solve(&AlignOptions { scale: ScaleOption::Between([0.01, 3.0]), ..quick() });
    assert!(!wide.diagnostics.common.clamped);
    assert_eq!(wide.camera_from_mesh, solve(&quick()).camera_from_mesh, "bounds that hold nothing change nothing");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_local_search_refines_the_pose_it_is_given() {
    let mut near = truth();
    near.rotation = Rotation3::new(Vector3::new(0.1, -0.12, 0.08)) * near.rotation;
    near.scale *= 1.08;
    near.translation += Vector3::new(0.006, -0.004, 0.02);
    let options = AlignOptions { initial: Some(near), search: SearchScope::Local, ..quick() };
    let result = solve(&options);
    let pose = pose(&result);
    assert!(turn_deg(&pose, &truth()) < 1.5, "{}°", turn_deg(&pose, &truth()));
    assert!((pose.scale / truth().scale - 1.0).abs() < 0.01);
    assert!(
        result.diagnostics.counts.renders < solve(&quick()).diagnostics.counts.renders / 2,
        "only the neighbourhood is drawn"
    );

    let locked = AlignOptions { scale: ScaleOption::Fixed(near.scale), ..options };
    assert!((solve(&locked).camera_from_mesh.scale - near.scale).abs() < 1e-9);
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn a_local_search_far_from_the_truth_stays_there() {
    let far = Similarity { rotation: Rotation3::new(Vector3::new(2.5, 0.0, 0.0)) * truth().rotation, ..truth() };
    let result = solve(&AlignOptions { initial: Some(far), search: SearchScope::Local, ..quick() });
    assert!(turn_deg(&pose(&result), &truth()) > 30.0);
    // Searched everywhere, the same pose does no harm.
    let result = solve(&AlignOptions { initial: Some(far), ..quick() });
    assert!(turn_deg(&pose(&result), &truth()) < 1.5);
}

#[wasm_bindgen_test(unsupported = test)]
fn an_initial_pose_behind_the_camera_is_refused() {
    let behind = Similarity { translation: -truth().translation, ..truth() };
    let options = AlignOptions { initial: Some(behind), ..quick() };
    let error = align(&observe(&body(), &truth()), &body(), &options, &mut Silent).unwrap_err();
    assert_eq!((error.code, error.argument.as_ref()), (ErrorCode::InvalidOption, "options.initial"));
}

/// A brick's turns about its own axes look alike: which way up is told by the prior alone.
#[wasm_bindgen_test(unsupported = test)]
fn an_up_direction_chooses_among_poses_that_look_alike() {
    let brick = cuboid(Vec3::new(0.5, 0.8, 1.1));
    let observation = observe(&brick, &truth());
    for sign in [1.0, -1.0] {
        let up = truth().rotation * Vector3::z() * sign;
        let options = AlignOptions {
            camera_up: Some([3.0 * up.x, 3.0 * up.y, 3.0 * up.z]),
            mesh_up: Some([0.0, 0.0, 2.0]),
            ..quick()
        };
        let result = align(&observation, &brick, &options, &mut Silent).unwrap();
        let found = pose(&result).rotation * Vector3::z();
        assert!(found.dot(&up) > 0.95, "sign {sign}: {found}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn alternatives_are_told_from_repetitions() {
    let brick = cuboid(Vec3::new(0.5, 0.8, 1.1));
    let observation = observe(&brick, &truth());
    let run = |symmetry| align(&observation, &brick, &AlignOptions { symmetry, ..quick() }, &mut Silent).unwrap();
    let all = run(Symmetry::None);
    assert!(!all.alternatives.is_empty(), "a brick has four poses that look alike");
    assert!(all.alternatives.iter().all(|a| a.score <= all.diagnostics.score && a.turn_deg > 14.0));
    let flips = |a: &Alignment| a.alternatives.iter().filter(|a| a.turn_deg > 170.0).count();
    assert!(flips(&all) > 0);
    assert_eq!(flips(&run(Symmetry::Auto)), 0, "the surfaces coincide");
    let half = |axis| SymmetryAxis { axis, fold: Some(2) };
    let declared = Symmetry::Declared(vec![half(Vector3::x()), half(Vector3::y()), half(Vector3::z())]);
    assert_eq!(flips(&run(declared)), 0);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_budget_bounds_the_work() {
    let renders = |work_budget| solve(&AlignOptions { work_budget, ..quick() }).diagnostics.counts.renders;
    let (small, large) = (renders(Some(15.0)), renders(Some(120.0)));
    assert!(small < large, "{small} and {large}");
    assert!(small < renders(None));
    assert_eq!(small, renders(Some(15.0)), "counted, not timed");
    let settings = |work_budget| efforts::of(&AlignOptions { work_budget: Some(work_budget), ..quick() });
    assert!(settings(1e-9)[0].rotations() >= 60, "the least that is a search");
    assert!(settings(1e300)[0].rotations() < 100_000, "the most");
    // Two searches share a budget: as little as one takes is for one, and what it leaves for the other.
    let both = |work_budget| efforts::of(&AlignOptions { work_budget: Some(work_budget), ..AlignOptions::default() });
    let [fast, best] = both(1e9)[..] else { panic!("two searches") };
    assert_eq!((fast.effort, best.effort), (Effort::Fast, Effort::Best));
    assert_eq!(both(0.5 * fast.cost()).len(), 1);
    assert_eq!(both(1.9 * fast.cost()).len(), 1);
    let [first, second] = both(5.0 * fast.cost())[..] else { panic!("two searches") };
    assert_eq!(first, fast);
    let share = (first.cost() + second.cost()) / (5.0 * fast.cost());
    assert!((0.8..=1.0001).contains(&share), "{share} of the budget");
}

#[wasm_bindgen_test(unsupported = test)]
fn confidence_knows_a_mesh_that_does_not_fit() {
    let right = solve(&quick());
    let fits = right.confidence;
    let other = cuboid(Vec3::new(0.2, 0.3, 1.4));
    let result = align(&observe(&body(), &truth()), &other, &quick(), &mut Silent).unwrap();
    let misfits = result.confidence;
    assert!((0.0..=1.0).contains(&fits) && (0.0..=1.0).contains(&misfits));
    assert!(fits > 0.8, "{fits}");
    assert!(misfits < 0.5, "{misfits}");
    let is_doubtful = |found: &Alignment| found.warnings.iter().any(|w| w.code == WarningCode::MeshDoubtful);
    assert!(is_doubtful(&result) && !is_doubtful(&right), "{:?}, {:?}", result.warnings, right.warnings);
}

#[wasm_bindgen_test(unsupported = test)]
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

#[wasm_bindgen_test(unsupported = test)]
fn directions_of_any_length_are_up() {
    let run = |camera: f64, mesh: f64| {
        let camera_up = DVec3::new(0.0, -camera, 0.3 * camera).to_array();
        solve(&AlignOptions { camera_up: Some(camera_up), mesh_up: Some([0.0, 0.0, mesh]), ..quick() })
    };
    let unit = run(1.0, 1.0);
    assert_ne!(unit.diagnostics.score, solve(&quick()).diagnostics.score, "the directions count");
    for (camera, mesh) in [(1e-3, 1e6), (1e-100, 1e100)] {
        let other = run(camera, mesh);
        let off = (other.diagnostics.score - unit.diagnostics.score).abs();
        assert!(off < 1e-4, "lengths {camera} and {mesh}: the score is {off} off");
        assert!(turn_deg(&pose(&other), &pose(&unit)) < 0.1, "lengths {camera} and {mesh}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn metrics_are_left_out_on_request_and_nothing_else_changes() {
    for quality in [Quality::Fast, Quality::Best] {
        let with = solve(&AlignOptions { quality, ..quick() });
        assert!(quality == Quality::Fast || turn_deg(&pose(&with), &truth()) < 1.0);
        let without = solve(&AlignOptions { quality, metrics: false, ..quick() });
        assert!(with.metrics.is_some() && without.metrics.is_none());
        let stages = |result: &Alignment| {
            let timed = result.diagnostics.common.timings_ms.stages().iter().map(|(stage, _)| stage.as_str());
            timed.collect::<Vec<_>>()
        };
        assert!(stages(&with).contains(&"normals") && stages(&with).contains(&"metrics"));
        // The search itself needs no normals.
        assert!(!stages(&without).contains(&"metrics") && !stages(&without).contains(&"normals"));
        let same = |result: Alignment| {
            let mut diagnostics = result.diagnostics;
            diagnostics.common.timings_ms = Default::default();
            (result.camera_from_mesh, result.confidence, result.alternatives, result.uncertainty, diagnostics)
        };
        assert_eq!(same(with), same(without));
    }
}
