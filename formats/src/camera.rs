//! Cameras from the JSON files that datasets and drivers write.

use serde_json::{Map, Value};

use crate::guard::corrupt;
use crate::json;
use sim3align_geometry::error::{Error, ErrorCode, Result};
use sim3align_geometry::pinhole::Pinhole;

/// A camera file's content.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraFile {
    /// The intrinsics, pixels.
    pub camera: Pinhole,
    /// Pixels in a row, where the file says so.
    pub width: Option<usize>,
    /// Rows, where the file says so.
    pub height: Option<usize>,
    /// Metres per unit of whole-number depth, where the file says so.
    pub depth_scale_m: Option<f64>,
    /// What the caller should know: distortion that the pinhole camera leaves out.
    pub warnings: Vec<String>,
}

/// Reads a camera from JSON. `image_size` is (width, height) of the depth map; `image_id` picks an entry of a
/// BOP `scene_camera.json`. These forms are known, `width` and `height` optional in each:
///
/// - `{fx, fy, cx, cy}` (RealSense's `ppx`, `ppy` too); a `depthScale` is metres per unit, a `depth_scale` is
///   millimetres per unit as in BOP's `camera.json`;
/// - `{K}`, row-major, 9 numbers or 3×3, or bare; Open3D's `intrinsic_matrix`, column-major;
/// - `{fovYDeg}` or `{fov_y_deg}`: vertical field of view in degrees, square pixels;
/// - BOP's `scene_camera.json` (`{"0": {cam_K, depth_scale}, …}`) and one entry of it;
/// - ROS CameraInfo (`K` or `k`, `D` or `d`).
///
/// # Errors
/// [`ErrorCode::CorruptFile`] for other content, [`ErrorCode::InvalidCamera`], [`ErrorCode::InvalidArgument`] for
/// an image id that is missing or needed, [`ErrorCode::SizeMismatch`] where the file is for another image size.
pub fn read_camera(bytes: &[u8], image_size: Option<(usize, usize)>, image_id: Option<&str>) -> Result<CameraFile> {
    let value = json::parse("camera", bytes)?;
    if let Some(k) = json::numbers(&value) {
        return Ok(plain(Pinhole::from_matrix(&k)?));
    }
    let Some(object) = value.as_object() else { return Err(unknown("JSON that is no object")) };
    let entry = scene_entry(object, image_id)?.unwrap_or(object);
    let whole = |name| entry.get(name).and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok());
    let (width, height) = (whole("width"), whole("height"));
    if let (Some(width), Some(height), Some((image_width, image_height))) = (width, height, image_size)
        && (width, height) != (image_width, image_height)
    {
        return Err(Error::new(
            ErrorCode::SizeMismatch,
            "camera",
            format!("intrinsics for {width} × {height} pixels beside an image of {image_width} × {image_height}"),
            "intrinsics of this very image",
            "Scale fx, cx by the ratio of the widths and fy, cy by that of the heights, or pass the full-size depth.",
        ));
    }
    let file_size = width.zip(height);
    Ok(CameraFile {
        camera: intrinsics(entry, file_size.or(image_size))?,
        width,
        height,
        depth_scale_m: depth_scale_m(entry)?,
        warnings: distortion(entry).into_iter().collect(),
    })
}

fn plain(camera: Pinhole) -> CameraFile {
    CameraFile { camera, width: None, height: None, depth_scale_m: None, warnings: Vec::new() }
}

fn unknown(found: impl Into<sim3align_geometry::error::Text>) -> Error {
    corrupt(
        "camera",
        found,
        "{fx, fy, cx, cy}, {K}, {fovYDeg}, intrinsic_matrix, a BOP scene_camera.json or a ROS CameraInfo",
    )
}

/// The entry of a BOP `scene_camera.json`; `None` where the object is no such file.
fn scene_entry<'a>(object: &'a Map<String, Value>, image_id: Option<&str>) -> Result<Option<&'a Map<String, Value>>> {
    let entries = || object.iter().filter_map(|(id, entry)| Some((id, entry.as_object()?)));
    if object.is_empty() || !entries().any(|(_, entry)| entry.contains_key("cam_K")) {
        return Ok(None);
    }
    if let Some(id) = image_id {
        // BOP writes ids plainly and file names with leading zeros.
        let short = |id: &str| id.trim_start_matches('0').to_owned();
        if let Some((_, entry)) = entries().find(|(key, _)| key.as_str() == id || short(key) == short(id)) {
            return Ok(Some(entry));
        }
    } else if let (Some((_, entry)), 1) = (entries().next(), object.len()) {
        return Ok(Some(entry));
    }
    let mut ids: Vec<&str> = object.keys().map(String::as_str).collect();
    ids.sort_by_key(|id| (id.len(), *id));
    let more = if ids.len() > 20 { format!(", … ({} in all)", ids.len()) } else { String::new() };
    Err(Error::new(
        ErrorCode::InvalidArgument,
        "options.imageId",
        image_id.map_or_else(|| "no image id for a file of several images".into(), |id| format!("{id:?}")),
        format!("one of {}{more}", ids.iter().take(20).copied().collect::<Vec<_>>().join(", ")),
        "Pass the id of the image that the depth map belongs to.",
    ))
}

fn intrinsics(entry: &Map<String, Value>, size: Option<(usize, usize)>) -> Result<Pinhole> {
    if let Some((name, k)) = ["K", "k", "cam_K"].iter().find_map(|name| Some((name, entry.get(*name)?))) {
        let k = json::numbers(k).ok_or_else(|| unknown(format!("{name} that is not 3 × 3 numbers")))?;
        return Pinhole::from_matrix(&k);
    }
    if let Some(k) = entry.get("intrinsic_matrix") {
        let k: [f64; 9] = json::numbers(k).ok_or_else(|| unknown("intrinsic_matrix that is not 9 numbers"))?;
        return Pinhole::from_matrix(&[k[0], k[3], k[6], k[1], k[4], k[7], k[2], k[5], k[8]]);
    }
    let number = |names: &[&str]| -> Result<Option<f64>> {
        match names.iter().find_map(|name| Some((name, entry.get(*name)?))) {
            None => Ok(None),
            Some((name, value)) => match value.as_f64() {
                Some(number) => Ok(Some(number)),
                None => Err(unknown(format!("{name} that is not a number"))),
            },
        }
    };
    let four = [number(&["fx"])?, number(&["fy"])?, number(&["cx", "ppx"])?, number(&["cy", "ppy"])?];
    if let [Some(fx), Some(fy), Some(cx), Some(cy)] = four {
        return Pinhole::new(fx, fy, cx, cy);
    }
    if let Some(fov_y_deg) = number(&["fovYDeg", "fov_y_deg"])? {
        let Some((width, height)) = size else {
            return Err(Error::new(
                ErrorCode::InvalidArgument,
                "options.width",
                "a field of view without image size",
                "width and height, in the file or as options",
                "Pass the depth map's width and height in pixels.",
            ));
        };
        return Pinhole::from_vertical_fov(fov_y_deg, width, height);
    }
    let names: Vec<&str> = entry.keys().map(String::as_str).take(12).collect();
    Err(unknown(format!("an object with {}", if names.is_empty() { "nothing".into() } else { names.join(", ") })))
}

fn depth_scale_m(entry: &Map<String, Value>) -> Result<Option<f64>> {
    let scale = match (entry.get("depthScale"), entry.get("depth_scale")) {
        (Some(metres), _) => metres.as_f64(),
        (None, Some(millimetres)) => millimetres.as_f64().map(|scale| scale / 1000.0),
        (None, None) => return Ok(None),
    };
    match scale {
        Some(scale) if scale.is_finite() && scale > 0.0 => Ok(Some(scale)),
        _ => Err(Error::new(
            ErrorCode::InvalidCamera,
            "camera.depthScale",
            "a depth scale that is not a number above 0",
            "a number above 0",
            "Write metres per unit as depthScale, or BOP's millimetres per unit as depth_scale.",
        )),
    }
}

fn distortion(entry: &Map<String, Value>) -> Option<String> {
    let coefficients = entry.get("D").or_else(|| entry.get("d"))?.as_array()?;
    let is_distorted = coefficients.iter().any(|c| c.as_f64().is_some_and(|c| c != 0.0));
    is_distorted.then(|| {
        "The camera has lens distortion, which is not modelled: pass a rectified depth map and mask, and its K.".into()
    })
}
