//! The photo of an observation.

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::image::Image;
use crate::geometry::surface_colors::Rgb;

/// Maximum difference of the aspect ratios of photo and depth map, relative.
const ASPECT: f64 = 0.02;

/// A photo, registered to the depth map: it shows the same field of view, at any size. sRGB-encoded.
pub type Photo = Image<Rgb>;

/// The part of a photo that an image shows, relative to its sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhotoRegion {
    /// The left upper corner.
    pub corner: [f64; 2],
    /// Width and height.
    pub size: [f64; 2],
}

impl PhotoRegion {
    /// All of it.
    pub const WHOLE: Self = Self { corner: [0.0; 2], size: [1.0; 2] };
}

/// Checks that a photo can have the field of view of a depth map of this size.
///
/// # Errors
/// [`ErrorCode::SizeMismatch`].
pub fn check_photo(photo: &Photo, [width, height]: [usize; 2]) -> Result<()> {
    let aspect = photo.width() as f64 * height as f64 / (photo.height() as f64 * width as f64);
    if (aspect - 1.0).abs() <= ASPECT {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::SizeMismatch,
        "image",
        format!("{} × {} pixels for a depth map of {width} × {height}", photo.width(), photo.height()),
        "a photo with the field of view of the depth map, at any size",
        "Crop the photo to the field of view of the depth map, or register the depth map to the photo.",
    ))
}
