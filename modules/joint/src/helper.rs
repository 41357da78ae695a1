//! A helper of a call of this module, in another thread.

use core::cell::RefCell;

use sim3align::align::helper::Helper;
use sim3align::bindings::helpers::step;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A helper of the alignment of an object of a scene, or of several views.
#[wasm_bindgen(skip_typescript)]
pub struct JointHelper(RefCell<Helper>);

impl From<Helper> for JointHelper {
    fn from(helper: Helper) -> Self {
        Self(RefCell::new(helper))
    }
}

#[wasm_bindgen]
impl JointHelper {
    /// Reads a message of the alignment.
    #[wasm_bindgen(skip_typescript)]
    pub fn receive(&self, message: &[f64]) {
        self.0.borrow_mut().receive(message);
    }

    /// See [`step`].
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> JsValue {
        step(&mut self.0.borrow_mut(), slice_ms)
    }
}
