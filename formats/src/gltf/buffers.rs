//! The buffers of a glTF scene: the binary chunk of the GLB, data URIs, and external files.

use std::borrow::Cow;

use crate::gltf::document::Buffer;
use crate::guard::{MAX_BUFFER_BYTES, corrupt, missing, too_large};
use crate::resources::{Resources, at_uri};
use sim3align_runtime::error::Result;

/// The buffers, each loaded on first use; those of animations are never loaded.
pub(super) struct Buffers<'a> {
    declared: &'a [Buffer],
    binary: Option<&'a [u8]>,
    resources: Option<Resources<'a>>,
    loaded: Vec<Option<Cow<'a, [u8]>>>,
    loaded_bytes: usize,
}

impl<'a> Buffers<'a> {
    pub fn new(declared: &'a [Buffer], binary: Option<&'a [u8]>, resources: Option<Resources<'a>>) -> Self {
        Self { declared, binary, resources, loaded: vec![None; declared.len()], loaded_bytes: 0 }
    }

    /// The external files.
    pub fn resources(&self) -> Option<Resources<'a>> {
        self.resources
    }

    /// Whether buffer `index` has data. Compressed files contain one without.
    pub fn has_source(&self, index: usize) -> bool {
        let has_uri = self.declared.get(index).is_some_and(|buffer| buffer.uri.is_some());
        has_uri || (index == 0 && self.binary.is_some())
    }

    /// The bytes of buffer `index`.
    pub fn get(&mut self, index: usize) -> Result<&[u8]> {
        let (Some(declared), Some(slot)) = (self.declared.get(index), self.loaded.get_mut(index)) else {
            return Err(missing("buffer", index, self.declared.len()));
        };
        let bytes = match slot.take() {
            Some(bytes) => bytes,
            None => {
                let bytes = load(declared, index, self.binary, self.resources)?;
                self.loaded_bytes = self.loaded_bytes.saturating_add(bytes.len());
                if self.loaded_bytes > MAX_BUFFER_BYTES {
                    let found = format!("{} bytes of buffers", self.loaded_bytes);
                    return Err(too_large("mesh", found, format!("at most {MAX_BUFFER_BYTES}")));
                }
                bytes
            }
        };
        Ok(slot.insert(bytes))
    }
}

fn load<'a>(
    declared: &'a Buffer,
    index: usize,
    binary: Option<&'a [u8]>,
    resources: Option<Resources<'a>>,
) -> Result<Cow<'a, [u8]>> {
    let bytes = match (&declared.uri, binary) {
        (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
        (None, _) => {
            let found = format!("buffer {index} without URI or binary chunk");
            return Err(corrupt("mesh", found, "bytes for every buffer"));
        }
        (Some(uri), _) => at_uri(uri, resources, || format!("buffer {index}"))?,
    };
    if (bytes.len() as u64) < declared.byte_length {
        let found = format!("buffer {index} of {} bytes", bytes.len());
        return Err(corrupt("mesh", found, format!("{} bytes, as its byteLength says", declared.byte_length)));
    }
    Ok(bytes)
}
