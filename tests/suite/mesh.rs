//! Meshes: what is refused, and the sign of their volume.

use sim3align::error::Result;

use crate::prelude::*;
use crate::shapes::inverted;

#[track_caller]
fn refused(mesh: Result<Mesh>, code: ErrorCode, argument: &str, found: &str) {
    let error = mesh.unwrap_err();
    assert_eq!((error.code, &*error.argument), (code, argument));
    assert!(error.found.contains(found), "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn meshes_that_are_none_are_refused() {
    let triangle = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let flat: Vec<f32> = triangle.iter().flat_map(|p| p.to_array()).collect();
    refused(Mesh::new(triangle.clone(), Vec::new()), ErrorCode::EmptyMesh, "mesh", "3 vertices and no triangle");
    refused(Mesh::from_flat(&[], None), ErrorCode::EmptyMesh, "mesh", "0 vertices");
    refused(Mesh::from_flat(&flat, Some(&[])), ErrorCode::EmptyMesh, "mesh", "3 vertices");
    for (index, message) in [(3, "index 3 in triangle 1"), (u32::MAX, "index 4294967295 in triangle 1")] {
        let triangles = vec![[0, 1, 2], [0, index, 2]];
        refused(Mesh::new(triangle.clone(), triangles), ErrorCode::IndexOutOfRange, "mesh.indices", message);
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut positions = triangle.clone();
        positions[1].y = bad;
        refused(Mesh::new(positions, vec![[0, 1, 2]]), ErrorCode::NonFinite, "mesh.positions", "at vertex 1");
    }
    refused(Mesh::from_flat(&flat[..8], Some(&[0, 1, 2])), ErrorCode::WrongLength, "mesh.positions", "8 numbers");
    refused(Mesh::from_flat(&flat[..6], None), ErrorCode::WrongLength, "mesh.positions", "6 numbers");
    refused(Mesh::from_flat(&flat, Some(&[0, 1])), ErrorCode::WrongLength, "mesh.indices", "2 indices");
}

#[wasm_bindgen_test(unsupported = test)]
fn flat_arrays_are_triples() {
    let flat: Vec<f32> = (0..18).map(|i| i as f32).collect();
    let soup = Mesh::from_flat(&flat, None).unwrap();
    assert_eq!(soup.triangles(), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(soup.positions()[4], Vec3::new(12.0, 13.0, 14.0));
    let indexed = Mesh::from_flat(&flat, Some(&[5, 0, 3])).unwrap();
    assert_eq!(indexed.corners(indexed.triangles()[0]).map(|p| p.x), [15.0, 0.0, 9.0]);
}

#[wasm_bindgen_test(unsupported = test)]
fn volumes_have_the_sign_of_the_faces() {
    let extent = Vec3::new(1.0, 2.0, 3.0);
    for offset in [Vec3::ZERO, Vec3::new(1e3, -1e3, 1e3)] {
        let mesh = mapped(&cuboid(extent), |p| p + offset);
        assert!((mesh.signed_volume6() - 36.0).abs() < 1e-9, "{}", mesh.signed_volume6());
        assert!((inverted(&mesh).signed_volume6() + 36.0).abs() < 1e-9);
    }
    // The volume of an ellipsoid, 4/3 π a b c, from inside by the polygons' share.
    let volume = ellipsoid(extent, 100).signed_volume6() / 6.0;
    assert!((volume / (8.0 * core::f64::consts::PI) - 1.0).abs() < 1e-3, "{volume}");
    // One mirrored axis turns the faces over; a thin sheet and an enormous body keep their sign.
    assert!(mapped(&cuboid(extent), |p| p * Vec3::new(-1.0, 1.0, 1.0)).signed_volume6() < 0.0);
    let sheet = mapped(&ellipsoid(Vec3::new(1.0, 1.0, 1e-6), 40), |p| p + Vec3::new(0.0, 0.0, 0.01));
    assert!(sheet.signed_volume6() > 0.0 && inverted(&sheet).signed_volume6() < 0.0);
    let huge = cuboid(Vec3::splat(1e20));
    assert!((huge.signed_volume6() / 6e60 - 1.0).abs() < 1e-6);
}
