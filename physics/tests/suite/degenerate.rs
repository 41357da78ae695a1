//! Meshes that are no solids: typed errors or bodies with finite numbers, and no panic.

use glam::{DQuat, DVec3, Vec3};
use sim3align_geometry::error::ErrorCode;
use sim3align_geometry::mesh::Mesh;
use sim3align_physics::scene::{Object, On, Settings, settle};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::solids::{Draw, cuboid, moved, similarity};

const SETTINGS: Settings =
    Settings { density: 400.0, parts: 1, turn_deg: 20.0, move_m: 1.0, fits_ground: true, rest: true };

/// Settles one object; all of its numbers are finite, and its mass is not negative.
fn settled(mesh: &Mesh, scale: f64, parts: usize, what: &str) -> (usize, f64) {
    let pose = similarity(scale, DQuat::from_rotation_x(0.02), DVec3::new(0.1, 0.2, 0.3));
    let object = Object { mesh: mesh.clone(), world_from_mesh: pose, on: On::Ground };
    let [found] = settle(&[object], &Settings { parts, ..SETTINGS }).0.try_into().unwrap();
    let (body, mass) = (&found.body, found.body.mass);
    let corners = body.parts.iter().flat_map(|part| &part.positions);
    let vectors = [mass.center, mass.moments, body.pose.translation];
    assert!(corners.copied().chain(vectors).all(DVec3::is_finite), "{what}: {mass:?}");
    assert!(mass.mass.is_finite() && mass.mass >= 0.0 && mass.moments.min_element() > 0.0, "{what}: {mass:?}");
    assert!(mass.axes.is_normalized() && body.pose.rotation.is_normalized(), "{what}: {mass:?}");
    assert!(body.parts.iter().all(|part| part.volume() > 0.0), "{what}: a part without volume");
    (body.parts.len(), mass.mass)
}

#[wasm_bindgen_test(unsupported = test)]
fn meshes_with_numbers_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let error = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, bad, 0.0)], vec![[0, 1, 2]]).unwrap_err();
        assert_eq!(error.code, ErrorCode::NonFinite);
    }
    assert_eq!(Mesh::new(vec![Vec3::ZERO], Vec::new()).unwrap_err().code, ErrorCode::EmptyMesh);
    assert_eq!(Mesh::new(vec![Vec3::ZERO], vec![[0, 0, 1]]).unwrap_err().code, ErrorCode::IndexOutOfRange);
}

#[wasm_bindgen_test(unsupported = test)]
fn flat_meshes_get_a_thin_body() {
    let triangle = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    let quad = cuboid(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0));
    let line = Mesh::new(vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], vec![[0, 1, 2]]).unwrap();
    for (name, mesh, area) in [("triangle", triangle, 0.5), ("quad", quad, 1.0), ("line", line, 0.0)] {
        for parts in [1, 16] {
            let (count, mass) = settled(&mesh, 0.1, parts, name);
            assert_eq!(count, 1, "{name}");
            // About a thousandth of the diagonal to each side.
            let most = 400.0 * 1e-3 * (area + 0.05) * 4.0 * 2.3;
            assert!(mass > 0.0 && mass < most * 1e-3, "{name}: {mass} kg, below {} kg", most * 1e-3);
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn points_have_no_body() {
    let point = Mesh::new(vec![Vec3::splat(0.3); 3], vec![[0, 1, 2]]).unwrap();
    assert_eq!(settled(&point, 1.0, 16, "point"), (0, 0.0));
}

#[wasm_bindgen_test(unsupported = test)]
fn sizes_of_many_decades_have_bodies_of_their_size() {
    for exponent in [-12, -6, -3, 3, 6, 9] {
        let size = 10f32.powi(exponent);
        let mesh = cuboid(-Vec3::splat(size), Vec3::splat(size));
        let scale = 0.1 / f64::from(size);
        let (count, mass) = settled(&mesh, scale, 16, &format!("1e{exponent}"));
        assert_eq!(count, 1, "1e{exponent}");
        assert!((mass - 3.2).abs() < 1e-3, "1e{exponent}: {mass} kg");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn coordinates_near_the_largest_numbers_do_not_panic() {
    for size in [1e18f32, 1e30, f32::MAX / 4.0, f32::MAX] {
        for parts in [1, 16] {
            let mesh = cuboid(-Vec3::splat(size), Vec3::splat(size));
            let object = Object { mesh, world_from_mesh: moved(0.0, 0.0, 0.0), on: On::Ground };
            let [found] = settle(&[object], &Settings { parts, ..SETTINGS }).0.try_into().unwrap();
            assert!(found.body.parts.len() <= 1, "{size}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn random_soups_do_not_panic() {
    for seed in 0..12 {
        let mut draw = Draw::new(700 + seed);
        let count = 3 + seed as usize % 30;
        // Coordinates of few values: coincident, collinear and coplanar vertices, triangles without area.
        let mut coarse = || draw.vector(0.0, 3.99).floor().as_vec3();
        let positions: Vec<Vec3> = (0..count).map(|_| coarse()).collect();
        let triangles = (0..2 * count as u32).map(|k| [0, 5, 11].map(|step| (k * 7 + step) % count as u32)).collect();
        let mesh = Mesh::new(positions, triangles).unwrap();
        settled(&mesh, 0.05, 1 + seed as usize % 9, &format!("seed {seed}"));
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn thin_plates_have_their_mass() {
    for thickness in [0.1, 0.01, 0.002, 0.001] {
        let plate = cuboid(Vec3::ZERO, Vec3::new(1.0, 0.7, thickness));
        let (count, mass) = settled(&plate, 0.1, 16, &format!("{thickness}"));
        let expected = 0.4 * 0.7 * f64::from(thickness);
        assert!(count == 1 && (mass / expected - 1.0).abs() < 1e-5, "{thickness}: {mass} kg, expected {expected} kg");
    }
}
