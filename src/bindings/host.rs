//! Clock and progress of a JavaScript host.

use js_sys::Reflect;
use wasm_bindgen::prelude::*;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::Performance;

use crate::align::progress::{Host, Stage};

#[wasm_bindgen]
extern "C" {
    /// A function that follows progress. What it throws is not caught: it ends the call, and the instance with it, whose
    /// memory is not tidied up.
    #[wasm_bindgen(js_name = Function, typescript_type = "Function")]
    pub type Listener;

    #[wasm_bindgen(method)]
    fn call(this: &Listener, this_arg: &JsValue, stage: &str, fraction: f64);
}

/// `globalThis.performance` and a callback, either of which may be missing.
pub struct JsHost {
    performance: Option<Performance>,
    on_progress: Option<Listener>,
}

impl JsHost {
    /// A host that calls `on_progress(stage, fraction)`.
    pub fn new(on_progress: Option<Listener>) -> Self {
        // Windows, workers and Node all have it on the global object; none shares a class for that object.
        let performance = Reflect::get(&js_sys::global(), &"performance".into()).ok().filter(JsValue::is_object);
        Self { performance: performance.map(JsCast::unchecked_into), on_progress }
    }
}

impl Host for JsHost {
    fn now_ms(&mut self) -> f64 {
        self.performance.as_ref().map_or(0.0, Performance::now)
    }

    fn progress(&mut self, stage: Stage, fraction: f64) {
        if let Some(callback) = &self.on_progress {
            callback.call(&JsValue::NULL, stage.as_str(), fraction);
        }
    }
}
