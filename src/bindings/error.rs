//! Errors as JavaScript throws them.

use js_sys::Reflect;
use wasm_bindgen::JsValue;

use crate::error::Error;

/// A JavaScript `Error` named `Sim3AlignError` with the own properties `code`, `argument`, `found`, `expected` and
/// `remedy`.
pub fn to_js(error: &Error) -> JsValue {
    let js = js_sys::Error::new(&error.to_string());
    js.set_name("Sim3AlignError");
    let properties = [
        ("code", error.code.as_str()),
        ("argument", &error.argument),
        ("found", &error.found),
        ("expected", &error.expected),
        ("remedy", &error.remedy),
    ];
    for (name, value) in properties {
        // A fresh Error is extensible: setting a property on it can't fail.
        let _ = Reflect::set(&js, &name.into(), &value.into());
    }
    js.into()
}
