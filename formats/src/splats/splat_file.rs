//! `.splat` files: Gaussians of 32 bytes each, without a header.

use glam::Vec3;

use super::gaussian::{Gaussian, check_count};
use super::surface_of;
use crate::colored_mesh::{ColoredMesh, Content};
use crate::guard::corrupt;
use sim3align_geometry::error::Result;

/// Centre and standard deviations as six f32, colour (sRGB) and opacity as four bytes, rotation (w, x, y, z) as four
/// bytes around 128.
const RECORD_BYTES: usize = 32;

/// Number of Gaussians by which a file is recognised.
const CHECKED: usize = 256;

/// Whether these bytes can be a `.splat` file: it has no signature, but its quaternions have length 1.
pub(crate) fn is_splat_file(bytes: &[u8]) -> bool {
    let (records, rest) = bytes.as_chunks::<RECORD_BYTES>();
    let is_gaussian = |record: &[u8; RECORD_BYTES]| {
        let [center, scales] = vectors(record);
        let norm: f32 = quaternion(record).iter().map(|x| x * x).sum();
        center.is_finite() && scales.is_finite() && scales.min_element() >= 0.0 && (norm - 1.0).abs() < 0.1
    };
    !records.is_empty() && rest.is_empty() && records.iter().take(CHECKED).all(is_gaussian)
}

/// Reads a `.splat` file as the mesh of its surface.
///
/// # Errors
/// [`CorruptFile`](sim3align_geometry::error::ErrorCode::CorruptFile), `FileTooLarge`, `NonFinite` and those of
/// [`surface_of`].
pub(crate) fn read_splat_file(bytes: &[u8], content: Content) -> Result<ColoredMesh> {
    let (records, rest) = bytes.as_chunks::<RECORD_BYTES>();
    if records.is_empty() || !rest.is_empty() {
        let found = format!("{} bytes", bytes.len());
        return Err(corrupt("mesh", found, format!("{RECORD_BYTES} bytes for each Gaussian of a .splat file")));
    }
    check_count(records.len())?;
    let gaussians = (records.iter().enumerate())
        .map(|(i, record)| {
            let [center, scales] = vectors(record);
            let [red, green, blue, opacity] = [24, 25, 26, 27].map(|at| record[at]);
            let opacity = f32::from(opacity) / 255.0;
            Gaussian::new(i, center, scales.abs(), quaternion(record), opacity, [red, green, blue])
        })
        .collect::<Result<Vec<_>>>()?;
    surface_of(gaussians, content)
}

/// Centre and standard deviations.
fn vectors(record: &[u8; RECORD_BYTES]) -> [Vec3; 2] {
    let float = |at: usize| f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]);
    [0, 12].map(|at| Vec3::new(float(at), float(at + 4), float(at + 8)))
}

fn quaternion(record: &[u8; RECORD_BYTES]) -> [f32; 4] {
    [28, 29, 30, 31].map(|at| (f32::from(record[at]) - 128.0) / 128.0)
}
