//! COCO's run-length encoded masks, plain and compressed. The runs go down the columns, and begin with background.

use serde_json::Value;

use crate::guard::{corrupt, pixel_count};
use crate::json;
use sim3align_geometry::error::{Error, Result};
use sim3align_geometry::image::{Image, Mask};

/// A mask as the lengths of its runs, column by column: background, object, background, …
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rle {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The lengths of the runs; they sum up to width × height.
    pub counts: Vec<u32>,
}

impl Rle {
    /// The runs of a mask; non-zero pixels are the object.
    pub fn encode(mask: &Mask) -> Self {
        let (width, height) = (mask.width(), mask.height());
        let mut counts = Vec::new();
        let (mut run, mut in_object) = (0, false);
        for place in 0..width * height {
            let is_object = mask.get(place / height, place % height).is_some_and(|pixel| pixel != 0);
            if is_object != in_object {
                counts.push(run);
                run = 0;
                in_object = is_object;
            }
            run += 1;
        }
        counts.push(run);
        Self { width, height, counts }
    }

    /// The mask: 1 is the object.
    ///
    /// # Errors
    /// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile) where the runs don't sum up to width ×
    /// height, [`FileTooLarge`](sim3align_geometry::error::ErrorCode::FileTooLarge),
    /// [`EmptyImage`](sim3align_geometry::error::ErrorCode::EmptyImage).
    pub fn decode(&self) -> Result<Mask> {
        let (width, height) = (self.width, self.height);
        let count = pixel_count("mask", width, height)?;
        let total: u64 = self.counts.iter().map(|&run| u64::from(run)).sum();
        if total != count as u64 {
            let found = format!("runs of {total} pixels in all");
            return Err(corrupt("mask", found, format!("{height} × {width} = {count}, as size says")));
        }
        let mut data = vec![0; count];
        let mut place = 0;
        for (i, &run) in self.counts.iter().enumerate() {
            let end = place + run as usize;
            if i % 2 == 1 {
                for place in place..end {
                    if let Some(pixel) = data.get_mut(place % height * width + place / height) {
                        *pixel = 1;
                    }
                }
            }
            place = end;
        }
        Image::new("mask", width, height, data)
    }

    /// Runs from COCO's compressed string: differences to the run before the last, five bits a letter.
    ///
    /// # Errors
    /// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile) for letters and lengths that no encoder
    /// writes.
    pub fn from_compressed(width: usize, height: usize, text: &str) -> Result<Self> {
        let mut counts: Vec<u32> = Vec::new();
        let (mut value, mut shift) = (0_i64, 0);
        for &letter in text.as_bytes() {
            let bits = match letter {
                48..=111 => i64::from(letter - 48),
                _ => return Err(broken_counts(format!("the byte {letter}"))),
            };
            if shift > 30 {
                return Err(broken_counts("a number of more than 35 bits".into()));
            }
            value |= (bits & 31) << shift;
            shift += 5;
            if bits & 32 != 0 {
                continue;
            }
            if bits & 16 != 0 {
                value |= -1 << shift;
            }
            // The first three runs are written as they are.
            let before = if counts.len() > 2 { counts.get(counts.len() - 2).copied().unwrap_or_default() } else { 0 };
            let run = value + i64::from(before);
            counts.push(u32::try_from(run).map_err(|_| broken_counts(format!("a run of {run} pixels")))?);
            (value, shift) = (0, 0);
        }
        if shift != 0 {
            return Err(broken_counts("an unfinished number at the end".into()));
        }
        Ok(Self { width, height, counts })
    }

    /// The runs as COCO's compressed string.
    pub fn to_compressed(&self) -> String {
        let mut text = String::new();
        for (i, &run) in self.counts.iter().enumerate() {
            let before = if i > 2 { self.counts.get(i - 2).copied().unwrap_or_default() } else { 0 };
            let mut value = i64::from(run) - i64::from(before);
            loop {
                let bits = (value & 31) as u8;
                value >>= 5;
                let is_last = value == if bits & 16 == 0 { 0 } else { -1 };
                text.push(char::from(48 + bits + if is_last { 0 } else { 32 }));
                if is_last {
                    break;
                }
            }
        }
        text
    }

    /// Runs from `{"size": [height, width], "counts": "…" or […]}`, or an object that has such as `segmentation`.
    ///
    /// # Errors
    /// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile),
    /// [`FileTooLarge`](sim3align_geometry::error::ErrorCode::FileTooLarge).
    pub fn from_json(bytes: &[u8]) -> Result<Self> {
        let value = json::parse("mask", bytes)?;
        let value = value.get("segmentation").unwrap_or(&value);
        let wrong = || corrupt("mask", "JSON without a run-length encoding", "{\"size\": [h, w], \"counts\": …}");
        let size = value.get("size").and_then(Value::as_array).ok_or_else(wrong)?;
        // Saturated: too large is too large, whatever the platform's word.
        let side = |i: usize| size.get(i).and_then(Value::as_u64).map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let (Some(height), Some(width), 2) = (side(0), side(1), size.len()) else { return Err(wrong()) };
        match value.get("counts") {
            Some(Value::String(text)) => Self::from_compressed(width, height, text),
            Some(Value::Array(runs)) => {
                let run = |run: &Value| {
                    let whole = run.as_u64().and_then(|run| u32::try_from(run).ok());
                    whole.ok_or_else(|| broken_counts(format!("{run}")))
                };
                Ok(Self { width, height, counts: runs.iter().map(run).collect::<Result<_>>()? })
            }
            _ => Err(wrong()),
        }
    }
}

fn broken_counts(found: String) -> Error {
    corrupt("mask", format!("{found} in counts"), "COCO run lengths, a compressed string or whole numbers from 0")
}
