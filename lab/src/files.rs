//! Reads and writes files; errors name the path.

use std::fs;

use crate::prelude::*;
use sim3align_runtime::error::Text;

/// Reads a file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).map_err(|error| unreadable(path, error))
}

/// Writes a file, and creates its parent folders.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(path, bytes));
    written.map_err(|error| unwritable(path, error))
}

/// Paths of the entries of a folder, sorted by name.
///
/// # Errors
/// [`ErrorCode::InvalidArgument`] if the folder cannot be read.
pub(crate) fn listed(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).map_err(|error| unreadable(folder, error))?;
    let mut entries: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort();
    Ok(entries)
}

/// Paths of the entries of a folder, sorted by name; empty if the folder cannot be read.
pub(crate) fn entries(folder: &Path) -> Vec<PathBuf> {
    listed(folder).unwrap_or_default()
}

/// The error for a path that cannot be read.
pub(crate) fn unreadable(path: &Path, error: std::io::Error) -> Error {
    failed(path, error, "a file or a folder that can be read", "Check the layout of the folder.")
}

/// The error for a path that cannot be written.
pub(crate) fn unwritable(path: &Path, error: std::io::Error) -> Error {
    failed(path, error, "a writable folder", "Name a folder that can be created, on a disk that is not full.")
}

fn failed(path: &Path, error: std::io::Error, expected: &'static str, remedy: &'static str) -> Error {
    let (argument, found) = (path.display().to_string(), format!("the file system error: {error}"));
    Error::new(ErrorCode::InvalidArgument, argument, found, expected, remedy)
}

/// The error for an inconsistent file.
pub(crate) fn corrupt(path: &Path, found: impl Into<Text>, expected: impl Into<Text>) -> Error {
    let remedy = "The file is damaged or incomplete: download or export it again.";
    Error::new(ErrorCode::CorruptFile, path.display().to_string(), found, expected, remedy)
}
