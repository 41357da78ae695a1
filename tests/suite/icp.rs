//! ICP over the matrix of its settings, its lock and bounds, outliers, partial views, and what it does without support.

use sim3align::register::at_once::refine;
use sim3align::register::icp::{IcpMetric, IcpSettings, Refined};
use sim3align::register::support::SupportSettings;

use crate::prelude::*;

const METRICS: [IcpMetric; 2] = [IcpMetric::PointToPlane, IcpMetric::PointToPoint];

/// Corner error of a pose that ICP has to reach, in box diagonals: on the same points, and on points with noise
/// of [`NOISE`].
const EXACT: f64 = 1e-5;
const NOISY: f64 = 2.0 * NOISE;
const NOISE: f64 = 0.002;

fn settings(metric: IcpMetric, lock_scale: bool) -> IcpSettings {
    IcpSettings {
        metric,
        robust: true,
        lock_scale,
        scale_bounds: None,
        max_iterations: 200,
        support: SupportSettings { max_distance: 0.15, min_cosine: 0.3 },
        final_distance: 0.03,
        tolerance: 1e-7,
    }
}

fn run(source: &Cloud, target: &Cloud, start: &Similarity, settings: &IcpSettings) -> Refined {
    let refined = refine(source, target, &KdTree::new(&target.points), start, settings);
    assert!(rotation_defect(refined.target_from_source.rotation.matrix()) < 1e-12, "{refined:?}");
    assert!(refined.iterations <= settings.max_iterations, "{refined:?}");
    refined
}

/// A pose off the identity by some degrees, a shift and, where it may, a scale.
fn start(size: f64, sign: f64, lock_scale: bool) -> Similarity {
    let rotation = Rotation3::new(Vector3::new(0.5, -0.7, 0.5).normalize() * size * sign);
    let translation = Vector3::new(0.2, 0.1, -0.2) * size * sign;
    let scale = if lock_scale { 1.0 } else { 1.0 + 0.3 * size * sign };
    Similarity { scale, rotation, translation }
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_are_recovered() {
    let seed = 30;
    let mut draw = Draw::new(seed);
    // Where the truth is: a pose in which nothing is aligned with the axes.
    let truth = Similarity { scale: 1.0, rotation: draw.rotation(), translation: Vector3::new(0.1, -0.2, 0.3) };
    let source = unit_box(&blob(&mut draw, 1000));
    let mut cells = Vec::new();
    for i in 0..1 << 5 {
        let at = core::array::from_fn(|axis| i >> axis & 1);
        let (metric, noise, lock) = (METRICS[at[0]], [0.0, NOISE][at[1]], at[2] == 0);
        let (size, sign) = ([0.05, 0.25][at[3]], [1.0, -1.0][at[4]]);
        let mut target = transformed(&source, &truth);
        target.points = Draw::new(seed).noisy(&target.points, noise);
        let initial = truth.compose(&start(size, sign, lock));
        let refined = run(&source, &target, &initial, &settings(metric, lock));
        let found = refined.target_from_source;
        let context = format!("seed {seed}, {metric:?}, noise {noise}, lock {lock}, {size} × {sign}: {refined:?}");
        assert!(pose_error(&found, &truth) < if noise == 0.0 { EXACT } else { NOISY }, "{context}");
        assert!(refined.converged && refined.supported > 900, "{context}");
        let expected_rms = if metric == IcpMetric::PointToPlane { NOISE } else { 3f64.sqrt() * NOISE };
        let rms = if noise == 0.0 { 0.0..1e-5 } else { 0.5 * expected_rms..1.2 * expected_rms };
        assert!(rms.contains(&refined.rms), "{context}");
        assert!(!lock || found.scale.to_bits() == initial.scale.to_bits(), "{context}");
        cells.push((at, refined));
    }
    assert_no_dead_axis(["metric", "noise", "lock", "start", "direction"], &cells);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_locked_scale_keeps_its_bits() {
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let source = unit_box(&blob(&mut draw, 500));
        for metric in METRICS {
            // A scale off by some per cent that the data would gladly change, and bounds that it is not in.
            let initial = Similarity { scale: 1.0 + draw.between(0.01, 0.03), ..start(0.1, 1.0, true) };
            for scale_bounds in [None, Some([0.5, 0.9])] {
                let locked = IcpSettings { scale_bounds, ..settings(metric, true) };
                let refined = run(&source, &source, &initial, &locked);
                let scale = refined.target_from_source.scale;
                assert_eq!(scale.to_bits(), initial.scale.to_bits(), "seed {seed}, {metric:?}, {scale_bounds:?}");
                assert!(refined.iterations > 2, "seed {seed}, {metric:?}");
            }
            let free = run(&source, &source, &initial, &settings(metric, false));
            assert!((free.target_from_source.scale - 1.0).abs() < EXACT, "seed {seed}, {metric:?}: {free:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_free_scale_stays_in_its_bounds() {
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let source = unit_box(&blob(&mut draw, 500));
        for metric in METRICS {
            for (bounds, at) in [([0.95, 0.98], 0.98), ([1.02, 1.05], 1.02), ([0.9, 1.1], 1.0)] {
                let initial = Similarity { scale: 0.5 * (bounds[0] + bounds[1]), ..start(0.05, 1.0, true) };
                let bounded = IcpSettings { scale_bounds: Some(bounds), ..settings(metric, false) };
                let refined = run(&source, &source, &initial, &bounded);
                let scale = refined.target_from_source.scale;
                assert!((bounds[0]..=bounds[1]).contains(&scale), "seed {seed}, {metric:?}: {scale}");
                assert!((scale - at).abs() < EXACT, "seed {seed}, {metric:?}, {bounds:?}: {scale}");
                // Held at a bound, the middle still comes home.
                assert!(refined.target_from_source.translation.norm() < 0.02, "seed {seed}, {metric:?}: {refined:?}");
            }
            // No panic whatever the bounds.
            for bounds in [[1.05, 0.95], [f64::NAN, 1.0], [1.0, f64::NAN]] {
                let odd = IcpSettings { scale_bounds: Some(bounds), max_iterations: 3, ..settings(metric, false) };
                refine(&source, &source, &KdTree::new(&source.points), &Similarity::identity(), &odd);
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn without_support_the_pose_stays() {
    let mut draw = Draw::new(40);
    let cloud = unit_box(&blob(&mut draw, 300));
    let initial = start(0.1, 1.0, false);
    let far = Similarity { translation: Vector3::new(5.0, 0.0, 0.0), ..initial };
    let stays = |source: &Cloud, target: &Cloud, initial: &Similarity, settings: &IcpSettings, supported: usize| {
        let refined = run(source, target, initial, settings);
        let expected = Refined { target_from_source: *initial, iterations: 0, converged: false, supported, rms: 0.0 };
        assert_eq!(refined, expected);
    };
    for metric in METRICS {
        for lock in [true, false] {
            let settings = settings(metric, lock);
            stays(&cloud, &cloud, &far, &settings, 0);
            stays(&cloud.select(0..5), &cloud, &Similarity::identity(), &settings, 5);
            stays(&Cloud::default(), &cloud, &initial, &settings, 0);
            stays(&cloud, &Cloud::default(), &initial, &settings, 0);
            stays(&cloud, &cloud, &initial, &IcpSettings { max_iterations: 0, ..settings }, 0);
            let nowhere = Similarity { translation: Vector3::repeat(f64::MAX), ..initial };
            stays(&cloud, &cloud, &nowhere, &settings, 0);
        }
    }
    // Planes need normals; points do not.
    let bare = Cloud::from_points(cloud.points.clone());
    let plane = run(&cloud, &bare, &initial, &settings(IcpMetric::PointToPlane, true));
    assert_eq!((plane.target_from_source, plane.converged, plane.iterations), (initial, false, 0));
    let point = run(&bare, &bare, &start(0.1, 1.0, true), &settings(IcpMetric::PointToPoint, true));
    assert!(pose_error(&point.target_from_source, &Similarity::identity()) < EXACT, "{point:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_line_of_points_is_no_support_for_a_turn() {
    let line = Cloud::from_points((0..20).map(|i| Vec3::X * (i as f32 * 0.05 - 0.5)).collect());
    let initial = Similarity { translation: Vector3::new(0.0, 0.01, 0.0), ..Similarity::identity() };
    let refined = run(&line, &line, &initial, &settings(IcpMetric::PointToPoint, true));
    assert_eq!((refined.target_from_source, refined.converged), (initial, false));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_plane_slides_freely_and_stays_where_it_is() {
    let mut draw = Draw::new(41);
    let points: Vec<Vec3> = (0..400).map(|_| vec3(&draw.cube(0.5)) * Vec3::new(1.0, 1.0, 0.0)).collect();
    let plane = Cloud { normals: vec![Vec3::Z; points.len()], points };
    let initial = Similarity {
        translation: Vector3::new(0.03, -0.02, 0.02),
        rotation: Rotation3::new(Vector3::x() * 0.02),
        ..Similarity::identity()
    };
    let refined = run(&plane, &plane, &initial, &settings(IcpMetric::PointToPlane, true));
    let found = refined.target_from_source;
    // Onto the plane and level with it; along it, and about its normal, not a step.
    assert!(found.translation.z.abs() < 1e-6 && (found.rotation * Vector3::z()).xy().norm() < 1e-6, "{refined:?}");
    assert!((found.translation.xy() - initial.translation.xy()).norm() < 1e-3, "{refined:?}");
    assert!(found.rotation.matrix()[(1, 0)].abs() < 1e-3, "{refined:?}");
}

#[wasm_bindgen_test(unsupported = test)]
fn four_points_in_ten_may_be_spurious() {
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let truth = Similarity { scale: 1.0, rotation: draw.rotation(), translation: draw.cube(0.3) };
        for cloud in [blob(&mut draw, 900), mug(&mut draw, 900)] {
            let clean = unit_box(&cloud);
            let target = transformed(&clean, &truth);
            let mut source = clean.clone();
            // 600 more, anywhere in the box, with normals as wrong as their positions.
            source.points.extend(draw.points(600, 0.4));
            source.normals.extend((0..600).map(|_| vec3(&draw.direction())));
            for metric in METRICS {
                let initial = truth.compose(&start(0.1, 1.0, true));
                let refined = run(&source, &target, &initial, &settings(metric, true));
                let error = pose_error(&refined.target_from_source, &truth);
                let tolerance = if metric == IcpMetric::PointToPlane { 1e-3 } else { 5e-3 };
                assert!(error < tolerance, "seed {seed}, {metric:?}: {error}, {refined:?}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn one_side_is_enough() {
    // The source is whole; the target is what a camera at −z sees of another sampling of it.
    for seed in 0..5 {
        let mut draw = Draw::new(seed);
        let cloud = blob(&mut draw, 6000);
        let unit = unit_box(&cloud);
        let (source, all) = (unit.select(0..1500), unit.select(1500..6000));
        let target = all.select((0..all.len()).filter(|&i| all.normals[i].z < -0.1));
        // From 0.11 away. Points are dragged to where the other sampling happens to have some; planes are not.
        for (metric, tolerance) in METRICS.into_iter().zip([1e-3, 0.05]) {
            let refined = run(&source, &target, &start(0.1, 1.0, true), &settings(metric, true));
            let error = pose_error(&refined.target_from_source, &Similarity::identity());
            assert!(error < tolerance, "seed {seed}, {metric:?}: {error}, {refined:?}");
            assert!(refined.supported < 1100, "seed {seed}, {metric:?}: the far side takes part, {refined:?}");
        }
    }
}
