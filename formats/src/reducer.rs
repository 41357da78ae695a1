//! Reduces an image while it is read, so that large ones need no more memory than small ones.

use sim3align_geometry::image::Image;
use sim3align_geometry::surface_colors::Rgb;
use sim3align_runtime::error::Result;

/// Takes the pixels of an image in any order, and averages them to a smaller one. The average is that of the encoded
/// values, as usual when photos are resized.
pub(crate) struct Reducer {
    width: usize,
    height: usize,
    /// New column of each column, new row of each row.
    columns: Vec<u32>,
    rows: Vec<u32>,
    pixels: Vec<Rgb>,
    /// Sums of the pixels in each new one; empty if each is one.
    sums: Vec<[u32; 3]>,
}

/// The largest size of at most `max_pixels` that divides both sides by the same whole number.
pub(crate) fn reduced_size(size: [usize; 2], max_pixels: usize) -> [usize; 2] {
    let divided = |by: usize| size.map(|side| (side / by).max(1));
    let factor = (1..).find(|&by| divided(by).iter().product::<usize>() <= max_pixels.max(1));
    factor.map_or([1; 2], divided)
}

impl Reducer {
    /// For an image of the `full` size of which every pixel passed stands for `scale` × `scale` (fewer at the right and
    /// lower edge). Neither side of `size` is more than that of `full` divided by `scale`, rounded down.
    pub fn new(full: [usize; 2], scale: usize, size: [usize; 2]) -> Self {
        let map = |axis: usize| -> Vec<u32> {
            // Each pixel counts where its centre lies.
            let new = |i: usize| (2 * i as u64 + 1) * scale as u64 * size[axis] as u64 / (2 * full[axis] as u64);
            (0..full[axis].div_ceil(scale)).map(|i| new(i).min(size[axis] as u64 - 1) as u32).collect()
        };
        let count = size[0] * size[1];
        // Each pixel passed is a pixel of the new image: those of a decoder that reduces as much itself.
        let is_same = full.map(|side| side.div_ceil(scale)) == size;
        Self {
            width: size[0],
            height: size[1],
            columns: map(0),
            rows: map(1),
            pixels: if is_same { vec![[0; 3]; count] } else { Vec::new() },
            sums: if is_same { Vec::new() } else { vec![[0; 3]; count] },
        }
    }

    /// Adds the pixels of row `v`, or every `step`th of them from column `first` on; pixels outside the image are ignored.
    pub fn add_row(&mut self, v: usize, first: usize, step: usize, colors: impl Iterator<Item = Rgb>) {
        let Some(&row) = self.rows.get(v) else { return };
        let row = row as usize * self.width..(row as usize + 1) * self.width;
        if let Some(pixels) = self.pixels.get_mut(row.clone()) {
            let pixels = pixels.iter_mut().skip(first).step_by(step);
            pixels.zip(colors).for_each(|(pixel, color)| *pixel = color);
        } else if let Some(sums) = self.sums.get_mut(row) {
            for (&column, color) in self.columns.iter().skip(first).step_by(step).zip(colors) {
                let sum = &mut sums[column as usize];
                sum.iter_mut().zip(color).for_each(|(sum, channel)| *sum += u32::from(channel));
            }
        }
    }

    /// The reduced image. Every pixel of the original must have been added.
    pub fn finish(mut self, argument: &str) -> Result<Image<Rgb>> {
        if !self.sums.is_empty() {
            let counts = |places: &[u32], length: usize| {
                let mut counts = vec![0_u32; length];
                places.iter().for_each(|&place| counts[place as usize] += 1);
                counts
            };
            let (across, down) = (counts(&self.columns, self.width), counts(&self.rows, self.height));
            let counts = down.iter().flat_map(|down| across.iter().map(move |across| (across * down).max(1)));
            let mean = |(sum, count): (&[u32; 3], u32)| sum.map(|sum| ((sum + count / 2) / count) as u8);
            self.pixels = self.sums.iter().zip(counts).map(mean).collect();
        }
        Image::new(argument, self.width, self.height, self.pixels)
    }
}

/// An image averaged to a smaller size.
pub(crate) fn reduce(image: &Image<Rgb>, size: [usize; 2]) -> Result<Image<Rgb>> {
    let mut reducer = Reducer::new([image.width(), image.height()], 1, size);
    for (v, row) in image.data().chunks_exact(image.width()).enumerate() {
        reducer.add_row(v, 0, 1, row.iter().copied());
    }
    reducer.finish("image")
}
