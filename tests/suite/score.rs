//! The score of a pose against its definition, cell by cell: what is covered, hidden, against free space and unknown. The
//! evidence is random, around a body.

use crate::prelude::*;

pub const WIDTH: usize = 56;
pub const HEIGHT: usize = 44;

/// A body without symmetry in its own frame, with some of its faces turned over.
pub fn model() -> Model {
    let body = mapped(&ellipsoid(Vec3::new(0.5, 0.36, 0.28), 10), |p| {
        p * (1.0 + 0.4 * libm::sinf(5.0 * p.x + 1.0) * libm::sinf(6.0 * p.y + 0.4))
    });
    let triangles = (0..).zip(body.triangles()).map(|(i, &[a, b, c])| if i % 3 == 0 { [a, c, b] } else { [a, b, c] });
    let body = Mesh::new(body.positions().to_vec(), triangles.collect()).unwrap();
    Model::new(&MeshFrame::of(&body).normalized(&body).unwrap())
}

pub fn rotation(draw: &mut Draw) -> DQuat {
    DQuat::from_xyzw(draw.normal(), draw.normal(), draw.normal(), draw.normal()).normalize()
}

/// A pose whose picture fills about half of the grid; `off` moves its middle away from the grid's, in cells.
pub fn pose(draw: &mut Draw, off: f64) -> CropPose {
    let mut place = || draw.between(-off, off) / FOCAL;
    let place = DVec2::new(place(), place());
    CropPose {
        rotation: rotation(draw),
        size: libm::log(draw.between(0.45, 0.65)),
        place,
        distance: draw.between(-0.9, 0.3),
    }
}

const FOCAL: f64 = 60.0;

/// A grid that holds no evidence.
fn empty_grid(width: usize, height: usize) -> CropGrid {
    let cells = width * height;
    CropGrid {
        width,
        height,
        focal: FOCAL,
        center: [0.5 * width as f64 - 0.5, 0.5 * height as f64 - 0.5],
        cell: [1.0; 2],
        corner: [0.0; 2],
        mask: vec![false; cells],
        mask_cells: 0,
        depth_cells: 0,
        depth: vec![0.0; cells],
        normals: [0, 1, 2].map(|_| vec![0.0; cells]),
        scene: vec![0.0; cells],
        known: 0.0,
        outline: vec![0.0; cells],
        bounds: [[0.0, width as f64], [0.0, height as f64]],
    }
}

/// Evidence that is the picture of `pose` with faults: the mask differs at its rim, depths and normals are off or
/// missing, something nearer stands before one side, and some cells have no reading at all. The outline is a quadratic
/// over the grid, of which central differences are exact.
pub fn noisy_grid(draw: &mut Draw, model: &Model, pose: &CropPose, scoring: &Scoring) -> CropGrid {
    let mut grid = empty_grid(WIDTH, HEIGHT);
    let mut canvas = Canvas::default();
    canvas.draw(model, pose, &grid);
    let coefficients: [f64; 6] = core::array::from_fn(|_| draw.between(-1.0, 1.0));
    let occluder = draw.below(WIDTH);
    let z_m = libm::exp(pose.distance);
    for v in 0..HEIGHT {
        for u in 0..WIDTH {
            let i = v * WIDTH + u;
            let w = canvas.inverse_depth[i];
            grid.mask[i] = (w > 0.0) != (draw.below(12) == 0);
            if grid.mask[i] && draw.below(5) > 0 {
                let z = if w > 0.0 { f64::from(1.0 / w) } else { z_m };
                // From hardly off to far off.
                let off = f64::from(scoring.depth_m) * draw.normal() * [0.05, 0.6, 4.0][draw.below(3)];
                grid.depth[i] = (z + off) as f32;
                if w > 0.0 && draw.below(5) > 0 {
                    let normal = facing(&canvas, model, &grid, u, v);
                    let turn = exp(DVec3::from(<[f64; 3]>::from(draw.direction())) * draw.between(0.0, 0.7));
                    let turned = (turn * normal.as_dvec3()).as_vec3().to_array();
                    grid.normals.iter_mut().zip(turned).for_each(|(axis, x)| axis[i] = x);
                }
            }
            grid.scene[i] = match draw.below(6) {
                0 => 0.0,
                1..4 if u < occluder => (z_m * draw.between(0.3, 0.6)) as f32,
                _ => (z_m * draw.between(0.9, 1.6)) as f32,
            };
            let (x, y) = (u as f64 / 20.0 - 1.4, v as f64 / 20.0 - 1.1);
            let terms = [1.0, x, y, x * x, x * y, y * y];
            grid.outline[i] = (3.0 * terms.iter().zip(coefficients).map(|(t, c)| t * c).sum::<f64>()) as f32;
        }
    }
    // Between a depth map without background and a complete one.
    grid.known = draw.between(0.0, 0.5) as f32;
    grid.mask_cells = grid.mask.iter().filter(|set| **set).count();
    grid
}

/// The normal of what is drawn in a cell, towards the camera.
pub fn facing(canvas: &Canvas, model: &Model, grid: &CropGrid, u: usize, v: usize) -> Vec3 {
    let normal = canvas.rotation * model.normals[canvas.triangle[v * grid.width + u] as usize];
    if normal.dot(grid.ray(u as f32, v as f32)) > 0.0 { -normal } else { normal }
}

pub fn scoring() -> Scoring {
    let weights =
        Weights { overlap: 0.3, depth: 1.1, normals: 0.4, outline: 0.7, occluded: 0.2, unknown: 0.1, silhouette: 1.0 };
    Scoring { weights, depth_m: 0.03, occluder_m: 0.04, outline_cells: 1.7 }
}

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
            let seen = grid.normal_at(i).as_dvec3();
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

#[wasm_bindgen_test]
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
