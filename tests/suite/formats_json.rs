//! Cameras and true poses from JSON.

use sim3align::error::{Error, ErrorCode};
use sim3align::geometry::pinhole::Pinhole;
use sim3align_formats::camera::{CameraFile, read_camera};
use sim3align_formats::truth::read_truth;
use wasm_bindgen_test::wasm_bindgen_test;

const CAMERA: Pinhole = Pinhole { fx: 600.0, fy: 610.0, cx: 319.5, cy: 239.5 };

fn camera(json: &str) -> CameraFile {
    read_camera(json.as_bytes(), Some((640, 480)), None).unwrap_or_else(|error| panic!("{json}: {error}"))
}

fn refused(json: &str) -> Error {
    read_camera(json.as_bytes(), None, None).map(|file| format!("{file:?}")).unwrap_err()
}

#[wasm_bindgen_test(unsupported = test)]
fn every_form_of_camera_is_the_same_camera() {
    for json in [
        r#"{"fx":600,"fy":610,"cx":319.5,"cy":239.5}"#,
        // RealSense.
        r#"{"fx":600,"fy":610,"ppx":319.5,"ppy":239.5,"width":640,"height":480,"model":"brown_conrady"}"#,
        r#"{"K":[600,0,319.5,0,610,239.5,0,0,1]}"#,
        r#"{"K":[[600,0,319.5],[0,610,239.5],[0,0,1]]}"#,
        r#"[600,0,319.5,0,610,239.5,0,0,1]"#,
        r#"[[600,0,319.5],[0,610,239.5],[0,0,1]]"#,
        // Open3D, column by column.
        r#"{"width":640,"height":480,"intrinsic_matrix":[600,0,0,0,610,0,319.5,239.5,1]}"#,
        // BOP: a whole file and one entry.
        r#"{"0":{"cam_K":[600,0,319.5,0,610,239.5,0,0,1],"depth_scale":0.1}}"#,
        r#"{"cam_K":[600,0,319.5,0,610,239.5,0,0,1],"depth_scale":0.1}"#,
        // ROS 1 and 2.
        r#"{"header":{"seq":1},"height":480,"width":640,"distortion_model":"plumb_bob","D":[0,0,0,0,0],
            "K":[600,0,319.5,0,610,239.5,0,0,1],"R":[1,0,0,0,1,0,0,0,1],"P":[600,0,319.5,0,0,610,239.5,0,0,0,1,0]}"#,
        r#"{"height":480,"width":640,"d":[],"k":[600,0,319.5,0,610,239.5,0,0,1]}"#,
    ] {
        let file = camera(json);
        assert_eq!((file.camera, file.warnings.len()), (CAMERA, 0), "{json}");
    }
    assert_eq!(camera(r#"{"fx":1,"fy":1,"cx":0,"cy":0,"width":640,"height":480}"#).width, Some(640));
}

#[wasm_bindgen_test(unsupported = test)]
fn a_field_of_view_needs_the_size_of_the_image() {
    // tan 30° = 1/√3: f = 240·√3.
    for json in [r#"{"fovYDeg":60}"#, r#"{"fov_y_deg":60}"#] {
        let camera = camera(json).camera;
        assert!((camera.fx - 240.0 * 3_f64.sqrt()).abs() < 1e-9 && camera.fx == camera.fy, "{camera:?}");
        assert_eq!((camera.cx, camera.cy), (319.5, 239.5));
    }
    assert_eq!(camera(r#"{"fovYDeg":60,"width":640,"height":480}"#).camera.cy, 239.5);
    let error = refused(r#"{"fovYDeg":60}"#);
    assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidArgument, "options.width"));
    assert_eq!(refused(r#"{"fovYDeg":180,"width":4,"height":3}"#).code, ErrorCode::InvalidCamera);
}

#[wasm_bindgen_test(unsupported = test)]
fn depth_scales_are_in_metres_per_unit() {
    let entry = r#""fx":600,"fy":610,"cx":319.5,"cy":239.5"#;
    // BOP's depth_scale gives millimetres: YCB-Video's 0.1 is a tenth of one.
    assert_eq!(camera(&format!(r#"{{{entry},"depth_scale":0.1}}"#)).depth_scale_m, Some(0.1 / 1000.0));
    assert_eq!(camera(&format!(r#"{{{entry},"depthScale":0.0002}}"#)).depth_scale_m, Some(0.0002));
    assert_eq!(camera(&format!("{{{entry}}}")).depth_scale_m, None);
    for scale in ["0", "-1", "\"1\"", "null"] {
        assert_eq!(refused(&format!(r#"{{{entry},"depth_scale":{scale}}}"#)).code, ErrorCode::InvalidCamera);
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn of_several_images_one_has_to_be_chosen() {
    let entry = |f: u32| format!(r#"{{"cam_K":[{f},0,1,0,{f},1,0,0,1],"depth_scale":1.0}}"#);
    let file = format!(r#"{{"3":{},"20":{},"100":{}}}"#, entry(3), entry(20), entry(100));
    let read = |id| read_camera(file.as_bytes(), None, id);
    for (id, fx) in [("3", 3.0), ("20", 20.0), ("000100", 100.0)] {
        assert_eq!(read(Some(id)).unwrap().camera.fx, fx);
    }
    for id in [None, Some("4"), Some("")] {
        let error = read(id).unwrap_err();
        assert_eq!((error.code, &*error.argument), (ErrorCode::InvalidArgument, "options.imageId"));
        assert_eq!(error.expected, "one of 3, 20, 100");
    }
    let zero = format!(r#"{{"0":{},"1":{}}}"#, entry(5), entry(6));
    assert_eq!(read_camera(zero.as_bytes(), None, Some("000000")).unwrap().camera.fx, 5.0);
}

#[wasm_bindgen_test(unsupported = test)]
fn distortion_warns_and_another_size_is_refused() {
    let ros = r#"{"width":640,"height":480,"D":[0.1,-0.2,0,0,0],"K":[600,0,319.5,0,610,239.5,0,0,1]}"#;
    let file = camera(ros);
    assert!(file.warnings.len() == 1 && file.warnings[0].contains("rectified"), "{:?}", file.warnings);
    let error = read_camera(ros.as_bytes(), Some((320, 240)), None).unwrap_err();
    assert_eq!(error.code, ErrorCode::SizeMismatch);
    assert!(error.found.contains("640 × 480") && error.found.contains("320 × 240"), "{error}");
}

#[wasm_bindgen_test(unsupported = test)]
fn other_content_is_refused() {
    for json in [
        "",
        "nonsense",
        "1",
        "[]",
        "[1,2,3]",
        "{}",
        r#"{"fx":600,"fy":610,"cx":319.5}"#,
        r#"{"fx":"600","fy":610,"cx":319.5,"cy":239.5}"#,
        r#"{"K":[1,2,3]}"#,
        r#"{"K":[[1,0,0],[0,1,0],[0,0,1],[0,0,0]]}"#,
        r#"{"K":"eye"}"#,
        r#"{"intrinsic_matrix":7}"#,
        r#"{"0":{"cam_R_m2c":[]}}"#,
    ] {
        assert_eq!(refused(json).code, ErrorCode::CorruptFile, "{json}");
    }
    assert!(refused(r#"{"focal":1,"center":2}"#).found.contains("center, focal"));
    assert_eq!(refused(r#"{"fx":0,"fy":610,"cx":1,"cy":1}"#).code, ErrorCode::InvalidCamera);
    // A column-major K, as of MATLAB.
    assert_eq!(refused("[600,0,0,0,610,0,319.5,239.5,1]").code, ErrorCode::InvalidCamera);
    let deep = "[".repeat(100_000);
    assert_eq!(refused(&deep).code, ErrorCode::CorruptFile);
    let mut long = vec![b' '; (1 << 24) + 1];
    long[0] = b'{';
    assert_eq!(read_camera(&long, None, None).unwrap_err().code, ErrorCode::FileTooLarge);
}

#[wasm_bindgen_test(unsupported = test)]
fn poses_come_as_parts_or_as_a_matrix() {
    let expected = [0.0, 2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.0, 2.0, 3.0, 1.0];
    for rotation in
        ["[[0,-1,0],[1,0,0],[0,0,1]]", "[0,-1,0,1,0,0,0,0,1]", "[0,0,0.7071067811865476,0.7071067811865476]"]
    {
        let json =
            format!(r#"{{"available":true,"scale":2,"rotation":{rotation},"translation":[1,2,3],"symmetry":"none"}}"#);
        let (pose, symmetry) = read_truth(json.as_bytes()).unwrap().unwrap();
        assert_eq!(symmetry, "none");
        for (found, expected) in pose.to_column_major().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{rotation}: {pose:?}");
        }
    }
    let (pose, symmetry) = read_truth(format!(r#"{{"matrix":{expected:?}}}"#).as_bytes()).unwrap().unwrap();
    assert!((pose.scale - 2.0).abs() < 1e-12 && symmetry == "unknown");
    assert_eq!(read_truth(br#"{"available":false,"symmetry":"unknown"}"#), Ok(None));
}

#[wasm_bindgen_test(unsupported = test)]
fn what_is_no_similarity_is_no_pose() {
    let code = |json: &str| read_truth(json.as_bytes()).unwrap_err().code;
    let pose = |scale: &str, rotation: &str, translation: &str| {
        code(&format!(r#"{{"scale":{scale},"rotation":{rotation},"translation":{translation}}}"#))
    };
    let one = "[[1,0,0],[0,1,0],[0,0,1]]";
    assert_eq!(pose("0", one, "[0,0,0]"), ErrorCode::InvalidTransform);
    assert_eq!(pose("1", "[[1,0,0],[0,1,0],[0,0,-1]]", "[0,0,0]"), ErrorCode::InvalidTransform);
    assert_eq!(pose("1", "[0,0,0,0]", "[0,0,0]"), ErrorCode::InvalidTransform);
    assert_eq!(pose("1", "7", "[0,0,0]"), ErrorCode::InvalidTransform);
    assert_eq!(pose("1", one, "[0,0]"), ErrorCode::InvalidTransform);
    assert_eq!(pose("1", one, "[0,0,1e999]"), ErrorCode::CorruptFile);
    assert_eq!(code("{}"), ErrorCode::InvalidTransform);
    assert_eq!(code("{"), ErrorCode::CorruptFile);
    // A row-major matrix.
    assert_eq!(code(r#"{"matrix":[1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}"#), ErrorCode::InvalidTransform);
}
