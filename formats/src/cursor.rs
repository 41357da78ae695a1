//! A checked reader of bytes: reading past the end is an error, never a panic.

use crate::guard::corrupt;
use sim3align_runtime::error::Result;

/// A position in a byte slice.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    argument: &'static str,
}

impl<'a> Cursor<'a> {
    /// A cursor at the start of `bytes`; `argument` names the file in errors.
    pub fn new(argument: &'static str, bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, argument }
    }

    /// Remaining bytes.
    pub fn remaining(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let Some(taken) = self.remaining().get(..count) else {
            return Err(corrupt(
                self.argument,
                format!("the end of the file at byte {}", self.bytes.len()),
                format!("{count} more bytes after byte {}", self.at),
            ));
        };
        self.at += count;
        Ok(taken)
    }

    /// The next `N` bytes as an array.
    pub fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    /// The next little-endian u32.
    pub fn u32_le(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    /// The next big-endian u32.
    pub fn u32_be(&mut self) -> Result<u32> {
        Ok(u32::from_be_bytes(self.array()?))
    }
}
