//! Convex parts: hulls contain their points, and parts fill their mesh.

use glam::{DVec3, Vec3};
use sim3align_physics::part::{ConvexPart, convex_parts};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, bracket, cuboid, cylinder, is_near, sphere, together, tray};

/// How far a point is outside of a convex part, metres: 0 inside.
fn outside(part: &ConvexPart, p: DVec3) -> f64 {
    let beyond = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero().dot(p - a);
    part.corners().map(beyond).fold(0.0, f64::max)
}

/// Every edge belongs to two triangles, once in each direction; Euler's formula; and no vertex is outside.
fn assert_closed_and_convex(part: &ConvexPart, size: f64, what: &str) {
    let mut edges: Vec<(u32, u32)> = part.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "{what}: an edge is used twice");
    assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()), "{what}: a side is open");
    assert_eq!(part.positions.len() + part.triangles.len(), edges.len() / 2 + 2, "{what}: Euler");
    let worst = part.positions.iter().map(|p| outside(part, *p)).fold(0.0, f64::max);
    assert!(worst < 1e-4 * size, "{what}: a vertex is {worst} outside");
    assert!(part.volume() > 0.0, "{what}: volume {}", part.volume());
}

#[wasm_bindgen_test(unsupported = test)]
fn hulls_contain_their_points() {
    for seed in 0..100 {
        let mut draw = Draw::new(300 + seed);
        // Far from the origin, flattened, and of all sizes.
        let size = 10f64.powi((seed % 7) as i32 - 3);
        let flat = DVec3::new(1.0, 1.0, if seed % 3 == 0 { 0.02 } else { 1.0 });
        let shift = draw.vector(-3.0, 3.0);
        let count = 8 + (seed as usize * 7) % 300;
        let points: Vec<DVec3> = (0..count).map(|_| size * (shift + flat * draw.vector(-0.5, 0.5))).collect();
        let Some(hull) = ConvexPart::hull(&points) else { panic!("seed {seed}: no hull of {count} points") };
        assert_closed_and_convex(&hull, size, &format!("seed {seed}"));
        let worst = points.iter().map(|p| outside(&hull, *p)).fold(0.0, f64::max);
        assert!(worst < 1e-4 * size, "seed {seed}: a point is {worst} outside of a hull of {size}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn hulls_of_solids_have_their_volume() {
    let mesh = cuboid(Vec3::ZERO, Vec3::new(0.1, 0.2, 0.3));
    let [hull] = convex_parts(&mesh, 16).try_into().unwrap();
    assert!(is_near(hull.volume(), 0.006, 1e-5), "{}", hull.volume());
    // A convex mesh is one part, however many are allowed.
    for mesh in [sphere(0.1, 24), cylinder(0.05, 0.2, 48)] {
        let parts = convex_parts(&mesh, 16);
        assert_eq!(parts.len(), 1);
        assert!(is_near(parts[0].volume(), mesh.signed_volume6() / 6.0, 1e-3), "{}", parts[0].volume());
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn parts_cover_their_mesh_and_fill_no_more() {
    let (tray, tray_volume) = tray();
    for (name, mesh, volume, fewest) in [("bracket", bracket(), 0.003, 2), ("tray", tray, tray_volume, 5)] {
        let parts = convex_parts(&mesh, 16);
        assert!((fewest..=16).contains(&parts.len()), "{name}: {} parts", parts.len());
        for (k, part) in parts.iter().enumerate() {
            assert_closed_and_convex(part, mesh.diagonal(), &format!("{name}, part {k}"));
        }
        let found: f64 = parts.iter().map(ConvexPart::volume).sum();
        assert!(is_near(found, volume, 0.15), "{name}: {found} and {volume} m³");
        // Vertices are at most two cells of the decomposition outside of all parts.
        let cell = mesh.diagonal() / 64.0;
        for p in mesh.positions() {
            let far = parts.iter().map(|part| outside(part, p.as_dvec3())).fold(f64::INFINITY, f64::min);
            assert!(far < 2.0 * cell, "{name}: {p} is {far} m outside of all parts");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn no_more_parts_than_asked_for() {
    // Apart from each other, so that few parts have to bridge gaps.
    let boxes: Vec<_> = (0..4)
        .map(|k| Vec3::new(0.3 * k as f32, 0.1 * (k % 2) as f32, 0.0))
        .map(|low| cuboid(low, low + Vec3::splat(0.1)))
        .collect();
    let mesh = together(&boxes);
    let mut last = 0.0;
    for most in (0..=6).rev() {
        let parts = convex_parts(&mesh, most);
        assert!((1..=most.max(1)).contains(&parts.len()), "{} parts, at most {most}", parts.len());
        if most >= 4 {
            assert_eq!(parts.len(), 4);
        }
        let volume: f64 = parts.iter().map(ConvexPart::volume).sum();
        assert!(volume >= last, "{most} parts fill {volume} m³, and more parts {last} m³");
        last = volume;
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn parts_are_the_same_bits_each_time() {
    let (mesh, _) = tray();
    let [a, b] = [0; 2].map(|_| convex_parts(&mesh, 8));
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!((&a.positions, &a.triangles), (&b.positions, &b.triangles));
    }
}
