//! The orientation that cameras note in EXIF data.

use sim3align_geometry::error::Result;
use sim3align_geometry::image::Image;

/// Tag of the orientation (Exif 2.32, 4.6.4).
const ORIENTATION: u16 = 0x0112;

/// Where the first row and column of a stored image are when it is viewed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Orientation(u16);

impl Orientation {
    /// As stored.
    pub const UPRIGHT: Self = Self(1);

    /// The orientation in EXIF data, from their TIFF header; upright where they state none.
    pub fn of_exif(exif: &[u8]) -> Self {
        Self::find(exif).map_or(Self::UPRIGHT, Self)
    }

    fn find(exif: &[u8]) -> Option<u16> {
        let is_little = match exif.get(..2)? {
            b"II" => true,
            b"MM" => false,
            _ => return None,
        };
        let u16_at = |at: usize| {
            let bytes = *exif.get(at..)?.first_chunk()?;
            Some(if is_little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) })
        };
        let u32_at = |at: usize| {
            let bytes = *exif.get(at..)?.first_chunk()?;
            Some(if is_little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
        };
        let directory = u32_at(4)? as usize;
        let entries = usize::from(u16_at(directory)?);
        let mut places = (0..entries).map_while(|i| directory.checked_add(2 + 12 * i));
        let place = places.find(|&place| u16_at(place) == Some(ORIENTATION))?;
        u16_at(place.checked_add(8)?).filter(|value| (1..=8).contains(value))
    }

    /// The image as it is viewed.
    pub fn apply<T: Copy>(self, argument: &str, image: Image<T>) -> Result<Image<T>> {
        if self == Self::UPRIGHT {
            return Ok(image);
        }
        let [stored_width, stored_height] = [image.width(), image.height()];
        let is_turned = self.0 >= 5;
        let [width, height] = if is_turned { [stored_height, stored_width] } else { [stored_width, stored_height] };
        let stored = |u: usize, v: usize| {
            let (right, down) = (stored_width - 1, stored_height - 1);
            match self.0 {
                2 => [right - u, v],
                3 => [right - u, down - v],
                4 => [u, down - v],
                5 => [v, u],
                6 => [v, down - u],
                7 => [right - v, down - u],
                _ => [right - v, u],
            }
        };
        let mut data = Vec::with_capacity(image.data().len());
        for v in 0..height {
            data.extend((0..width).map(|u| {
                let [column, row] = stored(u, v);
                image.data()[row * stored_width + column]
            }));
        }
        Image::new(argument, width, height, data)
    }
}
