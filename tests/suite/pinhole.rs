//! The pinhole camera: projection and back, matrices, fields of view, and cameras that are none.

use crate::prelude::*;

#[wasm_bindgen_test(unsupported = test)]
fn back_projection_undoes_projection() {
    for seed in 0..100 {
        let mut draw = Draw::new(seed);
        let f = draw.between(100.0, 2000.0);
        let camera =
            Pinhole::new(f, f * draw.between(0.8, 1.2), draw.between(0.0, 640.0), draw.between(0.0, 480.0)).unwrap();
        let (u, v, z) = (draw.between(-50.0, 700.0), draw.between(-50.0, 500.0), draw.between(0.1, 100.0));
        let point = camera.back_project(u, v, z);
        assert_eq!(point.z, z as f32, "seed {seed}");
        let [u_back, v_back] = camera.project(point);
        assert!(
            (u_back - u).abs() < 1e-3 && (v_back - v).abs() < 1e-3,
            "seed {seed}: ({u}, {v}), ({u_back}, {v_back})"
        );
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn x_is_right_y_is_down_z_is_forward() {
    let camera = Pinhole::new(500.0, 250.0, 320.0, 240.0).unwrap();
    assert_eq!(camera.back_project(320.0, 240.0, 2.0), Vec3::new(0.0, 0.0, 2.0));
    assert_eq!(camera.back_project(420.0, 290.0, 2.0), Vec3::new(0.4, 0.4, 2.0));
    assert_eq!(camera.project(Vec3::new(1.0, -1.0, 5.0)), [420.0, 190.0]);
}

#[wasm_bindgen_test(unsupported = test)]
fn a_matrix_is_read_row_by_row_up_to_a_factor() {
    let expected = Pinhole::new(600.0, 610.0, 320.0, 240.0).unwrap();
    let k = [600.0, 0.0, 320.0, 0.0, 610.0, 240.0, 0.0, 0.0, 1.0];
    for factor in [1.0, 4.0, -2.0] {
        assert_eq!(Pinhole::from_matrix(&k.map(|x| x * factor)).unwrap(), expected);
    }
    let mut transposed = k;
    for (i, j) in [(1, 3), (2, 6), (5, 7)] {
        transposed.swap(i, j);
    }
    let error = Pinhole::from_matrix(&transposed).unwrap_err();
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidCamera, "camera.K"));
    assert!(error.remedy.contains("transpose"), "{error}");
    for (i, x) in
        [(1, 2.0), (8, 0.0), (8, f64::NAN), (8, f64::INFINITY), (3, f64::NAN), (0, 0.0), (4, -610.0), (2, f64::NAN)]
    {
        let mut bad = k;
        bad[i] = x;
        assert_eq!(Pinhole::from_matrix(&bad).unwrap_err().code, ErrorCode::InvalidCamera, "{bad:?}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn a_field_of_view_reaches_from_edge_to_edge() {
    let camera = Pinhole::from_vertical_fov(90.0, 640, 480).unwrap();
    // tan 45° = 1: the focal length is half the height.
    assert!((camera.fx - 240.0).abs() < 1e-12 && camera.fy == camera.fx);
    assert_eq!([camera.cx, camera.cy], [319.5, 239.5]);
    // Pixel centres are whole, so that the image's upper edge is row −0.5.
    let [_, top] = camera.project(Vec3::new(0.0, -3.0, 3.0));
    assert!((top + 0.5).abs() < 1e-9, "{top}");
    for (fov, height) in
        [(0.0, 480), (180.0, 480), (-10.0, 480), (f64::NAN, 480), (f64::INFINITY, 480), (1e-320, 480), (60.0, 0)]
    {
        assert_eq!(Pinhole::from_vertical_fov(fov, 640, height).unwrap_err().code, ErrorCode::InvalidCamera, "{fov}");
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn cameras_that_are_none_are_refused_by_name() {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0] {
        for (i, name) in ["fx", "fy", "cx", "cy"].into_iter().enumerate() {
            let mut numbers = [500.0, 500.0, 320.0, 240.0];
            numbers[i] = x;
            let [fx, fy, cx, cy] = numbers;
            let made = Pinhole::new(fx, fy, cx, cy);
            // A principal point may be anywhere.
            if i >= 2 && x.is_finite() {
                assert!(made.is_ok(), "{name} = {x}");
                continue;
            }
            let error = made.unwrap_err();
            assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidCamera, &*format!("camera.{name}")), "{x}");
        }
    }
}
