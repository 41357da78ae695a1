//! Score, prior and objective of `precise`, against their definitions, cell by cell.

use sim3align::precise::scored::score::Background;

use crate::precise_scene::{FOCAL, model, noisy_grid, pose, rotation, scoring};
use crate::prelude::*;

/// The score's definition, in f64; the terms in the order total, overlap, coverage, depth, normals, outline, hidden,
/// union.
fn by_definition(
    scoring: &Scoring,
    canvas: &Canvas,
    model: &Model,
    grid: &CropGrid,
    pose: &CropPose,
    stretch: f64,
) -> ([f64; 8], [f64; 3]) {
    let Weights { overlap, depth, normals, outline, occluded, unknown, .. } = scoring.weights;
    let is_drawn = |u: usize, v: usize| canvas.inverse_depth[v * grid.width + u] > 0.0;
    let (mut both, mut extra, mut hidden, mut unseen) = (0.0, 0.0, 0.0, 0.0);
    // Cells without a reading weigh less the more of the background has one, down to `unknown` at 30 %.
    let complete = (f64::from(grid.known) / 0.3).min(1.0);
    let of_unseen = 1.0 - complete + complete * f64::from(unknown);
    let (mut depths, mut alike, mut edges) = (Vec::new(), Vec::new(), Vec::new());
    for (u, v) in (0..grid.height).flat_map(|v| (0..grid.width).map(move |u| (u, v))).filter(|&(u, v)| is_drawn(u, v)) {
        let i = v * grid.width + u;
        let z = stretch / f64::from(canvas.inverse_depth[i]);
        let scene = f64::from(grid.scene[i]);
        let is_hidden = !grid.mask[i] && scene > 0.0 && z - scene > f64::from(scoring.occluder_m);
        let is_unseen = !grid.mask[i] && scene == 0.0;
        match (grid.mask[i], is_hidden) {
            (true, _) => both += 1.0,
            (_, true) => hidden += 1.0,
            _ if is_unseen => unseen += 1.0,
            _ => extra += 1.0,
        }
        if grid.mask[i] && grid.depth[i] > 0.0 {
            let error = (z - f64::from(grid.depth[i])).abs() / f64::from(scoring.depth_m);
            depths.push(1.0 - error / (1.0 + error));
            let seen = grid.normals[i].as_dvec3();
            if seen != DVec3::ZERO {
                let drawn = pose.rotation * model.normals[canvas.triangle[i] as usize].as_dvec3();
                alike.push(seen.dot(drawn).abs());
            }
        }
        let inner = u > 0 && v > 0 && u + 1 < grid.width && v + 1 < grid.height;
        let neighbours = || [(u - 1, v), (u + 1, v), (u, v - 1), (u, v + 1)];
        if inner && !is_hidden && neighbours().iter().any(|&(u, v)| !is_drawn(u, v)) {
            let q = f64::from(grid.outline[i]) / f64::from(scoring.outline_cells);
            edges.push((1.0 / (1.0 + q * q), if is_unseen { of_unseen } else { 1.0 }));
        }
    }
    let lost = lost_vertices(model, grid, pose);
    let drawn = both + extra + hidden + unseen;
    let masked = grid.mask.iter().filter(|set| **set).count() as f64;
    let union = masked + extra + f64::from(occluded) * hidden + of_unseen * unseen + lost / (1.05 - lost) * drawn;
    let mean = |values: &[f64]| if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 };
    let edge_cells: f64 = edges.iter().map(|(_, weight)| weight).sum();
    let edge_sum: f64 = edges.iter().map(|(credit, weight)| credit * weight).sum();
    let terms = [mean(&depths), mean(&alike), if edge_cells > 0.0 { edge_sum / edge_cells } else { 0.0 }];
    let agreement: f64 =
        [depth, normals, outline].iter().zip(terms).map(|(weight, term)| f64::from(*weight) * term).sum();
    let iou = both / union;
    let total = iou * (f64::from(overlap) + agreement);
    let values = [total, iou, both / masked, terms[0], terms[1], terms[2], hidden / drawn.max(1.0), union];
    (values, [depths.len() as f64, alike.len() as f64, edge_cells])
}

/// Share of the vertices whose projection is not on the grid.
fn lost_vertices(model: &Model, grid: &CropGrid, pose: &CropPose) -> f64 {
    let (scale, translation) = pose.scale_translation();
    let is_lost = |p: &&Vec3| {
        let x = pose.rotation * p.as_dvec3() * scale + translation;
        let at = x.truncate() / x.z * FOCAL + DVec2::from(grid.center);
        x.z < 0.05 * translation.z
            || at.cmplt(DVec2::splat(-0.5)).any()
            || at.x > grid.width as f64 - 0.5
            || at.y > grid.height as f64 - 0.5
    };
    model.positions.iter().filter(is_lost).count() as f64 / model.positions.len() as f64
}

fn values(score: &Score) -> [f64; 8] {
    let Score { total, overlap, coverage, depth, normals, outline, hidden, union, .. } = *score;
    [total, overlap, coverage, depth, normals, outline, hidden, union].map(f64::from)
}

#[wasm_bindgen_test(unsupported = test)]
fn a_score_is_what_its_definition_says() {
    let (model, scoring) = (model(), scoring());
    let mut canvas = Canvas::default();
    let (mut hidden, mut leaving) = (0, 0);
    for seed in 0..60 {
        let draw = &mut Draw::new(seed);
        let observed = pose(draw, 3.0);
        let grid = noisy_grid(draw, &model, &observed, &scoring);
        // Every third leaves the grid on some side.
        let tried = pose(draw, if seed % 3 == 0 { 30.0 } else { 4.0 });
        let tried = CropPose { distance: observed.distance, ..tried };
        let stretch = if seed % 2 == 0 { 1.0 } else { draw.between(0.8, 1.3) as f32 };
        canvas.draw(&model, &tried, &grid);
        let found = scoring.score(&canvas, &model, &grid, stretch);
        let (expected, counts) = by_definition(&scoring, &canvas, &model, &grid, &tried, f64::from(stretch));
        for (found, expected) in found.counts.iter().zip(counts) {
            assert!(
                (f64::from(*found) - expected).abs() < 1e-3 * expected.max(1.0),
                "seed {seed}: {found} for {expected}"
            );
        }
        for (found, expected) in values(&found).iter().zip(expected) {
            assert!((found - expected).abs() < 3e-5 * expected.max(1.0), "seed {seed}: {found} for {expected}");
        }
        hidden += usize::from(found.hidden > 0.05);
        leaving += usize::from(canvas.lost > 0.1);
    }
    assert!(hidden > 20 && leaving > 8, "{hidden} hidden, {leaving} leaving the grid");
}

#[wasm_bindgen_test(unsupported = test)]
fn nothing_drawn_scores_nothing_and_terms_without_weight_cost_nothing() {
    let (model, scoring) = (model(), scoring());
    let draw = &mut Draw::new(1);
    let observed = pose(draw, 2.0);
    let grid = noisy_grid(draw, &model, &observed, &scoring);
    let away = CropPose { place: DVec2::new(40.0, 0.0), ..observed };
    let mut canvas = Canvas::default();
    canvas.draw(&model, &away, &grid);
    let nothing = scoring.score(&canvas, &model, &grid, 1.0);
    assert_eq!((nothing.total, nothing.overlap, nothing.coverage, nothing.counts), (0.0, 0.0, 0.0, [0.0; 3]));
    canvas.draw(&model, &observed, &grid);
    let without = Scoring { weights: Weights { outline: 0.0, ..scoring.weights }, ..scoring };
    let (with, without) = (scoring.score(&canvas, &model, &grid, 1.0), without.score(&canvas, &model, &grid, 1.0));
    assert!(with.counts[2] > 0.0 && without.counts[2] == 0.0, "{with:?}, {without:?}");
    assert!((with.total - without.total - with.overlap * scoring.weights.outline * with.outline).abs() < 1e-6);
}

#[wasm_bindgen_test(unsupported = test)]
fn an_infinite_distance_to_occluders_hides_nothing() {
    let scoring = Scoring { occluder_m: f32::INFINITY, ..scoring() };
    assert_eq!(scoring.background(0.01, 100.0), Background::FreeSpace);
    let scoring = Scoring { occluder_m: 0.1, ..scoring };
    let cases = [
        (0.0, Background::Unknown),
        (0.5, Background::Occluder),
        (0.89, Background::Occluder),
        (0.91, Background::FreeSpace),
        (2.0, Background::FreeSpace),
    ];
    for (scene, expected) in cases {
        assert_eq!(scoring.background(scene, 1.0), expected, "{scene}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_objective_is_the_score_of_the_picture_and_the_prior() {
    let (model, scoring) = (model(), scoring());
    let (mut canvas, mut other) = (Canvas::default(), Canvas::default());
    for seed in 0..10 {
        let draw = &mut Draw::new(100 + seed);
        let observed = pose(draw, 3.0);
        let grid = noisy_grid(draw, &model, &observed, &scoring);
        let prior = Prior { up: Some([rotation(draw) * DVec3::Z, DVec3::X]), ..Prior::default() };
        let objective = objective(&model, &grid, scoring, prior);
        let tried = pose(draw, 5.0);
        let found = objective.score(&mut canvas, &tried);
        other.draw(&model, &tried, &grid);
        let mut expected = scoring.score(&other, &model, &grid, 1.0);
        let counted = prior.score(&tried, &Equivalence::default());
        expected.total += counted;
        assert!(counted < 0.0, "seed {seed}");
        assert_eq!(found, expected, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn bounds_of_the_scale_hold_at_the_same_distance() {
    let scale_of = |pose: &CropPose| pose.scale_translation().0;
    for seed in 0..200 {
        let draw = &mut Draw::new(seed);
        let any = CropPose { distance: draw.between(-2.0, 2.0), size: draw.between(-3.0, 1.0), ..pose(draw, 3.0) };
        let low = libm::exp(draw.between(-4.0, 2.0));
        let bounds = [low, low * if seed % 4 == 0 { 1.0 } else { draw.between(1.0, 5.0) }];
        let prior = Prior { scale: Some(bounds), ..Prior::default() };
        let held = prior.bounded(any);
        let expected = scale_of(&any).clamp(bounds[0], bounds[1]);
        assert!((scale_of(&held) / expected - 1.0).abs() < 1e-12, "seed {seed}: {} for {expected}", scale_of(&held));
        assert_eq!((held.rotation, held.place, held.distance), (any.rotation, any.place, any.distance), "seed {seed}");
        let was_inside = (bounds[0]..=bounds[1]).contains(&scale_of(&any));
        assert!(!was_inside || held == any, "seed {seed}: moved within its bounds");
        assert_eq!(prior.is_at_bound(&held), bounds[0] < bounds[1] && !was_inside, "seed {seed}");
        assert_eq!(Prior::default().bounded(any), any, "seed {seed}");
        assert!(!Prior::default().is_at_bound(&any), "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_more_a_pose_leans_the_less_it_scores() {
    for seed in 0..20 {
        let draw = &mut Draw::new(seed);
        let upright = pose(draw, 3.0);
        let mesh_up = rotation(draw) * DVec3::Z;
        let camera_up = upright.rotation * mesh_up;
        let prior = Prior { up: Some([camera_up, mesh_up]), ..Prior::default() };
        let axis = camera_up.any_orthonormal_vector();
        let leaning = |degrees: f64| {
            let rotation: DQuat = exp(axis * degrees.to_radians()) * upright.rotation;
            prior.score(&CropPose { rotation, ..upright }, &Equivalence::default())
        };
        assert!(leaning(0.0).abs() < 1e-6, "seed {seed}: {}", leaning(0.0));
        assert!((leaning(20.0) + 0.15).abs() < 1e-6, "seed {seed}: half of 0.3 at 20°, not {}", leaning(20.0));
        let scores: Vec<f32> = (0..=18).map(|k| leaning(10.0 * f64::from(k))).collect();
        assert!(scores.windows(2).all(|pair| pair[1] < pair[0]), "seed {seed}: {scores:?}");
        assert!(scores[18] > -0.3 && scores[18] < -0.28, "seed {seed}: {scores:?}");
        // A turn about the vertical is no lean.
        let turned = CropPose { rotation: exp(camera_up * 2.0) * upright.rotation, ..upright };
        assert!(prior.score(&turned, &Equivalence::default()).abs() < 1e-6, "seed {seed}");
        assert_eq!(Prior::default().score(&upright, &Equivalence::default()), 0.0, "seed {seed}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_pose_far_from_the_initial_rotation_scores_less() {
    let group = |axis: DVec3| {
        let axis = SymmetryAxis { axis: vector3(axis.as_vec3()), fold: Some(2) };
        Equivalence::new(Symmetry::Declared(vec![axis]).group(&cuboid(Vec3::new(1.0, 0.8, 0.6))).unwrap())
    };
    for seed in 0..20 {
        let draw = &mut Draw::new(seed);
        let initial = pose(draw, 3.0);
        let prior = Prior { initial: Some(initial.rotation), ..Prior::default() };
        let axis = rotation(draw) * DVec3::Z;
        let turned = |degrees: f64, equivalence: &Equivalence| {
            let rotation = initial.rotation * exp(axis * degrees.to_radians());
            prior.score(&CropPose { rotation, ..initial }, equivalence)
        };
        let none = Equivalence::default();
        assert!((0..=12).all(|k| turned(2.0 * f64::from(k), &none) == 0.0), "seed {seed}: within 25°");
        assert!((turned(40.0, &none) + 0.025).abs() < 1e-6, "seed {seed}: half of 0.05, not {}", turned(40.0, &none));
        let scores: Vec<f32> = (3..=18).map(|k| turned(10.0 * f64::from(k), &none)).collect();
        assert!(scores.windows(2).all(|pair| pair[1] < pair[0]) && scores[15] > -0.05, "seed {seed}: {scores:?}");
        // A half turn that the symmetry makes none, and a quarter turn between two equal poses.
        let half = group(axis);
        assert_eq!(turned(180.0, &half), 0.0, "seed {seed}");
        assert!((turned(120.0, &half) - turned(60.0, &half)).abs() < 1e-6, "seed {seed}");
    }
}
