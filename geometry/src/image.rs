//! Row-major images of any pixel type.

use sim3align_runtime::error::{Error, ErrorCode, Result};
use sim3align_runtime::number::number;

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

/// A rectangle of pixels of an image; empty by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Window {
    /// The first column and row.
    pub first: [usize; 2],
    /// Width and height.
    pub size: [usize; 2],
}

impl Window {
    /// A whole image.
    pub fn whole(width: usize, height: usize) -> Self {
        Self { first: [0; 2], size: [width, height] }
    }

    /// The pixels from the first to the last column and row, as [`bounds_of`] returns them.
    pub fn of_bounds(bounds: [[usize; 2]; 2]) -> Self {
        Self { first: bounds.map(|[low, _]| low), size: bounds.map(|[low, high]| high + 1 - low) }
    }

    /// The smallest window that contains both.
    pub fn union(self, other: Self) -> Self {
        let first = [0, 1].map(|axis| self.first[axis].min(other.first[axis]));
        let end = |window: Self, axis: usize| window.first[axis] + window.size[axis];
        Self { first, size: [0, 1].map(|axis| end(self, axis).max(end(other, axis)) - first[axis]) }
    }

    /// The window with a margin, as far as that is inside an image of this size.
    pub fn grown(self, margin: usize, image: [usize; 2]) -> Self {
        let first = self.first.map(|first| first.saturating_sub(margin));
        let end = |axis: usize| (self.first[axis] + self.size[axis] + margin).min(image[axis]);
        Self { first, size: [0, 1].map(|axis| end(axis).saturating_sub(first[axis])) }
    }
}

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

    /// The pixels in a window that is inside the image.
    pub fn window(&self, window: &Window) -> Self {
        let ([left, top], [width, height]) = (window.first, window.size);
        let row = |v: usize| &self.data[v * self.width + left..][..width];
        Self { width, height, data: (top..top + height).flat_map(row).copied().collect() }
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
    ///
    /// # Errors
    /// [`ErrorCode::WrongLength`], [`ErrorCode::EmptyImage`], and [`ErrorCode::NoDepthInMask`] if all values are below 0.
    pub fn from_metres(width: usize, height: usize, mut data: Vec<f32>) -> Result<Self> {
        check_size("depth", width, height, data.len())?;
        let (mut lowest, mut is_read) = (0.0_f32, false);
        for z in &mut data {
            if z.is_finite() && *z > 0.0 {
                is_read = true;
            } else {
                lowest = if z.is_finite() { lowest.min(*z) } else { lowest };
                *z = 0.0;
            }
        }
        if lowest < 0.0 && !is_read {
            return Err(Error::new(
                ErrorCode::NoDepthInMask,
                "depth",
                format!("only values below 0, down to {}", number(lowest.into())),
                "z forward, above 0",
                "Pass -depth: in OpenGL's camera frame, z points backward.",
            ));
        }
        Ok(Self { width, height, data })
    }
}

/// The bounding box of the set pixels of a row-major image: first and last column, first and last row; all 0 if no pixel
/// is set.
pub fn bounds_of<T>(pixels: &[T], width: usize, is_set: impl Fn(&T) -> bool) -> [[usize; 2]; 2] {
    let mut bounds = [[usize::MAX, 0]; 2];
    for (v, row) in pixels.chunks_exact(width.max(1)).enumerate() {
        // Without a branch per pixel: most rows are empty.
        if !row.iter().fold(false, |any, pixel| any | is_set(pixel)) {
            continue;
        }
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
