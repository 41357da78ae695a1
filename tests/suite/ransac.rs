//! RANSAC: recovery among outliers, the guard against collapse, counts, seeds, bounds.

use sim3align::register::at_once::ransac;
use sim3align::register::matching::Match;
use sim3align::register::ransac::{Consensus, Guard, GuardMode, RansacSettings};

use crate::prelude::*;

fn settings(seed: u64) -> RansacSettings {
    RansacSettings {
        inlier_distance: 0.02,
        edge_similarity: 0.9,
        max_iterations: 20_000,
        confidence: 0.999,
        scale_mode: ScaleMode::Free,
        guard: Some(Guard { min: 0.5, max: 1.5, mode: GuardMode::Reject }),
        seed,
    }
}

/// Matches of which the first `inliers` follow `truth`, to within noise, and the rest nothing.
struct Scene {
    source: Vec<Vec3>,
    target: Vec<Vec3>,
    matches: Vec<Match>,
    truth: Similarity,
}

impl Scene {
    fn new(draw: &mut Draw, truth: Similarity, inliers: usize, outliers: usize, noise: f64) -> Self {
        let source = draw.points(inliers + outliers, 0.5);
        let landed: Vec<Vec3> = source[..inliers].iter().map(|&p| vec3(&truth.apply(vector3(p)))).collect();
        let mut target = draw.noisy(&landed, noise);
        target.extend(draw.points(outliers, 0.7));
        Self { matches: one_to_one(source.len()), source, target, truth }
    }

    fn run(&self, settings: &RansacSettings) -> sim3align::error::Result<Consensus> {
        ransac(&self.source, &self.target, &self.matches, settings)
    }
}

fn one_to_one(n: usize) -> Vec<Match> {
    (0..n as u32).map(|i| Match { source: i, target: i }).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn seven_outliers_in_ten_are_no_obstacle() {
    for seed in 0..10 {
        let mut draw = Draw::new(seed);
        let truth = draw.similarity([0.6, 1.4], 0.3);
        let scene = Scene::new(&mut draw, truth, 60, 140, 0.002);
        let found = scene.run(&settings(seed)).unwrap();
        let error = pose_error(&found.target_from_source, &scene.truth);
        assert!(error < 0.005, "seed {seed}: {error}");
        assert!(rotation_defect(found.target_from_source.rotation.matrix()) < 1e-13, "seed {seed}");
        // All true matches, and of the others only what fell there by chance.
        assert!((0..60).all(|i| found.inliers.contains(&i)), "seed {seed}: {:?}", found.inliers);
        assert!(found.inliers.len() < 65 && found.inliers.is_sorted(), "seed {seed}: {:?}", found.inliers);
        assert!(!found.clamped && found.counts.clamped == 0, "seed {seed}");
        for &i in &found.inliers {
            let residual = (found.target_from_source.apply(vector3(scene.source[i])) - vector3(scene.target[i])).norm();
            assert!(residual <= 0.02, "seed {seed}: {residual}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_same_seed_gives_the_same_bits() {
    let mut draw = Draw::new(20);
    let truth = draw.similarity([0.6, 1.4], 0.3);
    let scene = Scene::new(&mut draw, truth, 30, 60, 0.01);
    let runs: Vec<Consensus> = (0..6).map(|i| scene.run(&settings(i / 2)).unwrap()).collect();
    for pair in runs.chunks_exact(2) {
        assert_eq!(pair[0], pair[1]);
    }
    assert!(runs[0].counts != runs[2].counts || runs[0].counts != runs[4].counts, "seeds do nothing");
}

/// 40 matches of the truth, of scale 1, and 60 that all agree on shrinking the source to a fifth of it.
fn collapse(seed: u64) -> Scene {
    let mut draw = Draw::new(seed);
    let truth = Similarity { scale: 1.0, ..draw.similarity([1.0, 1.0], 0.2) };
    let shrunk = draw.similarity([0.2, 0.2], 0.3);
    let mut scene = Scene::new(&mut draw, truth, 40, 60, 0.002);
    for i in 40..100 {
        scene.target[i] = vec3(&shrunk.apply(vector3(scene.source[i])));
    }
    scene
}

#[wasm_bindgen_test(unsupported = test)]
fn the_guard_keeps_the_scale_from_collapsing() {
    for seed in 0..5 {
        let scene = collapse(seed);
        let free = scene.run(&RansacSettings { guard: None, ..settings(seed) }).unwrap();
        assert!((free.target_from_source.scale - 0.2).abs() < 1e-3, "seed {seed}: {free:?}");
        assert_eq!((free.counts.rejected, free.counts.clamped), (0, 0), "seed {seed}");

        let guarded = scene.run(&settings(seed)).unwrap();
        assert!(pose_error(&guarded.target_from_source, &scene.truth) < 0.005, "seed {seed}: {guarded:?}");
        assert!(guarded.counts.rejected > 0 && guarded.counts.clamped == 0, "seed {seed}: {:?}", guarded.counts);
        assert!(guarded.inliers.iter().filter(|&&i| i < 40).count() == 40, "seed {seed}");

        let clamp = Some(Guard { min: 0.5, max: 1.5, mode: GuardMode::Clamp });
        let clamped = scene.run(&RansacSettings { guard: clamp, ..settings(seed) }).unwrap();
        assert!(pose_error(&clamped.target_from_source, &scene.truth) < 0.005, "seed {seed}: {clamped:?}");
        assert!(clamped.counts.clamped > 0 && clamped.counts.rejected == 0, "seed {seed}: {:?}", clamped.counts);
        assert!(!clamped.clamped, "seed {seed}: the truth needs no clamping");
        for counts in [guarded.counts, clamped.counts] {
            let accounted = counts.inconsistent + counts.rejected + counts.clamped;
            assert!(accounted < counts.iterations && counts.iterations <= 20_000, "seed {seed}: {counts:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_scale_outside_the_guard_is_rejected_or_projected() {
    for (scale, bound) in [(0.4, 0.5), (1.7, 1.5)] {
        let mut draw = Draw::new(5);
        let truth = Similarity { scale, ..draw.similarity([1.0, 1.0], 0.2) };
        let scene = Scene::new(&mut draw, truth, 50, 0, 0.0);
        let wide = RansacSettings { inlier_distance: 0.3, max_iterations: 500, ..settings(0) };
        let error = scene.run(&wide).unwrap_err();
        assert_eq!(error.code, ErrorCode::NoConsensus);
        assert!(error.found.contains("50 matches") && error.found.contains("500 minimal sets"), "{error}");
        assert!(error.found.contains("500 a scale out of bounds"), "{error}");

        let guard = Some(Guard { min: 0.5, max: 1.5, mode: GuardMode::Clamp });
        let found = scene.run(&RansacSettings { guard, ..wide }).unwrap();
        assert_eq!(found.target_from_source.scale, bound);
        assert!(found.clamped && found.counts.clamped > 0 && found.counts.rejected == 0, "{:?}", found.counts);
        // Rotation and centre are the data's; the closed form moved with the scale.
        assert!(found.target_from_source.rotation_angle_to(&truth) < 0.05);
        assert!((found.target_from_source.translation - truth.translation).norm() < 0.05);
        assert_eq!(found.inliers.len(), 50);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn bounds_in_the_wrong_order_leave_no_scale() {
    let mut draw = Draw::new(6);
    let truth = draw.similarity([0.9, 1.1], 0.2);
    let scene = Scene::new(&mut draw, truth, 20, 0, 0.0);
    for mode in [GuardMode::Reject, GuardMode::Clamp] {
        let run = |min, max| {
            let guard = Some(Guard { min, max, mode });
            scene.run(&RansacSettings { guard, max_iterations: 20, ..settings(0) })
        };
        assert_eq!(run(2.0, 0.5).unwrap_err().code, ErrorCode::NoConsensus, "{mode:?}: no scale is between them");
        // Options refuse what is no number; here it holds nothing.
        for (min, max) in [(f64::NAN, 1.5), (f64::NAN, f64::NAN)] {
            let found = run(min, max).unwrap().target_from_source;
            assert!((found.scale / truth.scale - 1.0).abs() < 1e-5, "{mode:?}, {min}, {max}: {found:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_known_scale_is_kept() {
    let mut draw = Draw::new(7);
    let truth = Similarity { scale: 1.25, ..draw.similarity([1.0, 1.0], 0.2) };
    let scene = Scene::new(&mut draw, truth, 40, 40, 0.002);
    let fixed = RansacSettings { scale_mode: ScaleMode::Fixed(1.25), guard: None, ..settings(1) };
    let found = scene.run(&fixed).unwrap();
    assert_eq!(found.target_from_source.scale, 1.25);
    assert!(pose_error(&found.target_from_source, &scene.truth) < 0.005);
}

#[wasm_bindgen_test(unsupported = test)]
fn fewer_than_three_matches_are_no_consensus() {
    let points = Draw::new(8).points(10, 0.5);
    for n in 0..3 {
        let error = ransac(&points, &points, &one_to_one(n), &settings(0)).unwrap_err();
        assert_eq!(error.code, ErrorCode::NoConsensus);
        assert!(error.found.contains(&format!("{n} matches")), "{error}");
        assert!(error.found.contains("of 0 minimal sets"), "{error}");
    }
    // Matches of points that do not exist are none.
    let nowhere: Vec<Match> = (8..20).map(|i| Match { source: i, target: 0 }).collect();
    assert!(ransac(&points, &points, &nowhere, &settings(0)).unwrap_err().found.contains("2 matches"));
    assert_eq!(ransac(&[], &[], &one_to_one(9), &settings(0)).unwrap_err().code, ErrorCode::NoConsensus);
}

#[wasm_bindgen_test(unsupported = test)]
fn inliers_are_numbers_of_matches() {
    let mut draw = Draw::new(9);
    let truth = draw.similarity([0.9, 1.1], 0.2);
    let mut scene = Scene::new(&mut draw, truth, 20, 0, 0.0);
    // The first two name points that do not exist.
    scene.matches.insert(0, Match { source: 999, target: 0 });
    scene.matches.insert(1, Match { source: 0, target: 999 });
    assert!(scene.run(&settings(0)).unwrap().inliers.into_iter().eq(2..22));
}

#[wasm_bindgen_test(unsupported = test)]
fn minimal_sets_are_three_different_matches_and_all_alike() {
    // Three matches leave one set: with a match drawn twice the points would be on a line.
    let mut draw = Draw::new(10);
    let truth = draw.similarity([0.9, 1.1], 0.2);
    let once = |seed| RansacSettings {
        max_iterations: 1,
        edge_similarity: 0.0,
        guard: None,
        inlier_distance: 1e-4,
        ..settings(seed)
    };
    let three = Scene::new(&mut draw, truth, 3, 0, 0.0);
    for seed in 0..300 {
        assert_eq!(three.run(&once(seed)).unwrap().inliers, [0, 1, 2], "seed {seed}");
    }
    // Of five matches, of which two are wrong, one set of ten is right: a tenth of the seeds finds it.
    for wrong in [[0, 1], [1, 3], [3, 4]] {
        let mut scene = Scene::new(&mut draw, truth, 5, 0, 0.0);
        wrong.into_iter().for_each(|i| scene.target[i] = vec3(&draw.cube(5.0)));
        let hits = (0..1000)
            .filter(|&seed| scene.run(&once(seed)).is_ok_and(|c| c.inliers.iter().all(|i| !wrong.contains(i))));
        // Four standard deviations of a binomial count are 38.
        let hits = hits.count();
        assert!((62..=138).contains(&hits), "{wrong:?}: {hits}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn points_that_coincide_are_inconsistent() {
    // Two matches of the same two points, and three of one: no edge between them has a length.
    let points = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let twice = [0, 0, 1].map(|i| Match { source: i, target: i });
    let error = ransac(&points, &points, &twice, &RansacSettings { max_iterations: 50, ..settings(0) }).unwrap_err();
    assert!(error.found.contains("50 had inconsistent edges"), "{error}");
    let to_one = [0, 1, 2].map(|i| Match { source: i, target: 0 });
    let error = ransac(&points, &points, &to_one, &RansacSettings { max_iterations: 50, ..settings(0) }).unwrap_err();
    assert!(error.found.contains("50 had inconsistent edges"), "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_edge_check_asks_for_one_stretch() {
    // A triangle with one edge stretched by 0.8.
    let source = vec![Vec3::ZERO, Vec3::X, Vec3::Y * 2.0];
    let target = vec![Vec3::ZERO, Vec3::X * 0.8, Vec3::Y * 2.0];
    let run = |edge_similarity| {
        let settings = RansacSettings { edge_similarity, inlier_distance: 0.5, max_iterations: 10, ..settings(0) };
        ransac(&source, &target, &one_to_one(3), &settings)
    };
    assert!(run(0.79).is_ok());
    assert!(run(0.81).unwrap_err().found.contains("10 had inconsistent edges"));
}

#[wasm_bindgen_test(unsupported = test)]
fn draws_stop_when_enough_and_at_the_limit() {
    let mut draw = Draw::new(11);
    let truth = draw.similarity([0.9, 1.1], 0.2);
    // All agree: the first draw is enough.
    assert_eq!(Scene::new(&mut draw, truth, 50, 0, 0.0).run(&settings(0)).unwrap().counts.iterations, 1);
    // Half agree: ln(1 − 0.999) / ln(1 − 0.5³) = 51.7 draws.
    let mut scene = Scene::new(&mut draw, truth, 50, 50, 0.0);
    scene.target[50..].iter_mut().for_each(|p| *p += Vec3::splat(10.0));
    for seed in 0..20 {
        let strict = RansacSettings { edge_similarity: 0.999, ..settings(seed) };
        let draws = scene.run(&strict).unwrap().counts.iterations;
        assert_eq!(draws, 52, "seed {seed}");
        let sure = scene.run(&RansacSettings { confidence: 0.999_999, ..strict }).unwrap().counts.iterations;
        assert_eq!(sure, 104, "seed {seed}");
        let content = scene.run(&RansacSettings { confidence: 0.0, ..strict }).unwrap().counts.iterations;
        assert!(content <= 52, "seed {seed}: {content}");
    }
    // None agree: the limit.
    let hopeless = Scene::new(&mut draw, truth, 0, 60, 0.0);
    let strict = RansacSettings { inlier_distance: 1e-6, max_iterations: 777, edge_similarity: 0.99, ..settings(0) };
    let error =
        hopeless.run(&RansacSettings { guard: Some(Guard { min: 5.0, max: 6.0, mode: GuardMode::Reject }), ..strict });
    assert!(error.unwrap_err().found.contains("of 777 minimal sets"));
    assert_eq!(
        scene.run(&RansacSettings { max_iterations: 0, ..settings(0) }).unwrap_err().code,
        ErrorCode::NoConsensus
    );
}
