//! Portable float maps: a text header, then 32-bit floats, the bottom row first.

use crate::cursor::Cursor;
use crate::depth_image::{DepthImage, DepthReadOptions, Stored};
use crate::guard::{corrupt, pixel_count};
use crate::point_map;
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_runtime::error::Result;

/// Longest number in a header.
const MAX_WORD: usize = 32;

pub(crate) fn read_depth(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    let mut cursor = Cursor::new("depth", bytes);
    // Three channels are the points of a map.
    let channels = if cursor.take(3)?.starts_with(b"PF") { 3 } else { 1 };
    let (width, height) = (side(&mut cursor)?, side(&mut cursor)?);
    let scale = word(&mut cursor)?;
    // The sign is the byte order. The value is a unit of light, which writers of depth leave at 1.
    let is_little = match scale.parse::<f64>() {
        Ok(scale) if scale.is_finite() && scale != 0.0 => scale < 0.0,
        _ => return Err(broken(format!("the scale {scale:?}"))),
    };
    let count = pixel_count("depth", width, height)?;
    // Lines that end with a space or with two characters.
    while cursor.remaining().len() > 4 * channels * count
        && cursor.remaining().first().is_some_and(u8::is_ascii_whitespace)
    {
        cursor.take(1)?;
    }
    let data = cursor.take(4 * channels * count)?;
    let value = |bytes: &[u8]| {
        let bytes = bytes.first_chunk().copied().unwrap_or_default();
        f64::from(if is_little { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) })
    };
    let value_at = |row: usize, place: usize| {
        let start = 4 * ((height - 1 - row) * width * channels + place);
        data.get(start..start + 4).map_or(f64::NAN, value)
    };
    let stored = Stored { width, height, bits: 32, is_integer: false };
    if channels == 3 {
        let point = |i: usize| [0, 1, 2].map(|axis| value_at(i / width, 3 * (i % width) + axis));
        return point_map::read(&stored, options, kind, &point);
    }
    stored.read(options, kind, &|i| value_at(i / width, i % width))
}

fn side(cursor: &mut Cursor<'_>) -> Result<usize> {
    let word = word(cursor)?;
    word.parse().map_err(|_| broken(format!("the size {word:?}")))
}

/// The next word, and the one white space after it.
fn word(cursor: &mut Cursor<'_>) -> Result<String> {
    let mut word = String::new();
    loop {
        match cursor.take(1)? {
            [space] if space.is_ascii_whitespace() => {
                // Some writers end lines with two characters, or pad numbers.
                if !word.is_empty() {
                    return Ok(word);
                }
            }
            [letter] if letter.is_ascii_graphic() && word.len() < MAX_WORD => word.push(char::from(*letter)),
            _ => return Err(broken("a header that is no text".into())),
        }
    }
}

fn broken(found: String) -> sim3align_runtime::error::Error {
    corrupt("depth", format!("a PFM with {found}"), "width, height and scale")
}
