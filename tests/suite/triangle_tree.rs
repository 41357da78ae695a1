//! Nearest points on triangles, against a search that knows no formula for them.

use sim3align::geometry::triangle_tree::{Hint, SurfacePoint};

use crate::prelude::*;
use crate::shapes::soup;

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

#[wasm_bindgen_test(unsupported = test)]
fn equals_an_exhaustive_search() {
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

#[wasm_bindgen_test(unsupported = test)]
fn of_equally_near_triangles_the_first_is_found() {
    let mesh = cuboid(Vec3::ONE);
    let tree = TriangleTree::new(&mesh);
    for corner in mesh.positions() {
        let holders = mesh.triangles().iter().position(|t| mesh.corners(*t).contains(corner));
        let found = tree.nearest(*corner * 4.0).unwrap();
        assert_eq!((Some(found.triangle as usize), found.point), (holders, *corner));
    }
    // Straight above the middle of each edge, the two (or, on a diagonal, two) triangles tie.
    for (i, &[a, b, c]) in mesh.triangles().iter().enumerate() {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let middle = (mesh.positions()[p as usize] + mesh.positions()[q as usize]) * 0.5;
            let found = tree.nearest(middle * 3.0).unwrap();
            let first = mesh.triangles().iter().position(|t| t.contains(&p) && t.contains(&q)).unwrap();
            assert_eq!((found.triangle as usize, found.point), (first, middle), "edge {p}-{q} of triangle {i}");
        }
    }
    let copies = Mesh::new(vec![Vec3::X, Vec3::Y, Vec3::Z], vec![[0, 1, 2]; 100]).unwrap();
    assert_eq!(TriangleTree::new(&copies).nearest(Vec3::ONE).unwrap().triangle, 0);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_query_without_a_distance_has_no_answer() {
    let tree = TriangleTree::new(&cuboid(Vec3::ONE));
    assert_eq!(tree.nearest(Vec3::NAN), None);
    assert_eq!(tree.nearest(Vec3::splat(1e30)), None);
}

#[wasm_bindgen_test(unsupported = test)]
fn points_are_left_out_only_where_all_triangles_overlap() {
    let visited = |mesh: &Mesh, count: usize| {
        let mut draw = Draw::new(5);
        let points = draw.points(count, 0.6);
        let tree = TriangleTree::new(mesh);
        let mut indices = Vec::new();
        tree.nearest_of_each(
            count,
            |i| points[i],
            |i, nearest| {
                assert_eq!(nearest, tree.nearest(points[i]), "point {i}");
                indices.push(i);
            },
        );
        indices
    };
    assert_eq!(visited(&sphere(0.5, 40), 3000), (0..3000).collect::<Vec<_>>());
    // Every triangle contains the point that is nearest to all.
    let mut draw = Draw::new(6);
    let overlapping = soup((0..12_000).map(|_| draw.points(1, 0.5)[0] * 100.0).collect());
    let far = |count: usize| visited(&mapped(&overlapping, |p| p + Vec3::splat(1e9)), count);
    let some = far(3000);
    assert!(some.len() >= 64 && some.len() < 2000, "{} points", some.len());
    assert!(some.last().is_some_and(|last| *last > 2800), "to the end of the list");
}

#[wasm_bindgen_test(unsupported = test)]
fn of_many_triangles_the_same_is_found_as_one_by_one() {
    // Squares and products of these sizes leave the range of f32.
    for (seed, unit) in [1e-12f32, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9].into_iter().enumerate() {
        let mut random = Random::new(seed as u64, 79);
        let mesh = mapped(&triangles(&mut random, 120), |p| p * unit);
        let alone: Vec<TriangleTree> =
            mesh.triangles().iter().map(|t| TriangleTree::new(&mesh.of_triangles(&[*t]))).collect();
        let (tree, mut hint) = (TriangleTree::new(&mesh), Hint::default());
        for q in 0..300 {
            let size = [0.3, 1.0, 40.0][q % 3] * unit;
            let mut query = Vec3::from_array([0; 3].map(|_| (random.uniform() as f32 * 2.0 - 1.0) * size));
            if q % 5 == 0 {
                let [a, b, c] = mesh.corners(mesh.triangles()[q % mesh.triangles().len()]);
                query = [a, a.lerp(b, 0.3), a * 0.2 + b * 0.3 + c * 0.5][q % 3];
            }
            let mut expected: Option<SurfacePoint> = None;
            for (triangle, alone) in (0..).zip(&alone) {
                let found = alone.nearest(query).map(|found| SurfacePoint { triangle, ..found });
                expected = match (expected, found) {
                    (Some(best), Some(found)) if found.distance_squared < best.distance_squared => Some(found),
                    (None, found) => found,
                    (best, _) => best,
                };
            }
            assert_eq!(tree.nearest_from(query, &mut hint), expected, "unit {unit}, query {q} {query}");
        }
        // A hint of another, larger tree is no worse than none.
        assert_eq!(alone[0].nearest_from(Vec3::ONE, &mut hint), alone[0].nearest(Vec3::ONE), "unit {unit}");
    }
}
