//! Clock and progress of a JavaScript host.

use js_sys::{Function, Reflect};
use wasm_bindgen::{JsCast, JsValue, throw_val};
use web_sys::Performance;

use crate::align::progress::{Host, Stage};

/// `globalThis.performance` and a callback, either of which may be missing.
pub struct JsHost {
    performance: Option<Performance>,
    on_progress: Option<Function>,
}

impl JsHost {
    /// A host that calls `on_progress(stage, fraction)`.
    pub fn new(on_progress: Option<Function>) -> Self {
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
            let heard = callback.call2(&JsValue::NULL, &stage.as_str().into(), &fraction.into());
            // It ends the call, and the instance with it: nothing is tidied up on the way.
            heard.unwrap_or_else(|error| throw_val(error));
        }
    }
}
