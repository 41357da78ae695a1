//! The grid of rotations of `precise`: boxes that fit, distances, and the best of many.

use sim3align::geometry::rotations::super_fibonacci;
use sim3align::precise::drawn::mesh_pyramid::outermost;
use sim3align::precise::observed::anchors::Anchor;
use sim3align::precise::searched::coarse::Coarse;
use sim3align::precise::searched::ranking::{Found, best_of, distinct};
use sim3align::precise::searched::recipe::COARSE;

use crate::precise::{body, observe, truth};
use crate::precise_scene::{pose, rotation};
use crate::prelude::*;

struct Scene {
    model: Model,
    grid: CropGrid,
    clean: CleanObservation,
}

impl Scene {
    fn new() -> Self {
        let mesh = body();
        let clean = CleanObservation::new(&observe(&mesh, &truth()));
        let model = Model::new(&MeshFrame::of(&mesh).normalized(&mesh).unwrap());
        Self { model, grid: CropGrid::new(&clean, 900), clean }
    }

    fn coarse(&self, prior: Prior) -> Coarse<'_> {
        let scoring = SearchSettings::from(Effort::Balanced).scoring(&self.clean, COARSE);
        let objective = objective(&self.model, &self.grid, scoring, prior);
        Coarse { objective, median_m: self.clean.median_m }
    }
}

/// The corners of the box around the projected mesh: x/z and y/z.
fn projected_box(model: &Model, pose: &CropPose) -> [DVec2; 2] {
    let (scale, translation) = pose.scale_translation();
    let project = |p: &Vec3| {
        let x = pose.rotation * p.as_dvec3() * scale + translation;
        x.truncate() / x.z
    };
    let projected = || model.positions.iter().map(project);
    [projected().fold(DVec2::INFINITY, DVec2::min), projected().fold(DVec2::NEG_INFINITY, DVec2::max)]
}

#[wasm_bindgen_test(unsupported = test)]
fn the_box_of_the_projected_mesh_is_that_of_the_mask() {
    let scene = Scene::new();
    let coarse = scene.coarse(Prior::default());
    let mut canvas = Canvas::default();
    let [[left, right], [top, bottom]] = scene.grid.bounds;
    let (middle, sides) = (DVec2::new(left + right, top + bottom) * 0.5, DVec2::new(right - left, bottom - top));
    for k in 0..24 {
        let rotation = super_fibonacci(k, 24);
        // All vertices, then those that are outermost along some directions, which boxes touch, or nearly.
        for (points, tolerance) in [(scene.model.positions.clone(), 2e-3), (outermost(&scene.model), 0.02)] {
            let mut found = Vec::new();
            coarse.try_anchors(&mut canvas, &points, rotation, &[Anchor::AS_IT_IS], &mut found);
            let pose = found[0].pose;
            assert_eq!((found.len(), pose.rotation), (1, rotation), "rotation {k}");
            let to_cells = |at: DVec2| at * scene.grid.focal + DVec2::from(scene.grid.center);
            let [low, high] = projected_box(&scene.model, &pose).map(to_cells);
            let off = (0.5 * (low + high) - middle) / sides.max_element();
            assert!(off.length() < tolerance, "rotation {k}: the middle is off by {off}");
            let (found, wanted) = (high - low, sides);
            let ratio = (found.x * found.y / (wanted.x * wanted.y)).sqrt();
            assert!((ratio - 1.0).abs() < tolerance, "rotation {k}: sides are off by {ratio}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn an_anchor_enlarges_the_box_towards_its_side() {
    let scene = Scene::new();
    let coarse = scene.coarse(Prior::default());
    let (mut canvas, mut found) = (Canvas::default(), Vec::new());
    let both = [(1.0, [0.0, 0.0]), (1.6, [1.0, 0.0]), (1.25, [0.0, -1.0]), (1.25, [-1.0, 1.0])];
    let mut tried: Vec<Anchor> = both.map(|(zoom, towards)| Anchor { along: None, zoom, towards }).into();
    tried.push(Anchor { along: Some(1), zoom: 1.0, towards: [1.0, 0.0] });
    tried.push(Anchor { along: Some(0), zoom: 1.0, towards: [0.0, -1.0] });
    coarse.try_anchors(&mut canvas, &scene.model.positions, super_fibonacci(3, 24), &tried, &mut found);
    let [[left, right], [top, bottom]] = scene.grid.bounds;
    let seen = DVec2::new(right - left, bottom - top) / scene.grid.focal;
    let plain = found[0].pose;
    let [low, high] = projected_box(&scene.model, &plain);
    let sides = high - low;
    for (anchor, candidate) in tried.iter().zip(&found) {
        let zoom = anchor.zoom * anchor.along.map_or(1.0, |axis| seen[axis] / sides[axis]);
        let pose = candidate.pose;
        // As exact as the fit of the box.
        assert!((pose.size - plain.size - libm::log(zoom)).abs() < 2e-3, "{anchor:?}");
        // Half of what the box exceeds that of the mask by: the side that is not cut is where that of the mask is.
        let expected = DVec2::from(anchor.towards) * (0.5 * (sides * zoom - seen)).max(DVec2::ZERO);
        assert!((pose.place - plain.place - expected).length() < 2e-3, "{anchor:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn outermost_vertices_are_those_that_boxes_touch() {
    let model = Scene::new().model;
    let kept = outermost(&model);
    assert!(kept.len() < model.positions.len() / 4, "{} of {}", kept.len(), model.positions.len());
    assert!(kept.iter().all(|p| model.positions.contains(p)));
    for seed in 0..300 {
        let direction = Vec3::from_array(<[f64; 3]>::from(Draw::new(seed).direction()).map(|x| x as f32));
        let reach = |points: &[Vec3]| points.iter().map(|p| p.dot(direction)).fold(f32::MIN, f32::max);
        assert!(reach(&kept) > reach(&model.positions) - 0.01, "seed {seed}: a hundredth of the diagonal at most");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_pose_goes_to_the_distance_of_the_depths() {
    let scene = Scene::new();
    let coarse = scene.coarse(Prior::default());
    let truth = CropPose::of_similarity(&truth(), &MeshFrame::of(&body())).unwrap();
    let (mut canvas, mut other) = (Canvas::default(), Canvas::default());
    for seed in 0..30 {
        let draw = &mut Draw::new(seed);
        let start = CropPose {
            rotation: rotation(draw),
            size: truth.size + draw.between(-0.3, 0.3),
            distance: truth.distance + draw.between(-0.7, 0.7),
            ..truth
        };
        let found = coarse.at_its_distance(&mut canvas, start);
        let moved = CropPose { distance: start.distance, ..found.pose };
        assert_eq!(moved, start, "seed {seed}: the distance alone moves");
        other.draw(&scene.model, &found.pose, &scene.grid);
        let mut ratios: Vec<f32> = (other.inverse_depth.iter().zip(&scene.grid.depth))
            .filter(|(w, z)| **w > 0.0 && **z > 0.0)
            .map(|(w, z)| w * z)
            .collect();
        ratios.sort_by(f32::total_cmp);
        let median = ratios[ratios.len() / 2];
        assert!((median - 1.0).abs() < 1e-4, "seed {seed}: observed over drawn depths have the median {median}");
        // Drawn where it came from, and scored as where it went.
        let redrawn = coarse.objective.score(&mut other, &found.pose);
        assert!((redrawn.total - found.score.total).abs() < 5e-3, "seed {seed}: {found:?} for {redrawn:?}");

        let bounds = [0.9, 1.1].map(|factor| factor * truth.scale_translation().0);
        let prior = Prior { scale: Some(bounds), ..Prior::default() };
        let held = scene.coarse(prior).at_its_distance(&mut canvas, start);
        assert_eq!(held.pose, prior.bounded(found.pose), "seed {seed}");
        if held.pose != found.pose {
            let expected = scene.coarse(prior).objective.score(&mut other, &held.pose);
            assert_eq!(held.score, expected, "seed {seed}: another size is another picture");
        }
    }
    let beside = CropPose { place: truth.place + DVec2::new(0.6, 0.0), ..truth };
    assert_eq!(coarse.at_its_distance(&mut canvas, beside).pose, beside, "no depth to go to");
}

#[wasm_bindgen_test(unsupported = test)]
fn a_prior_counts_in_the_scores_of_the_grid() {
    let scene = Scene::new();
    let mut canvas = Canvas::default();
    for seed in 0..10 {
        let draw = &mut Draw::new(seed);
        let mut start = CropPose::of_similarity(&truth(), &MeshFrame::of(&body())).unwrap();
        start.rotation = rotation(draw);
        let prior = Prior { up: Some([DVec3::NEG_Y, DVec3::Z]), initial: Some(rotation(draw)), ..Prior::default() };
        let [plain, leaning] =
            [Prior::default(), prior].map(|prior| scene.coarse(prior).at_its_distance(&mut canvas, start));
        let counted = prior.score(&plain.pose, &Equivalence::default());
        assert!(counted < 0.0 && leaning.score.total == plain.score.total + counted, "seed {seed}");
    }
}

/// Founds of which many score alike, and many are near one another.
fn candidates(draw: &mut Draw, count: usize) -> Vec<Found> {
    let centers: Vec<_> = (0..5).map(|_| rotation(draw)).collect();
    (0..count)
        .map(|_| {
            let center = centers[draw.below(5)];
            let near = CropPose { rotation: center, ..pose(draw, 1.0) };
            let step: [f64; 7] = core::array::from_fn(|k| if k < 3 { draw.between(-0.3, 0.3) } else { 0.0 });
            let total = draw.below(12) as f32 / 10.0 - 0.3;
            Found::of(near.moved(&step), Score { total, ..Score::default() })
        })
        .collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn the_best_come_first_and_equal_ones_as_they_came() {
    for seed in 0..40 {
        let draw = &mut Draw::new(seed);
        let count = draw.below(120);
        let candidates = candidates(draw, count);
        // A stable sort keeps the order of equals.
        let mut sorted: Vec<&Found> = candidates.iter().collect();
        sorted.sort_by(|a, b| b.score.total.partial_cmp(&a.score.total).unwrap());
        for keep in [0, 1, 7, count, usize::MAX] {
            let found: Vec<CropPose> = best_of(&candidates, keep).iter().map(|c| c.pose).collect();
            let expected: Vec<CropPose> = sorted.iter().take(keep).map(|c| c.pose).collect();
            assert_eq!(found, expected, "seed {seed}, {keep} of {count}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn distinct_candidates_are_the_best_of_their_surroundings() {
    for seed in 0..40 {
        let draw = &mut Draw::new(seed);
        let count = draw.below(80);
        let candidates = candidates(draw, count);
        let ranked = best_of(&candidates, count);
        for (keep, angle) in [(usize::MAX, 0.21), (6, 0.105), (3, 0.5), (usize::MAX, 0.0)] {
            let kept = distinct(candidates.clone(), keep, angle);
            let mut expected: Vec<Found> = Vec::new();
            for candidate in &ranked {
                let is_near = |k: &Found| angle_between(k.pose.rotation, candidate.pose.rotation) <= angle;
                if expected.len() < keep && !expected.iter().any(is_near) {
                    expected.push(*candidate);
                }
            }
            let poses = |list: &[Found]| list.iter().map(|c| c.pose).collect::<Vec<_>>();
            assert_eq!(poses(&kept), poses(&expected), "seed {seed}, {keep} of {count}, {angle} rad apart");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_move_as_the_units_of_their_steps_say() {
    for seed in 0..20 {
        let draw = &mut Draw::new(seed);
        let pose = pose(draw, 3.0);
        let (scale, origin) = pose.scale_translation();
        let by = |k: usize, x: f64| {
            let mut step = [0.0; 7];
            step[k] = x;
            pose.moved(&step)
        };
        for k in 0..3 {
            let expected = DMat3::from_axis_angle(DVec3::AXES[k], 0.3) * DMat3::from_quat(pose.rotation);
            let found = DMat3::from_quat(by(k, 0.3).rotation);
            assert!((found - expected).to_cols_array().iter().all(|x| x.abs() < 1e-12), "seed {seed}: axis {k}");
        }
        assert!((by(3, 0.1).scale_translation().0 / scale - libm::exp(0.1)).abs() < 1e-12, "seed {seed}");
        // A unit of place, and one of distance, are the size of the object.
        for k in [4, 5] {
            let (same, moved) = by(k, 0.1).scale_translation();
            assert!((((moved - origin) / scale)[k - 4] - 0.1).abs() < 1e-12 && same == scale, "seed {seed}: {moved}");
        }
        let moved = by(6, 1e-6).scale_translation().1 - origin;
        assert!(((moved.z / scale) / 1e-6 - 1.0).abs() < 1e-5, "seed {seed}: {moved}");
    }
}
