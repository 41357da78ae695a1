//! Registration recovers known transforms; the closed form against Horn's quaternions.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion};
use sim3align::register::options::{EstimateSim3Options, RegisterOptions};
use sim3align::register::umeyama::{Pair, ScaleMode, umeyama};
use sim3align::register::{estimate_sim3, register, register_task};

use crate::prelude::*;

/// Points of a cloud: as few as show a surface.
const POINTS: usize = 1000;

fn solve(pairs: &[Pair], scale_mode: ScaleMode) -> Similarity {
    umeyama(pairs.iter().copied(), scale_mode).unwrap()
}

/// Centroids, Σ w (q − q̄)(p − p̄)ᵀ and Σ w ‖p − p̄‖².
fn moments(pairs: &[Pair]) -> (Vector3<f64>, Vector3<f64>, Matrix3<f64>, f64) {
    let total: f64 = pairs.iter().map(|pair| pair.weight).sum();
    let p_mean = pairs.iter().map(|pair| pair.source * pair.weight).sum::<Vector3<f64>>() / total;
    let q_mean = pairs.iter().map(|pair| pair.target * pair.weight).sum::<Vector3<f64>>() / total;
    let sigma = pairs.iter().map(|c| (c.target - q_mean) * (c.source - p_mean).transpose() * c.weight).sum();
    let spread = pairs.iter().map(|pair| pair.weight * (pair.source - p_mean).norm_squared()).sum();
    (p_mean, q_mean, sigma, spread)
}

/// Horn 1987: the rotation is the eigenvector of the largest eigenvalue of a 4×4 matrix made of the moments.
fn horn(pairs: &[Pair]) -> Similarity {
    let (p_mean, q_mean, sigma, spread) = moments(pairs);
    let m = sigma.transpose(); // Horn's S_xy = Σ x_left y_right.
    let [xx, xy, xz] = [m[(0, 0)], m[(0, 1)], m[(0, 2)]];
    let [yx, yy, yz] = [m[(1, 0)], m[(1, 1)], m[(1, 2)]];
    let [zx, zy, zz] = [m[(2, 0)], m[(2, 1)], m[(2, 2)]];
    #[rustfmt::skip]
    let n = Matrix4::new(
        xx + yy + zz, yz - zy,       zx - xz,       xy - yx,
        yz - zy,      xx - yy - zz,  xy + yx,       zx + xz,
        zx - xz,      xy + yx,      -xx + yy - zz,  yz + zy,
        xy - yx,      zx + xz,       yz + zy,      -xx - yy + zz,
    );
    let eigen = n.symmetric_eigen();
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix();
    let scale = (rotation.matrix().transpose() * sigma).trace() / spread;
    Similarity { scale, rotation, translation: q_mean - rotation * p_mean * scale }
}

/// Noisy counterparts with weights.
fn noisy(draw: &mut Draw, n: usize, noise: f64) -> Vec<Pair> {
    let truth = draw.similarity([0.1, 10.0], 5.0);
    let pair = |_| {
        let source = draw.cube(1.0);
        let target = truth.apply(source + draw.cube(noise));
        Pair { source, target, weight: draw.between(0.1, 3.0) }
    };
    (0..n).map(pair).collect()
}

#[wasm_bindgen_test]
fn the_answer_is_that_of_horn() {
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        let n = 3 + draw.below(30);
        let noise = draw.between(0.0, 1.0);
        let pairs = noisy(&mut draw, n, noise);
        let (found, expected) = (solve(&pairs, ScaleMode::Free), horn(&pairs));
        assert!(found.rotation_angle_to(&expected) < 1e-7, "seed {seed}: {found:?} {expected:?}");
        assert!((found.scale / expected.scale - 1.0).abs() < 1e-12, "seed {seed}");
        let (p_mean, q_mean, ..) = moments(&pairs);
        // The rotation is the best at every scale.
        for (found, scale) in [(found, found.scale), (solve(&pairs, ScaleMode::Fixed(0.7)), 0.7)] {
            let t = q_mean - found.rotation * p_mean * scale;
            assert_eq!((found.scale, found.rotation), (scale, solve(&pairs, ScaleMode::Free).rotation), "seed {seed}");
            assert!((found.translation - t).norm() < 1e-12 * (1.0 + t.norm()), "seed {seed}");
        }
    }
}

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

#[wasm_bindgen_test]
fn recovers_any_similarity_of_a_full_surface_exactly() {
    let cases =
        [(blob as fn(&mut Draw, usize) -> Cloud, 0.01, 0.0, false), (mug, 100.0, 0.5, false), (blob, 0.01, 0.5, true)];
    for (seed, (surface, scale, clutter, is_known)) in (100..).zip(cases) {
        let draw = &mut Draw::new(seed);
        let source: Vec<_> = surface(draw, POINTS).points.into_iter().map(vector3).collect();
        let truth = draw.similarity([scale, scale], 1e4);
        let moved: Vec<_> = source.iter().map(|&p| truth.apply(p)).collect();
        let target = cluttered(draw, &moved, clutter);
        // Back as well, where the clutter is in the source.
        for (source, target, truth, surface, clutter) in
            [(&source, &target, truth, &source, 0.0), (&target, &source, truth.inverse(), &moved, clutter)]
        {
            let what = format!("seed {seed}, scale {}, known {is_known}, clutter {clutter}", truth.scale);
            let scale = if is_known { ScaleOption::Fixed(truth.scale) } else { ScaleOption::Free };
            let options = RegisterOptions { scale, ..RegisterOptions::default() };
            let result = register(&flat(source), &flat(target), &options, &mut Silent);
            let result = result.unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_recovers(&result.target_from_source.matrix, &truth, surface, 1e-4, &what);
            let converged = result.diagnostics.converged && result.fitness > 0.99 * (1.0 - clutter);
            assert!(converged, "{what}: fitness {}", result.fitness);
        }
    }
}

#[wasm_bindgen_test]
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
}

#[wasm_bindgen_test]
fn points_without_a_reading_are_skipped_and_counted() {
    let draw = &mut Draw::new(9);
    let source: Vec<_> = mug(draw, 900).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([2.0, 3.0], 5.0);
    let target = flat(&source.iter().map(|&p| truth.apply(p)).collect::<Vec<_>>());
    let source = flat(&source);
    // Every third point of an organised cloud has none, be it all three coordinates or one.
    let organised =
        |xyz: &[f64], empty: [f64; 3]| xyz.chunks(6).flat_map(|two| [two, &empty].concat()).collect::<Vec<_>>();
    let found = |source: &[f64], target: &[f64]| {
        let found = register(source, target, &RegisterOptions::default(), &mut Silent).unwrap();
        let diagnostics = found.diagnostics;
        (found.target_from_source, [diagnostics.skipped_source_points, diagnostics.skipped_target_points])
    };
    let (plain, none) = found(&source, &target);
    let with_gaps = [organised(&source, [f64::NAN; 3]), organised(&target, [0.0, f64::INFINITY, 0.0])];
    assert_eq!((found(&with_gaps[0], &with_gaps[1]), none), ((plain, [450; 2]), [0; 2]));
}

/// The part of a cloud on one side of a plane through its middle, by share.
fn part(points: &[Vector3<f64>], direction: Vector3<f64>, share: f64) -> Vec<Vector3<f64>> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].dot(&direction).total_cmp(&points[b].dot(&direction)));
    order[..(share * points.len() as f64) as usize].iter().map(|&i| points[i]).collect()
}

#[wasm_bindgen_test]
fn a_free_scale_of_partial_clouds_does_not_collapse() {
    let shapes = [("blob", blob as fn(&mut Draw, usize) -> Cloud, 0.65), ("mug", mug, 0.75)];
    for (seed, (shape, surface, share)) in (400..).zip(shapes) {
        let draw = &mut Draw::new(seed);
        let whole = surface(draw, 3 * POINTS).points;
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

#[wasm_bindgen_test]
fn a_registration_in_parts_is_the_whole_one() {
    let draw = &mut Draw::new(11);
    let points: Vec<_> = mug(draw, POINTS).points.into_iter().map(vector3).collect();
    let truth = draw.similarity([2.0, 2.0], 1.0);
    let direction = draw.direction();
    let moved: Vec<_> = part(&points, direction, 0.8).iter().map(|&p| truth.apply(p)).collect();
    let (source, target) = (flat(&points), flat(&moved));
    for scale in [ScaleOption::Free, ScaleOption::Fixed(truth.scale)] {
        let options = RegisterOptions { scale, ..RegisterOptions::default() };
        let whole = register(&source, &target, &options, &mut Silent).unwrap();
        let mut task = register_task(source.clone(), target.clone(), options, Silent, pausing(0, 1)).unwrap();
        let (found, steps) = stepped(&mut task, 0.0);
        assert_eq!(found, whole, "{scale:?}");
        // What is done for a voxel or a match at once, and one pass over all points.
        let (longest, most) = (task.longest_block(), 12.0 + 6e-5 * points.len() as f64);
        assert!(steps > 50 && longest <= most, "{scale:?}: {steps} steps, {longest} units, at most {most}");
        assert_eq!(task.step(0.0).unwrap_err().code, ErrorCode::Internal, "the task is over");
    }
}
