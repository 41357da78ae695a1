//! `pairs.json` beside generated data: which pairs there are, and how much they overlap.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{corrupt, read};
use sim3align_geometry::error::Result;

/// A pair of a generated set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Listed {
    /// Scene or sequence.
    pub group: String,
    /// Number of the source's file.
    pub source: u32,
    /// Number of the target's file.
    pub target: u32,
    /// Share of the points of both clouds that the other has.
    pub overlap: f64,
}

/// The list of a folder; `None` where there is none.
///
/// # Errors
/// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile).
pub fn read_list(root: &Path) -> Result<Option<Vec<Listed>>> {
    let path = root.join("pairs.json");
    if !path.is_file() {
        return Ok(None);
    }
    serde_json::from_slice(&read(&path)?)
        .map(Some)
        .map_err(|error| corrupt(&path, format!("{error}"), "an array of { group, source, target, overlap }"))
}
