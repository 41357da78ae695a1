//! Similarities, pinhole cameras and meshes: their conventions, and what is refused as one.

use glam::Mat3;
use nalgebra::{Matrix3, Matrix4};
use sim3align::geometry::surface::check_shape;

use crate::prelude::*;

#[wasm_bindgen_test]
fn similarities_compose_and_invert() {
    for seed in 0..200 {
        let mut draw = Draw::new(seed);
        let [a, b] = [0; 2].map(|_| draw.similarity([0.01, 100.0], 1e4));
        let x = draw.cube(10.0);
        let by_matrix = (Matrix4::from_column_slice(&a.to_column_major()) * x.push(1.0)).xyz();
        let size = a.scale * (b.scale * 20.0 + 2e4) + 2e4;
        // Relative to the numbers that were added up.
        for (found, expected, size) in [
            (a.compose(&b).apply(x), a.apply(b.apply(x)), size),
            (a.inverse().apply(a.apply(x)), x, 20.0 + 2e4 / a.scale),
            (a.apply(a.inverse().apply(x)), x, 4e4),
            (by_matrix, a.apply(x), 2e4),
        ] {
            assert!((found - expected).norm() <= 1e-13 * size, "seed {seed}: {found} for {expected}");
        }
        assert_eq!(a.compose(&Similarity::identity()), a, "seed {seed}");
    }
}

#[wasm_bindgen_test]
fn matrices_and_quaternions_give_the_similarity_back() {
    let mut draw = Draw::new(1);
    let mut rotations: Vec<Rotation3<f64>> = (0..200).map(|_| draw.rotation()).collect();
    // Half turns, and almost.
    let axes = [Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::x(), Vector3::new(1.0, 1.0, 0.0), draw.direction()];
    let angles = [0.0, 1e-15, 1e-9, 1e-4].map(|x| core::f64::consts::PI - x);
    rotations.extend(axes.iter().flat_map(|axis| angles.map(|angle| Rotation3::new(axis.normalize() * angle))));
    for rotation in rotations {
        let pose = Similarity { rotation, ..draw.similarity([0.01, 100.0], 1e4) };
        let back = Similarity::from_column_major(&pose.to_column_major()).unwrap();
        assert!((back.scale / pose.scale - 1.0).abs() < 1e-14 && back.translation == pose.translation, "{pose:?}");
        assert!((back.rotation.matrix() - rotation.matrix()).amax() < 1e-14, "{pose:?}");
        let q = pose.quaternion_xyzw();
        assert!((q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14 && q[3] >= 0.0, "{q:?}");
        for stretched in [q, q.map(|x| -3.0 * x)] {
            let back = Similarity::rotation_from_xyzw(&stretched).unwrap();
            assert!((back - rotation.matrix()).amax() < 1e-14, "{q:?}");
        }
        // Four decimals, as people print matrices.
        let printed = rotation.matrix().map(|x| (x * 1e4).round() / 1e4);
        let read = Similarity::from_parts(pose.scale, printed, pose.translation).unwrap();
        assert!(rotation_defect(read.rotation.matrix()) < 1e-14 && read.rotation_angle_to(&pose) < 2e-4, "{pose:?}");
    }
}

#[wasm_bindgen_test]
fn what_is_no_similarity_is_refused() {
    let good = Draw::new(3).similarity([0.5, 2.0], 10.0);
    let (r, t) = (*good.rotation.matrix(), good.translation);
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    let shear = Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let mut parts = vec![(1.0, -r), (1.0, r * mirror), (1.0, r * shear), (1.0, r * 2.0), (1.0, r * 0.0)];
    // |RᵀR − 1| of 1e-3 is where rounding ends; squares that overflow to ∞ − ∞.
    parts.extend([(1.0, r * 1.0006), (1.0, r * f64::NAN), (1.0, Matrix3::repeat(1e200))]);
    parts.extend([0.0, -1.0, f64::NAN, f64::INFINITY].map(|scale| (scale, r)));
    for (scale, rotation) in parts {
        let error = Similarity::from_parts(scale, rotation, t).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidTransform, "transform"), "{scale}, {rotation}");
    }
    assert!(Similarity::from_parts(1.0, r * 1.0004, t).is_ok());
    let code = |m: &[f64; 16]| Similarity::from_column_major(m).map_err(|error| error.code);
    let m = good.to_column_major();
    assert!(code(&m).is_ok());
    for i in 0..16 {
        let mut bad = m;
        bad[i] = [f64::NAN, f64::INFINITY][i % 2];
        assert_eq!(code(&bad), Err(ErrorCode::InvalidTransform), "{i}");
    }
    let rows: [f64; 16] = Matrix4::from_row_slice(&m).as_slice().try_into().unwrap();
    let error = Similarity::from_column_major(&rows).unwrap_err();
    assert!(error.to_string().contains("Transpose a row-major matrix"), "{error}");
    for q in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0, 1.0], [1e-200; 4]] {
        assert_eq!(Similarity::rotation_from_xyzw(&q).unwrap_err().code, ErrorCode::InvalidTransform, "{q:?}");
    }
}

#[wasm_bindgen_test]
fn x_is_right_y_is_down_and_z_is_forward() {
    let camera = Pinhole::new(500.0, 250.0, 320.0, 240.0).unwrap();
    assert_eq!(camera.back_project(420.0, 290.0, 2.0), Vec3::new(0.4, 0.4, 2.0));
    assert_eq!(camera.project(Vec3::new(1.0, -1.0, 5.0)), [420.0, 190.0]);
}

#[wasm_bindgen_test]
fn meshes_that_are_none_are_refused() {
    use ErrorCode::{EmptyMesh, IndexOutOfRange, NonFinite, WrongLength};
    let flat = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut infinite = flat;
    infinite[4] = f32::INFINITY;
    type Case<'a> = (&'a [f32], Option<&'a [u32]>, ErrorCode, &'a str, &'a str);
    let cases: [Case<'_>; 8] = [
        (&[], None, EmptyMesh, "mesh", "0 vertices"),
        (&flat, Some(&[]), EmptyMesh, "mesh", "3 vertices"),
        (&flat, Some(&[0, 1, 2, 0, 3, 2]), IndexOutOfRange, "mesh.indices", "index 3 in triangle 1"),
        (&flat, Some(&[0, 1, u32::MAX]), IndexOutOfRange, "mesh.indices", "index 4294967295 in triangle 0"),
        (&infinite, None, NonFinite, "mesh.positions", "at vertex 1"),
        (&flat[..8], Some(&[0, 1, 2]), WrongLength, "mesh.positions", "8 numbers"),
        (&flat[..6], None, WrongLength, "mesh.positions", "6 numbers"),
        (&flat, Some(&[0, 1]), WrongLength, "mesh.indices", "2 indices"),
    ];
    for (positions, indices, code, argument, found) in cases {
        let error = Mesh::from_flat(positions, indices).unwrap_err();
        assert_eq!((error.code, &*error.argument), (code, argument), "{error}");
        assert!(error.found.contains(found), "{error}");
    }
}

#[wasm_bindgen_test]
fn shapes_without_volume_are_refused() {
    let turned = Mat3::from_cols_array(&[0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6]);
    let flat = |extent: Vec3| mapped(&cuboid(extent), |p| turned * p + Vec3::new(3.0, -2.0, 1.0));
    let point = mapped(&cuboid(Vec3::ONE), |_| Vec3::ONE);
    let cases = [
        ("point", point, "area"),
        ("plane", flat(Vec3::new(1.0, 1.0, 0.0)), "plane"),
        ("almost a plane", flat(Vec3::new(1.0, 2.0, 1e-4)), "plane"),
        ("needle", flat(Vec3::new(1e-5, 1e-5, 1.0)), "needle"),
    ];
    for (name, mesh, found) in cases {
        let error = check_shape(&mesh).unwrap_err();
        assert_eq!(error.code, ErrorCode::DegenerateMesh, "{name}");
        assert!(error.found.contains(found), "{name}: {error}");
    }
}
