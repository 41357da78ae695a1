//! Observation and mesh from JavaScript objects.

use std::sync::Arc;

use js_sys::Uint16Array;
use wasm_bindgen::{JsCast, JsValue};

use super::object::{check_bytes, get, number, required_number, size, to_colors, to_f32s, to_u8s, wrong_type};
use crate::calibrate::calibration::CalibrationUncertainty;
use crate::calibrate::frames::RawFrame;
use crate::calibrate::raw_view::{Focal, RawView};
use crate::error::{Error, ErrorCode, Result};
use crate::evidence::frame::Frame;
use crate::evidence::observation::{Observation, from_point_map};
use crate::evidence::photo::Photo;
use crate::geometry::depth_kind::DepthKind;
use crate::geometry::image::{DepthMap, Image, Mask, check_size};
use crate::geometry::pinhole::Pinhole;
use crate::geometry::similarity::Similarity;
use crate::number::number as number_text;

/// Largest standard deviation of the logarithm of a focal length: from a fisheye to a telephoto lens.
const MAX_FOCAL_DEVIATION: f64 = 1.0;

/// Default metres per unit of integer depth: millimetres.
const DEFAULT_DEPTH_SCALE: f64 = 0.001;

/// `{ depth | pointMap, depthScale?, width, height, camera, mask, maskWidth?, maskHeight?, resizeMask?, image?, others?, uncertainty? }`,
/// the last that of the calibration of the view.
#[inline(never)]
pub fn observation(input: &JsValue) -> Result<Observation> {
    let (depth, camera) = view(input)?;
    let (width, height) = (depth.width(), depth.height());
    let mut observation = Observation::new(depth, mask(input, width, height)?, camera)?;
    if let Some(photo) = photo(input)? {
        observation = observation.with_photo(photo)?;
    }
    observation = observation.with_relief_deviation(relief_deviation(input)?);
    match get(input, "others") {
        Some(others) => observation.with_others(Image::new("occluders", width, height, to_u8s(&others, "occluders")?)?),
        None => Ok(observation),
    }
}

/// The depth map, the camera and, if there are any, the mask, the photo and the uncertainty of the calibration of an input.
pub fn frame(input: &JsValue) -> Result<Frame> {
    let (depth, camera) = view(input)?;
    let mask = get(input, "mask").map(|_| mask(input, depth.width(), depth.height())).transpose()?;
    Ok(Frame { depth, camera, mask, photo: photo(input)?, relief_deviation: relief_deviation(input)? })
}

/// How well the calibration of an input determines the relief of its objects.
fn relief_deviation(input: &JsValue) -> Result<f64> {
    let Some(uncertainty) = get(input, "uncertainty") else { return Ok(0.0) };
    let of = |key| required_number(&uncertainty, "uncertainty", key);
    Ok(CalibrationUncertainty { shift: of("shift")?, focal: of("focal")? }.relief())
}

/// The depth map and the camera of an input.
pub fn view(input: &JsValue) -> Result<(DepthMap, Pinhole)> {
    if !input.is_object() {
        let remedy = "Pass { depth, width, height, mask, camera, mesh }.";
        return Err(wrong_type("input", input, "an object", remedy));
    }
    let (width, height) = size_of(input)?;
    match get(input, "pointMap") {
        Some(points) => {
            let (depth, fitted) = from_point_map(width, height, &to_f32s(&points, "pointMap")?)?;
            // Known intrinsics take precedence over fitted ones.
            Ok((depth, get(input, "camera").map_or(Ok(fitted), |c| camera(&c))?))
        }
        None => {
            let given = get(input, "camera").unwrap_or(JsValue::UNDEFINED);
            Ok((depth(input, width, height)?, camera(&given)?))
        }
    }
}

/// A view whose depth or focal length is not fully known: `{ depth | pointMap, depthScale?, width, height, camera,
/// depthKind?, focalDeviation? }`, the last the standard deviation of the logarithm of a focal length that is a guess.
pub fn raw_view(input: &JsValue) -> Result<RawView> {
    let kind = match get(input, "depthKind") {
        None => DepthKind::default(),
        Some(name) => name.as_string().as_deref().and_then(DepthKind::from_name).ok_or_else(|| {
            let names = DepthKind::ALL.map(|kind| format!("\"{}\"", kind.name())).join(", ");
            wrong_type("depthKind", &name, &names, "Say what the depth model returns; omit it for metric depth.")
        })?,
    };
    let (width, height) = size_of(input)?;
    let (values, camera) = if get(input, "pointMap").is_some() {
        if kind.is_affine() {
            return Err(Error::new(
                ErrorCode::InvalidArgument,
                "depthKind",
                format!("\"{}\" with a point map", kind.name()),
                "\"metric\" or \"scale-invariant\" with a point map",
                "Points have no shift of their depth; pass the values of the depth model as depth.",
            ));
        }
        let (depth, camera) = view(input)?;
        (depth.data().to_vec(), camera)
    } else {
        let integer_scale = if kind.is_metric() { DEFAULT_DEPTH_SCALE } else { 1.0 };
        let given = get(input, "camera").unwrap_or(JsValue::UNDEFINED);
        (values(input, width, height, integer_scale)?, camera(&given)?)
    };
    let focal = match number(input, "input", "focalDeviation")? {
        Some(deviation) if deviation > 0.0 => Focal::Guessed(deviation.min(MAX_FOCAL_DEVIATION)),
        _ => Focal::Known,
    };
    camera.check_field_of_view(width, height)?;
    Ok(RawView { values: Image::new("depth", width, height, values)?, kind, camera, focal })
}

/// Whether the depth or the focal length of a view is not fully known.
pub fn is_raw(input: &JsValue) -> bool {
    let is_metric = |kind: JsValue| kind.as_string().as_deref() == Some(DepthKind::Metric.name());
    get(input, "focalDeviation").is_some() || get(input, "depthKind").is_some_and(|kind| !is_metric(kind))
}

/// Such a view with its mask, if it has one, and its camera's pose.
pub fn raw_frame(input: &JsValue, world_from_camera: Option<Similarity>) -> Result<RawFrame> {
    let view = raw_view(input)?;
    let size = [view.values.width(), view.values.height()];
    let mask = get(input, "mask").map(|_| mask(input, size[0], size[1])).transpose()?;
    Ok(RawFrame { view, mask, world_from_camera })
}

/// The photo of an input, if it has one: `{ data, width, height }` with a `Uint8Array` of red, green and blue. Other forms are
/// resolved in TypeScript.
pub fn photo(input: &JsValue) -> Result<Option<Arc<Photo>>> {
    let Some(image) = get(input, "image") else { return Ok(None) };
    let side = |name| size(&image, name).map(Option::unwrap_or_default);
    let colors = to_colors(&get(&image, "data").unwrap_or(JsValue::UNDEFINED), "image.data")?;
    Image::new("image", side("width")?, side("height")?, colors).map(|photo| Some(Arc::new(photo)))
}

fn size_of(input: &JsValue) -> Result<(usize, usize)> {
    let missing = |name| wrong_type(name, &JsValue::UNDEFINED, "an integer in pixels", "Pass the image size.");
    let width = size(input, "width")?.ok_or_else(|| missing("width"))?;
    let height = size(input, "height")?.ok_or_else(|| missing("height"))?;
    Ok((width, height))
}

fn depth(input: &JsValue, width: usize, height: usize) -> Result<DepthMap> {
    DepthMap::from_metres(width, height, values(input, width, height, DEFAULT_DEPTH_SCALE)?)
}

/// The numbers of a depth map, times its scale; that of integers is `integer_scale` if none is given.
fn values(input: &JsValue, width: usize, height: usize, integer_scale: f64) -> Result<Vec<f32>> {
    let values = get(input, "depth").unwrap_or(JsValue::UNDEFINED);
    let scale = number(input, "input", "depthScale")?;
    if let Some(scale) = scale
        && !(scale.is_finite() && scale > 0.0)
    {
        return Err(Error::new(
            ErrorCode::InvalidArgument,
            "depthScale",
            number_text(scale),
            "a finite number above 0",
            "Pass metres per unit of depth: 0.001 for millimetres.",
        ));
    }
    check_bytes(&values, "depth")?;
    if let Some(units) = values.dyn_ref::<Uint16Array>() {
        check_size("depth", width, height, units.length() as usize)?;
        let scale = scale.unwrap_or(integer_scale);
        return Ok(units.to_vec().into_iter().map(|unit| (f64::from(unit) * scale) as f32).collect());
    }
    let mut metres = to_f32s(&values, "depth")
        .map_err(|e| e.expecting("a Float32Array (metres) or a Uint16Array (with depthScale)"))?;
    if let Some(scale) = scale {
        metres.iter_mut().for_each(|z| *z = (f64::from(*z) * scale) as f32);
    }
    Ok(metres)
}

/// The mask of an input.
pub fn mask(input: &JsValue, width: usize, height: usize) -> Result<Mask> {
    let pixels = to_u8s(&get(input, "mask").unwrap_or(JsValue::UNDEFINED), "mask")?;
    let mask_width = size(input, "maskWidth")?.unwrap_or(width);
    let mask_height = size(input, "maskHeight")?.unwrap_or(height);
    let mask = Image::new("mask", mask_width, mask_height, pixels)?;
    let Some(resize) = get(input, "resizeMask") else { return Ok(mask) };
    if resize.as_string().as_deref() != Some("nearest") {
        return Err(wrong_type(
            "resizeMask",
            &resize,
            "\"nearest\"",
            "Omit it for masks of the size of the depth map.",
        ));
    }
    if width == 0 || height == 0 || (mask_width, mask_height) == (width, height) {
        return Ok(mask);
    }
    Ok(mask.resize_nearest(width, height))
}

/// `{ fx, fy, cx, cy }`: other forms of a camera are resolved in TypeScript.
pub fn camera(value: &JsValue) -> Result<Pinhole> {
    if !value.is_object() {
        let remedy = "Intrinsics are in pixels of the depth image.";
        return Err(wrong_type("camera", value, "{ fx, fy, cx, cy }", remedy));
    }
    let of = |key| required_number(value, "camera", key);
    Pinhole::new(of("fx")?, of("fy")?, of("cx")?, of("cy")?)
}
