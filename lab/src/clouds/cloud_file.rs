//! Cloud files: PLY, and `.bin` of KITTI.

use crate::files::{corrupt, read};
use crate::prelude::*;
use sim3align_formats::guard::MAX_VERTICES;
use sim3align_formats::ply::read_ply_points;

/// Bytes of a reading in a `.bin` file: x, y, z and reflectance as float32.
const READING: usize = 16;

/// The points of a `.ply` or `.bin` file.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] if a file cannot be read or is of neither kind, [`ErrorCode::CorruptFile`],
/// [`ErrorCode::FileTooLarge`], [`ErrorCode::NonFinite`] and those of [`read_ply_points`].
pub fn read_cloud(path: &Path) -> Result<Vec<Vec3>> {
    let points = match path.extension().and_then(|extension| extension.to_str()) {
        Some("ply") => read_ply_points(&read(path)?).map_err(|error| error.about(path.display().to_string()))?,
        Some("bin") => {
            let bytes = read(path)?;
            if !bytes.len().is_multiple_of(READING) {
                let found = format!("{} bytes", bytes.len());
                return Err(corrupt(path, found, "a multiple of 16: x, y, z, reflectance as float32"));
            }
            let points = bytes.chunks_exact(READING).map(|reading| {
                let coordinate = |i: usize| f32::from_le_bytes([0, 1, 2, 3].map(|byte| reading[4 * i + byte]));
                Vec3::new(coordinate(0), coordinate(1), coordinate(2))
            });
            points.collect()
        }
        _ => {
            let (argument, found) = (path.display().to_string(), "another file");
            let remedy = "Convert it to PLY.";
            return Err(Error::new(ErrorCode::InvalidArgument, argument, found, "a .ply or .bin file", remedy));
        }
    };
    if points.len() > MAX_VERTICES {
        let (found, expected) = (format!("{} points", points.len()), format!("at most {MAX_VERTICES}"));
        let argument = path.display().to_string();
        return Err(Error::new(ErrorCode::FileTooLarge, argument, found, expected, "Downsample it first."));
    }
    if let Some(i) = points.iter().position(|point: &Vec3| !point.is_finite()) {
        let argument = path.display().to_string();
        let remedy = "Leave points without a reading out of the cloud.";
        return Err(Error::new(ErrorCode::NonFinite, argument, format!("point {i}"), "finite numbers", remedy));
    }
    Ok(points)
}

/// Points as KITTI's `.bin`, with a reflectance of 0.
pub fn bin(points: &[Vec3]) -> Vec<u8> {
    points.iter().flat_map(|p| [p.x, p.y, p.z, 0.0]).flat_map(f32::to_le_bytes).collect()
}

/// Interleaved x, y, z, for `register`.
pub fn flat(points: &[Vec3]) -> Vec<f64> {
    points.iter().flat_map(|p| p.to_array()).map(f64::from).collect()
}
