//! The evidence of `precise`: the cleaned observation, and its grids, pixel by pixel.

use crate::prelude::*;
use crate::shapes::view;

const WIDTH: usize = 120;
const HEIGHT: usize = 90;

/// Pixels that are not square.
fn camera() -> Pinhole {
    Pinhole::new(150.0, 130.0, 57.3, 46.1).unwrap()
}

fn observation(mask: impl Fn(usize, usize) -> bool, depth: impl Fn(usize, usize) -> f32) -> Observation {
    seen_by(camera(), mask, depth)
}

fn seen_by(camera: Pinhole, mask: impl Fn(usize, usize) -> bool, depth: impl Fn(usize, usize) -> f32) -> Observation {
    view(camera, [WIDTH, HEIGHT], mask, depth).unwrap()
}

/// Discs that overlap: one connected mask without holes.
fn blob(draw: &mut Draw) -> impl Fn(usize, usize) -> bool + use<> {
    let discs: Vec<[f64; 3]> = (0..4)
        .map(|_| [60.0 + draw.between(-12.0, 12.0), 45.0 + draw.between(-9.0, 9.0), draw.between(12.0, 18.0)])
        .collect();
    move |u, v| {
        let inside = |disc: &[f64; 3]| DVec2::new(u as f64 - disc[0], v as f64 - disc[1]).length() < disc[2];
        discs.iter().any(inside)
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_outline_is_the_distance_to_the_rim_of_the_mask() {
    for seed in 0..3 {
        let mask = blob(&mut Draw::new(seed));
        // A wall without an edge: the depth has no outline of its own.
        let clean = CleanObservation::new(&observation(&mask, |u, v| 0.5 + 1e-4 * (u % 3 + v % 2) as f32));
        assert_eq!(clean.rim_offset, 0.0, "seed {seed}");
        let pixels: Vec<(usize, usize)> = (0..WIDTH * HEIGHT).map(|i| (i % WIDTH, i / WIDTH)).collect();
        let (inside, outside): (Vec<_>, Vec<_>) = pixels.into_iter().partition(|&(u, v)| mask(u, v));
        assert_eq!(clean.pixels, inside.len(), "seed {seed}");
        let nearest = |to: &[(usize, usize)], u: usize, v: usize| {
            let squared = to.iter().map(|&(x, y)| (x.abs_diff(u).pow(2) + y.abs_diff(v).pow(2)) as f64);
            squared.fold(f64::INFINITY, f64::min).sqrt()
        };
        for (i, found) in clean.outline.iter().enumerate() {
            let (u, v) = (clean.origin[0] + i % clean.width, clean.origin[1] + i / clean.width);
            let expected = if mask(u, v) { 0.5 - nearest(&outside, u, v) } else { nearest(&inside, u, v) - 0.5 };
            assert!((f64::from(*found) - expected).abs() < 1e-5, "seed {seed}, ({u}, {v}): {found} for {expected}");
        }
        for (axis, at) in
            [(0, inside.iter().map(|p| p.0).collect::<Vec<_>>()), (1, inside.iter().map(|p| p.1).collect())]
        {
            let bounds = [*at.iter().min().unwrap() as f64, *at.iter().max().unwrap() as f64];
            assert_eq!(clean.bounds[axis], bounds, "seed {seed}");
        }
    }
}

/// Depths that are not the object's own: near the rim of the mask, beside a jump, and background that the mask holds.
#[wasm_bindgen_test(unsupported = test)]
fn doubtful_depths_are_left_out_and_all_others_stay() {
    for seed in 0..6 {
        let draw = &mut Draw::new(seed);
        let mask = |u: usize, v: usize| (30..90).contains(&u) && (20..70).contains(&v);
        let flying: Vec<(usize, usize)> = (0..6).map(|_| (34 + draw.below(52), 24 + draw.below(42))).collect();
        let holes: Vec<(usize, usize)> = (0..6).map(|_| (34 + draw.below(52), 24 + draw.below(42))).collect();
        let background = |u: usize, v: usize| (50..62).contains(&u) && (30..42).contains(&v);
        let scene = |u: usize, v: usize| match (u, v) {
            at if holes.contains(&at) => 0.0,
            // The object is 20 cm wide, and a jump of 3 cm none of its own.
            at if flying.contains(&at) => 0.53,
            (u, v) if mask(u, v) && !background(u, v) => 0.5 + 1e-3 * (u % 4) as f32,
            _ => 2.0,
        };
        let clean = CleanObservation::new(&observation(mask, scene));
        assert_eq!(clean.pixels, 60 * 50, "seed {seed}: the rim is right");
        let around = |u: usize, v: usize| (v - 1..=v + 1).flat_map(move |y| (u - 1..=u + 1).map(move |x| (x, y)));
        let mut kept = Vec::new();
        for (i, found) in clean.depth.iter().enumerate() {
            let (u, v) = (clean.origin[0] + i % clean.width, clean.origin[1] + i / clean.width);
            assert_eq!(clean.scene[i], scene(u, v), "seed {seed}: every reading is part of the scene");
            let inner = (32..88).contains(&u) && (22..68).contains(&v);
            let own = |(u, v)| scene(u, v) == 0.0 || scene(u, v) < 0.51;
            let expected = if inner && around(u, v).all(own) { scene(u, v) } else { 0.0 };
            assert_eq!(*found, expected, "seed {seed}, ({u}, {v})");
            kept.extend((expected > 0.0).then_some(expected));
        }
        kept.sort_by(f32::total_cmp);
        assert_eq!(clean.median_m, f64::from(kept[kept.len() / 2]), "seed {seed}");
        // 56 × 46 pixels, less half a percent at either end.
        let diagonal = 0.5 * DVec2::new(55.0 * 0.99 / 150.0, 45.0 * 0.99 / 130.0).length();
        assert!((clean.diagonal_m / diagonal - 1.0).abs() < 0.03, "seed {seed}: {} for {diagonal}", clean.diagonal_m);
    }
}

/// A plate before a wall, as sensors see it and as a network predicts it, whose edges are ramps.
#[wasm_bindgen_test(unsupported = test)]
fn readings_on_ramps_are_left_out() {
    const STEP: f64 = 0.07;
    let mask = |u: usize, v: usize| (30..90).contains(&u) && (20..70).contains(&v);
    // Readings amid two sides, and the largest share of the step that one of them has made.
    let kept = |sigma: f64| {
        let below = |x: f64| 0.5 * (1.0 + libm::erf(x / (sigma * 2f64.sqrt())));
        let within = |x: f64, [low, high]: [f64; 2]| below(x - low) - below(x - high);
        let share = |u: usize, v: usize| 1.0 - within(u as f64, [29.5, 89.5]) * within(v as f64, [19.5, 69.5]);
        let scene = |u: usize, v: usize| (0.5 + STEP * share(u, v) + 1e-4 * ((u + v) % 2) as f64) as f32;
        let clean = CleanObservation::new(&observation(mask, scene));
        let at = |i: usize| (clean.origin[0] + i % clean.width, clean.origin[1] + i / clean.width);
        let amid = clean.depth.iter().enumerate().filter(|(i, z)| **z > 0.0 && (40..50).contains(&at(*i).1));
        let shares: Vec<f64> = amid.map(|(i, _)| share(at(i).0, at(i).1)).collect();
        (shares.len(), shares.into_iter().fold(0.0, f64::max))
    };
    // Two pixels at either side, and none on a step.
    assert_eq!(kept(0.01), (10 * 56, 0.0));
    // Beyond 0.6 of a ramp, which is 2.5 deviations of a normal distribution wide. The slope of what is left at its foot is
    // that of a surface: without the ramp, a sixth of the step would remain.
    let (count, most) = kept(2.5);
    assert!(most < 0.09 && count >= 10 * 52, "{count} with {most}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_object_is_where_most_readings_of_one_depth_are() {
    // Bands of a mask that holds more background than object; the median of all is 1.2 m.
    let mask = |u: usize, v: usize| (30..90).contains(&u) && (20..70).contains(&v);
    let scene = |u: usize, v: usize| match u {
        _ if !mask(u, v) => 0.0,
        30..54 => 0.5,
        54..72 => 1.2,
        _ => 2.0,
    };
    let clean = CleanObservation::new(&observation(mask, scene));
    assert_eq!(clean.median_m, 0.5);
    assert!(clean.depth.iter().all(|z| [0.0, 0.5].contains(z)), "background is taken for the object");
    // Two pixels at three sides, and one beside the background.
    assert_eq!(clean.depth.iter().filter(|z| **z > 0.0).count(), 21 * 46);
}

/// A slanted plane, seen in a mask of this size in a large image.
fn large([wide, high]: [usize; 2], is_set: impl Fn(usize, usize) -> bool) -> (Observation, impl Fn(Vec3) -> f64) {
    let camera = Pinhole::new(3000.0, 2900.0, 700.3, 540.1).unwrap();
    // n·p = 1 on the plane.
    let depth_at = |ray: Vec3| 1.0 / ray.as_dvec3().dot(DVec3::new(0.8, -0.5, 1.2));
    let depth = |u, v| depth_at(camera.back_project(u as f64, v as f64, 1.0)) as f32;
    let inside = |u, v| (40..40 + wide).contains(&u) && (40..40 + high).contains(&v) && is_set(u, v);
    (view(camera, [1502, 1101], inside, depth).unwrap(), depth_at)
}

/// Thinned observations show the same surface in the same place: the plane is off by .3 mm for a pixel.
#[wasm_bindgen_test(unsupported = test)]
fn large_masks_are_thinned_without_moving() {
    for (size, step) in [([500, 700], 1), ([900, 600], 2), ([1400, 1000], 3)] {
        let (observation, depth_at) = large(size, |_, _| true);
        let clean = CleanObservation::new(&observation);
        let pixels = clean.pixels * step * step;
        let expected = observation.mask().data().iter().filter(|m| **m != 0).count();
        assert!(pixels.abs_diff(expected) * 50 < expected, "{pixels} for {expected} pixels");
        assert_eq!(clean.image, [1502.0, 1101.0].map(|side| side / step as f64));
        let grid = CropGrid::new(&clean, 3000);
        let cells = (0..grid.width * grid.height).filter(|&i| grid.depth[i] > 0.0 && grid.outline[i] < -2.0);
        let errors = cells.map(|i| {
            let ray = grid.ray((i % grid.width) as f32, (i / grid.width) as f32);
            f64::from(grid.depth[i]) - depth_at(ray)
        });
        let (count, sum, worst) =
            errors.fold((0, 0.0, 0.0f64), |(n, sum, worst), e| (n + 1, sum + e, worst.max(e.abs())));
        assert!(count > 2000, "{size:?}: {count} cells");
        // Within a cell, the samples are those of the nearest pixels.
        let cell_m = grid.cell[0] * 0.3e-3;
        assert!((sum / f64::from(count)).abs() < 3e-5, "{size:?}: {} m", sum / f64::from(count));
        assert!(worst < 0.2 * cell_m * step as f64, "{size:?}: {worst} m in cells of {cell_m} m");
    }
    // Every second row and column of this mask has all of its pixels, or none.
    let (observation, _) = large([1400, 1000], |u, v| u % 2 == 0 && v % 2 == 0 || u % 97 == 0);
    assert_eq!(CleanObservation::new(&observation).image, [1502.0, 1101.0]);
}

/// Two specks in opposite corners of an image that is larger than 4K.
#[wasm_bindgen_test(unsupported = test)]
fn specks_that_are_far_apart_are_thinned_as_well() {
    let (width, height) = (4096, 2100);
    let speck = |u: usize, v: usize| {
        u.min(width - 1 - u) < 40 && v.min(height - 1 - v) < 40 && (2 * u < width) == (2 * v < height)
    };
    let camera = Pinhole::new(4000.0, 4000.0, 2048.0, 1050.0).unwrap();
    let observation = view(camera, [width, height], speck, |u, v| 1.0 + 1e-3 * ((u + v) % 5) as f32);
    assert_eq!(CleanObservation::new(&observation.unwrap()).image, [2048.0, 1050.0]);
}

/// A mask at the image's left border, and depths with holes.
fn at_the_border(draw: &mut Draw) -> CleanObservation {
    let holes: Vec<usize> = (0..900).map(|_| draw.below(WIDTH * HEIGHT)).collect();
    let mask = |u: usize, v: usize| DVec2::new(u as f64 - 14.0, v as f64 - 40.0).length() < 22.0;
    CleanObservation::new(&observation(mask, |u, v| match v * WIDTH + u {
        i if holes.contains(&i) => 0.0,
        i if mask(u, v) => 0.5 + 1e-5 * i as f32 % 0.01,
        _ => 0.9,
    }))
}

#[wasm_bindgen_test(unsupported = test)]
fn a_cell_is_the_mean_of_its_samples() {
    let mut outside_cells = 0;
    for seed in 0..3 {
        let clean = at_the_border(&mut Draw::new(seed));
        for cells in [100, 333, 900, 100_000] {
            let grid = CropGrid::new(&clean, cells);
            let what = format!("seed {seed}, {cells} cells");
            assert!((grid.cell[1] / grid.cell[0] - 130.0 / 150.0).abs() < 1e-12, "{what}: square in ray space");
            let pitch = (clean.pixels as f64 / cells as f64).sqrt().max(1.0);
            assert!((grid.cell[0] - pitch).abs() < 1e-12, "{what}");
            let samples = (pitch.round() as usize).clamp(1, 4);
            for i in 0..grid.mask.len() {
                let at = [i % grid.width, i / grid.width];
                // The pixel that holds each sample.
                let pixel = |axis: usize, k: usize| {
                    let x = at[axis] as f64 + (k as f64 + 0.5) / samples as f64;
                    (grid.corner[axis] + x * grid.cell[axis]).floor() as i64
                };
                let (mut outline, mut depths, mut scene, mut outside) = (0.0, Vec::new(), Vec::new(), 0);
                for (u, v) in (0..samples)
                    .flat_map(|y| (0..samples).map(move |x| (x, y)))
                    .map(|(x, y)| (pixel(0, x), pixel(1, y)))
                {
                    let is_outside = u < 0 || v < 0 || u >= WIDTH as i64 || v >= HEIGHT as i64;
                    outside += usize::from(is_outside);
                    let (x, y) = (u - clean.origin[0] as i64, v - clean.origin[1] as i64);
                    let (near_x, near_y) = (x.clamp(0, clean.width as i64 - 1), y.clamp(0, clean.height as i64 - 1));
                    let j = near_y as usize * clean.width + near_x as usize;
                    let beyond = DVec2::new((x - near_x) as f64, (y - near_y) as f64).length();
                    outline += f64::from(clean.outline[j]) + beyond;
                    if beyond == 0.0 {
                        depths.extend((clean.depth[j] > 0.0).then_some(f64::from(clean.depth[j])));
                        scene.extend((clean.scene[j] > 0.0).then_some(f64::from(clean.scene[j])));
                    }
                }
                let total = samples * samples;
                let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
                let distance = outline / total as f64;
                let is_mask = distance < 0.0 && 2 * outside <= total;
                let what = format!("{what}, cell {at:?}");
                // Rounding tells about cells right on the outline.
                assert!(grid.mask[i] == is_mask || distance.abs() < 1e-5, "{what}");
                assert!((f64::from(grid.outline[i]) - distance / pitch - 0.5).abs() < 1e-4, "{what}");
                let known = is_mask && depths.len() as f64 >= 0.34 * total as f64;
                let close = |found: f32, expected: f64| (f64::from(found) - expected).abs() < 1e-6;
                assert!(
                    close(grid.depth[i], if known { mean(&depths) } else { 0.0 }),
                    "{what}: depth {}",
                    grid.depth[i]
                );
                let is_outside = 2 * outside > total;
                let expected = match scene.is_empty() {
                    _ if is_outside => 1e-6,
                    true => 0.0,
                    false => mean(&scene),
                };
                assert!(close(grid.scene[i], expected), "{what}: scene {} for {expected}", grid.scene[i]);
                outside_cells += usize::from(is_outside);
            }
            let set = || (0..grid.mask.len()).filter(|&i| grid.mask[i]).map(|i| [i % grid.width, i / grid.width]);
            assert_eq!(grid.mask_cells, set().count(), "{what}");
            for axis in 0..2 {
                let along = || set().map(|at| at[axis] as f64);
                let bounds = [along().fold(f64::INFINITY, f64::min) - 0.5, along().fold(0.0, f64::max) + 0.5];
                assert_eq!(grid.bounds[axis], bounds, "{what}");
            }
        }
    }
    assert!(outside_cells > 100, "{outside_cells}");
}

#[wasm_bindgen_test(unsupported = test)]
fn the_ray_of_a_cell_is_that_of_its_place_in_the_image() {
    let clean = at_the_border(&mut Draw::new(1));
    for cells in [100, 900] {
        let grid = CropGrid::new(&clean, cells);
        for (u, v) in [(0, 0), (grid.width - 1, 3), (7, grid.height - 1)] {
            // The corner of the grid is the outer edge of its first pixel.
            let place = |axis: usize, i: usize| grid.corner[axis] - 0.5 + (i as f64 + 0.5) * grid.cell[axis];
            let image = [place(0, u), place(1, v)];
            let expected = DVec3::new((image[0] - 57.3) / 150.0, (image[1] - 46.1) / 130.0, 1.0);
            let found = grid.ray(u as f32, v as f32).as_dvec3();
            assert!((found - expected).length() < 1e-5, "{cells} cells, ({u}, {v}): {found} for {expected}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_normals_of_a_plane_are_its_own_and_face_the_camera() {
    for seed in 0..8 {
        let draw = &mut Draw::new(seed);
        let normal = DVec3::new(draw.between(-0.6, 0.6), draw.between(-0.6, 0.6), -1.0).normalize();
        // Square pixels, of which every cell holds as many.
        let camera = Pinhole { fy: 150.0, ..camera() };
        let plane = |u: usize, v: usize| {
            let ray = DVec3::new((u as f64 - camera.cx) / camera.fx, (v as f64 - camera.cy) / camera.fy, 1.0);
            (0.6 * normal.z / normal.dot(ray)) as f32
        };
        let clean = CleanObservation::new(&seen_by(camera, blob(draw), plane));
        // Cells of a pixel, and of more, whose samples are not spread evenly.
        for (cells, tolerance_deg) in [(100_000, 0.2), (400, 8.0)] {
            let grid = CropGrid::new(&clean, cells);
            let (mut fitted, mut whole, mut sum) = (0, 0, DVec3::ZERO);
            for i in 0..grid.normals.len() {
                let (u, v) = (i % grid.width, i / grid.width);
                let inner = u > 0 && v > 0 && u + 1 < grid.width && v + 1 < grid.height;
                let readings = || {
                    let near = (v - 1..=v + 1).flat_map(|y| (u - 1..=u + 1).map(move |x| y * grid.width + x));
                    near.filter(|&j| grid.depth[j] > 0.0).count()
                };
                let found = grid.normals[i].as_dvec3();
                if !(inner && grid.depth[i] > 0.0 && readings() >= 5) {
                    assert_eq!(found, DVec3::ZERO, "seed {seed}, {cells} cells, ({u}, {v})");
                    continue;
                }
                fitted += 1;
                let off = found.angle_between(normal).to_degrees();
                // Cells at the rim average the part of them that has readings.
                let is_whole = grid.outline[i] < -4.0;
                if is_whole {
                    whole += 1;
                    sum += found;
                }
                assert!(
                    off < if is_whole { tolerance_deg } else { 25.0 },
                    "seed {seed}, {cells} cells, ({u}, {v}): {found} is {off}° off {normal}"
                );
            }
            assert!(2 * fitted > grid.mask_cells, "seed {seed}, {cells} cells: {fitted} of {}", grid.mask_cells);
            assert!(whole > 15, "seed {seed}, {cells} cells: {whole}");
            let off = sum.angle_between(normal).to_degrees();
            assert!(off < 1.0, "seed {seed}, {cells} cells: their mean is {off}° off");
        }
    }
}
