//! Case folders with frames: a mesh, and `frame_*` folders with depth, mask, camera, and optionally the camera's pose and
//! the true pose.

use std::fs;
use std::sync::Arc;

use serde_json::Value;

use super::{Sequence, SequenceFrame};
use crate::case_folder::case::{depth_and_camera, has_mask, last_name, mask_in, mesh_in, photo_of, truth_of};
use crate::case_folder::json;
use crate::files::listed;
use crate::prelude::*;
use sim3align::views::View;

/// Reads a case folder with `frame_*` folders.
///
/// # Errors
/// As [`read_case`](crate::case_folder::case::read_case).
pub fn read_sequence(folder: &Path) -> Result<Sequence> {
    let mut folders = listed(folder)?;
    folders.retain(|path| path.is_dir() && last_name(path).starts_with("frame_"));
    if folders.is_empty() {
        return Err(Error::new(
            ErrorCode::InvalidArgument,
            folder.display().to_string(),
            "no folder frame_*",
            "a mesh and folders frame_*",
            "Pass a folder with frames.",
        ));
    }
    let frames = folders.iter().map(|folder| read_frame(folder)).collect::<Result<Vec<_>>>()?;
    let read = mesh_in(folder)?;
    Ok(Sequence {
        name: last_name(folder),
        kind: "real".into(),
        mesh: read.mesh,
        colors: read.colors,
        symmetry: Symmetry::Auto,
        frames,
    })
}

fn read_frame(folder: &Path) -> Result<SequenceFrame> {
    let (depth, camera) = depth_and_camera(folder)?;
    let photo = photo_of(folder)?.map(Arc::new);
    let mask = if has_mask(folder) { Some(mask_in(folder)?) } else { None };
    let world_from_camera = match fs::read(folder.join("pose.json")) {
        Ok(bytes) => Some(camera_to_world(&bytes)?),
        Err(_) => None,
    };
    Ok(SequenceFrame {
        name: last_name(folder),
        view: View { frame: Frame { depth, camera, mask, photo }, world_from_camera },
        camera_from_mesh: truth_of(folder)?.map(|(pose, _)| pose),
        visible: 1.0,
        is_wrong: false,
    })
}

/// `camera_to_world`, 4 × 4 by rows.
fn camera_to_world(bytes: &[u8]) -> Result<Similarity> {
    let value = json::parse("pose", bytes)?;
    let given = value.get("camera_to_world");
    let rows = given.and_then(json::numbers::<16>);
    let rows = rows.ok_or_else(|| json::corrupt("pose", json::found(given.or(Some(&Value::Null))), "4 × 4 numbers"))?;
    let rotation = Matrix3::new(rows[0], rows[1], rows[2], rows[4], rows[5], rows[6], rows[8], rows[9], rows[10]);
    Similarity::from_parts(1.0, rotation, Vector3::new(rows[3], rows[7], rows[11]))
}
