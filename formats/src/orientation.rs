//! The orientation that cameras note in EXIF data.

use sim3align_geometry::image::Image;
use sim3align_runtime::error::Result;

/// The place of the first row and column of a stored image when it is viewed: 1, the default, is as stored (Exif 2.32,
/// 4.6.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Orientation(u16);

impl Default for Orientation {
    fn default() -> Self {
        Self(1)
    }
}

impl Orientation {
    /// The orientation with this number, 1 to 8.
    pub fn new(number: u32) -> Option<Self> {
        u16::try_from(number).ok().filter(|number| (1..=8).contains(number)).map(Self)
    }

    /// Its number, 1 to 8.
    pub fn number(self) -> u16 {
        self.0
    }

    /// The image as it is viewed.
    pub(crate) fn apply<T: Copy>(self, argument: &str, image: Image<T>) -> Result<Image<T>> {
        if self == Self::default() {
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
