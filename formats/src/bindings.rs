//! Bindings shared by the modules of file readers: JavaScript's bytes, options, images and errors.

use glam::{DVec3, Vec3};
use js_sys::{Array, ArrayBuffer, Float32Array, Function, Object, Reflect, Uint8Array, Uint32Array};
use wasm_bindgen::prelude::*;

use crate::colored_mesh::ColoredMesh;
use crate::depth::{DepthImage, DepthReadOptions, DepthUnit};
use crate::guard::{MAX_BUFFER_BYTES, too_large};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::{Error, ErrorCode, ErrorParts, Result};

/// A plain object with these properties.
pub fn object(properties: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new().into();
    for (name, value) in properties {
        set(&object, name, value.clone());
    }
    object
}

/// Sets a property of an object of [`object`].
pub fn set(object: &JsValue, name: &str, value: JsValue) {
    // A fresh object is extensible: setting a property on it can't fail.
    let _ = Reflect::set(object, &name.into(), &value);
}

/// `{ data, width, height }`.
pub fn image<T: Copy>(image: &Image<T>, data: JsValue) -> JsValue {
    let (width, height) = (image.width() as f64, image.height() as f64);
    object(&[("data", data), ("width", width.into()), ("height", height.into())])
}

fn invalid(argument: &str, found: &JsValue, expected: &str, remedy: &str) -> Error {
    let (expected, remedy) = (expected.to_owned(), remedy.to_owned());
    Error::new(ErrorCode::InvalidArgument, argument.to_owned(), describe(found), expected, remedy)
}

fn describe(value: &JsValue) -> String {
    if value.is_null() { "null".into() } else { value.js_typeof().as_string().unwrap_or_default() }
}

/// The bytes of a byte array (of this realm or another: a worker's, a test runner's) or an `ArrayBuffer`.
pub fn to_bytes(argument: &str, value: &JsValue) -> Result<Vec<u8>> {
    let property = |name: &str| Reflect::get(value, &name.into()).unwrap_or_default();
    let number = |name: &str| property(name).as_f64().unwrap_or_default();
    let is_byte_array = ArrayBuffer::is_view(value) && number("BYTES_PER_ELEMENT") == 1.0;
    if !is_byte_array && !value.is_instance_of::<ArrayBuffer>() {
        let remedy = "Read files with fs.readFile, blobs and responses with new Uint8Array(await x.arrayBuffer()).";
        return Err(invalid(argument, value, "a Uint8Array", remedy));
    }
    // A view, where a new array of another one would be a copy.
    let bytes = if is_byte_array {
        let (offset, length) = (number("byteOffset") as u32, number("byteLength") as u32);
        Uint8Array::new_with_byte_offset_and_length(&property("buffer"), offset, length)
    } else {
        Uint8Array::new(value)
    };
    if bytes.length() as usize > MAX_BUFFER_BYTES {
        let found = format!("{} bytes", bytes.length());
        return Err(too_large(argument, found, format!("at most {MAX_BUFFER_BYTES}")));
    }
    Ok(bytes.to_vec())
}

/// A string.
pub fn string(argument: &str, value: &JsValue) -> Result<String> {
    value.as_string().ok_or_else(|| invalid(argument, value, "a string", "Pass a string, or leave it out."))
}

/// The image that a decoder in JavaScript makes of a file.
pub fn decoded_image(decode: &Function, bytes: &[u8]) -> Option<Image<Rgb>> {
    let decoded = decode.call1(&JsValue::UNDEFINED, &Uint8Array::from(bytes)).ok()?;
    let side = |name: &str| Reflect::get(&decoded, &name.into()).ok()?.as_f64().map(|side| side as usize);
    let data = to_bytes("", &Reflect::get(&decoded, &"data".into()).ok()?).ok()?;
    Image::new("mesh", side("width")?, side("height")?, data.as_chunks().0.to_vec()).ok()
}

/// An options object whose names have been checked.
pub struct Options<'a>(&'a JsValue);

impl<'a> Options<'a> {
    /// Checks that all names are known.
    pub fn new(value: &'a JsValue, known: &[&str]) -> Result<Self> {
        if value.is_null() || value.is_undefined() {
            return Ok(Self(value));
        }
        let Some(object) = value.dyn_ref::<Object>() else {
            return Err(invalid("options", value, "an object", "Pass { name: value }, or leave it out."));
        };
        let mut names = Object::keys(object).into_iter().filter_map(|name| name.as_string());
        match names.find(|name| !known.contains(&name.as_str())) {
            None => Ok(Self(value)),
            Some(name) => Err(Error::new(
                ErrorCode::UnknownOption,
                format!("options.{name}"),
                "an option that does not exist",
                known.join(", "),
                "Check the spelling.",
            )),
        }
    }

    /// The value of an option that is given.
    pub fn get(&self, name: &str) -> Option<JsValue> {
        let value = Reflect::get(self.0, &name.into()).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    /// The number of an option that is given.
    pub fn number(&self, name: &str) -> Result<Option<f64>> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.as_f64() {
            Some(number) => Ok(Some(number)),
            None => {
                let remedy = "Pass a number, or leave it out.";
                Err(invalid(&format!("options.{name}"), &value, "a number", remedy).coded(ErrorCode::InvalidOption))
            }
        }
    }
}

/// The options of a reader of depth: `{ depthScale, integerDepthScale, depthKind, isPacked }`.
pub fn depth_options(options: &JsValue) -> Result<(DepthReadOptions, DepthKind)> {
    let options = Options::new(options, &["depthScale", "integerDepthScale", "depthKind", "isPacked"])?;
    let (depth_scale, integer_depth_scale) = (options.number("depthScale")?, options.number("integerDepthScale")?);
    let kind = match options.get("depthKind") {
        None => DepthKind::default(),
        Some(value) => value.as_string().as_deref().and_then(DepthKind::from_name).ok_or_else(|| {
            let names = DepthKind::ALL.map(|kind| format!("\"{}\"", kind.name())).join(", ");
            let found = value.as_string().map_or_else(|| describe(&value), |name| format!("{name:?}"));
            let remedy = "Leave it out for depth in metres.";
            Error::new(ErrorCode::InvalidOption, "options.depthKind", found, format!("one of {names}"), remedy)
        })?,
    };
    let is_packed = options.get("isPacked").is_some();
    Ok((DepthReadOptions { depth_scale, integer_depth_scale, is_packed }, kind))
}

/// `{ data, width, height, unit, camera }`.
pub fn depth_image(depth: &DepthImage) -> JsValue {
    let data = Float32Array::from(depth.values.data()).into();
    let (width, height) = (depth.values.width() as f64, depth.values.height() as f64);
    let DepthUnit { metres, source, is_assumed } = &depth.unit;
    let metres = metres.map_or(JsValue::NULL, JsValue::from);
    let unit = object(&[("metres", metres), ("source", source.as_str().into()), ("isAssumed", (*is_assumed).into())]);
    let mut properties = vec![("data", data), ("width", width.into()), ("height", height.into()), ("unit", unit)];
    if let Some(camera) = &depth.camera {
        let numbers = [("fx", camera.fx), ("fy", camera.fy), ("cx", camera.cx), ("cy", camera.cy)];
        properties.push(("camera", object(&numbers.map(|(name, number)| (name, number.into())))));
    }
    if !depth.unread.is_empty() {
        properties.push(("unread", strings(&depth.unread)));
    }
    object(&properties)
}

/// An array of strings.
pub fn strings(texts: &[String]) -> JsValue {
    texts.iter().map(JsValue::from).collect::<Array>().into()
}

/// `{ positions, indices, origin?, copies?, samples?, warnings }`.
pub fn mesh_arrays(ColoredMesh { mesh, colors, flipped, copies, origin, unread, problem }: &ColoredMesh) -> JsValue {
    let warnings = problem.iter().map(|problem| JsValue::from(without_colors(problem)));
    let mut properties = vec![
        ("positions", flat(mesh.positions()).into()),
        ("indices", Uint32Array::from(mesh.triangles().as_flattened()).into()),
        ("warnings", warnings.collect::<Array>().into()),
    ];
    if !unread.is_empty() {
        properties.push(("unread", strings(unread)));
    }
    if *origin != DVec3::ZERO {
        let numbers: Array = origin.to_array().into_iter().map(JsValue::from).collect();
        properties.push(("origin", numbers.into()));
    }
    if *copies > 0 {
        properties.push(("copies", (*copies as u32).into()));
    }
    if let Some(colors) = colors {
        let cloud = colors.samples();
        let bytes = |colors: &[Rgb]| Uint8Array::from(colors.as_flattened()).into();
        let mut samples = vec![
            ("positions", flat(&cloud.points).into()),
            ("normals", flat(&cloud.normals).into()),
            ("colors", bytes(colors.colors())),
        ];
        if !flipped.is_empty() {
            samples.push(("flippedColors", bytes(flipped)));
        }
        properties.push(("samples", object(&samples)));
    }
    object(&properties)
}

/// The warning for colours that can't be read.
fn without_colors(problem: &Error) -> String {
    format!("The mesh is read without its colours. {problem}")
}

fn flat(points: &[Vec3]) -> Float32Array {
    let numbers: Vec<f32> = points.iter().flat_map(|p| p.to_array()).collect();
    Float32Array::from(numbers.as_slice())
}

/// A plain object `{ code, argument, found, expected, remedy }`, of which the TypeScript package makes its
/// `Sim3AlignError`.
pub fn to_js(error: &Error) -> JsValue {
    let ErrorParts { code, argument, found, expected, remedy } = &**error;
    let texts =
        [("code", code.as_str()), ("argument", argument), ("found", found), ("expected", expected), ("remedy", remedy)];
    object(&texts.map(|(name, text)| (name, text.into())))
}
