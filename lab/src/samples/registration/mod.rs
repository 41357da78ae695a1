//! General registration of point clouds: the protocols of 3DMatch, 3DLoMatch and KITTI odometry, and generated pairs
//! of decreasing overlap in the same layouts.

pub mod cloud_file;
mod depth_camera;
pub mod information;
pub mod kitti;
pub mod lidar;
pub mod lidar_set;
pub mod overlap;
pub mod pair;
pub mod pair_list;
pub mod room;
pub mod room_set;
pub mod street;
pub mod three_d_match;
pub mod trajectory;

use std::path::Path;

use super::case::unwritable;
use sim3align_geometry::error::{Error, ErrorCode, Result, Text};

/// Walls and furniture.
const ROOM_STREAM: u64 = 0x726f_6f6d;
/// Where the depth camera goes, and its faults.
const CAMERA_STREAM: u64 = 0x6361_6d65;
/// Houses, cars and trees.
const STREET_STREAM: u64 = 0x7374_7265;
/// The lidar's faults.
const LIDAR_STREAM: u64 = 0x6c69_6461;

/// The whole of a file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| {
        Error::new(
            ErrorCode::InvalidArgument,
            path.display().to_string(),
            format!("a file system that says: {error}"),
            "a file that can be read",
            "Check the folder's layout.",
        )
    })
}

/// Writes a file, and the folders that it is in.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(path, bytes));
    written.map_err(|error| unwritable(path, error))
}

/// A file that contradicts itself.
fn corrupt(path: &Path, found: impl Into<Text>, expected: impl Into<Text>) -> Error {
    let remedy = "The file may be cut short: download or export it again.";
    Error::new(ErrorCode::CorruptFile, path.display().to_string(), found, expected, remedy)
}

/// The entries of a folder by name; none where it can't be read.
fn entries(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort();
    entries
}
