//! The kd-tree against brute force: to the bit, ties included.

use sim3align::geometry::kd_tree::Neighbor;
use sim3align::geometry::order::{index_of, value_of};

use crate::prelude::*;

/// Distributions that trees stumble over. The first six hold 300 points.
fn distributions(draw: &mut Draw) -> Vec<(&'static str, Vec<Vec3>)> {
    let n = 300;
    let mut normals = || {
        let d = draw.direction();
        Vec3::new(d.x as f32, d.y as f32, d.z as f32)
    };
    let sphere = (0..n).map(|_| normals()).collect();
    let uniform = draw.points(n, 1.0);
    let far = uniform.iter().map(|&p| p + Vec3::new(1e6, -1e6, 1e6)).collect();
    let clusters = (0..n).map(|i| uniform[i] * 1e-3 + if i % 2 == 0 { Vec3::splat(5.0) } else { Vec3::ZERO }).collect();
    let mut grid = |edge: usize| (0..n).map(|_| Vec3::from_array([0; 3].map(|_| draw.below(edge) as f32))).collect();
    let (grid, coarse_grid): (Vec<Vec3>, Vec<Vec3>) = (grid(6), grid(2));
    let mut all = vec![
        ("sphere", sphere),
        ("uniform", uniform.clone()),
        ("far", far),
        ("clusters", clusters),
        ("grid", grid),
        ("coarse grid", coarse_grid),
        ("equal", vec![Vec3::new(0.5, -0.25, 3.0); 40]),
        ("line", (0..n).map(|i| Vec3::new(0.0, i as f32 * 0.01, 0.0)).collect()),
        ("diagonal", uniform.iter().map(|p| Vec3::ONE * p.x).collect()),
        ("mixed magnitudes", (0..n).map(|i| uniform[i] * libm::expf((i % 40) as f32 - 20.0)).collect()),
    ];
    for (name, count) in [("0", 0), ("1", 1), ("5", 5), ("8", 8), ("9", 9), ("10", 10), ("17", 17)] {
        all.push((name, uniform[..count].to_vec()));
    }
    all
}

const QUERIES: [&str; 4] = ["near", "on points", "far away", "between points"];

fn queries(kind: usize, points: &[Vec3], draw: &mut Draw) -> Vec<Vec3> {
    let Some(&first) = points.first() else { return draw.points(4, 1.0 + kind as f64) };
    let spread = points.iter().map(|p| p.distance(first)).fold(1e-3, f32::max);
    let mut pick = || points[draw.below(points.len())];
    let (mut picked, others): (Vec<Vec3>, Vec<Vec3>) =
        ((0..12).map(|_| pick()).collect(), (0..12).map(|_| pick()).collect());
    match kind {
        0 => picked.iter_mut().for_each(|p| *p += draw.points(1, 0.1)[0] * spread),
        1 => {}
        2 => picked.iter_mut().for_each(|p| *p += (draw.points(1, 1.0)[0] + Vec3::X * 3.0) * spread * 100.0),
        // Halfway: on a grid as far from one as from the other.
        _ => picked.iter_mut().zip(others).for_each(|(p, q)| *p = (*p + q) * 0.5),
    }
    picked
}

/// All points, nearest first, ties to the smaller index.
fn sorted_by_distance(points: &[Vec3], query: Vec3) -> Vec<Neighbor> {
    let mut all: Vec<Neighbor> = points
        .iter()
        .zip(0..)
        .map(|(p, index)| Neighbor { index, distance_squared: p.distance_squared(query) })
        .collect();
    all.sort_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.index.cmp(&b.index)));
    all
}

/// The answers of one operation for one query: from the tree, and by brute force. `reach` is a radius worth asking for.
fn answer(operation: usize, tree: &KdTree, all: &[Neighbor], query: Vec3, reach: f32) -> [Vec<Neighbor>; 2] {
    let mut found = Vec::new();
    // Where a radius is certain to reach the nearest, nearest_within is nearest.
    let radius = [0.0, 0.3, 0.8, 0.0, 0.3, 1.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0][operation] * reach;
    let inside = |n: &&Neighbor| n.distance_squared <= radius * radius;
    match operation {
        0..=2 => {
            found.extend(tree.nearest_within(query, radius));
            [found, all.iter().find(inside).copied().into_iter().collect()]
        }
        7..=10 => {
            let count = [2, 5, 9, all.len() + 3][operation - 7];
            tree.k_nearest(query, count, &mut found);
            [found, all[..count.min(all.len())].to_vec()]
        }
        3..=6 => {
            tree.within(query, radius, &mut found);
            found.sort_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.index.cmp(&b.index)));
            [found, all.iter().filter(inside).copied().collect()]
        }
        _ => [tree.nearest(query).into_iter().collect(), all.first().copied().into_iter().collect()],
    }
}

const OPERATIONS: usize = 12;

#[wasm_bindgen_test(unsupported = test)]
fn answers_are_those_of_brute_force() {
    for seed in 0..3 {
        let mut draw = Draw::new(seed);
        let mut cells = Vec::new();
        for (d, (name, points)) in distributions(&mut draw).into_iter().enumerate() {
            let tree = KdTree::new(&points);
            assert_eq!((tree.len(), tree.is_empty()), (points.len(), points.is_empty()));
            for (kind, queried) in QUERIES.iter().enumerate() {
                let queries = queries(kind, &points, &mut draw);
                for operation in 0..OPERATIONS {
                    let mut fingerprint = Vec::new();
                    for &query in &queries {
                        let all = sorted_by_distance(&points, query);
                        // The fifth nearest's distance, so that ties and bounds fall on the radius itself.
                        let reach = all.get(4).map_or(1.0, |n| n.distance_squared.sqrt());
                        let [found, expected] = answer(operation, &tree, &all, query, reach);
                        assert_eq!(found, expected, "seed {seed}, {name}, {queried}, operation {operation}, {query}");
                        fingerprint.push(found);
                    }
                    cells.push(([d, kind, operation], fingerprint));
                }
            }
        }
        assert_no_dead_axis(["distribution", "query", "operation"], &cells);
    }
}

/// Visits of all points for each would be 4·10¹⁰.
#[wasm_bindgen_test(unsupported = test)]
fn of_many_coincident_points_a_search_visits_few() {
    let mut points = vec![Vec3::new(0.5, -0.25, 3.0); 200_000];
    points.push(Vec3::ZERO);
    let tree = KdTree::new(&points);
    let mut found = Vec::new();
    for query in [points[0], Vec3::ZERO, Vec3::new(1.0, 0.0, 3.0)].into_iter().cycle().take(points.len()) {
        let nearest = tree.nearest(query).unwrap();
        assert_eq!(nearest.index, if query == Vec3::ZERO { 200_000 } else { 0 });
        tree.k_nearest(query, 8, &mut found);
        assert_eq!(found.len(), 8);
        assert!(found.iter().map(|n| n.index).filter(|i| *i < 200_000).eq(0..if query == Vec3::ZERO { 7 } else { 8 }));
    }
    let mut visited = 0;
    tree.neighborhoods(&points, 8, f32::INFINITY, 1, |_, keys| {
        visited += 1;
        assert_eq!(keys.len(), 8);
    });
    assert_eq!(visited, points.len());
}

#[wasm_bindgen_test(unsupported = test)]
fn queries_that_are_no_point_find_nothing() {
    let points = Draw::new(1).points(100, 1.0);
    let tree = KdTree::new(&points);
    let mut found = vec![Neighbor { index: 7, distance_squared: 0.0 }];
    let nowhere = Vec3::new(0.0, f32::NAN, 0.0);
    assert_eq!(tree.nearest(nowhere), None);
    tree.within(nowhere, 10.0, &mut found);
    assert_eq!(found, []);
    tree.within(Vec3::ZERO, f32::NAN, &mut found);
    assert_eq!(found, []);
    tree.k_nearest(Vec3::ZERO, 0, &mut found);
    assert_eq!(found, []);
    // Whatever an infinite or overflowing query is told, it is told without a panic, and the next one is right.
    tree.k_nearest(Vec3::INFINITY, 3, &mut found);
    tree.k_nearest(nowhere, 3, &mut found);
    assert!(tree.nearest(Vec3::splat(f32::MAX)).is_some());
    assert_eq!(tree.nearest(points[42]).unwrap().index, 42);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_stride_visits_some_points_evenly_with_the_same_neighbours() {
    for (name, points) in distributions(&mut Draw::new(3)).into_iter().filter(|(_, points)| points.len() >= 200) {
        let tree = KdTree::new(&points);
        let mut all = vec![Vec::new(); points.len()];
        tree.neighborhoods(&points, 7, f32::INFINITY, 1, |index, keys| all[index as usize] = keys.to_vec());
        for stride in [2, 5] {
            let mut visited = 0;
            tree.neighborhoods(&points, 7, f32::INFINITY, stride, |index, keys| {
                visited += 1;
                assert_eq!(keys, all[index as usize], "{name}, stride {stride}, point {index}");
            });
            // Groups have six to twelve points.
            let share = (visited * stride) as f64 / points.len() as f64;
            assert!((0.5..=1.3).contains(&share), "{name}, stride {stride}: {visited} of {}", points.len());
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn shared_searches_find_what_single_ones_find() {
    for seed in 0..2 {
        for (name, points) in distributions(&mut Draw::new(seed)) {
            let tree = KdTree::new(&points);
            let near = points.first().zip(points.last()).map_or(0.0, |(a, b)| 0.3 * a.distance(*b));
            for k in [0, 1, 2, 7, 30, 299, 300, 1000] {
                for radius in [f32::INFINITY, near, 0.0] {
                    let mut visited = vec![false; points.len()];
                    let mut expected = Vec::new();
                    tree.neighborhoods(&points, k, radius, 1, |index, keys| {
                        let context = format!("seed {seed}, {name}, {k} within {radius} of point {index}");
                        assert!(!core::mem::replace(&mut visited[index as usize], true), "{context}: twice");
                        tree.k_nearest(points[index as usize], k, &mut expected);
                        expected.retain(|n| n.distance_squared <= radius * radius);
                        let mut keys = keys.to_vec();
                        keys.sort_unstable();
                        let found = keys.iter().map(|&key| (index_of(key), value_of(key)));
                        assert!(found.eq(expected.iter().map(|n| (n.index, n.distance_squared))), "{context}");
                    });
                    assert!(visited.iter().all(|v| *v), "seed {seed}, {name}");
                }
            }
        }
    }
}
