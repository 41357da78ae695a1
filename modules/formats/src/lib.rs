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

/// Reads GLB, glTF, OBJ, PLY or STL: all parts merged, node transforms applied, with the colours of the surface.
#[wasm_bindgen(js_name = readMesh, skip_typescript)]
pub fn read_mesh(bytes: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
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
#[wasm_bindgen(js_name = externalResources, skip_typescript)]
pub fn external_resources(bytes: &JsValue) -> Result<JsValue, JsValue> {
    let found = to_bytes("mesh", bytes).and_then(|bytes| resources_of(&bytes)).map_err(|error| to_js(&error))?;
    let names = |names: &[String]| names.iter().map(|name| JsValue::from(name.as_str())).collect::<Array>().into();
    Ok(object(&[("shape", names(&found.shape)), ("colors", names(&found.colors))]))
}

/// Reads a PNG or a JPEG as a photo: sRGB colours, turned by the orientation of its EXIF data unless it is wanted as stored;
/// large ones are reduced.
#[wasm_bindgen(js_name = readImage, skip_typescript)]
pub fn read_image(bytes: &JsValue, as_stored: Option<bool>) -> Result<JsValue, JsValue> {
    let read = if as_stored == Some(true) { read_stored_photo } else { read_photo };
    let photo = to_bytes("image", bytes).and_then(|bytes| read(&bytes)).map_err(|error| to_js(&error))?;
    Ok(image(&photo, Uint8Array::from(photo.data().as_flattened()).into()))
}

/// Reads the EXIF data of a PNG or a JPEG, or of bytes that begin with their TIFF header; a property is missing where they do not state it.
#[wasm_bindgen(js_name = readExif, skip_typescript)]
pub fn read_exif(bytes: &JsValue) -> Result<JsValue, JsValue> {
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
#[wasm_bindgen(js_name = readDepth, skip_typescript)]
pub fn read_depth(bytes: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
    let read = || {
        let (options, kind) = depth_options(options)?;
        read_depth_image(&to_bytes("depth", bytes)?, &options, kind)
    };
    read().map(|depth| depth_image(&depth)).map_err(|error| to_js(&error))
}

/// Reads a PNG, a JPEG or a `.npy` array as a mask.
#[wasm_bindgen(js_name = readMask, skip_typescript)]
pub fn read_mask(bytes: &JsValue) -> Result<JsValue, JsValue> {
    let mask = to_bytes("mask", bytes).and_then(|bytes| mask_from_bytes(&bytes)).map_err(|error| to_js(&error))?;
    let object = image(&mask.object, Uint8Array::from(mask.object.data()).into());
    set(&object, "reading", mask.reading.into());
    Ok(object)
}
