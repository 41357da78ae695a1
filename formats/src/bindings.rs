//! The file readers' exports.

use js_sys::{Array, ArrayBuffer, Float32Array, JSON, Object, Reflect, Uint8Array, Uint32Array};
use wasm_bindgen::prelude::*;

use crate::camera::read_camera as camera_from_json;
use crate::depth::{DepthReadOptions, read_depth as depth_from_bytes};
use crate::gltf;
use crate::guard::MAX_BUFFER_BYTES;
use crate::mask::read_mask as mask_from_bytes;
use crate::mesh::{MeshFormat, MeshReadOptions, read_mesh as mesh_from_bytes};
use crate::rle::Rle;
use crate::truth::read_truth as truth_from_json;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::image::{Image, Mask};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Bytes of a file. */
export type FileBytes = Uint8Array | ArrayBuffer;

export interface ReadMeshOptions {
  /** The format; told from the content by default. */
  format?: "glb" | "gltf" | "obj" | "ply" | "stl";
  /** The buffers of a `.gltf` by the URIs it names them with: see `externalResources`. */
  resources?: Record<string, FileBytes>;
}

/** A mesh that was read. */
export interface MeshArrays {
  /** x, y, z per vertex, in the file's unit and axes. */
  positions: Float32Array;
  /** Three vertex indices per triangle. */
  indices: Uint32Array;
}

export interface ReadDepthOptions {
  /** Metres per unit, above 0. By default, whole numbers are millimetres (0.001) and floats are metres. */
  depthScale?: number;
  /** Metres per unit of whole numbers only, where there is no `depthScale`: what a camera file says. */
  integerDepthScale?: number;
}

/** A depth map that was read; `width` and `height` in pixels. */
export interface DepthImage {
  /** Metres along the optical axis, row by row; 0 is no reading. */
  data: Float32Array;
  width: number;
  height: number;
}

/** A mask that was read; `width` and `height` in pixels. */
export interface MaskImage {
  /** Row by row; 1 is the object. */
  data: Uint8Array;
  width: number;
  height: number;
}

/** COCO's run-length encoding: `size` is [height, width]; a string of `counts` is the compressed form. */
export interface CocoRle {
  size: [number, number];
  counts: string | number[];
}

export interface ReadCameraOptions {
  /** The depth map's size in pixels: needed for a field of view, checked against the file's. */
  width?: number;
  height?: number;
  /** Which entry of a BOP `scene_camera.json`. */
  imageId?: string | number;
}
/** What a camera file says: intrinsics, pixels (centres at whole numbers), for an image of width × height. */
export interface CameraFile {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  width?: number;
  height?: number;
  /** Metres per unit of whole-number depth. */
  depthScale?: number;
  warnings: string[];
}

/** A true pose: x_cam = scale · R · p_mesh + translation, metres. */
export interface Truth {
  scale: number;
  /** Quaternion x, y, z, w. */
  rotation: [number, number, number, number];
  /** R, row by row. */
  rotationMatrix: [[number, number, number], [number, number, number], [number, number, number]];
  translation: [number, number, number];
  /** 16 numbers, column by column. */
  matrix: number[];
  symmetry: string;
}
"#;

/// Reads GLB, glTF, OBJ, PLY or STL: all parts merged, node transforms applied.
#[wasm_bindgen(js_name = readMesh, unchecked_return_type = "MeshArrays")]
pub fn read_mesh(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadMeshOptions")] options: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let read = || {
        let options = Options::new(options, &["format", "resources"])?;
        let resources = options.get("resources");
        let find = |uri: &str| to_bytes("", &Reflect::get(resources.as_ref()?, &uri.into()).ok()?).ok();
        let format = match options.get("format") {
            None => None,
            Some(format) => Some(MeshFormat::from_name(&string("options.format", &format)?)?),
        };
        mesh_from_bytes(&to_bytes("mesh", bytes)?, &MeshReadOptions { format, resources: Some(&find) })
    };
    let mesh = read().map_err(|error| to_js(&error))?;
    let positions: Vec<f32> = mesh.positions().iter().flat_map(|p| p.to_array()).collect();
    Ok(object(&[
        ("positions", Float32Array::from(positions.as_slice()).into()),
        ("indices", Uint32Array::from(mesh.triangles().as_flattened()).into()),
    ]))
}

/// The URIs of the files that a `.gltf` keeps its geometry in: what `readMesh` needs as `resources`.
#[wasm_bindgen(js_name = externalResources)]
pub fn external_resources(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> core::result::Result<Vec<String>, JsValue> {
    to_bytes("mesh", bytes).and_then(|bytes| gltf::external_resources(&bytes)).map_err(|error| to_js(&error))
}

/// Reads a 16-bit grey PNG or a `.npy` array as depth in metres.
#[wasm_bindgen(js_name = readDepth, unchecked_return_type = "DepthImage")]
pub fn read_depth(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadDepthOptions")] options: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let read = || {
        let options = Options::new(options, &["depthScale", "integerDepthScale"])?;
        let (depth_scale, integer_depth_scale) = (options.number("depthScale")?, options.number("integerDepthScale")?);
        depth_from_bytes(&to_bytes("depth", bytes)?, &DepthReadOptions { depth_scale, integer_depth_scale })
    };
    let depth = read().map_err(|error| to_js(&error))?;
    Ok(image(&depth, Float32Array::from(depth.data()).into()))
}

/// Reads a PNG, a `.npy` array or COCO RLE in JSON as a mask.
#[wasm_bindgen(js_name = readMask, unchecked_return_type = "MaskImage")]
pub fn read_mask(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let mask = to_bytes("mask", bytes).and_then(|bytes| mask_from_bytes(&bytes)).map_err(|error| to_js(&error))?;
    Ok(image(&mask, Uint8Array::from(mask.data()).into()))
}

/// Decodes COCO's run-length encoding, plain or compressed.
#[wasm_bindgen(js_name = decodeCocoRle, unchecked_return_type = "MaskImage")]
pub fn decode_coco_rle(
    #[wasm_bindgen(unchecked_param_type = "CocoRle")] rle: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let decode = || Rle::from_json(&json_bytes("rle", rle)?).and_then(|rle| rle.decode());
    let mask = decode().map_err(|error| to_js(&error.about("rle")))?;
    Ok(image(&mask, Uint8Array::from(mask.data()).into()))
}

/// Encodes a mask, row by row, non-zero is the object, as COCO's run-length encoding: compressed by default.
#[wasm_bindgen(js_name = encodeCocoRle, unchecked_return_type = "CocoRle")]
pub fn encode_coco_rle(
    #[wasm_bindgen(unchecked_param_type = "Uint8Array")] mask: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "number")] width: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "number")] height: &JsValue,
    compressed: Option<bool>,
) -> core::result::Result<JsValue, JsValue> {
    let encode = || {
        let (width, height) = (whole("width", width)?, whole("height", height)?);
        Ok(Rle::encode(&Mask::new("mask", width, height, to_bytes("mask", mask)?)?))
    };
    let rle = encode().map_err(|error: Error| to_js(&error))?;
    let counts = match compressed {
        None | Some(true) => rle.to_compressed().into(),
        Some(false) => numbers(rle.counts.iter().map(|&run| f64::from(run))),
    };
    let size = numbers([rle.height as f64, rle.width as f64]);
    Ok(object(&[("size", size), ("counts", counts)]))
}

/// Reads a camera file: fx fy cx cy, K, a field of view, BOP, ROS or Open3D; bytes, text or the parsed object.
#[wasm_bindgen(js_name = readCamera, unchecked_return_type = "CameraFile")]
pub fn read_camera(
    #[wasm_bindgen(unchecked_param_type = "FileBytes | string | object")] file: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadCameraOptions")] options: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let read = || {
        let options = Options::new(options, &["width", "height", "imageId"])?;
        let side = |name: &str| options.get(name).map(|side| whole(&format!("options.{name}"), &side)).transpose();
        let size = side("width")?.zip(side("height")?);
        let image_id = match options.get("imageId") {
            None => None,
            Some(id) => match id.as_f64() {
                Some(number) => Some(format!("{number}")),
                None => Some(string("options.imageId", &id)?),
            },
        };
        camera_from_json(&json_bytes("camera", file)?, size, image_id.as_deref())
    };
    let file = read().map_err(|error| to_js(&error))?;
    let camera = file.camera;
    let mut properties: Vec<(&str, JsValue)> =
        vec![("fx", camera.fx.into()), ("fy", camera.fy.into()), ("cx", camera.cx.into()), ("cy", camera.cy.into())];
    let sides = [("width", file.width), ("height", file.height)];
    properties.extend(sides.into_iter().filter_map(|(name, side)| Some((name, JsValue::from(side? as f64)))));
    properties.extend(file.depth_scale_m.map(|scale| ("depthScale", scale.into())));
    let warnings: Array = file.warnings.iter().map(|warning| JsValue::from(warning.as_str())).collect();
    properties.push(("warnings", warnings.into()));
    Ok(object(&properties))
}

/// Reads a true pose (`gt.json`): bytes, text or the parsed object; `null` where it says `available: false`.
#[wasm_bindgen(js_name = readTruth, unchecked_return_type = "Truth | null")]
pub fn read_truth(
    #[wasm_bindgen(unchecked_param_type = "FileBytes | string | object")] file: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let truth = json_bytes("truth", file).and_then(|bytes| truth_from_json(&bytes)).map_err(|error| to_js(&error))?;
    let Some((pose, symmetry)) = truth else { return Ok(JsValue::NULL) };
    let rows: Array = pose.rotation.matrix().row_iter().map(|row| numbers(row.iter().copied())).collect();
    Ok(object(&[
        ("scale", pose.scale.into()),
        ("rotation", numbers(pose.quaternion_xyzw())),
        ("rotationMatrix", rows.into()),
        ("translation", numbers(pose.translation.iter().copied())),
        ("matrix", numbers(pose.to_column_major())),
        ("symmetry", symmetry.into()),
    ]))
}

fn object(properties: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new();
    for (name, value) in properties {
        // A fresh object is extensible: setting a property on it can't fail.
        let _ = Reflect::set(&object, &(*name).into(), value);
    }
    object.into()
}

fn image<T: Copy>(image: &Image<T>, data: JsValue) -> JsValue {
    let (width, height) = (image.width() as f64, image.height() as f64);
    object(&[("data", data), ("width", width.into()), ("height", height.into())])
}

fn numbers(values: impl IntoIterator<Item = f64>) -> JsValue {
    values.into_iter().map(JsValue::from).collect::<Array>().into()
}

fn invalid(argument: &str, found: &JsValue, expected: &str, remedy: &str) -> Error {
    let kind = if found.is_null() { "null".into() } else { found.js_typeof().as_string().unwrap_or_default() };
    Error::new(ErrorCode::InvalidArgument, argument.to_owned(), kind, expected.to_owned(), remedy.to_owned())
}

/// The bytes of a byte array (of this realm or another: a worker's, a test runner's) or an `ArrayBuffer`.
fn to_bytes(argument: &str, value: &JsValue) -> Result<Vec<u8>> {
    let element_bytes = || Reflect::get(value, &"BYTES_PER_ELEMENT".into()).ok().and_then(|size| size.as_f64());
    let is_byte_array = ArrayBuffer::is_view(value) && element_bytes() == Some(1.0);
    if !is_byte_array && !value.is_instance_of::<ArrayBuffer>() {
        let remedy = "Read files with fs.readFile, blobs and responses with new Uint8Array(await x.arrayBuffer()).";
        return Err(invalid(argument, value, "a Uint8Array", remedy));
    }
    let bytes = Uint8Array::new(value);
    if bytes.length() as usize > MAX_BUFFER_BYTES {
        let found = format!("{} bytes", bytes.length());
        return Err(crate::guard::too_large(argument, found, format!("at most {MAX_BUFFER_BYTES}")));
    }
    Ok(bytes.to_vec())
}

/// The bytes of JSON given as bytes, as text or as the object itself.
fn json_bytes(argument: &str, value: &JsValue) -> Result<Vec<u8>> {
    if let Some(text) = value.as_string() {
        return Ok(text.into_bytes());
    }
    if value.is_object() && !ArrayBuffer::is_view(value) && !value.is_instance_of::<ArrayBuffer>() {
        let text = JSON::stringify(value).ok().and_then(|text| text.as_string());
        let remedy = "Pass the file's bytes, its text or the parsed object.";
        return text.map(String::into_bytes).ok_or_else(|| invalid(argument, value, "plain JSON", remedy));
    }
    to_bytes(argument, value)
}

fn string(argument: &str, value: &JsValue) -> Result<String> {
    value.as_string().ok_or_else(|| invalid(argument, value, "a string", "Pass a string, or leave it out."))
}

fn whole(argument: &str, value: &JsValue) -> Result<usize> {
    match value.as_f64() {
        Some(number) if number >= 0.0 && number <= f64::from(u32::MAX) && number == number.trunc() => {
            Ok(number as usize)
        }
        Some(number) => {
            let remedy = "Pass the size in pixels.";
            Err(Error::new(
                ErrorCode::InvalidArgument,
                argument.to_owned(),
                format!("{number}"),
                "a whole number",
                remedy,
            ))
        }
        None => Err(invalid(argument, value, "a whole number", "Pass the size in pixels.")),
    }
}

/// An options object whose names have been checked.
struct Options<'a>(&'a JsValue);

impl<'a> Options<'a> {
    fn new(value: &'a JsValue, known: &[&str]) -> Result<Self> {
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

    fn get(&self, name: &str) -> Option<JsValue> {
        let value = Reflect::get(self.0, &name.into()).ok()?;
        (!value.is_undefined() && !value.is_null()).then_some(value)
    }

    fn number(&self, name: &str) -> Result<Option<f64>> {
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

/// A JavaScript `Error` named `Sim3AlignError` with the own properties `code`, `argument`, `found`, `expected` and
/// `remedy`.
fn to_js(error: &Error) -> JsValue {
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

/// See the aligner's.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: rlsf::SmallGlobalTlsf = rlsf::SmallGlobalTlsf::new();
