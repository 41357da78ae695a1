//! The exports of the formats module: the readers of meshes, photos, masks, and depth maps as PNG and NPY.

use glam::Vec3;
use js_sys::{Array, Float32Array, Reflect, Uint8Array, Uint32Array};
use sim3align_formats::bindings::{Options, image, object, string, to_bytes, to_js};
use sim3align_formats::colored_mesh::ColoredMesh;
use sim3align_formats::depth::{DepthReadOptions, read_depth as depth_from_bytes};
use sim3align_formats::error::Error;
use sim3align_formats::mask::read_mask as mask_from_bytes;
use sim3align_formats::mesh::{
    MeshFormat, MeshReadOptions, external_resources as resources_of, read_colored_mesh as mesh_from_bytes,
    read_mesh as read_mesh_shape,
};
use sim3align_formats::photo::read_photo;
use wasm_bindgen::prelude::*;

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
