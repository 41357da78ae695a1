//! The kd-tree and the tree of triangles against brute force.

use sim3align::geometry::curve::along_curve;
use sim3align::geometry::kd_tree::{KdTree, Neighbor};
use sim3align::geometry::triangle_tree::TriangleTree;

use crate::prelude::*;
use crate::shapes::soup;

/// Distributions that trees stumble over. The first six hold 300 points.
fn distributions(draw: &mut Draw) -> Vec<(&'static str, Vec<Vec3>)> {
    let uniform = draw.points(300, 1.0);
    let of = |change: &dyn Fn(usize, Vec3) -> Vec3| (0..).zip(&uniform).map(|(i, p)| change(i, *p)).collect();
    let mut all: Vec<(&str, Vec<Vec3>)> = vec![
        ("sphere", of(&|_, p| p.normalize())),
        ("far", of(&|_, p| p + Vec3::new(1e6, -1e6, 1e6))),
        ("clusters", of(&|i, p| p * 1e-3 + Vec3::splat(5.0) * (i % 2) as f32)),
        ("grid", of(&|_, p| (p * 3.0).round())),
        ("coarse grid", of(&|_, p| p.round())),
        ("equal", vec![Vec3::new(0.5, -0.25, 3.0); 40]),
        ("line", of(&|i, _| Vec3::Y * i as f32 * 0.01)),
        ("diagonal", of(&|_, p| Vec3::ONE * p.x)),
        ("mixed magnitudes", of(&|i, p| p * libm::expf((i % 40) as f32 - 20.0))),
    ];
    let counts = [("0", 0), ("1", 1), ("5", 5), ("8", 8), ("9", 9), ("10", 10), ("17", 17), ("uniform", 300)];
    all.extend(counts.map(|(name, count)| (name, uniform[..count].to_vec())));
    all
}

/// The smaller distance first, ties to the smaller index.
fn sort_by_distance(list: &mut [Neighbor]) {
    list.sort_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.index.cmp(&b.index)));
}

#[wasm_bindgen_test]
fn neighbours_are_those_of_brute_force_to_the_bit() {
    for seed in 0..3 {
        let mut draw = Draw::new(seed);
        for (name, points) in distributions(&mut draw) {
            let tree = KdTree::new(&points);
            let mut queries = draw.points(4, 1.5);
            for _ in 0..points.len().min(6) {
                let [p, q] = [0; 2].map(|_| points[draw.below(points.len())]);
                // On a point, halfway between two, near one, and far from all.
                queries.extend([p, (p + q) * 0.5, p + draw.points(1, 0.1)[0] * p.distance(q), p + (q - p) * 300.0]);
            }
            for query in queries {
                let context = format!("seed {seed}, {name}, {query}");
                let distance =
                    |(p, index): (&Vec3, u32)| Neighbor { index, distance_squared: p.distance_squared(query) };
                let mut all: Vec<Neighbor> = points.iter().zip(0..).map(distance).collect();
                sort_by_distance(&mut all);
                assert_eq!(tree.nearest(query), all.first().copied(), "{context}");
                let mut found = Vec::new();
                // The fifth nearest's distance, so that ties and bounds fall on the radius itself.
                let reach = all.get(4).map_or(1.0, |n| n.distance_squared.sqrt());
                for radius in [0.0, 0.3, 0.8, 1.0, 3.0].map(|share| share * reach) {
                    let is_inside = |n: &Neighbor| n.distance_squared <= radius * radius;
                    let inside: Vec<Neighbor> = all.iter().copied().filter(is_inside).collect();
                    assert_eq!(
                        tree.nearest_within(query, radius),
                        inside.first().copied(),
                        "{context} within {radius}"
                    );
                    tree.within(query, radius, &mut found);
                    sort_by_distance(&mut found);
                    assert_eq!(found, inside, "{context} within {radius}");
                }
                for count in [0, 2, 5, 9, all.len() + 3] {
                    tree.k_nearest(query, count, &mut found);
                    assert_eq!(found, all[..count.min(all.len())], "{context}, {count} nearest");
                }
            }
        }
    }
}

/// Distance to the segments a + s(b − a) … a + s(c − a), minimised over s by trisection: the function is convex,
/// whatever the triangle's shape.
fn distance_by_search([a, b, c]: [DVec3; 3], query: DVec3) -> f64 {
    let at = |s: f64| {
        let (p, q) = (a.lerp(b, s), a.lerp(c, s));
        let length_squared = (q - p).length_squared();
        let t = if length_squared > 0.0 { ((query - p).dot(q - p) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        query.distance(p.lerp(q, t))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..90 {
        let (s, t) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if at(s) <= at(t) { high = t } else { low = s }
    }
    at(low).min(at(high)).min(at(0.0)).min(at(1.0))
}

/// Ordinary triangles, needles, points, duplicates and giants.
fn triangles(random: &mut Random, count: usize) -> Mesh {
    let mut vector = |size: f32| Vec3::from_array([0; 3].map(|_| (random.uniform() as f32 * 2.0 - 1.0) * size));
    let mut positions: Vec<Vec3> = Vec::new();
    for i in 0..count {
        let (a, u, v) = (vector(1.0), vector(0.4), vector(0.4));
        positions.extend(match i % 6 {
            0 => [a, a, a],
            1 => [a, a + u, a + u * 0.3],
            2 => [a, a + u, a + u * 0.5 + v * 1e-6],
            3 if i > 6 => [positions[i], positions[i + 1], positions[i + 2]],
            4 => [a * 100.0, a + u * 300.0, a + v * 200.0],
            _ => [a, a + u, a + v],
        });
    }
    soup(positions)
}

#[wasm_bindgen_test]
fn points_of_a_surface_are_those_of_an_exhaustive_search() {
    for seed in 0..40 {
        let mut random = Random::new(seed, 911);
        let mesh = triangles(&mut random, 1 + seed as usize * 2);
        let tree = TriangleTree::new(&mesh);
        for q in 0..20 {
            let size = [0.1, 1.0, 30.0][q % 3];
            let query = Vec3::from_array([0; 3].map(|_| (random.uniform() as f32 * 2.0 - 1.0) * size));
            let distance = |t: [u32; 3]| distance_by_search(mesh.corners(t).map(|p| p.as_dvec3()), query.as_dvec3());
            let expected = mesh.triangles().iter().map(|&t| distance(t)).fold(f64::INFINITY, f64::min);
            let found = tree.nearest(query).unwrap();
            let context = format!("seed {seed}, query {q}: {found:?}, expected {expected}");
            // f32 squared: 6e-8 of the distance, and the search's own 1e-8 of the largest triangle.
            let tolerance = 2e-7 * expected + 1e-6;
            assert!((f64::from(found.distance_squared).sqrt() - expected).abs() < tolerance, "{context}");
            assert!((distance(mesh.triangles()[found.triangle as usize]) - expected).abs() < tolerance, "{context}");
            assert!((f64::from(found.point.distance(query)) - expected).abs() < 3e-5 * (1.0 + expected), "{context}");
        }
    }
}

#[wasm_bindgen_test]
fn a_tree_of_many_triangles_finds_what_trees_of_its_parts_find() {
    const COUNT: usize = 17_000;
    let mut random = Random::new(5, 911);
    let mesh = triangles(&mut random, COUNT);
    let tree = TriangleTree::new(&mesh);
    let parts = mesh.triangles().chunks(COUNT / 3).map(|part| TriangleTree::new(&mesh.of_triangles(part)));
    let parts: Vec<TriangleTree> = parts.collect();
    for q in 0..60 {
        let query = Vec3::from_array([0; 3].map(|_| (random.uniform() as f32 * 2.0 - 1.0) * [0.1, 1.0, 30.0][q % 3]));
        let nearest = parts.iter().filter_map(|part| part.nearest(query));
        let expected = nearest.map(|found| found.distance_squared).fold(f32::INFINITY, f32::min);
        assert_eq!(tree.nearest(query).unwrap().distance_squared, expected, "query {q}");
        // Whatever triangle a search begins with.
        let from = |_| (query, Some(random_index(q, COUNT)));
        tree.nearest_of_each(1, &from, &mut |_, found| {
            assert_eq!(found.unwrap().distance_squared, expected, "query {q}");
        });
    }
}

fn random_index(q: usize, count: usize) -> u32 {
    (q * 7919 % (count + 10)) as u32
}

#[wasm_bindgen_test]
fn an_eighth_of_the_curve_is_an_octant() {
    let grid = |i: u32| Vec3::new((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32);
    let order = along_curve(&(0..512).map(grid).collect::<Vec<_>>());
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..512));
    for (count, side) in [(64, 3.0), (8, 1.0)] {
        for part in order.chunks(count) {
            let of = |pick: fn(Vec3, Vec3) -> Vec3| part.iter().map(|i| grid(*i)).reduce(pick).unwrap();
            assert_eq!(of(Vec3::max) - of(Vec3::min), Vec3::splat(side));
        }
    }
    assert_eq!(along_curve(&[Vec3::ONE; 3]), [0, 1, 2]);
}
