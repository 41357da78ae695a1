//! The closed form against Horn's quaternions; reflections, weights, degenerate sets.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion};

use crate::prelude::*;

fn pairs(source: &[Vector3<f64>], target: &[Vector3<f64>]) -> Vec<Pair> {
    source.iter().zip(target).map(|(&source, &target)| Pair { source, target, weight: 1.0 }).collect()
}

fn solve(pairs: &[Pair], scale_mode: ScaleMode) -> Similarity {
    umeyama(pairs.iter().copied(), scale_mode).unwrap()
}

/// Σ w ‖q − (s R p + t)‖².
fn cost(pairs: &[Pair], s: &Similarity) -> f64 {
    pairs.iter().map(|pair| pair.weight * (pair.target - s.apply(pair.source)).norm_squared()).sum()
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
    let q = largest_eigenvector(n);
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix();
    let scale = (rotation.matrix().transpose() * sigma).trace() / spread;
    Similarity { scale, rotation, translation: q_mean - rotation * p_mean * scale }
}

/// By Jacobi rotations.
fn largest_eigenvector(mut n: Matrix4<f64>) -> [f64; 4] {
    let mut v = Matrix4::identity();
    for _ in 0..60 {
        for p in 0..4 {
            for q in p + 1..4 {
                if n[(p, q)] == 0.0 {
                    continue;
                }
                let angle = 0.5 * libm::atan2(2.0 * n[(p, q)], n[(p, p)] - n[(q, q)]);
                let (s, c) = (libm::sin(angle), libm::cos(angle));
                let mut g = Matrix4::identity();
                (g[(p, p)], g[(q, q)], g[(p, q)], g[(q, p)]) = (c, c, -s, s);
                n = g.transpose() * n * g;
                v *= g;
            }
        }
    }
    let best = (0..4).max_by(|&a, &b| n[(a, a)].total_cmp(&n[(b, b)])).unwrap();
    [0, 1, 2, 3].map(|i| v[(i, best)])
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

#[wasm_bindgen_test(unsupported = test)]
fn exact_pairs_give_the_transform_back() {
    for seed in 0..300 {
        let mut draw = Draw::new(seed);
        let truth = draw.similarity([0.01, 100.0], 1e4);
        let offset = draw.cube([0.0, 1e4][seed as usize % 2]);
        let n = 3 + draw.below(20);
        let source: Vec<Vector3<f64>> = (0..n).map(|_| draw.cube(1.0) + offset).collect();
        let target: Vec<Vector3<f64>> = source.iter().map(|&p| truth.apply(p)).collect();
        let found = solve(&pairs(&source, &target), ScaleMode::Free);
        let size = target.iter().map(|q| q.norm()).fold(1.0, f64::max);
        for (p, q) in source.iter().zip(&target) {
            assert!((found.apply(*p) - q).norm() < 1e-11 * size, "seed {seed}: {found:?} for {truth:?}");
        }
        // Coordinates of 1e4 leave 12 digits for a cloud of size 1, divided by how thin three points may be.
        assert!((found.scale / truth.scale - 1.0).abs() < 1e-8, "seed {seed}");
        assert!(found.rotation_angle_to(&truth) < 1e-8, "seed {seed}");
        assert!(rotation_defect(found.rotation.matrix()) < 1e-13, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_answer_is_horns_and_the_scale_is_the_trace() {
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        let n = 3 + draw.below(30);
        let noise = draw.between(0.0, 1.0);
        let pairs = noisy(&mut draw, n, noise);
        let (found, expected) = (solve(&pairs, ScaleMode::Free), horn(&pairs));
        assert!(found.rotation_angle_to(&expected) < 1e-7, "seed {seed}: {found:?} {expected:?}");
        assert!((found.scale / expected.scale - 1.0).abs() < 1e-12, "seed {seed}");
        assert!((cost(&pairs, &found) / cost(&pairs, &expected).max(1e-20) - 1.0).abs() < 1e-9, "seed {seed}");
        let (p_mean, q_mean, sigma, spread) = moments(&pairs);
        let trace = (found.rotation.matrix().transpose() * sigma).trace() / spread;
        assert!((found.scale / trace - 1.0).abs() < 1e-13, "seed {seed}: {} {trace}", found.scale);
        let t = q_mean - found.rotation * p_mean * found.scale;
        assert!((found.translation - t).norm() < 1e-12 * (1.0 + t.norm()), "seed {seed}");
        // The rotation is the best at every scale.
        let fixed = solve(&pairs, ScaleMode::Fixed(0.7));
        let t = q_mean - found.rotation * p_mean * 0.7;
        assert_eq!((fixed.scale, fixed.rotation), (0.7, found.rotation), "seed {seed}");
        assert!((fixed.translation - t).norm() < 1e-12 * (1.0 + t.norm()), "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_mirror_image_gets_the_best_rotation() {
    for seed in 0..30 {
        let mut draw = Draw::new(seed);
        // Uneven spread: which axis it costs least to give up is no tie.
        let source: Vec<Vector3<f64>> =
            (0..20).map(|_| draw.cube(1.0).component_mul(&Vector3::new(1.0, 0.6, 0.3))).collect();
        let truth = draw.similarity([0.1, 10.0], 3.0);
        let mirrored = |p: &Vector3<f64>| truth.apply(Vector3::new(-p.x, p.y, p.z));
        let pairs = pairs(&source, &source.iter().map(mirrored).collect::<Vec<_>>());
        let found = solve(&pairs, ScaleMode::Free);
        assert!(rotation_defect(found.rotation.matrix()) < 1e-13, "seed {seed}: {:?}", found.rotation);
        assert!(found.rotation_angle_to(&horn(&pairs)) < 1e-7, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn weights_are_repetitions() {
    for seed in 0..20 {
        let mut draw = Draw::new(seed);
        let mut weighted = noisy(&mut draw, 10, 0.5);
        weighted.iter_mut().for_each(|pair| pair.weight = draw.below(4) as f64);
        let repeated: Vec<Pair> = (weighted.iter())
            .flat_map(|pair| core::iter::repeat_n(Pair { weight: 1.0, ..*pair }, pair.weight as usize))
            .collect();
        let (a, b) = (solve(&weighted, ScaleMode::Free), solve(&repeated, ScaleMode::Free));
        assert!((a.scale - b.scale).abs() < 1e-12 && a.rotation_angle_to(&b) < 1e-12, "seed {seed}");
        // Pairs of no weight, of any coordinates, are no pairs.
        for weight in [0.0, -1.0, f64::NAN] {
            let nowhere = Vector3::repeat(f64::NAN);
            let more: Vec<Pair> =
                weighted.iter().copied().chain([Pair { source: nowhere, target: nowhere, weight }]).collect();
            assert_eq!(solve(&more, ScaleMode::Free), a, "seed {seed}, weight {weight}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn planes_and_thin_sets_are_enough() {
    for seed in 0..100 {
        let mut draw = Draw::new(seed);
        let truth = draw.similarity([0.01, 100.0], 10.0);
        let turn = draw.rotation();
        for thin in [1.0, 0.1, 0.01] {
            let source: Vec<Vector3<f64>> =
                (0..8).map(|_| turn * draw.cube(1.0).component_mul(&Vector3::new(1.0, thin, 0.0))).collect();
            let target: Vec<Vector3<f64>> = source.iter().map(|&p| truth.apply(p)).collect();
            let found = solve(&pairs(&source, &target), ScaleMode::Free);
            assert!(rotation_defect(found.rotation.matrix()) < 1e-13, "seed {seed}, {thin}");
            let angle = found.rotation_angle_to(&truth);
            // The solver squares Σ, whose singular values are as 1 to thin².
            assert!(angle < 1e-13 / (thin * thin * thin * thin), "seed {seed}, thin {thin}: {angle:e}");
            assert!((found.scale / truth.scale - 1.0).abs() < 1e-12, "seed {seed}, {thin}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn half_turns_and_equal_spreads_are_no_special_case() {
    // The corners of a cube and of a regular tetrahedron: all singular values equal.
    let cube: Vec<Vector3<f64>> = (0..8).map(|i| Vector3::from_fn(|a, _| f64::from(i >> a & 1))).collect();
    let tetrahedron = vec![cube[0], cube[3], cube[5], cube[6]];
    let axes = [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(1.0, 1.0, 0.0), Vector3::new(1.0, -2.0, 3.0)];
    for source in [cube, tetrahedron] {
        for axis in axes {
            for angle in [0.0, 1e-9, 0.5, 1.0, 2.0].map(|x| x * core::f64::consts::FRAC_PI_2) {
                let rotation = Rotation3::new(axis.normalize() * angle);
                let truth = Similarity { scale: 2.0, rotation, translation: Vector3::new(1.0, 2.0, 3.0) };
                let target: Vec<Vector3<f64>> = source.iter().map(|&p| truth.apply(p)).collect();
                let found = solve(&pairs(&source, &target), ScaleMode::Free);
                assert!(found.rotation_angle_to(&truth) < 1e-13, "{axis}, {angle}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn sets_that_leave_the_turn_free_are_refused() {
    let refused = |what: &str, source: &[Vector3<f64>], target: &[Vector3<f64>], code: ErrorCode| {
        for mode in [ScaleMode::Free, ScaleMode::Fixed(1.0)] {
            let error = umeyama(pairs(source, target).into_iter(), mode).expect_err(what);
            assert_eq!(error.code, code, "{what}");
        }
    };
    for seed in 0..30 {
        let mut draw = Draw::new(seed);
        let truth = draw.similarity([0.01, 100.0], 1e4);
        let mapped = |points: &[Vector3<f64>]| points.iter().map(|&p| truth.apply(p)).collect::<Vec<_>>();
        let cloud: Vec<Vector3<f64>> = (0..6).map(|_| draw.cube(1.0)).collect();
        let (from, along) = (draw.cube(100.0), draw.direction());
        let line: Vec<Vector3<f64>> = (0..6).map(|_| from + along * draw.between(-1.0, 1.0)).collect();
        let point = vec![draw.cube(1.0); 6];
        refused("line", &line, &mapped(&line), ErrorCode::DegeneratePoints);
        refused("line to cloud", &line, &cloud, ErrorCode::DegeneratePoints);
        refused("cloud to line", &cloud, &line, ErrorCode::DegeneratePoints);
        refused("point", &point, &mapped(&point), ErrorCode::DegeneratePoints);
        refused("point to cloud", &point, &cloud, ErrorCode::DegeneratePoints);
        refused("cloud to point", &cloud, &point, ErrorCode::DegeneratePoints);
        refused("two", &cloud[..2], &cloud[..2], ErrorCode::TooFewPoints);
        refused("none", &[], &[], ErrorCode::TooFewPoints);
        for x in [f64::NAN, f64::INFINITY, 1e200] {
            let mut bad = cloud.clone();
            bad[draw.below(6)][draw.below(3)] = x;
            refused("not finite", &bad, &cloud, ErrorCode::DegeneratePoints);
            refused("not finite", &cloud, &bad, ErrorCode::DegeneratePoints);
        }
    }
    let cloud: Vec<Vector3<f64>> = (0..6).map(|i| Vector3::ith(i % 3, f64::from(i as u32 + 1))).collect();
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = umeyama(pairs(&cloud, &cloud).into_iter(), ScaleMode::Fixed(scale)).unwrap_err();
        assert_eq!(error.code, ErrorCode::DegeneratePoints, "{scale}");
    }
}
