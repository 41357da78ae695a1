//! Clock and progress of a JavaScript host.

use js_sys::Function;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsValue, throw_val};

use crate::align::progress::{Host, Stage};

#[wasm_bindgen]
extern "C" {
    /// Windows, workers and Node all have it; where it is missing, the call fails, and nothing else does.
    #[wasm_bindgen(catch, js_namespace = performance, js_name = now)]
    fn performance_now() -> Result<f64, JsValue>;
}

/// `globalThis.performance` and a callback, either of which may be missing.
pub struct JsHost(Option<Function>);

impl JsHost {
    /// A host that calls `on_progress(stage, fraction)`.
    pub fn new(on_progress: Option<Function>) -> Self {
        Self(on_progress)
    }
}

impl Host for JsHost {
    fn now_ms(&mut self) -> f64 {
        performance_now().unwrap_or_default()
    }

    fn progress(&mut self, stage: Stage, fraction: f64) {
        if let Some(callback) = &self.0 {
            let heard = callback.call2(&JsValue::NULL, &stage.as_str().into(), &fraction.into());
            // It ends the call, and the instance with it: nothing is tidied up on the way.
            heard.unwrap_or_else(|error| throw_val(error));
        }
    }
}
