//! General registration recovers known transforms.

use nalgebra::Vector3;
use sim3align::error::ErrorCode;
use sim3align::geometry::cloud::Cloud;
use sim3align::geometry::similarity::{Similarity, vector3};
use sim3align::options::scale::ScaleOption;
use sim3align::progress::Silent;
use sim3align::register::estimate_sim3;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::register;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::support::{Draw, blob, mug};

/// The transformed points with `share` of clutter (of the whole) spread over their box, half as large again,
/// all in random order.
fn cluttered(draw: &mut Draw, points: &[Vector3<f64>], share: f64) -> Vec<Vector3<f64>> {
    let (min, max) = points.iter().fold((points[0], points[0]), |(a, b), p| (a.inf(p), b.sup(p)));
    let (center, half) = ((min + max) * 0.5, (max - min) * 0.75);
    let clutter = (points.len() as f64 * share / (1.0 - share)) as usize;
    let mut all = points.to_vec();
    for _ in 0..clutter {
        all.push(center + half.component_mul(&draw.cube(1.0)));
    }
    draw.permutation(all.len()).into_iter().map(|i| all[i]).collect()
}

fn flat(points: &[Vector3<f64>]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// Scale and angle relative, and where the points land relative to their extent.
fn assert_recovers(found: &[f64; 16], truth: &Similarity, points: &[Vector3<f64>], tolerance: f64, what: &str) {
    let found = Similarity::from_column_major(found).unwrap();
    let scale = (found.scale / truth.scale - 1.0).abs();
    let angle = found.rotation_angle_to(truth);
    let off = points.iter().map(|&p| (found.apply(p) - truth.apply(p)).norm()).fold(0.0, f64::max) / truth.scale;
    assert!(
        scale <= tolerance && angle <= tolerance && off <= tolerance,
        "{what}: scale off by {scale:.1e}, rotation by {angle:.1e} rad, points by {off:.1e} of the source unit"
    );
}

#[wasm_bindgen_test(unsupported = test)]
fn recovers_any_similarity_of_a_full_surface_exactly() {
    let settings =
        [(0.01, 0.0), (1.0, 0.0), (100.0, 0.0), (0.01, 0.5), (0.3, 0.25), (1.0, 0.5), (7.0, 0.5), (100.0, 0.5)];
    for (shape, surface) in [("blob", blob as fn(&mut Draw, usize) -> Cloud), ("mug", mug)] {
        for (case, (scale, clutter)) in settings.into_iter().enumerate() {
            let seed = 100 + case as u64;
            let draw = &mut Draw::new(seed);
            let source: Vec<_> = surface(draw, 3000).points.into_iter().map(vector3).collect();
            let truth = draw.similarity([scale, scale], 1e4);
            let moved: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
            let target = cluttered(draw, &moved, clutter);
            let what = format!("{shape}, seed {seed}, scale {scale}, clutter {clutter}");
            let options = RegisterOptions::default();
            let result = register(&flat(&source), &flat(&target), &options, &mut Silent);
            let result = result.unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_recovers(&result.target_from_source.matrix, &truth, &source, 1e-4, &what);
            assert!(result.diagnostics.converged && result.fitness > 0.99, "{what}: fitness {}", result.fitness);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_known_scale_gives_the_pose_exactly_in_clutter_too() {
    for (shape, surface) in [("blob", blob as fn(&mut Draw, usize) -> Cloud), ("mug", mug)] {
        for (case, (scale, clutter)) in [(1.0, 0.0), (1.0, 0.25), (0.01, 0.5), (30.0, 0.5)].into_iter().enumerate() {
            let seed = 300 + case as u64;
            let draw = &mut Draw::new(seed);
            let source: Vec<_> = surface(draw, 3000).points.into_iter().map(vector3).collect();
            let truth = draw.similarity([scale, scale], 100.0);
            let moved: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
            let target = cluttered(draw, &moved, clutter);
            let what = format!("{shape}, seed {seed}, scale {scale}, clutter {clutter}");
            let options = RegisterOptions { scale: ScaleOption::Fixed(truth.scale), ..RegisterOptions::default() };
            let result = register(&flat(&source), &flat(&target), &options, &mut Silent);
            let result = result.unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_recovers(&result.target_from_source.matrix, &truth, &source, 1e-4, &what);
            assert!(result.diagnostics.converged && result.fitness > 0.99, "{what}: fitness {}", result.fitness);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_known_scale_is_kept_and_bounds_are_respected() {
    let draw = &mut Draw::new(7);
    let source: Vec<_> = blob(draw, 2000).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([1.0, 1.0], 10.0);
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
    let solve = |scale| {
        let options = RegisterOptions { scale, ..RegisterOptions::default() };
        register(&flat(&source), &flat(&target), &options, &mut Silent).map(|r| r.target_from_source)
    };
    let fixed = solve(ScaleOption::Fixed(1.0)).unwrap();
    assert_eq!(fixed.scale, 1.0);
    assert_recovers(&fixed.matrix, &truth, &source, 1e-4, "scale fixed at 1");
    let between = solve(ScaleOption::Between([0.9, 1.1])).unwrap();
    assert_recovers(&between.matrix, &truth, &source, 1e-4, "scale between 0.9 and 1.1");
    // The true scale is 1: it is held at the bound that is nearer.
    for (bounds, nearer) in [([1.02, 2.0], 1.02), ([1.5, 2.0], 1.5), ([0.5, 0.98], 0.98)] {
        let held = solve(ScaleOption::Between(bounds)).unwrap();
        assert!((held.scale / nearer - 1.0).abs() < 1e-9, "scale {} for bounds of {bounds:?}", held.scale);
    }
    for bad in [ScaleOption::Fixed(0.0), ScaleOption::Fixed(f64::NAN), ScaleOption::Between([2.0, 1.0])] {
        assert_eq!(solve(bad).unwrap_err().code, ErrorCode::InvalidOption);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn correspondences_with_many_wrong_ones_give_the_transform() {
    let draw = &mut Draw::new(8);
    let source: Vec<_> = (0..400).map(|_| draw.cube(1.0)).collect();
    let truth = draw.similarity([0.2, 5.0], 1e4);
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
    // Three in four are wrong.
    let pairs: Vec<u32> = (0..400).flat_map(|i| [i, if i % 4 == 0 { i } else { draw.below(400) as u32 }]).collect();
    let options = EstimateSim3Options::default();
    let result = estimate_sim3(&flat(&source), &flat(&target), &pairs, &options, &mut Silent).unwrap();
    assert_recovers(&result.target_from_source.matrix, &truth, &source, 1e-3, "three wrong in four, seed 8");
    assert!((0.25..0.35).contains(&result.fitness), "fitness {}", result.fitness);

    let refused = [
        (vec![0, 1, 2], ErrorCode::WrongLength),
        (vec![0, 0, 1, 1], ErrorCode::TooFewPoints),
        (vec![0, 0, 1, 1, 2, 400], ErrorCode::IndexOutOfRange),
        (vec![0, 0, 0, 0, 0, 0], ErrorCode::NoConsensus),
    ];
    for (pairs, code) in refused {
        let result = estimate_sim3(&flat(&source), &flat(&target), &pairs, &options, &mut Silent);
        assert_eq!(result.unwrap_err().code, code, "{pairs:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn clouds_that_can_not_be_registered_are_refused_by_name() {
    let good: Vec<f64> = (0..300).map(|i| f64::from(i * 7919 % 101)).collect();
    let with = |i: usize, x: f64| {
        let mut cloud = good.clone();
        cloud[i] = x;
        cloud
    };
    let bad = [
        (good[..100].to_vec(), ErrorCode::WrongLength),
        (good[..30].to_vec(), ErrorCode::TooFewPoints),
        (with(5, f64::NAN), ErrorCode::NonFinite),
        (vec![1.0; 300], ErrorCode::DegeneratePoints),
    ];
    for (cloud, code) in bad {
        let options = RegisterOptions::default();
        let error = register(&good, &cloud, &options, &mut Silent).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "target"), "{error}");
        let error = register(&cloud, &good, &options, &mut Silent).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, "source"), "{error}");
    }
}
