//! Size limits of the readers, and their errors.

use crate::text::quoted;
use sim3align_geometry::image::check_not_empty;
use sim3align_runtime::error::{Error, ErrorCode, Result, Text};

/// Maximum number of pixels of an image: 8192 × 8192.
pub const MAX_PIXELS: usize = 1 << 26;

/// Maximum number of vertices of a mesh: 16.7 million, about fifty times the size of generated meshes.
pub const MAX_VERTICES: usize = 1 << 24;

/// Maximum number of triangles of a mesh: 33.5 million.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// Maximum total size of the buffers of a glTF scene: 1 GiB.
pub const MAX_BUFFER_BYTES: usize = 1 << 30;

/// The error for a truncated or inconsistent file.
pub(crate) fn corrupt(argument: &str, found: impl Into<Text>, expected: impl Into<Text>) -> Error {
    Error::new(
        ErrorCode::CorruptFile,
        argument.to_owned(),
        found,
        expected,
        "The file is damaged or incomplete: download or export it again.",
    )
}

/// The error for a reference of a mesh file to the `index`th of `count` parts of this kind.
pub(crate) fn missing(kind: &str, index: usize, count: usize) -> Error {
    let article = if kind.starts_with(['a', 'i']) { "an" } else { "a" };
    corrupt("mesh", format!("{kind} {index} of {count}"), format!("{article} {kind} that exists"))
}

/// The error for a file that exceeds a limit.
pub(crate) fn too_large(argument: &str, found: impl Into<Text>, expected: impl Into<Text>) -> Error {
    Error::new(
        ErrorCode::FileTooLarge,
        argument.to_owned(),
        found,
        expected,
        "Simplify or downscale it first; if the file is small, it is corrupted or malicious.",
    )
}

/// The error for an unsupported format.
pub(crate) fn unsupported(
    argument: &str,
    found: impl Into<Text>,
    expected: impl Into<Text>,
    remedy: impl Into<Text>,
) -> Error {
    Error::new(ErrorCode::UnsupportedFormat, argument.to_owned(), found, expected, remedy)
}

/// Names in a file that its reader does not know: the first few, once each.
#[derive(Debug, Default)]
pub(crate) struct Unknown(Vec<String>);

impl Unknown {
    /// Adds a name.
    pub fn insert(&mut self, name: &[u8]) {
        const MOST: usize = 8;
        if self.0.len() < MOST {
            let name = quoted(name);
            if !self.0.contains(&name) {
                self.0.push(name);
            }
        }
    }

    /// Whether the predicate holds for any of the names.
    pub fn any(&self, is_such: impl Fn(&str) -> bool) -> bool {
        self.0.iter().any(|name| is_such(name))
    }

    /// The sentence about them, if there are any; `what` they are.
    pub fn named(&self, what: &str) -> Vec<String> {
        let sentence =
            || format!("The mesh file holds {what} {}: not read, their meaning is not known.", self.0.join(", "));
        (!self.0.is_empty()).then(sentence).into_iter().collect()
    }
}

/// The number of pixels, or an error if the size is 0 or exceeds the limit.
pub(crate) fn pixel_count(argument: &str, width: usize, height: usize) -> Result<usize> {
    check_not_empty(argument, width, height)?;
    match width.checked_mul(height) {
        Some(count) if count <= MAX_PIXELS => Ok(count),
        _ => Err(too_large(
            argument,
            format!("{width} × {height} pixels"),
            format!("at most {MAX_PIXELS} pixels (8192 × 8192)"),
        )),
    }
}

/// Describes the start of an unrecognised file, for the error message.
pub(crate) fn beginning(bytes: &[u8]) -> String {
    const KNOWN: [(&[u8], &str); 12] = [
        (b"\x89PNG\r\n\x1a\n", "a PNG image"),
        (b"\x93NUMPY", "a NumPy array"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"RIFF", "a RIFF file (WebP?)"),
        (b"II*\0", "a TIFF image"),
        (b"MM\0*", "a TIFF image"),
        (b"v/1\x01", "an OpenEXR image"),
        (b"PK\x03\x04", "a ZIP archive (NPZ?)"),
        (b"\x1f\x8b", "a gzip stream"),
        (b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
        (b"version https://git-lfs", "a pointer of Git LFS: \"git lfs pull\" fetches the file"),
        (b"<!DOCTYPE html", "an HTML page, which the server sent in place of the file"),
    ];
    if bytes.is_empty() {
        return "no bytes".into();
    }
    match KNOWN.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        Some((_, name)) => (*name).into(),
        None => {
            let head = bytes.get(..bytes.len().min(12)).unwrap_or_default();
            format!("{} bytes that begin with \"{}\"", bytes.len(), head.escape_ascii())
        }
    }
}
