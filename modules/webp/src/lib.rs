//! The export of the module that decodes WebP.

use js_sys::Uint8Array;
use sim3align_formats::bindings::{image, set, to_bytes, to_js};
use sim3align_formats::webp::read_webp;
use wasm_bindgen::prelude::*;

/// Decodes a WebP: `(bytes, asStored) → { data, width, height, exif? }`, RGB, and the EXIF data from their TIFF header.
#[wasm_bindgen(js_name = decodeWebp, skip_typescript)]
pub fn decode_webp(bytes: &JsValue, as_stored: bool) -> Result<JsValue, JsValue> {
    let read =
        to_bytes("image", bytes).and_then(|bytes| read_webp(&bytes, as_stored)).map_err(|error| to_js(&error))?;
    let decoded = image(&read.pixels, Uint8Array::from(read.pixels.data().as_flattened()).into());
    if let Some(exif) = &read.exif {
        set(&decoded, "exif", Uint8Array::from(exif.as_slice()).into());
    }
    Ok(decoded)
}
