//! `.splat` files: Gaussians of 32 bytes each, without a header.

use glam::Vec3;

use super::gaussian::{Gaussian, check_count};
use crate::guard::corrupt;
use sim3align_runtime::error::Result;

/// Centre and standard deviations as six f32, colour (sRGB) and opacity as four bytes, rotation (w, x, y, z) as four
/// bytes around 128.
const RECORD_BYTES: usize = 32;

/// Reads a `.splat` file.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Gaussian>> {
    let (records, rest) = bytes.as_chunks::<RECORD_BYTES>();
    if records.is_empty() || !rest.is_empty() {
        let found = format!("{} bytes", bytes.len());
        return Err(corrupt("mesh", found, format!("{RECORD_BYTES} bytes for each Gaussian of a .splat file")));
    }
    check_count(records.len())?;
    (records.iter().enumerate())
        .map(|(i, record)| {
            let [center, scales] = vectors(record);
            let [red, green, blue, opacity] = [24, 25, 26, 27].map(|at| record[at]);
            let opacity = f32::from(opacity) / 255.0;
            Gaussian::new(i, center, scales.abs(), quaternion(record), opacity, [red, green, blue])
        })
        .collect()
}

/// Centre and standard deviations.
fn vectors(record: &[u8; RECORD_BYTES]) -> [Vec3; 2] {
    let float = |at: usize| f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]);
    [0, 12].map(|at| Vec3::new(float(at), float(at + 4), float(at + 8)))
}

fn quaternion(record: &[u8; RECORD_BYTES]) -> [f32; 4] {
    [28, 29, 30, 31].map(|at| (f32::from(record[at]) - 128.0) / 128.0)
}
