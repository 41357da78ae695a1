//! The file readers as JavaScript calls them.
#![cfg(target_arch = "wasm32")]

use js_sys::{Array, Function, JSON, Object, Reflect, Uint8Array};
use sim3align_formats::bindings::*;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::formats_fixtures::fixture;

fn bytes(bytes: &[u8]) -> JsValue {
    Uint8Array::from(bytes).into()
}

fn js(expression: &str) -> JsValue {
    Function::new_no_args(&format!("return {expression}")).call0(&JsValue::NULL).unwrap()
}

fn text(value: &JsValue) -> String {
    JSON::stringify(value).unwrap().into()
}

fn property(value: &JsValue, name: &str) -> JsValue {
    Reflect::get(value, &name.into()).unwrap()
}

/// Code and argument of an error, after its shape was checked.
#[track_caller]
fn error_of(result: Result<JsValue, JsValue>) -> (String, String) {
    let error = result.unwrap_err();
    assert!(error.is_instance_of::<js_sys::Error>());
    let string = |name: &str| property(&error, name).as_string().unwrap_or_else(|| panic!("no {name}"));
    assert_eq!(string("name"), "Sim3AlignError");
    assert!(string("message").contains(&string("found")) && string("message").contains(&string("remedy")));
    assert!(string("message").contains(&string("expected")));
    let own: Vec<String> =
        Object::keys(error.unchecked_ref::<Object>()).iter().filter_map(|name| name.as_string()).collect();
    assert!(["code", "argument", "found", "expected", "remedy"].iter().all(|name| own.iter().any(|own| own == name)));
    (string("code"), string("argument"))
}

fn is(code: &str, argument: &str) -> (String, String) {
    (code.into(), argument.into())
}

#[wasm_bindgen_test]
fn meshes_come_as_typed_arrays() {
    let mesh = read_mesh(&bytes(fixture!("mesh.stl")), &JsValue::UNDEFINED).unwrap();
    assert_eq!(property(&property(&mesh, "positions"), "length").as_f64(), Some(126.0));
    assert_eq!(property(&property(&mesh, "indices"), "length").as_f64(), Some(240.0));
    // An ArrayBuffer is bytes, too; a format may be given.
    let buffer: JsValue = Uint8Array::from(fixture!("mesh.obj")).buffer().into();
    assert!(read_mesh(&buffer, &js("{ format: 'obj' }")).is_ok());
    let gltf = bytes(fixture!("mesh-external.gltf"));
    assert_eq!(external_resources(&gltf).unwrap(), ["gltf_buffer_0.bin", "gltf_buffer_1.bin"]);
    assert_eq!(error_of(read_mesh(&gltf, &JsValue::NULL)), is("INVALID_ARGUMENT", "options.resources"));
    let (options, files) = (Object::new(), Object::new());
    Reflect::set(&files, &"gltf_buffer_0.bin".into(), &bytes(fixture!("mesh-external-gltf_buffer_0.bin"))).unwrap();
    Reflect::set(&files, &"gltf_buffer_1.bin".into(), &bytes(fixture!("mesh-external-gltf_buffer_1.bin"))).unwrap();
    Reflect::set(&options, &"resources".into(), &files).unwrap();
    assert!(read_mesh(&gltf, &options.into()).is_ok());
}

#[wasm_bindgen_test]
fn wrong_arguments_are_named() {
    let none = JsValue::UNDEFINED;
    for wrong in [js("'text'"), js("[1, 2]"), js("null"), js("undefined"), js("new Float32Array(4)"), js("7"), js("{}")]
    {
        assert_eq!(error_of(read_mesh(&wrong, &none)), is("INVALID_ARGUMENT", "mesh"));
        assert_eq!(error_of(read_depth(&wrong, &none)), is("INVALID_ARGUMENT", "depth"));
        assert_eq!(error_of(read_mask(&wrong)), is("INVALID_ARGUMENT", "mask"));
    }
    let stl = bytes(fixture!("mesh.stl"));
    assert_eq!(error_of(read_mesh(&stl, &js("7"))), is("INVALID_ARGUMENT", "options"));
    assert_eq!(error_of(read_mesh(&stl, &js("{ fromat: 'stl' }"))), is("UNKNOWN_OPTION", "options.fromat"));
    assert_eq!(error_of(read_mesh(&stl, &js("{ format: 'fbx' }"))), is("INVALID_OPTION", "options.format"));
    let png = bytes(fixture!("depth-16.png"));
    assert_eq!(error_of(read_depth(&png, &js("{ depthScale: 0 }"))), is("INVALID_OPTION", "options.depthScale"));
    assert_eq!(error_of(read_depth(&png, &js("{ depthScale: '1' }"))), is("INVALID_OPTION", "options.depthScale"));
    assert_eq!(error_of(read_depth(&bytes(fixture!("depth-8.png")), &none)), is("EIGHT_BIT_DEPTH", "depth"));
    // The next good call works.
    let depth = read_depth(&png, &js("{ depthScale: 0.001 }")).unwrap();
    assert_eq!(property(&depth, "width").as_f64(), Some(7.0));
    assert_eq!(property(&property(&depth, "data"), "length").as_f64(), Some(35.0));
}

#[wasm_bindgen_test]
fn masks_and_run_lengths_go_both_ways() {
    let mask = read_mask(&bytes(fixture!("mask-grey.png"))).unwrap();
    let data = property(&mask, "data");
    let (width, height) = (property(&mask, "width"), property(&mask, "height"));
    for (compressed, file) in [(None, fixture!("rle-small.json")), (Some(false), fixture!("rle-small-plain.json"))] {
        let rle = encode_coco_rle(&data, &width, &height, compressed).unwrap();
        let expected = js(&String::from_utf8_lossy(file));
        assert_eq!(text(&rle), text(&expected));
        assert_eq!(text(&property(&decode_coco_rle(&expected).unwrap(), "data")), text(&data));
    }
    assert_eq!(error_of(decode_coco_rle(&js("{ size: [5, 7], counts: [1] }"))), is("CORRUPT_FILE", "rle"));
    assert_eq!(error_of(decode_coco_rle(&js("null"))), is("INVALID_ARGUMENT", "rle"));
    assert_eq!(error_of(encode_coco_rle(&data, &js("6"), &height, None)), is("WRONG_LENGTH", "mask"));
    assert_eq!(error_of(encode_coco_rle(&data, &js("-7"), &height, None)), is("INVALID_ARGUMENT", "width"));
    assert_eq!(error_of(encode_coco_rle(&data, &width, &js("'5'"), None)), is("INVALID_ARGUMENT", "height"));
}

#[wasm_bindgen_test]
fn cameras_and_poses_come_from_bytes_text_or_objects() {
    let json = r#"{"fx":600,"fy":610,"cx":319.5,"cy":239.5,"width":640,"height":480,"depthScale":0.001}"#;
    let expected = format!(r#"{},"warnings":[]}}"#, &json[..json.len() - 1]);
    for file in [bytes(json.as_bytes()), json.into(), js(&format!("({json})"))] {
        assert_eq!(text(&read_camera(&file, &JsValue::UNDEFINED).unwrap()), expected);
    }
    let fov = read_camera(&js("({ fovYDeg: 90 })"), &js("({ width: 4, height: 3 })")).unwrap();
    assert!((property(&fov, "fx").as_f64().unwrap() - 1.5).abs() < 1e-12);
    assert!(property(&fov, "width").is_undefined());
    let bop = r#"{"0":{"cam_K":[1,0,0,0,1,0,0,0,1]},"12":{"cam_K":[2,0,0,0,2,0,0,0,1]}}"#.into();
    for id in ["({ imageId: 12 })", "({ imageId: '12' })"] {
        assert_eq!(property(&read_camera(&bop, &js(id)).unwrap(), "fx").as_f64(), Some(2.0));
    }
    assert_eq!(error_of(read_camera(&bop, &JsValue::NULL)), is("INVALID_ARGUMENT", "options.imageId"));
    assert_eq!(error_of(read_camera(&js("7"), &JsValue::NULL)), is("INVALID_ARGUMENT", "camera"));
    assert_eq!(error_of(read_camera(&bop, &js("({ width: 1.5 })"))), is("INVALID_ARGUMENT", "options.width"));

    assert!(read_truth(&js("({ available: false })")).unwrap().is_null());
    let pose = r#"{"scale":2,"rotation":[[0,-1,0],[1,0,0],[0,0,1]],"translation":[1,2,3],"symmetry":"none"}"#;
    let truth = read_truth(&pose.into()).unwrap();
    assert_eq!(text(&property(&truth, "rotationMatrix")), "[[0,-1,0],[1,0,0],[0,0,1]]");
    assert_eq!(text(&property(&truth, "matrix")), "[0,2,0,0,-2,0,0,0,0,0,2,0,1,2,3,1]");
    assert_eq!(Array::from(&property(&truth, "rotation")).length(), 4);
    assert_eq!(property(&truth, "symmetry").as_string().as_deref(), Some("none"));
    assert_eq!(error_of(read_truth(&"{}".into())), is("INVALID_TRANSFORM", "truth.scale"));
}
