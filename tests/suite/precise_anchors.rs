//! The anchors of `precise`: where something nearer, or the image border, cuts the mask off.

use glam::DVec2;
use sim3align::precise::observed::anchors::{Anchor, anchors};
use sim3align::precise::observed::grid::CropGrid;
use wasm_bindgen_test::wasm_bindgen_test;

use crate::precise_scene::empty_grid;
use crate::support::Draw;

/// A square mask in the middle of a grid, half a metre away, with a wall behind it.
fn square() -> CropGrid {
    let (width, height, sides) = (70, 66, [[20, 50], [18, 48]]);
    let mut grid = empty_grid(width, height);
    for i in 0..width * height {
        let at = [i % width, i / width];
        let beyond = |axis: usize| {
            let [low, high] = sides[axis].map(|side| side as f64);
            let x = at[axis] as f64;
            (low - x).max(x - high)
        };
        let (x, y) = (beyond(0), beyond(1));
        grid.mask[i] = x <= 0.0 && y <= 0.0;
        grid.outline[i] = if grid.mask[i] { x.max(y) } else { DVec2::new(x.max(0.0), y.max(0.0)).length() } as f32;
        grid.depth[i] = if grid.mask[i] { 0.5 } else { 0.0 };
        grid.scene[i] = if grid.mask[i] { 0.5 } else { 0.9 };
    }
    grid.bounds = sides.map(|[low, high]| [low as f64 - 0.5, high as f64 + 0.5]);
    grid
}

/// The hypotheses that sides ask for, in any order.
fn expected_anchors(sides: &[[f64; 2]]) -> Vec<Anchor> {
    let mut expected: Vec<Anchor> = [1.0, 1.12].iter().map(|&zoom| Anchor { zoom, ..Anchor::AS_IT_IS }).collect();
    // Sizes of the sides along the other axis, where nothing cuts.
    for axis in [0, 1] {
        let others = sides.iter().filter(|_| sides.iter().all(|side| side[axis] == 0.0));
        expected.extend(others.map(|&towards| Anchor { along: Some(axis), zoom: 1.0, towards }));
    }
    for zoom in [1.25, 1.6] {
        let mut directions = vec![[0.0; 2]];
        directions.extend(sides);
        for a in sides.iter().filter(|side| side[0] != 0.0) {
            directions.extend(sides.iter().filter(|side| side[1] != 0.0).map(|b| [a[0], b[1]]));
        }
        expected.extend(directions.iter().map(|&towards| Anchor { zoom, towards, ..Anchor::AS_IT_IS }));
    }
    if sides.is_empty() { expected[..2].to_vec() } else { expected }
}

fn assert_same_anchors(grid: &CropGrid, sides: &[[f64; 2]], what: &str) {
    let found = anchors(grid, true);
    let expected = expected_anchors(sides);
    assert_eq!(found[0], Anchor::AS_IT_IS, "{what}");
    assert_eq!(found.len(), expected.len(), "{what}: {found:?}");
    assert!(expected.iter().all(|anchor| found.contains(anchor)), "{what}: {found:?} for {expected:?}");
    assert_eq!(anchors(grid, false), expected_anchors(&[]), "{what}: without occlusion");
}

const SIDES: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

#[wasm_bindgen_test(unsupported = test)]
fn the_mesh_may_stick_out_where_something_nearer_cuts_the_mask() {
    // What cuts: a board, and the image border, whose cells are next to no distance away.
    for scene in [0.35, 1e-6] {
        for subset in 0..16 {
            let mut grid = square();
            let sides: Vec<[f64; 2]> = (0..4).filter(|k| subset >> k & 1 == 1).map(|k| SIDES[k]).collect();
            for i in 0..grid.mask.len() {
                let from_middle = [(i % grid.width) as f64 - 35.0, (i / grid.width) as f64 - 33.0];
                // Before the middle third of the side.
                let cut = |side: &[f64; 2]| {
                    let across = from_middle[0] * side[0] + from_middle[1] * side[1];
                    let along = from_middle[0] * side[1] + from_middle[1] * side[0];
                    across > 15.0 && along.abs() <= 5.0
                };
                if sides.iter().any(cut) {
                    grid.scene[i] = scene;
                }
            }
            assert_same_anchors(&grid, &sides, &format!("{scene} m, sides {sides:?}"));
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_behind_or_beside_or_small_cuts_nothing() {
    let board = |grid: &mut CropGrid, scene: f32, half: f64| {
        for i in 0..grid.mask.len() {
            let (x, y) = ((i % grid.width) as f64 - 35.0, (i / grid.width) as f64 - 33.0);
            if x > 15.0 && y.abs() <= half {
                grid.scene[i] = scene;
            }
        }
    };
    // Half a metre less a hundredth of it, and less 4 % of the object's 31 cells' width: 1.53 cm.
    for (scene, half, cuts) in
        [(0.48, 5.0, true), (0.49, 5.0, false), (0.6, 5.0, false), (0.0, 5.0, false), (0.3, 1.0, false)]
    {
        let mut grid = square();
        board(&mut grid, scene, half);
        let sides: &[[f64; 2]] = if cuts { &SIDES[..1] } else { &[] };
        assert_same_anchors(&grid, sides, &format!("{scene} m, half {half} cells high"));
    }
    let mut grid = square();
    grid.depth.fill(0.0);
    board(&mut grid, 0.3, 5.0);
    assert_same_anchors(&grid, &[], "no depth of the object");
}

/// The rule itself, counted over boards at random.
#[wasm_bindgen_test(unsupported = test)]
fn sides_are_cut_where_enough_of_the_ring_is() {
    let mut found_sides = [0; 5];
    for seed in 0..150 {
        let draw = &mut Draw::new(seed);
        let mut grid = square();
        let (width, height) = (grid.width, grid.height);
        for _ in 0..1 + draw.below(3) {
            let [u, v] = [draw.below(width), draw.below(height)];
            let [columns, rows] = [6 + draw.below(22), 6 + draw.below(22)];
            let z = draw.between(0.4, 0.5) as f32;
            for (y, x) in (v..(v + rows).min(height)).flat_map(|y| (u..(u + columns).min(width)).map(move |x| (y, x))) {
                grid.scene[y * width + x] = z;
            }
        }
        // Depths that slope, with holes.
        for i in (0..grid.depth.len()).filter(|&i| grid.mask[i]) {
            let slope = 1.0 + 0.002 * (i % width) as f32;
            grid.depth[i] = if i % 17 == 3 { 0.0 } else { 0.47 * slope };
        }
        let mut depths: Vec<f32> = grid.depth.iter().copied().filter(|z| *z > 0.0).collect();
        depths.sort_by(f32::total_cmp);
        let depth = f64::from(depths[depths.len() / 2]);
        let tolerance = depth * (0.01 + 0.04 * 31.0 / grid.focal);
        let (mut ring, mut cut) = (0, Vec::new());
        for (u, v) in (0..height).flat_map(|v| (0..width).map(move |u| (u, v))) {
            let i = v * width + u;
            if !grid.mask[i] && grid.outline[i] <= 2.0 {
                ring += 1;
                let near =
                    (0..grid.depth.len()).filter(|j| (j % width).abs_diff(u) <= 2 && (j / width).abs_diff(v) <= 2);
                let deepest = near.map(|j| f64::from(grid.depth[j])).fold(0.0, f64::max);
                if deepest > 0.0 && f64::from(grid.scene[i]) < deepest - tolerance {
                    // Relative to half the box, and half a cell of the ring's two.
                    cut.push([(u as f64 - 35.0) / 16.5, (v as f64 - 33.0) / 16.5]);
                }
            }
        }
        let is_cut = |side: &&[f64; 2]| {
            let there = cut.iter().filter(|at| at[0] * side[0] + at[1] * side[1] > 0.45).count();
            40 * cut.len() >= ring && 5 * there > cut.len()
        };
        let sides: Vec<[f64; 2]> = SIDES.iter().filter(is_cut).copied().collect();
        found_sides[sides.len()] += 1;
        assert_same_anchors(&grid, &sides, &format!("seed {seed}"));
    }
    assert!(found_sides[..4].iter().all(|&count| count > 5), "{found_sides:?}");
}
