//! General registration recovers known transforms.

use sim3align::pauses::Task;
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::report::Registration;
use sim3align::register::{estimate_sim3, estimate_sim3_task, register, register_task};

use crate::prelude::*;

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

/// Registers both shapes, moved by similarities of each scale of at most this translation, in each amount of clutter.
fn register_both(
    settings: &[(f64, f64)],
    first_seed: u64,
    reach: f64,
    options: impl Fn(&Similarity) -> RegisterOptions,
) {
    for (shape, surface) in [("blob", blob as fn(&mut Draw, usize) -> Cloud), ("mug", mug)] {
        for (seed, &(scale, clutter)) in (first_seed..).zip(settings) {
            let draw = &mut Draw::new(seed);
            let source: Vec<_> = surface(draw, 3000).points.into_iter().map(vector3).collect();
            let truth = draw.similarity([scale, scale], reach);
            let moved: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
            let target = cluttered(draw, &moved, clutter);
            let what = format!("{shape}, seed {seed}, scale {scale}, clutter {clutter}");
            let result = register(&flat(&source), &flat(&target), &options(&truth), &mut Silent);
            let result = result.unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_recovers(&result.target_from_source.matrix, &truth, &source, 1e-4, &what);
            assert!(result.diagnostics.converged && result.fitness > 0.99, "{what}: fitness {}", result.fitness);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn recovers_any_similarity_of_a_full_surface_exactly() {
    let settings = [(0.01, 0.0), (100.0, 0.0), (0.01, 0.5), (0.3, 0.25), (1.0, 0.5), (100.0, 0.5)];
    register_both(&settings, 100, 1e4, |_| RegisterOptions::default());
}

#[wasm_bindgen_test(unsupported = test)]
fn a_known_scale_gives_the_pose_exactly_in_clutter_too() {
    let settings = [(1.0, 0.0), (0.01, 0.5), (30.0, 0.25)];
    let options =
        |truth: &Similarity| RegisterOptions { scale: ScaleOption::Fixed(truth.scale), ..RegisterOptions::default() };
    register_both(&settings, 300, 100.0, options);
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
    let bad = [
        (good[..100].to_vec(), ErrorCode::WrongLength),
        (good[..30].to_vec(), ErrorCode::TooFewPoints),
        (vec![f64::NAN; 300], ErrorCode::TooFewPoints),
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

#[wasm_bindgen_test(unsupported = test)]
fn points_without_a_reading_are_skipped_and_counted() {
    let draw = &mut Draw::new(9);
    let source: Vec<_> = mug(draw, 2000).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([2.0, 3.0], 5.0);
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
    let (source, target) = (flat(&source), flat(&target));
    // Every third point of an organised cloud has none, be it all three coordinates or one.
    let organised = |xyz: &[f64], empty: [f64; 3]| -> Vec<f64> {
        xyz.chunks(6).flat_map(|points| points.iter().copied().chain(empty)).collect()
    };
    let options = RegisterOptions::default();
    let plain = register(&source, &target, &options, &mut Silent).unwrap();
    let with_nan = organised(&source, [f64::NAN; 3]);
    let with_infinity = organised(&target, [0.0, f64::INFINITY, 0.0]);
    let skipping = register(&with_nan, &with_infinity, &options, &mut Silent).unwrap();
    assert_eq!(skipping.target_from_source, plain.target_from_source);
    let skipped =
        |found: &Registration| [found.diagnostics.skipped_source_points, found.diagnostics.skipped_target_points];
    assert_eq!((skipped(&plain), skipped(&skipping)), ([0, 0], [1000, 1000]));
}

/// The part of a cloud on one side of a plane through its middle, by share.
fn part(points: &[Vector3<f64>], direction: Vector3<f64>, share: f64) -> Vec<Vector3<f64>> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].dot(&direction).total_cmp(&points[b].dot(&direction)));
    order[..(share * points.len() as f64) as usize].iter().map(|&i| points[i]).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn a_free_scale_of_partial_clouds_does_not_collapse() {
    for (shape, surface, share) in [("blob", blob as fn(&mut Draw, usize) -> Cloud, 0.65), ("mug", mug, 0.75)] {
        for seed in 400..402 {
            let draw = &mut Draw::new(seed);
            let whole = surface(draw, 4000).points;
            let direction = draw.direction();
            // Two samples of noisy parts, which have a half or two thirds of their points in common.
            let [source, target] = [direction, -direction].map(|direction| {
                let noisy: Vec<_> = draw.noisy(&whole, 0.004).into_iter().map(vector3).collect();
                part(&noisy, direction, share)
            });
            let truth = draw.similarity([0.2, 5.0], 10.0);
            let target: Vec<_> = target.iter().map(|&p| truth.apply(p)).collect();
            let found = register(&flat(&source), &flat(&target), &RegisterOptions::default(), &mut Silent).unwrap();
            assert_recovers(&found.target_from_source.matrix, &truth, &source, 0.05, &format!("{shape}, seed {seed}"));
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_scale_at_a_bound_of_the_searched_range_is_no_answer() {
    let mut refused = 0;
    for seed in 500..504 {
        let draw = &mut Draw::new(seed);
        let source: Vec<_> = blob(draw, 1500).points.into_iter().map(vector3).collect();
        // The target stands twice in its cloud, so far apart that the true scale is slightly below a fifth of the ratio
        // of the boxes.
        let (low, high) = source.iter().fold((source[0], source[0]), |(a, b), p| (a.inf(p), b.sup(p)));
        let away = (high - low) * (1.0 / 0.19 - 1.0);
        let target: Vec<_> = source.iter().flat_map(|&p| [p, p + away]).collect();
        match register(&flat(&source), &flat(&target), &RegisterOptions::default(), &mut Silent) {
            Ok(found) => {
                let ratio = found.diagnostics.scale_ratio;
                assert!(ratio > 0.2 * (1.0 + 1e-6) && ratio < 5.0 * (1.0 - 1e-6), "seed {seed}: {ratio}");
            }
            Err(error) => {
                assert_eq!(error.code, ErrorCode::NoConsensus, "seed {seed}: {error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 0);
}

/// A clock at which every pause point is due.
fn always() -> f64 {
    1.0
}

/// The result of a task, and the number of its steps.
fn stepped(task: &mut Task<'_, Registration>) -> (Registration, usize) {
    let mut steps = 1;
    loop {
        if let Some(found) = task.step(0.0).unwrap() {
            return (found, steps);
        }
        steps += 1;
    }
}

/// The most units of work between two pause points: those of what is done for a voxel or a match at once, and those of one
/// pass over all points.
fn longest_block(points: usize) -> f64 {
    12.0 + 6e-5 * points as f64
}

#[wasm_bindgen_test(unsupported = test)]
fn no_part_of_a_registration_is_long() {
    let draw = &mut Draw::new(11);
    let points: Vec<_> = mug(draw, 8_000).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([2.0, 2.0], 1.0);
    let direction = draw.direction();
    let moved: Vec<_> = part(&points, direction, 0.8).iter().map(|&p| truth.apply(p)).collect();
    let (source, target) = (flat(&points), flat(&moved));
    for scale in [ScaleOption::Free, ScaleOption::Fixed(truth.scale)] {
        for voxel_divisions in [None, Some(200.0)] {
            let options = RegisterOptions { scale, voxel_divisions, ..RegisterOptions::default() };
            let mut task = register_task(source.clone(), target.clone(), options, Silent, always).unwrap();
            let (_, steps) = stepped(&mut task);
            let (longest, most) = (task.longest_block(), longest_block(points.len()));
            assert!(longest <= most, "{scale:?}, {voxel_divisions:?}: {longest} units, at most {most}");
            assert!(steps > 100, "{scale:?}, {voxel_divisions:?}: {steps} steps");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn no_part_of_an_estimate_is_long() {
    let draw = &mut Draw::new(12);
    let count = 200_000;
    let source: Vec<_> = (0..count).map(|_| draw.cube(1.0)).collect();
    let truth = draw.similarity([2.0, 2.0], 1.0);
    let target: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
    let pairs: Vec<u32> =
        (0..count).flat_map(|i| [i as u32, if i % 2 == 0 { i } else { draw.below(count) } as u32]).collect();
    for scale in [ScaleOption::Free, ScaleOption::Fixed(truth.scale)] {
        let options = EstimateSim3Options { scale, ransac_iterations: 10_000_000, ..EstimateSim3Options::default() };
        let whole = estimate_sim3(&flat(&source), &flat(&target), &pairs, &options, &mut Silent).unwrap();
        let mut task =
            estimate_sim3_task(flat(&source), flat(&target), pairs.clone(), options, Silent, always).unwrap();
        let (found, steps) = stepped(&mut task);
        assert_eq!(found, whole);
        let (longest, most) = (task.longest_block(), longest_block(count));
        assert!(longest <= most, "{scale:?}: {longest} units, at most {most}");
        assert!(steps > 30, "{scale:?}: {steps} steps");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn pauses_change_no_bit() {
    let draw = &mut Draw::new(3);
    let points: Vec<_> = mug(draw, 1500).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([2.0, 2.0], 1.0);
    let moved: Vec<_> = points.iter().map(|&p| truth.apply(p)).collect();
    for scale in [ScaleOption::Free, ScaleOption::Fixed(truth.scale)] {
        let (source, target) = (flat(&points), flat(&moved));
        let options = RegisterOptions { scale, ..RegisterOptions::default() };
        let whole = register(&source, &target, &options, &mut Silent).unwrap();
        let mut task = register_task(source, target, options, Silent, always).unwrap();
        let (found, steps) = stepped(&mut task);
        assert_eq!(found, whole);
        assert!(steps > 20, "{steps} steps");
        assert_eq!(task.step(0.0).unwrap_err().code, ErrorCode::Internal, "the task is over");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_work_budget_bounds_the_draws() {
    let points: Vec<_> = blob(&mut Draw::new(7), 400).points.into_iter().map(vector3).collect();
    let points = flat(&points);
    // Every source point with a target point that has nothing to do with it.
    let pairs: Vec<u32> = (0..400).flat_map(|i| [i, (i * 173 + 31) % 400]).collect();
    let draws = |work_budget| {
        let options = EstimateSim3Options {
            ransac_iterations: 10_000_000,
            edge_similarity: 0.0,
            work_budget: Some(work_budget),
            ..EstimateSim3Options::default()
        };
        let found = estimate_sim3(&points, &points, &pairs, &options, &mut Silent);
        found.unwrap().diagnostics.counts.iterations
    };
    let (few, many) = (draws(20.0), draws(200.0));
    assert_eq!(few, draws(20.0));
    assert!(few > 100 && many > 5 * few && many < 200_000, "{few} and {many} draws");
}
