//! The GLB container: a JSON chunk and an optional binary chunk.

use crate::cursor::Cursor;
use crate::guard::{corrupt, too_large, unsupported};
use sim3align_runtime::error::Result;

/// Maximum size of a GLB: 2 GiB.
const MAX_GLB_BYTES: u32 = 1 << 31;

/// The chunks of a `.glb`; a `.gltf` is JSON as a whole.
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
}

impl<'a> Container<'a> {
    pub fn split(bytes: &'a [u8]) -> Result<Self> {
        if !bytes.starts_with(b"glTF") {
            return Ok(Self { json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), binary: None });
        }
        let mut cursor = Cursor::new("mesh", bytes);
        cursor.take(4)?;
        let version = cursor.u32_le()?;
        if version != 2 {
            return Err(unsupported(
                "mesh",
                format!("GLB version {version}"),
                "version 2",
                "Convert glTF 1.0 with gltf-pipeline (npx gltf-pipeline -i in.glb -o out.glb).",
            ));
        }
        let length = cursor.u32_le()?;
        if length > MAX_GLB_BYTES {
            let found = format!("a header that claims {length} bytes; the file has {}", bytes.len());
            return Err(too_large("mesh", found, format!("at most {MAX_GLB_BYTES} bytes")));
        }
        let Some(body) = bytes.get(12..length as usize) else {
            let found = format!("{} bytes, and a header that claims {length}", bytes.len());
            return Err(corrupt("mesh", found, "a file as long as its header says"));
        };
        let mut cursor = Cursor::new("mesh", body);
        let (kind, json) = chunk(&mut cursor)?;
        if &kind != b"JSON" {
            let found = format!("a first chunk \"{}\"", kind.escape_ascii());
            return Err(corrupt("mesh", found, "\"JSON\""));
        }
        // Only the second chunk can be the binary one; the specification requires readers to ignore others.
        let binary = if cursor.remaining().is_empty() {
            None
        } else {
            let (kind, data) = chunk(&mut cursor)?;
            (&kind == b"BIN\0").then_some(data)
        };
        Ok(Self { json, binary })
    }
}

fn chunk<'a>(cursor: &mut Cursor<'a>) -> Result<([u8; 4], &'a [u8])> {
    let length = cursor.u32_le()?;
    let kind = cursor.array()?;
    Ok((kind, cursor.take(length as usize)?))
}
