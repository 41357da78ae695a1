//! Helpers of calls, which JavaScript brings: workers of the pool.

use js_sys::Float64Array;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use super::host::now_ms;
use crate::align::helper::Helper;
use crate::helpers::{Helpers, Link};
use crate::scheduler::Scheduler;

#[wasm_bindgen]
extern "C" {
    /// The `CoreHelpers` of the package: see [`Link`].
    pub type JsHelpers;

    #[wasm_bindgen(method)]
    fn ask(this: &JsHelpers);

    #[wasm_bindgen(method)]
    fn send(this: &JsHelpers, helper: usize, message: Float64Array);

    #[wasm_bindgen(method)]
    fn receive(this: &JsHelpers) -> Option<Vec<f64>>;

    #[wasm_bindgen(method)]
    fn wait(this: &JsHelpers);
}

impl Link for JsHelpers {
    fn ask(&self) {
        self.ask();
    }

    fn send(&self, helper: usize, message: &[f64]) {
        self.send(helper, Float64Array::from(message));
    }

    fn receive(&self) -> Option<Vec<f64>> {
        self.receive()
    }

    fn wait(&self) {
        self.wait();
    }
}

/// The scheduler of a call of JavaScript, which may have helpers.
pub fn scheduler(helpers: Option<JsHelpers>) -> Scheduler {
    Scheduler::new(now_ms, None).with_helpers(helpers.map(Helpers::new).unwrap_or_default())
}

/// Runs tasks for about `slice_ms` milliseconds. Returns the message about them, or `undefined` if there is nothing to do.
pub fn step(helper: &mut Helper, slice_ms: f64) -> JsValue {
    let until = now_ms() + slice_ms;
    let message = helper.step(|| now_ms() >= until);
    message.map_or(JsValue::UNDEFINED, |message| Float64Array::from(message.as_slice()).into())
}
