//! The exports of the formats module: the readers of meshes, photos, masks, and depth maps as PNG and NPY.

use js_sys::{Array, Function, Reflect, Uint8Array};
use sim3align_formats::bindings::{
    Options, decoded_image, depth_image, depth_options, image, mesh_arrays, object, set, string, to_bytes, to_js,
};
use sim3align_formats::depth::read_depth_image;
use sim3align_formats::mask::read_mask as mask_from_bytes;
use sim3align_formats::mesh::{
    ColorSpace, MeshFormat, MeshReadOptions, external_resources as resources_of, read_colored_mesh as mesh_from_bytes,
    read_shape,
};
use sim3align_formats::photo::{read_exif as exif_from_bytes, read_photo, read_stored_photo};
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Bytes of a file. */
export type FileBytes = Uint8Array | ArrayBuffer;

export interface ReadMeshOptions {
  /** The format; told from the content by default. */
  format?: "glb" | "gltf" | "obj" | "ply" | "stl";
  /** The files that a glTF, OBJ or PLY file refers to, by the names in it: see `externalResources`. */
  resources?: Record<string, FileBytes>;
  /** Whether to read the colours; `true` by default. */
  colors?: boolean;
  /** What the vertex colours of a glTF file are; by default, bytes are sRGB-encoded and others mostly linear. */
  colorSpace?: "srgb" | "linear";
  /**
   * Decodes a texture in a format that is neither PNG nor JPEG, such as KTX2: sRGB-encoded RGB pixels, row by row from the top left;
   * `undefined` if it cannot.
   */
  decodeImage?: (bytes: Uint8Array) => { data: Uint8Array; width: number; height: number } | undefined;
}

/** A mesh that was read. */
export interface MeshArrays {
  /** x, y, z per vertex, in the file's unit and axes, relative to `origin`. */
  positions: Float32Array;
  /**
   * What was subtracted from the coordinates of the file: x, y, z of its centre, for coordinates that are too large for 32 bits,
   * such as those of a map; otherwise missing.
   */
  origin?: [number, number, number];
  /** How many copies of one mesh the file places, if it has no other; otherwise missing. */
  copies?: number;
  /** Three vertex indices per triangle. */
  indices: Uint32Array;
  /** The colours of the surface, if the file has any. */
  samples?: ColorSamples;
  /** Content of the file that its reader does not know; missing if there is nothing. */
  unread?: string[];
  /** Why the colours of the file can't be read. */
  warnings: string[];
}

/** Colours of a surface, at points spread evenly over it. */
export interface ColorSamples {
  /** Interleaved x, y, z per point, in the frame of the mesh. */
  positions: Float32Array;
  /** The unit normal of the surface at each point, outward: interleaved x, y, z. */
  normals: Float32Array;
  /** Red, green and blue per point, sRGB-encoded. */
  colors: Uint8Array;
  /** The same if the textures were stored upside down, with which `align` compares a photo that contradicts `colors`. */
  flippedColors?: Uint8Array | undefined;
}

/** The files that a mesh file refers to, by the names in it. */
export interface ExternalResources {
  /** The buffers of a `.gltf`, without which it cannot be read. */
  shape: string[];
  /** Textures and material libraries, without which it has no colours. */
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
  /** What the values are; `"metric"` by default. */
  depthKind?: string;
}

/** A depth map that was read; `width` and `height` in pixels. */
export interface DepthImage {
  /** Row by row: metres along the optical axis, unless `depthKind` says otherwise. */
  data: Float32Array;
  width: number;
  height: number;
  /** The unit of the values in the file; `metres` is null without one. */
  unit: { metres: number | null; source: string; isAssumed: boolean };
  /** The camera in the file, in pixels. */
  camera?: { fx: number; fy: number; cx: number; cy: number };
  /** Content of the file that its reader does not know; missing if there is nothing. */
  unread?: string[];
}

/** The camera by the EXIF data of a photo; properties that they do not state are missing. */
export interface Exif {
  /** Focal length with the same diagonal field of view on a frame of 36 × 24 mm, in mm: `FocalLengthIn35mmFilm`. */
  focalLength35mm?: number;
  /** Focal length of the lens, in mm. */
  focalLengthMm?: number;
  /** Width of the sensor as far as the original image shows it, in mm. */
  sensorWidthMm?: number;
  /** How many times the camera enlarged the image. */
  digitalZoom?: number;
  make?: string;
  model?: string;
  /** 1 to 8; from 5, the stored image is viewed with its sides exchanged. 1 if the data state none. */
  orientation: number;
  /** Width of the original image as stored, in pixels. */
  width?: number;
  /** Height of the original image as stored, in pixels. */
  height?: number;
}

/** A mask that was read; `width` and `height` in pixels. */
export interface MaskImage {
  /** Row by row; 1 is the object. */
  data: Uint8Array;
  width: number;
  height: number;
  /** Which values of the file are the object: `values of 127.5 or more, of 0 to 255`. */
  reading: string;
}
"#;

/// Reads GLB, glTF, OBJ, PLY or STL: all parts merged, node transforms applied, with the colours of the surface.
#[wasm_bindgen(js_name = readMesh, unchecked_return_type = "MeshArrays")]
pub fn read_mesh(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadMeshOptions")] options: &JsValue,
) -> Result<JsValue, JsValue> {
    let read = || {
        let options = Options::new(options, &["format", "resources", "colors", "colorSpace", "decodeImage"])?;
        let resources = options.get("resources");
        let find = |uri: &str| to_bytes("", &Reflect::get(resources.as_ref()?, &uri.into()).ok()?).ok();
        let format = match options.get("format") {
            None => None,
            Some(format) => Some(MeshFormat::from_name(&string("options.format", &format)?)?),
        };
        let bytes = to_bytes("mesh", bytes)?;
        let decoder = options.get("decodeImage").and_then(|decoder| decoder.dyn_into::<Function>().ok());
        let decode = |bytes: &[u8]| decoder.as_ref().and_then(|decode| decoded_image(decode, bytes));
        let color_space = match options.get("colorSpace") {
            None => None,
            Some(space) => Some(ColorSpace::from_name(&string("options.colorSpace", &space)?)?),
        };
        let with_resources = MeshReadOptions { format, resources: Some(&find), images: Some(&decode), color_space };
        if options.get("colors").is_some_and(|colors| colors.is_falsy()) {
            return read_shape(&bytes, &with_resources);
        }
        mesh_from_bytes(&bytes, &with_resources)
    };
    read().map(|mesh| mesh_arrays(&mesh)).map_err(|error| to_js(&error))
}

/// The files that a mesh file refers to: what `readMesh` needs as `resources`. The libraries of an OBJ refer to files
/// themselves.
#[wasm_bindgen(js_name = externalResources, unchecked_return_type = "ExternalResources")]
pub fn external_resources(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
) -> Result<JsValue, JsValue> {
    let found = to_bytes("mesh", bytes).and_then(|bytes| resources_of(&bytes)).map_err(|error| to_js(&error))?;
    let names = |names: &[String]| names.iter().map(|name| JsValue::from(name.as_str())).collect::<Array>().into();
    Ok(object(&[("shape", names(&found.shape)), ("colors", names(&found.colors))]))
}

/// Reads a PNG or a JPEG as a photo: sRGB colours, turned by the orientation of its EXIF data unless it is wanted as stored;
/// large ones are reduced.
#[wasm_bindgen(js_name = readImage, unchecked_return_type = "PhotoImage")]
pub fn read_image(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    as_stored: Option<bool>,
) -> Result<JsValue, JsValue> {
    let read = if as_stored == Some(true) { read_stored_photo } else { read_photo };
    let photo = to_bytes("image", bytes).and_then(|bytes| read(&bytes)).map_err(|error| to_js(&error))?;
    Ok(image(&photo, Uint8Array::from(photo.data().as_flattened()).into()))
}

/// Reads the EXIF data of a PNG or a JPEG, or of bytes that begin with their TIFF header; a property is missing where they do not state it.
#[wasm_bindgen(js_name = readExif, unchecked_return_type = "Exif")]
pub fn read_exif(#[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue) -> Result<JsValue, JsValue> {
    let exif = to_bytes("image", bytes).and_then(|bytes| exif_from_bytes(&bytes)).map_err(|error| to_js(&error))?;
    let numbers = [
        ("focalLength35mm", exif.focal_length_35mm),
        ("focalLengthMm", exif.focal_length_mm),
        ("sensorWidthMm", exif.sensor_width_mm),
        ("digitalZoom", exif.digital_zoom),
        ("width", exif.width.map(f64::from)),
        ("height", exif.height.map(f64::from)),
    ];
    let texts = [("make", exif.make), ("model", exif.model)];
    let mut properties: Vec<(&str, JsValue)> = vec![("orientation", exif.orientation.number().into())];
    properties.extend(numbers.into_iter().filter_map(|(name, number)| Some((name, number?.into()))));
    properties.extend(texts.into_iter().filter_map(|(name, text)| Some((name, text?.into()))));
    Ok(object(&properties))
}

/// Reads a grey PNG or a `.npy` array as depth.
#[wasm_bindgen(js_name = readDepth, unchecked_return_type = "DepthImage")]
pub fn read_depth(
    #[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "ReadDepthOptions")] options: &JsValue,
) -> Result<JsValue, JsValue> {
    let read = || {
        let (options, kind) = depth_options(options)?;
        read_depth_image(&to_bytes("depth", bytes)?, &options, kind)
    };
    read().map(|depth| depth_image(&depth)).map_err(|error| to_js(&error))
}

/// Reads a PNG, a JPEG or a `.npy` array as a mask.
#[wasm_bindgen(js_name = readMask, unchecked_return_type = "MaskImage")]
pub fn read_mask(#[wasm_bindgen(unchecked_param_type = "FileBytes")] bytes: &JsValue) -> Result<JsValue, JsValue> {
    let mask = to_bytes("mask", bytes).and_then(|bytes| mask_from_bytes(&bytes)).map_err(|error| to_js(&error))?;
    let object = image(&mask.object, Uint8Array::from(mask.object.data()).into());
    set(&object, "reading", mask.reading.into());
    Ok(object)
}
