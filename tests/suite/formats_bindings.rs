//! The file readers as JavaScript calls them.
#![cfg(target_arch = "wasm32")]

use js_sys::{Function, Object, Reflect, Uint8Array};
use sim3align_module_formats::*;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::wasm_bindgen_test;

use crate::formats_fixtures::fixture;

fn bytes(bytes: &[u8]) -> JsValue {
    Uint8Array::from(bytes).into()
}

fn js(expression: &str) -> JsValue {
    Function::new_no_args(&format!("return {expression}")).call0(&JsValue::NULL).unwrap()
}

fn property(value: &JsValue, name: &str) -> JsValue {
    Reflect::get(value, &name.into()).unwrap()
}

/// Code and argument of an error, after its shape was checked.
#[track_caller]
fn error_of(result: Result<JsValue, JsValue>) -> (String, String) {
    let error = result.unwrap_err();
    let string = |name: &str| property(&error, name).as_string().unwrap_or_else(|| panic!("no {name}"));
    let own: Vec<String> =
        Object::keys(error.unchecked_ref::<Object>()).iter().filter_map(|name| name.as_string()).collect();
    assert_eq!(own, ["code", "argument", "found", "expected", "remedy"]);
    assert!(["found", "expected", "remedy"].iter().all(|name| !string(name).is_empty()));
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
    let names = property(&external_resources(&gltf).unwrap(), "shape");
    assert_eq!(js_sys::Array::from(&names).join(" "), "gltf_buffer_0.bin gltf_buffer_1.bin");
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
