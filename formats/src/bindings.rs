//! The file readers' exports.

use glam::Vec3;
use js_sys::{Array, ArrayBuffer, Float32Array, Object, Reflect, Uint8Array, Uint32Array};
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use wasm_bindgen::prelude::*;

use crate::colored_mesh::ColoredMesh;
use crate::depth::{DepthReadOptions, read_depth as depth_from_bytes};
use crate::guard::MAX_BUFFER_BYTES;
use crate::mask::read_mask as mask_from_bytes;
use crate::mesh::{
    MeshFormat, MeshReadOptions, external_resources as resources_of, read_colored_mesh as mesh_from_bytes,
    read_mesh as read_mesh_shape,
};
use crate::photo::read_photo;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::image::Image;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Bytes of a file. */
export type FileBytes = Uint8Array | ArrayBuffer;

export interface ReadMeshOptions {
  /** The format; told from the content by default. */
  format?: "glb" | "gltf" | "obj" | "ply" | "stl";
  /** The files that a `.gltf` or `.obj` refers to, by the names in it: see `externalResources`. */
  resources?: Record<string, FileBytes>;
  /** Whether to read the colours; `true` by default. */
  colors?: boolean;
}

/** A mesh that was read. */
export interface MeshArrays {
  /** x, y, z per vertex, in the file's unit and axes. */
  positions: Float32Array;
  /** Three vertex indices per triangle. */
  indices: Uint32Array;
  /** The colours of the surface, if the file has any. */
  samples?: ColorSamples;
  /** Why the colours of the file can't be read. */
  warnings: string[];
}

/** Colours of a surface, at points spread evenly over it. */
export interface ColorSamples {
  /** x, y, z per point. */
  positions: Float32Array;
  /** x, y, z of the unit normal per point, outward. */
  normals: Float32Array;
  /** Red, green and blue per point, sRGB-encoded. */
  colors: Uint8Array;
}

/** The files that a mesh file refers to, by the names in it. */
export interface ExternalResources {
  /** Without these, the mesh can't be read. */
  shape: string[];
  /** Without these, it has no colours. */
  colors: string[];
}

/** A photo that was read; `width` and `height` in pixels. */
export interface PhotoImage {
  /** Red, green and blue per pixel, row by row, sRGB-encoded. */
  data: Uint8Array;
  width: number;
  height: number;
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
"#;

/// Reads GLB, glTF, OBJ, PLY or STL: all parts merged, node transforms applied, with the colours of the surface.
#[wasm_bindgen(js_name = readMesh, unchecked_return_type = "MeshArrays")]
pub fn read_mesh(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadMeshOptions")] options: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let read = || {
        let options = Options::new(options, &["format", "resources", "colors"])?;
        let resources = options.get("resources");
        let find = |uri: &str| to_bytes("", &Reflect::get(resources.as_ref()?, &uri.into()).ok()?).ok();
        let format = match options.get("format") {
            None => None,
            Some(format) => Some(MeshFormat::from_name(&string("options.format", &format)?)?),
        };
        let bytes = to_bytes("mesh", bytes)?;
        let with_resources = MeshReadOptions { format, resources: Some(&find) };
        if options.get("colors").is_some_and(|colors| colors.is_falsy()) {
            return read_mesh_shape(&bytes, &with_resources).map(ColoredMesh::from);
        }
        mesh_from_bytes(&bytes, &with_resources)
    };
    let ColoredMesh { mesh, colors, problem } = read().map_err(|error| to_js(&error))?;
    let mut properties = vec![
        ("positions", flat(mesh.positions()).into()),
        ("indices", Uint32Array::from(mesh.triangles().as_flattened()).into()),
        ("warnings", problem.iter().map(|problem| JsValue::from(without_colors(problem))).collect::<Array>().into()),
    ];
    if let Some(colors) = &colors {
        let samples = colors.samples();
        properties.push((
            "samples",
            object(&[
                ("positions", flat(&samples.points).into()),
                ("normals", flat(&samples.normals).into()),
                ("colors", Uint8Array::from(colors.colors().as_flattened()).into()),
            ]),
        ));
    }
    Ok(object(&properties))
}

/// The warning for colours that can't be read.
fn without_colors(problem: &Error) -> String {
    format!("The mesh is read without its colours. {problem}")
}

fn flat(points: &[Vec3]) -> Float32Array {
    let numbers: Vec<f32> = points.iter().flat_map(|p| p.to_array()).collect();
    Float32Array::from(numbers.as_slice())
}

/// The files that a mesh file refers to: what `readMesh` needs as `resources`. The libraries of an OBJ refer to files
/// themselves.
#[wasm_bindgen(js_name = externalResources, unchecked_return_type = "ExternalResources")]
pub fn external_resources(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let found = to_bytes("mesh", bytes).and_then(|bytes| resources_of(&bytes)).map_err(|error| to_js(&error))?;
    let names = |names: &[String]| names.iter().map(|name| JsValue::from(name.as_str())).collect::<Array>().into();
    Ok(object(&[("shape", names(&found.shape)), ("colors", names(&found.colors))]))
}

/// Reads a PNG or a JPEG as a photo: sRGB colours, turned as the EXIF data say; large ones are reduced.
#[wasm_bindgen(js_name = readImage, unchecked_return_type = "PhotoImage")]
pub fn read_image(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let photo = to_bytes("image", bytes).and_then(|bytes| read_photo(&bytes)).map_err(|error| to_js(&error))?;
    Ok(image(&photo, Uint8Array::from(photo.data().as_flattened()).into()))
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

/// Reads a PNG or a `.npy` array as a mask.
#[wasm_bindgen(js_name = readMask, unchecked_return_type = "MaskImage")]
pub fn read_mask(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> core::result::Result<JsValue, JsValue> {
    let mask = to_bytes("mask", bytes).and_then(|bytes| mask_from_bytes(&bytes)).map_err(|error| to_js(&error))?;
    Ok(image(&mask, Uint8Array::from(mask.data()).into()))
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

fn string(argument: &str, value: &JsValue) -> Result<String> {
    value.as_string().ok_or_else(|| invalid(argument, value, "a string", "Pass a string, or leave it out."))
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

/// A plain object `{ code, argument, found, expected, remedy }`, of which the TypeScript package makes its
/// `Sim3AlignError`.
fn to_js(error: &Error) -> JsValue {
    error.serialize(&Serializer::json_compatible()).unwrap_or_else(Into::into)
}
