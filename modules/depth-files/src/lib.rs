//! The export of the module that reads the files of depth models.

use sim3align_formats::bindings::{depth_image, depth_options, to_bytes, to_js};
use sim3align_formats::depth::read_depth_file as depth_from_bytes;
use wasm_bindgen::prelude::*;

/// Reads depth from the bytes of an NPZ, EXR, TIFF or PFM file:
/// `(bytes, { depthScale, integerDepthScale, depthKind }) → { data, width, height, unit, camera }`.
#[wasm_bindgen(js_name = readDepthFile, skip_typescript)]
pub fn read_depth_file(bytes: &JsValue, options: &JsValue) -> Result<JsValue, JsValue> {
    let read = || {
        let (options, kind) = depth_options(options)?;
        depth_from_bytes(&to_bytes("depth", bytes)?, &options, kind)
    };
    read().map(|depth| depth_image(&depth)).map_err(|error| to_js(&error))
}
