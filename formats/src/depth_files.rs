//! Depth maps in the files that depth models and renderers write: `.npz`, `.exr`, `.tiff` and `.pfm`.

use crate::depth::{DepthImage, DepthReadOptions};
use crate::guard::{beginning, unsupported};
use crate::{exr, npz, pfm, tiff};
use sim3align_geometry::depth_kind::DepthKind;
use sim3align_geometry::error::Result;

/// The formats, by their signatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// NumPy's archive of arrays, a ZIP.
    Npz,
    /// OpenEXR.
    Exr,
    /// TIFF, of either byte order.
    Tiff,
    /// Portable float map, one channel (`Pf`) or three (`PF`).
    Pfm,
}

/// The first bytes of each format.
const SIGNATURES: [(&[u8], Format); 7] = [
    (b"PK\x03\x04", Format::Npz),
    // An archive without entries.
    (b"PK\x05\x06", Format::Npz),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"II*\0", Format::Tiff),
    (b"MM\0*", Format::Tiff),
    (b"Pf\n", Format::Pfm),
    (b"PF\n", Format::Pfm),
];

impl Format {
    /// The format of a file that begins like this.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        SIGNATURES.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|&(_, format)| format)
    }
}

/// Reads depth from an `.npz`, `.exr`, `.tiff` or `.pfm` file, with the camera in it.
///
/// - `.npz`: an array with one of the usual names of depth (`depth`, `pred_depth`, …), the only two-dimensional array of
///   floats, or the z of a point map; pixels that are false in `mask` or `valid` have no reading; intrinsics in pixels
///   or, as MoGe writes them, in image sizes; a focal length in pixels or a field of view in degrees.
/// - `.exr`: a channel that is named as depth, or the only one.
/// - `.tiff`: one channel of floats, or of integers.
/// - `.pfm`: one channel.
///
/// # Errors
/// [`ErrorCode`](sim3align_geometry::error::ErrorCode)`::EightBitDepth`, `UnsupportedFormat`, `CorruptFile`,
/// `FileTooLarge`, `EmptyImage`, `SizeMismatch` for a mask of another size, `InvalidCamera`, `InvalidOption`.
pub fn read_depth_file(bytes: &[u8], options: &DepthReadOptions, kind: DepthKind) -> Result<DepthImage> {
    match Format::of(bytes) {
        Some(Format::Npz) => npz::read_depth(bytes, options, kind),
        Some(Format::Exr) => exr::read_depth(bytes, options, kind),
        Some(Format::Tiff) => tiff::read_depth(bytes, options, kind),
        Some(Format::Pfm) => pfm::read_depth(bytes, options, kind),
        None => Err(unsupported(
            "depth",
            beginning(bytes),
            "a .npz, .exr, .tiff or .pfm file",
            "Save the depth with numpy.savez, or as 16-bit PNG in millimetres.",
        )),
    }
}
