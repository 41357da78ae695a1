//! Running calls of this module, and their helpers in other threads.

use core::cell::RefCell;

use js_sys::{Array, Object, Reflect};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use sim3align::align::helper::Helper;
use sim3align::bindings::answer::to_js;
use sim3align::bindings::helpers::step;
use sim3align::bindings::host::now_ms;
use sim3align::bindings::object::{get, wrong_type};
use sim3align::error::Result;
use sim3align::scheduler::Task;

/// What JavaScript gets: a result or an error.
pub type Answer = core::result::Result<JsValue, JsValue>;

/// A running call.
#[wasm_bindgen(skip_typescript)]
pub struct JointTask(RefCell<Box<dyn FnMut(f64) -> Answer>>);

impl JointTask {
    /// A call that has begun, with what makes its result a plain object.
    pub fn new<T: 'static>(
        begun: Result<Task<'static, T>>,
        answer: fn(T) -> Answer,
    ) -> core::result::Result<Self, JsValue> {
        let mut task = begun.map_err(|error| to_js(&error))?;
        Ok(Self(RefCell::new(Box::new(move |slice_ms| {
            let done = task.step(now_ms() + slice_ms).map_err(|error| to_js(&error))?;
            done.map_or(Ok(JsValue::UNDEFINED), answer)
        }))))
    }
}

#[wasm_bindgen]
impl JointTask {
    /// Runs for about `slice_ms` milliseconds. Returns the result when finished, otherwise `undefined`.
    #[wasm_bindgen(skip_typescript)]
    pub fn step(&self, slice_ms: f64) -> Answer {
        (self.0.borrow_mut())(slice_ms)
    }
}

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

/// A property, `undefined` if it is missing.
pub fn of(object: &JsValue, key: &str) -> JsValue {
    get(object, key).unwrap_or(JsValue::UNDEFINED)
}

/// The items of a property that is an array.
pub fn items(object: &JsValue, key: &str) -> Result<Array> {
    let array = get(object, key).filter(Array::is_array);
    let array = array.ok_or_else(|| wrong_type(key, &JsValue::UNDEFINED, "an array", &format!("Pass the {key}.")))?;
    Ok(Array::from(&array))
}

/// A plain object.
pub fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new().into();
    for (name, value) in fields {
        set(&object, name, &value);
    }
    object
}

/// Sets a property of a new object, which cannot fail.
pub fn set(object: &JsValue, name: &str, value: &JsValue) {
    let _ = Reflect::set(object, &name.into(), value);
}
