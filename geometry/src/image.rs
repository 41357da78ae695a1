//! Row-major images of any pixel type.

use crate::error::{Error, ErrorCode, Result};

/// A row-major image: pixel (u, v) is `data[v * width + u]`; u runs right, v runs down.
#[derive(Debug, Clone, PartialEq)]
pub struct Image<T> {
    width: usize,
    height: usize,
    data: Vec<T>,
}

/// Depth in metres along the optical axis; 0 is "no reading" (see [`DepthMap::from_metres`]).
pub type DepthMap = Image<f32>;

/// A mask: non-zero pixels are the object.
pub type Mask = Image<u8>;

impl<T: Copy> Image<T> {
    /// An image from its pixels. `argument` names it in errors.
    pub fn new(argument: &str, width: usize, height: usize, data: Vec<T>) -> Result<Self> {
        check_size(argument, width, height, data.len())?;
        Ok(Self { width, height, data })
    }

    /// An image with the same value in all pixels. The size must be that of a validated image.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, data: vec![value; width * height] }
    }

    /// Width, in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height, in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row-major.
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All pixels, row-major, mutable.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// The pixel at column `u`, row `v`, or `None` outside the image.
    pub fn get(&self, u: usize, v: usize) -> Option<T> {
        if u < self.width && v < self.height { self.data.get(v * self.width + u).copied() } else { None }
    }

    /// Nearest-neighbour resampling: each new pixel takes the value of the old pixel that contains its centre. The new
    /// size must be that of a validated image.
    pub fn resize_nearest(&self, width: usize, height: usize) -> Self {
        // In u64: the product of two row lengths can overflow a 32-bit usize.
        let source = |i: usize, to: usize, from: usize| ((2 * i as u64 + 1) * from as u64 / (2 * to as u64)) as usize;
        let mut data = Vec::with_capacity(width * height);
        for v in 0..height {
            let row = source(v, height, self.height) * self.width;
            data.extend((0..width).map(|u| self.data[row + source(u, width, self.width)]));
        }
        Self { width, height, data }
    }
}

impl DepthMap {
    /// Depth from metres; NaN, infinities and values ≤ 0 become 0, "no reading".
    pub fn from_metres(width: usize, height: usize, mut data: Vec<f32>) -> Result<Self> {
        check_size("depth", width, height, data.len())?;
        for z in &mut data {
            if !(z.is_finite() && *z > 0.0) {
                *z = 0.0;
            }
        }
        Ok(Self { width, height, data })
    }
}

/// The bounding box of the set pixels of a row-major image: first and last column, first and last row; all 0 if no pixel
/// is set.
pub fn bounds_of<T>(pixels: &[T], width: usize, is_set: impl Fn(&T) -> bool) -> [[usize; 2]; 2] {
    let mut bounds = [[usize::MAX, 0]; 2];
    for (v, row) in pixels.chunks_exact(width).enumerate() {
        let Some(first) = row.iter().position(&is_set) else { continue };
        let last = row.iter().rposition(&is_set).unwrap_or(first);
        bounds[0] = [bounds[0][0].min(first), bounds[0][1].max(last)];
        bounds[1] = [bounds[1][0].min(v), bounds[1][1].max(v)];
    }
    bounds.map(|[low, high]| [low.min(high), high])
}

/// Checks that both sizes are above 0.
pub fn check_not_empty(argument: &str, width: usize, height: usize) -> Result<()> {
    if width > 0 && height > 0 {
        return Ok(());
    }
    Err(Error::new(
        ErrorCode::EmptyImage,
        argument.to_owned(),
        format!("{width} × {height} pixels"),
        "at least 1 × 1",
        "Check the width and height of the image, and that its file is complete.",
    ))
}

/// Checks that sizes are above 0 and that `length` is their product.
pub fn check_size(argument: &str, width: usize, height: usize, length: usize) -> Result<()> {
    check_not_empty(argument, width, height)?;
    if width.checked_mul(height) != Some(length) {
        return Err(Error::new(
            ErrorCode::WrongLength,
            argument.to_owned(),
            format!("{length} values"),
            format!("width × height = {width} × {height} = {}", width.saturating_mul(height)),
            "Pass one value per pixel, row-major, and the width and height of the same array.",
        ));
    }
    Ok(())
}
