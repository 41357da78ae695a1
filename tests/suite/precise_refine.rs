//! The refinement of `precise`: its quadratic against finite differences, its climb, and what the quadratic says of the
//! uncertainty.

use nalgebra::{SMatrix, SVector};
use sim3align::precise::scored::conditioning::{Conditioning, covariance, fix_roll};
use sim3align::precise::searched::recipe::FINE;

use crate::precise::{body, observe, truth};
use crate::precise_scene::{HEIGHT, WIDTH, facing, model, noisy_grid, pose, scoring};
use crate::prelude::*;

pub type Matrix = SMatrix<f64, 7, 7>;
pub type Vector = SVector<f64, 7>;

/// JᵀWJ and JᵀWr, which equations tell by their damped steps alone.
pub fn unpacked(equations: &NormalEquations) -> (Matrix, Vector) {
    const DAMPING: f64 = 1e-2;
    let inverse = equations.inverse(DAMPING).unwrap();
    let damped = Matrix::from_fn(|i, j| inverse[j][i]).try_inverse().unwrap();
    let gradient = -(damped * Vector::from(equations.solve(DAMPING).unwrap()));
    let trace = damped.trace() / (1.0 + 7.0 * DAMPING);
    (damped - Matrix::identity() * (DAMPING * trace), gradient)
}

/// The pose moved by `x` along the `k`-th parameter; with `lock_scale`, distance follows size, and is no parameter.
fn moved(pose: &CropPose, k: usize, x: f64, lock_scale: bool) -> CropPose {
    let mut step: Step = [0.0; 7];
    step[k] = x;
    if lock_scale {
        step[6] = if k == 3 { -x / libm::exp(pose.size) } else { 0.0 };
    }
    pose.moved(&step)
}

/// A residual as a function of the pose, at the pose and by central differences.
fn differences(pose: &CropPose, lock_scale: bool, residual: impl Fn(&CropPose) -> f64) -> (Vector, f64) {
    const H: f64 = 1e-6;
    let slope =
        |k: usize| (residual(&moved(pose, k, H, lock_scale)) - residual(&moved(pose, k, -H, lock_scale))) / (2.0 * H);
    (Vector::from_fn(|k, _| slope(k)), residual(pose))
}

/// ρ′(e), of a loss that is smooth where e > 0.
fn slope_of(loss: impl Fn(f64) -> f64, e: f64) -> f64 {
    let h = 1e-6 * e.max(1e-3);
    (loss(e + h) - loss(e - h)) / (2.0 * h)
}

struct Scene {
    model: Model,
    grid: CropGrid,
    pose: CropPose,
    canvas: Canvas,
}

impl Scene {
    fn new(seed: u64) -> Self {
        let draw = &mut Draw::new(seed);
        let model = model();
        let observed = pose(draw, 2.0);
        let grid = noisy_grid(draw, &model, &observed, &scoring());
        let step: Step = core::array::from_fn(|_| draw.between(-0.03, 0.03));
        let pose = observed.moved(&step);
        let mut canvas = Canvas::default();
        canvas.draw(&model, &pose, &grid);
        Self { model, grid, pose, canvas }
    }

    fn score(&self, scoring: &Scoring) -> Score {
        scoring.score(&self.canvas, &self.model, &self.grid, 1.0)
    }

    fn equations(&self, scoring: Scoring, score: &Score, lock_scale: bool) -> NormalEquations {
        let objective = objective(&self.model, &self.grid, scoring, Prior::default());
        Refiner { objective, lock_scale }.equations(&self.canvas, score, &self.pose)
    }

    /// The same by its definition: every residual is a function of the pose, its derivatives are differences.
    fn by_differences(&self, scoring: &Scoring, score: &Score, lock_scale: bool) -> (Matrix, Vector) {
        let Self { model, grid, pose, canvas } = self;
        let (weights, share) =
            (&scoring.weights, |k: usize| f64::from(score.overlap) / f64::from(score.counts[k].max(1.0)));
        let (mut matrix, mut gradient) = (Matrix::zeros(), Vector::zeros());
        let mut add = |(jacobian, residual): (Vector, f64), weight: f64| {
            matrix += jacobian * jacobian.transpose() * weight;
            gradient += jacobian * (weight * residual);
        };
        let (scale, translation) = pose.scale_translation();
        let cells = (0..HEIGHT).flat_map(|v| (0..WIDTH).map(move |u| (u, v)));
        for (u, v) in cells.filter(|&(u, v)| canvas.inverse_depth[v * WIDTH + u] > 0.0) {
            let i = v * WIDTH + u;
            let z = 1.0 / f64::from(canvas.inverse_depth[i]);
            let ray = grid.ray(u as f32, v as f32).as_dvec3();
            // The point and the normal of the mesh that are drawn here.
            let point = pose.rotation.conjugate() * (ray * z - translation) / scale;
            let facing = facing(canvas, model, grid, u, v).as_dvec3();
            let normal = pose.rotation.conjugate() * facing;
            let place = |q: &CropPose| {
                let (scale, translation) = q.scale_translation();
                q.rotation * point * scale + translation
            };
            if grid.depth[i] > 0.0 {
                // Where the ray meets the plane of the triangle; its error counts along the normal.
                let error = |q: &CropPose| {
                    let normal = q.rotation * normal;
                    (normal.dot(place(q)) / normal.dot(ray) - f64::from(grid.depth[i])) / f64::from(scoring.depth_m)
                };
                let size = error(pose).abs();
                let curvature = slope_of(|e| e / (1.0 + e), size) / size.max(0.1);
                let along = facing.dot(ray);
                let weight = f64::from(weights.depth) * share(0) * curvature;
                add(differences(pose, lock_scale, |q| along * error(q)), weight);
                let seen = grid.normals[i].as_dvec3();
                if seen != DVec3::ZERO {
                    let weight = f64::from(weights.normals) * share(1);
                    for axis in 0..3 {
                        add(differences(pose, lock_scale, |q| (q.rotation * normal - seen)[axis]), weight);
                    }
                }
            }
            let is_edge = u > 0
                && v > 0
                && u + 1 < WIDTH
                && v + 1 < HEIGHT
                && [i - 1, i + 1, i - WIDTH, i + WIDTH].iter().any(|&j| canvas.inverse_depth[j] == 0.0);
            let scene = f64::from(grid.scene[i]);
            let is_hidden = !grid.mask[i] && scene > 0.0 && scene < z - f64::from(scoring.occluder_m);
            // Without a reading, little is known.
            let seen = if !grid.mask[i] && scene == 0.0 { grid.unknown_weight(weights.unknown).into() } else { 1.0 };
            if is_edge && !is_hidden {
                // The quadratic over the grid, from the cell's neighbours, at the place of the point.
                let at = |du: i32, dv: i32| {
                    let cell = (v as i32 + dv) as usize * WIDTH + (u as i32 + du) as usize;
                    f64::from(grid.outline[cell])
                };
                let outline = |q: &CropPose| {
                    let x = place(q);
                    let to =
                        x.truncate() / x.z * grid.focal + DVec2::from(grid.center) - DVec2::new(u as f64, v as f64);
                    at(0, 0) + 0.5 * (at(1, 0) - at(-1, 0)) * to.x + 0.5 * (at(0, 1) - at(0, -1)) * to.y
                };
                let distance = at(0, 0).abs();
                let half = f64::from(scoring.outline_cells);
                let loss = |d: f64| 1.0 - 1.0 / (1.0 + (d / half) * (d / half));
                let curvature = slope_of(loss, distance.max(1e-3)) / distance.max(1e-3);
                // A cell gained or lost, less the further the outline is.
                let step = 1.0 / (distance.max(0.5) * (1.0 + distance * distance / 9.0));
                let per_cell = f64::from(weights.agreement(score)) / f64::from(score.union);
                let weight = f64::from(weights.outline) * share(2) * curvature + per_cell * step;
                add(differences(pose, lock_scale, outline), seen * weight);
            }
        }
        (matrix, gradient)
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_quadratic_is_that_of_finite_differences() {
    let none =
        Weights { overlap: 0.0, depth: 0.0, normals: 0.0, outline: 0.0, occluded: 0.2, unknown: 0.1, silhouette: 1.0 };
    // A union without end makes the overlap's own term vanish.
    let terms = [
        ("depth", Weights { depth: 1.3, ..none }, f32::INFINITY),
        ("normals", Weights { normals: 0.7, ..none }, f32::INFINITY),
        ("outline", Weights { outline: 0.9, ..none }, f32::INFINITY),
        ("overlap", Weights { overlap: 0.4, ..none }, 300.0),
        ("all", scoring().weights, 450.0),
    ];
    for seed in 0..6 {
        let scene = Scene::new(seed);
        for (term, weights, union) in terms {
            let scoring = Scoring { weights, ..scoring() };
            let score = Score { union, ..scene.score(&crate::precise_scene::scoring()) };
            assert!(score.counts.iter().all(|&cells| cells > 30.0), "seed {seed}: {score:?}");
            for lock_scale in [false, true] {
                let what = format!("seed {seed}, {term}, scale {}", if lock_scale { "locked" } else { "free" });
                let (matrix, gradient) = unpacked(&scene.equations(scoring, &score, lock_scale));
                let (expected, slope) = scene.by_differences(&scoring, &score, lock_scale);
                let largest = expected.diagonal().amax();
                let size = |k: usize| expected[(k, k)].max(1e-4 * largest).sqrt();
                let steepest = (0..7).map(|k| slope[k].abs() / size(k)).fold(0.0, f64::max);
                for i in 0..7 {
                    for j in 0..7 {
                        let off = (matrix[(i, j)] - expected[(i, j)]) / (size(i) * size(j));
                        assert!(off.abs() < 1e-3, "{what}: entry ({i}, {j}): {matrix} for {expected}");
                    }
                    let off = (gradient[i] - slope[i]) / size(i);
                    assert!(off.abs() < 1e-3 * steepest, "{what}: gradient {i}: {gradient} for {slope}");
                }
                // Normals hold the turn alone, and outlines all but the distance.
                let held = |k: usize| expected[(k, k)] > 1e-6 * largest;
                let free = match term {
                    "normals" => 3,
                    "depth" | "all" if !lock_scale => 7,
                    _ => 6,
                };
                assert!((0..7).all(|k| held(k) == (k < free)), "{what}: {expected}");
            }
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_depth_residual_is_a_root_mean_square_without_outliers() {
    for seed in 0..6 {
        let scene = Scene::new(seed);
        let scoring = scoring();
        let (mut sum, mut count, mut left_out) = (0.0, 0, 0);
        for (w, observed) in scene.canvas.inverse_depth.iter().zip(&scene.grid.depth) {
            if *w > 0.0 && *observed > 0.0 {
                let error = 1.0 / f64::from(*w) - f64::from(*observed);
                let counts = error.abs() < 3.0 * f64::from(scoring.depth_m);
                sum += if counts { error * error } else { 0.0 };
                count += usize::from(counts);
                left_out += usize::from(!counts);
            }
        }
        let objective = objective(&scene.model, &scene.grid, scoring, Prior::default());
        let found = Refiner { objective, lock_scale: false }.depth_rms(&scene.canvas);
        let expected = (sum / count as f64).sqrt();
        assert!(left_out > 5, "seed {seed}");
        assert!((found / expected - 1.0).abs() < 1e-4, "seed {seed}: {found} for {expected}");
    }
}

/// The body of the tests of the whole method on the fine grid, and its true pose.
fn observed() -> (Model, CropGrid, Scoring, CropPose) {
    let mesh = body();
    let frame = MeshFrame::of(&mesh);
    let clean = CleanObservation::new(&observe(&mesh, &truth()));
    let grid = CropGrid::new(&clean, 3000);
    let scoring = SearchSettings::from(Effort::Balanced).scoring(&clean, FINE);
    (Model::new(&frame.normalized(&mesh).unwrap()), grid, scoring, CropPose::of_similarity(&truth(), &frame).unwrap())
}

#[wasm_bindgen_test(unsupported = test)]
fn a_refinement_climbs_back_to_where_the_observation_was_drawn() {
    let (model, grid, scoring, truth) = observed();
    let objective = objective(&model, &grid, scoring, Prior::default());
    let (mut canvas, mut other) = (Canvas::default(), Canvas::default());
    for seed in 0..8 {
        let draw = &mut Draw::new(seed);
        let step: Step = core::array::from_fn(|k| draw.between(-1.0, 1.0) * if k < 3 { 0.15 } else { 0.06 });
        let start = truth.moved(&step);
        let refiner = Refiner { objective, lock_scale: false };
        let found = refiner.refine(&mut canvas, start, 30);
        assert_eq!(found.score, objective.score(&mut other, &found.pose), "seed {seed}: the score is the pose's");
        let turn = angle_between(found.pose.rotation, truth.rotation).to_degrees();
        assert!(turn < 0.7, "seed {seed}: {turn}°");
        assert!((found.pose.size - truth.size).abs() < 5e-3, "seed {seed}: {found:?}");
        assert!((found.pose.distance - truth.distance).abs() < 3e-3, "seed {seed}: {found:?}");
        assert!(found.converged && found.renders <= 31, "seed {seed}: {found:?}");

        // Fewer steps end lower, and never below the start.
        let scores = [0, 1, 3, 30].map(|steps| refiner.refine(&mut canvas, start, steps).score.total);
        assert!(scores.windows(2).all(|pair| pair[0] <= pair[1]) && scores[0] < scores[2], "seed {seed}: {scores:?}");
        let still = refiner.refine(&mut canvas, start, 0);
        assert_eq!((still.pose, still.renders, still.converged), (start, 1, false), "seed {seed}");
    }
}

/// The step of the quadratic, or a part of it, raises the score itself, here with one term at a time, from poses around the
/// true one. Normals are tested together with depths: their quadratic turns each normal where it is, although a curved
/// surface that turns shows another normal there.
#[wasm_bindgen_test(unsupported = test)]
fn a_step_of_the_quadratic_raises_each_term() {
    let (model, grid, scoring, truth) = observed();
    let none = Weights { overlap: 0.0, depth: 0.0, normals: 0.0, outline: 0.0, silhouette: 0.0, ..scoring.weights };
    let terms = [
        ("depth", Weights { depth: 1.0, ..none }),
        ("depth and normals", Weights { depth: 1.0, normals: scoring.weights.normals, ..none }),
        ("outline", Weights { outline: 1.0, ..none }),
        ("overlap", Weights { overlap: 1.0, silhouette: 1.0, ..none }),
    ];
    let mut canvas = Canvas::default();
    for (term, weights) in terms {
        let scoring = Scoring { weights, ..scoring };
        let objective = objective(&model, &grid, scoring, Prior::default());
        let refiner = Refiner { objective, lock_scale: false };
        for seed in 0..12 {
            let draw = &mut Draw::new(seed);
            let away: Step = core::array::from_fn(|k| draw.between(-1.0, 1.0) * if k < 3 { 0.1 } else { 0.04 });
            let start = truth.moved(&away);
            let score = objective.score(&mut canvas, &start);
            let step = refiner.equations(&canvas, &score, &start).solve(1e-3).unwrap();
            // Cells make the score a staircase, on which a part of a step may not be seen.
            let after = [1.0, 0.5, 0.25, 0.125].map(|part| {
                let pose = start.moved(&step.map(|x| part * x));
                objective.score(&mut canvas, &pose).total
            });
            let best = after.into_iter().fold(f32::NEG_INFINITY, f32::max);
            assert!(
                best > score.total,
                "{term}, seed {seed}: {} at the start, {after:?} after parts of a step",
                score.total
            );
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_refinement_keeps_a_locked_scale_and_the_bounds_of_a_free_one() {
    let (model, grid, scoring, truth) = observed();
    let log_scale = |pose: &CropPose| pose.size + pose.distance;
    let mut canvas = Canvas::default();
    for seed in 0..6 {
        let draw = &mut Draw::new(seed);
        let step: Step = core::array::from_fn(|_| draw.between(-0.05, 0.05));
        let start = truth.moved(&step);
        let free = objective(&model, &grid, scoring, Prior::default());
        let locked = Refiner { objective: free, lock_scale: true }.refine(&mut canvas, start, 20);
        assert!((log_scale(&locked.pose) - log_scale(&start)).abs() < 1e-12, "seed {seed}: {locked:?}");
        let before = Refiner { objective: free, lock_scale: true }.refine(&mut canvas, start, 0).score.total;
        assert!(locked.score.total > before, "seed {seed}: nothing but the scale moves");

        let bounds = [1.03, 1.1].map(|factor| factor * libm::exp(log_scale(&truth)));
        let prior = Prior { scale: Some(bounds), ..Prior::default() };
        let bounded =
            Refiner { objective: Objective { prior, ..free }, lock_scale: false }.refine(&mut canvas, start, 20);
        let scale = libm::exp(log_scale(&bounded.pose));
        assert!((bounds[0] * (1.0 - 1e-12)..=bounds[1]).contains(&scale), "seed {seed}: {scale} in {bounds:?}");
        assert!(prior.is_at_bound(&bounded.pose), "seed {seed}: the truth is below");
    }
}

/// Equations of known JᵀWJ, which holds turns, size, place and distance differently, and not independently.
fn known_equations(draw: &mut Draw) -> (NormalEquations, Matrix) {
    let (mut equations, mut matrix) = (NormalEquations::new(), Matrix::zeros());
    let stretch = Vector::from_fn(|_, _| libm::exp(draw.between(-1.0, 1.5)));
    for _ in 0..60 {
        let jacobian = Vector::from_fn(|k, _| draw.normal() * stretch[k]) + Vector::repeat(draw.normal() * 0.5);
        let weight = draw.between(0.0, 2.0);
        equations.add(&jacobian.into(), draw.normal(), weight);
        matrix += jacobian * jacobian.transpose() * weight;
    }
    (equations, matrix)
}

#[wasm_bindgen_test(unsupported = test)]
fn one_standard_deviation_lowers_the_quadratic_by_a_hundredth() {
    for seed in 0..30 {
        let draw = &mut Draw::new(seed);
        let (equations, matrix) = known_equations(draw);
        let pose = CropPose { place: DVec2::new(draw.between(-0.3, 0.3), draw.between(-0.3, 0.3)), ..pose(draw, 3.0) };
        let found = Conditioning::new(&covariance(&equations).unwrap(), &pose);
        let covariance = matrix.try_inverse().unwrap() * 0.02;
        // The largest change of a quantity among the steps x with ½xᵀAx = 0.01, A being JᵀWJ.
        let deviation = |quantity: &dyn Fn(&CropPose) -> f64| {
            let (slope, _) = differences(&pose, false, quantity);
            (slope.transpose() * covariance * slope)[0].sqrt()
        };
        let z = libm::exp(pose.distance);
        let lateral = [0, 1].map(|axis| deviation(&|q| q.place[axis] * z)).into_iter().fold(0.0, f64::max);
        let expected = [
            ("scale", found.scale, deviation(&|q| libm::log(q.scale_translation().0))),
            ("lateral", found.lateral_m, lateral),
            ("distance", found.distance_m, deviation(&|q| q.scale_translation().1.z)),
        ];
        for (what, found, expected) in expected {
            assert!((found / expected - 1.0).abs() < 1e-5, "seed {seed}: {what}: {found} for {expected}");
        }
        let (angle, axis) = found.rotation;
        let about = |axis: DVec3| {
            let turn = Vector::from_fn(|k, _| if k < 3 { axis[k] } else { 0.0 });
            (turn.transpose() * covariance * turn)[0].sqrt()
        };
        assert!(
            (axis.length() - 1.0).abs() < 1e-9 && (about(axis) / angle - 1.0).abs() < 1e-6,
            "seed {seed}: {found:?}"
        );
        for _ in 0..200 {
            let other = DVec3::from(<[f64; 3]>::from(draw.direction()));
            assert!(about(other) <= angle * (1.0 + 1e-9), "seed {seed}: held less about {other}");
        }
    }
    assert_eq!(covariance(&NormalEquations::new()), None);
}

#[wasm_bindgen_test(unsupported = test)]
fn the_axis_held_least_is_that_of_a_bodys_revolution() {
    // Only turns about z are left free, or nearly.
    let mut equations = NormalEquations::new();
    let turn = DMat3::from_quat(exp(DVec3::new(0.4, -0.2, 0.9)));
    for k in 0..7 {
        let mut jacobian = [0.0; 7];
        if k < 3 {
            jacobian[..3].copy_from_slice(&turn.col(k).to_array());
        } else {
            jacobian[k] = 1.0;
        }
        equations.add(&jacobian, 0.0, if k == 2 { 1e-3 } else { 10.0 });
    }
    let held_at = pose(&mut Draw::new(2), 3.0);
    let found = Conditioning::new(&covariance(&equations).unwrap(), &held_at);
    assert!(found.rotation.1.dot(turn.z_axis).abs() > 1.0 - 1e-9, "{found:?}");
    assert!((found.rotation.0 / (0.02f64 / 1e-3).sqrt() - 1.0).abs() < 1e-4, "{found:?}");

    // A symmetry that makes this turn meaningless leaves the other two, and all else as it is.
    fix_roll(&mut equations, turn.z_axis);
    let up_to_roll = Conditioning::new(&covariance(&equations).unwrap(), &held_at);
    assert!((up_to_roll.rotation.0 / (0.02f64 / 10.0).sqrt() - 1.0).abs() < 1e-4, "{up_to_roll:?}");
    assert!((up_to_roll.scale / found.scale - 1.0).abs() < 1e-4, "{up_to_roll:?}");
}
