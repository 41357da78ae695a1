//! The quadratic of the refinement against finite differences.

use nalgebra::{SMatrix, SVector};
use sim3align::geometry::normal_equations::NormalEquations;
use sim3align::precise::drawing::equivalence::Equivalence;
use sim3align::precise::scoring::conditioning::{Conditioning, at_known, gradient_of_scale};
use sim3align::precise::scoring::objective::Objective;
use sim3align::precise::scoring::prior::Prior;
use sim3align::precise::scoring::score::Score;
use sim3align::precise::search::refine::Refiner;

use crate::prelude::*;
use crate::score::{HEIGHT, WIDTH, facing, model, noisy_grid, pose, scoring};

type Matrix = SMatrix<f64, 7, 7>;
type Vector = SVector<f64, 7>;

/// JᵀWJ and JᵀWr, which equations tell by their damped steps alone.
fn unpacked(equations: &NormalEquations) -> (Matrix, Vector) {
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
        let (model, grid, equivalence) = (&self.model, &self.grid, &Equivalence::default());
        let objective = Objective { model, grid, scoring, prior: Prior::default(), equivalence, scene: None };
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
                let seen = grid.normal_at(i).as_dvec3();
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

#[wasm_bindgen_test]
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
            let score = Score { union, ..scene.score(&crate::score::scoring()) };
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

#[wasm_bindgen_test]
fn deviations_are_those_of_the_widest_direction_and_of_a_known_scale() {
    let draw = &mut Draw::new(5);
    let pose = pose(draw, 2.0);
    let (scale, _) = pose.scale_translation();
    // Round but for a diagonal of the image, and for a size that is bound to the distance.
    let mut covariance = [[0.0; 7]; 7];
    (0..7).for_each(|k| covariance[k][k] = 1e-4);
    (covariance[4][5], covariance[5][4]) = (9e-5, 9e-5);
    (covariance[3][6], covariance[6][3]) = (5e-5, 5e-5);
    let free = Conditioning::new(&covariance, &pose);
    assert!((free.lateral_m / scale - libm::sqrt(1.9e-4)).abs() < 1e-12, "{free:?}");
    let fixed = Conditioning::new(&at_known(&covariance, &gradient_of_scale(&pose)), &pose);
    assert!(fixed.scale < 1e-9 && free.scale > 1e-3, "{fixed:?}, free {free:?}");
    assert!(fixed.distance_m < free.distance_m && fixed.lateral_m == free.lateral_m, "{fixed:?}, free {free:?}");
}

#[wasm_bindgen_test]
fn a_size_is_as_uncertain_as_its_fit_is_inexact() {
    let pose = pose(&mut Draw::new(6), 2.0);
    let mut covariance = [[0.0; 7]; 7];
    (0..7).for_each(|k| covariance[k][k] = 1e-4);
    let free = Conditioning::new(&covariance, &pose);
    let of = |depth, outline| free.with_misfit(&Score { depth, outline, ..Score::default() });
    let [exact, typical, poor] = [of(1.0, 1.0), of(0.85, 0.95), of(0.7, 0.8)];
    assert!(exact.scale < typical.scale && typical.scale < poor.scale, "{exact:?} {typical:?} {poor:?}");
    assert!(exact.scale > 0.0 && poor.scale / typical.scale > 2.0, "{exact:?} {typical:?} {poor:?}");
    assert_eq!((typical.rotation, typical.lateral_m), (free.rotation, free.lateral_m));
    assert!((typical.distance_m / free.distance_m - typical.scale / free.scale).abs() < 1e-12);
}
