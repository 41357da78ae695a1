//! The voxel grid against maps of cells, and what it does at the edges of f32.

use std::collections::BTreeMap;

use sim3align::geometry::voxel_grid::voxel_downsample;

use crate::prelude::*;

/// The same in a map from cell to members, with means in f64.
fn naive(cloud: &Cloud, voxel_size: f32) -> Vec<(DVec3, DVec3)> {
    let min = |axis: usize| cloud.points.iter().map(|p| p[axis]).fold(f32::INFINITY, f32::min);
    let min = [min(0), min(1), min(2)];
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for (i, p) in cloud.points.iter().enumerate() {
        cells.entry([0, 1, 2].map(|a| ((p[a] - min[a]) / voxel_size).floor() as i64)).or_default().push(i);
    }
    let mean = |of: &[Vec3], members: &[usize]| {
        members.iter().map(|&i| of[i].as_dvec3()).sum::<DVec3>() / members.len() as f64
    };
    cells.values().map(|m| (mean(&cloud.points, m), mean(&cloud.normals, m).normalize_or_zero())).collect()
}

#[wasm_bindgen_test(unsupported = test)]
fn cells_and_means_are_those_of_a_map() {
    for seed in 0..10 {
        let mut draw = Draw::new(seed);
        let similarity = draw.similarity([0.01, 100.0], 100.0);
        for cloud in [blob(&mut draw, 2000), mug(&mut draw, 500)] {
            let cloud = transformed(&cloud, &similarity);
            let mut sizes = Vec::new();
            for size in [0.03, 0.11, 0.5, 1.7].map(|s| (s * similarity.scale) as f32) {
                let (found, expected) = (voxel_downsample(&cloud, size), naive(&cloud, size));
                assert_eq!(found.points.len(), expected.len(), "seed {seed}, size {size}");
                assert_eq!(found.normals.len(), expected.len(), "seed {seed}, size {size}");
                for ((p, n), (q, m)) in found.points.iter().zip(&found.normals).zip(expected) {
                    // Two roundings at the size of the coordinates.
                    let tolerance = 3e-7 * q.length();
                    assert!(p.as_dvec3().distance(q) <= tolerance, "seed {seed}, size {size}: {p} for {q}");
                    assert!(n.as_dvec3().distance(m) < 1e-5, "seed {seed}, size {size}: normal {n} for {m}");
                }
                sizes.push(found.len());
            }
            assert!(sizes.is_sorted_by(|a, b| a > b), "seed {seed}: {sizes:?}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn the_result_moves_with_the_cloud() {
    // On multiples of 2⁻¹⁰ a shift by whole numbers, and the means of two, four or eight points, are exact.
    let mut draw = Draw::new(3);
    let points: Vec<Vec3> =
        (0..400).map(|_| Vec3::from_array([0; 3].map(|_| draw.below(1024) as f32 / 1024.0))).collect();
    let shift = Vec3::new(64.0, -32.0, 128.0);
    let moved: Vec<Vec3> = points.iter().map(|&p| p + shift).collect();
    let here = voxel_downsample(&Cloud::from_points(points), 0.0625);
    let there = voxel_downsample(&Cloud::from_points(moved), 0.0625);
    assert!(here.len() > 300 && here.len() < 400, "{}", here.len());
    assert_eq!(here.len(), there.len());
    for (p, q) in here.points.iter().zip(&there.points) {
        assert!((p + shift).distance(*q) < 2e-5, "{p} {q}");
    }
    assert!(here.normals.is_empty());
}

#[wasm_bindgen_test(unsupported = test)]
fn one_cell_holds_everything_that_fits() {
    let cloud = blob(&mut Draw::new(4), 100);
    let one = voxel_downsample(&cloud, 100.0);
    let mean = cloud.points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / 100.0;
    assert_eq!(one.len(), 1);
    assert!(one.points[0].as_dvec3().distance(mean) < 1e-6);

    let single = Cloud { points: vec![Vec3::new(1e6, -2.0, 3e-5)], normals: vec![Vec3::Y] };
    assert_eq!(voxel_downsample(&single, 0.1), single);
    let equal = Cloud::from_points(vec![Vec3::new(0.1, 0.2, 0.3); 7]);
    assert_eq!(voxel_downsample(&equal, 1e-6).points, [Vec3::new(0.1, 0.2, 0.3)]);
    assert_eq!(voxel_downsample(&Cloud::default(), 0.1), Cloud::default());
}

#[wasm_bindgen_test(unsupported = test)]
fn opposite_normals_leave_none() {
    let cloud = Cloud { points: vec![Vec3::ZERO, Vec3::X * 0.1], normals: vec![Vec3::Z, -Vec3::Z] };
    assert_eq!(voxel_downsample(&cloud, 1.0).normals, [Vec3::ZERO]);
}

#[wasm_bindgen_test(unsupported = test)]
fn cells_beyond_the_last_are_the_last() {
    // 10³⁰ cells of 1 mm along an axis: more than any integer holds.
    let points = [0.0, 0.5e-3, 1e30, 2e30].map(|x| Vec3::new(x, 0.0, 0.0));
    let found = voxel_downsample(&Cloud::from_points(points.to_vec()), 1e-3);
    assert_eq!(found.len(), 2);
    assert_eq!(found.points[0], Vec3::X * 0.25e-3);
    assert!((found.points[1].x / 1.5e30 - 1.0).abs() < 1e-6);
    let largest = Cloud::from_points(vec![Vec3::splat(f32::MIN), Vec3::ZERO, Vec3::splat(f32::MAX)]);
    assert_eq!(voxel_downsample(&largest, f32::MIN_POSITIVE).points[0], Vec3::splat(f32::MIN));
}

#[wasm_bindgen_test(unsupported = test)]
fn sizes_that_are_none_leave_the_cloud() {
    let cloud = blob(&mut Draw::new(5), 20);
    for size in [0.0, -1.0, f32::NAN] {
        assert_eq!(voxel_downsample(&cloud, size), cloud);
    }
    // Fewer normals than points: the others have none to give.
    let short = Cloud { normals: vec![Vec3::Z], ..cloud };
    assert_eq!(voxel_downsample(&short, 0.01).len(), 20);
}
