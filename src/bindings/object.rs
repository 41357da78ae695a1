//! Reads properties of JavaScript objects, with errors that name them.

use js_sys::{Array, Float32Array, Float64Array, Reflect, Uint8Array, Uint8ClampedArray, Uint16Array, Uint32Array};
use wasm_bindgen::{JsCast, JsValue};

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::surface_colors::Rgb;
use crate::number::number as number_text;

/// The property `key`, or `None` if it is missing, `undefined` or `null`.
pub fn get(object: &JsValue, key: &str) -> Option<JsValue> {
    // Reflect.get throws on primitives, which have none of the properties.
    Reflect::get(object, &key.into()).ok().filter(|value| !value.is_undefined() && !value.is_null())
}

/// The property `key` as a number.
pub fn number(object: &JsValue, argument: &str, key: &str) -> Result<Option<f64>> {
    get(object, key).map(|value| to_number(&value, &format!("{argument}.{key}"))).transpose()
}

/// The required property `key` as a number.
pub fn required_number(object: &JsValue, argument: &str, key: &str) -> Result<f64> {
    number(object, argument, key)?
        .ok_or_else(|| wrong_type(&format!("{argument}.{key}"), &JsValue::UNDEFINED, "a number", "Pass it."))
}

/// The property `key` as a size in pixels.
pub fn size(object: &JsValue, key: &str) -> Result<Option<usize>> {
    let Some(value) = get(object, key) else { return Ok(None) };
    let number = to_number(&value, key)?;
    // Any integer below 2³¹; the product of two sizes is compared with array lengths.
    if (0.0..=2_147_483_647.0).contains(&number) && number.fract() == 0.0 {
        return Ok(Some(number as usize));
    }
    Err(wrong_type(key, &value, "an integer in pixels", "Pass the image size in pixels."))
}

/// A JavaScript number.
pub fn to_number(value: &JsValue, argument: &str) -> Result<f64> {
    value.as_f64().ok_or_else(|| wrong_type(argument, value, "a number", "Pass a number."))
}

/// An array (typed or not) of exactly N numbers.
pub fn to_numbers<const N: usize>(value: &JsValue, argument: &str) -> Result<[f64; N]> {
    let mut numbers = [0.0; N];
    read_numbers(value, argument, &mut numbers)?;
    Ok(numbers)
}

/// The same for every length, to keep the code small.
fn read_numbers(value: &JsValue, argument: &str, numbers: &mut [f64]) -> Result<()> {
    let expected = || format!("{} numbers", numbers.len());
    let wrong = || wrong_type(argument, value, &expected(), "Pass an array of numbers.");
    let array = flat_array(value).ok_or_else(wrong)?;
    if array.length() as usize != numbers.len() {
        let found = format!("{} numbers", array.length());
        return Err(Error::new(ErrorCode::WrongLength, argument.to_owned(), found, expected(), "Check its shape."));
    }
    let read: Option<Vec<f64>> = array.iter().map(|item| item.as_f64()).collect();
    numbers.copy_from_slice(&read.ok_or_else(wrong)?);
    Ok(())
}

/// An array or typed array as an `Array`; nested rows are flattened.
fn flat_array(value: &JsValue) -> Option<Array> {
    if Array::is_array(value) {
        let array = Array::from(value);
        let nested = array.iter().any(|item| Array::is_array(&item) || is_typed_array(&item));
        return Some(if nested { array.flat(1) } else { array });
    }
    is_typed_array(value).then(|| Array::from(value))
}

fn is_typed_array(value: &JsValue) -> bool {
    value.is_instance_of::<Float32Array>() || value.is_instance_of::<Float64Array>()
}

/// Largest array of an argument, bytes: 67 million pixels of f32. Derived data, at up to 31 bytes per number, then
/// stays below 2 GB, which is what a single allocation can have.
const MAX_BYTES: f64 = (1 << 28) as f64;

/// Checks the size of a typed array before it is copied; 16-bit numbers become 32-bit ones.
pub fn check_bytes(array: &JsValue, argument: &str) -> Result<()> {
    let of_numbers = if array.is_instance_of::<Uint16Array>() { 2.0 } else { 1.0 };
    let bytes = of_numbers * get(array, "byteLength").and_then(|bytes| bytes.as_f64()).unwrap_or_default();
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::OutOfMemory,
        argument.to_owned(),
        format!("an array of {} MB", number_text((bytes / 1e6).round())),
        format!("at most {} MB", MAX_BYTES as u32 / 1_000_000),
        "Crop the images to the object, reduce their size, or simplify the mesh.",
    ))
}

/// A copy of a `Float32Array`.
pub fn to_f32s(value: &JsValue, argument: &str) -> Result<Vec<f32>> {
    check_bytes(value, argument)?;
    match value.dyn_ref::<Float32Array>() {
        Some(array) => Ok(array.to_vec()),
        None => Err(not_typed_array(argument, value, "a Float32Array")),
    }
}

/// A copy of a `Float32Array` or `Float64Array` in f64.
pub fn to_f64s(value: &JsValue, argument: &str) -> Result<Vec<f64>> {
    check_bytes(value, argument)?;
    if let Some(array) = value.dyn_ref::<Float64Array>() {
        return Ok(array.to_vec());
    }
    match value.dyn_ref::<Float32Array>() {
        Some(array) => Ok(array.to_vec().into_iter().map(f64::from).collect()),
        None => Err(not_typed_array(argument, value, "a Float32Array or Float64Array")),
    }
}

/// A copy of a `Uint32Array` or `Uint16Array`.
pub fn to_u32s(value: &JsValue, argument: &str) -> Result<Vec<u32>> {
    check_bytes(value, argument)?;
    if let Some(array) = value.dyn_ref::<Uint32Array>() {
        return Ok(array.to_vec());
    }
    match value.dyn_ref::<Uint16Array>() {
        Some(array) => Ok(array.to_vec().into_iter().map(u32::from).collect()),
        None => Err(not_typed_array(argument, value, "a Uint32Array or Uint16Array")),
    }
}

/// A copy of a `Uint8Array` or `Uint8ClampedArray`.
pub fn to_u8s(value: &JsValue, argument: &str) -> Result<Vec<u8>> {
    check_bytes(value, argument)?;
    if let Some(array) = value.dyn_ref::<Uint8Array>() {
        return Ok(array.to_vec());
    }
    match value.dyn_ref::<Uint8ClampedArray>() {
        Some(array) => Ok(array.to_vec()),
        None => Err(not_typed_array(argument, value, "a Uint8Array")),
    }
}

/// A copy of a `Uint8Array` of red, green and blue; what is left over is ignored, because TypeScript checks the lengths.
pub fn to_colors(value: &JsValue, argument: &str) -> Result<Vec<Rgb>> {
    to_u8s(value, argument).map(|bytes| bytes.as_chunks().0.to_vec())
}

/// A value of the wrong type.
pub fn wrong_type(argument: &str, value: &JsValue, expected: &str, remedy: &str) -> Error {
    Error::new(ErrorCode::InvalidArgument, argument.to_owned(), describe(value), expected.to_owned(), remedy.to_owned())
}

fn not_typed_array(argument: &str, value: &JsValue, expected: &str) -> Error {
    wrong_type(argument, value, expected, "Convert it first, for example with `new Float32Array(values)`.")
}

/// Describes a JavaScript value for error messages.
pub fn describe(value: &JsValue) -> String {
    if value.is_undefined() {
        return "nothing".into();
    }
    if value.is_null() {
        return "null".into();
    }
    if let Some(text) = value.as_string() {
        let start: String = text.chars().take(40).collect();
        return format!("the string \"{start}\"");
    }
    if let Some(number) = value.as_f64() {
        return format!("the number {}", number_text(number));
    }
    if Array::is_array(value) {
        return format!("an Array of {}", Array::from(value).length());
    }
    if value.is_function() {
        return "a function".into();
    }
    if !value.is_object() {
        return value.js_typeof().as_string().unwrap_or_default();
    }
    // An object need not have a constructor, nor the constructor a name.
    let name = get(value, "constructor").and_then(|class| get(&class, "name")).and_then(|name| name.as_string());
    name.map_or_else(|| "an object".into(), |name| format!("a value of type {name}"))
}
