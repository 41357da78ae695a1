//! Clock and progress of a JavaScript host.

use js_sys::{Float64Array, Function};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::Performance;

use crate::geometry::similarity::Similarity;
use crate::progress::{Host, Stage};

#[wasm_bindgen]
extern "C" {
    /// Windows, workers and Node have it under this name, on global objects without a common class.
    #[wasm_bindgen(thread_local_v2, js_name = performance)]
    static PERFORMANCE: Option<Performance>;
}

/// Milliseconds since a fixed point in time; 0 without a clock.
pub fn now_ms() -> f64 {
    PERFORMANCE.with(|performance| performance.as_ref().map_or(0.0, Performance::now))
}

/// `globalThis.performance` and a callback, either of which may be missing.
pub struct JsHost {
    on_progress: Option<Function>,
    best: JsValue,
}

impl JsHost {
    /// A host that calls `on_progress(stage, fraction, best)`: 16 numbers of a pose, column-major, and its score, if
    /// there is one.
    pub fn new(on_progress: Option<Function>) -> Self {
        Self { on_progress, best: JsValue::UNDEFINED }
    }
}

impl Host for JsHost {
    fn now_ms(&mut self) -> f64 {
        now_ms()
    }

    fn progress(&mut self, stage: Stage, fraction: f64) {
        if let Some(callback) = &self.on_progress {
            // The callbacks of the package hold back exceptions of the caller until the step ends.
            let _ = callback.call3(&JsValue::NULL, &stage.as_str().into(), &fraction.into(), &self.best);
        }
    }

    fn best(&mut self, camera_from_mesh: &Similarity, score: f64) {
        self.best = Float64Array::from(best_numbers(camera_from_mesh, score).as_slice()).into();
    }
}

/// A pose, column-major, and its score.
fn best_numbers(camera_from_mesh: &Similarity, score: f64) -> [f64; 17] {
    let mut numbers = [score; 17];
    numbers[..16].copy_from_slice(&camera_from_mesh.to_column_major());
    numbers
}
