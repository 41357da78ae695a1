//! Gaussians that are packed into four words each, as SuperSplat's compressed PLY has them.

use glam::Vec3;

use super::gaussian::Gaussian;
use crate::guard::corrupt;
use sim3align_runtime::error::Result;

/// Gaussians per chunk, which has their ranges.
const CHUNK: usize = 256;

/// The ranges of a chunk: lowest and highest coordinates, logarithms of standard deviations and, in later versions of the
/// format, colours.
pub(super) const RANGES: [&[u8]; 18] = [
    b"min_x",
    b"min_y",
    b"min_z",
    b"max_x",
    b"max_y",
    b"max_z",
    b"min_scale_x",
    b"min_scale_y",
    b"min_scale_z",
    b"max_scale_x",
    b"max_scale_y",
    b"max_scale_z",
    b"min_r",
    b"min_g",
    b"min_b",
    b"max_r",
    b"max_g",
    b"max_b",
];

/// The words of a Gaussian.
pub(super) const WORDS: [&[u8]; 4] = [b"packed_position", b"packed_rotation", b"packed_scale", b"packed_color"];

/// The ranges of all chunks.
#[derive(Default)]
pub(super) struct Chunks(Vec<[f64; RANGES.len()]>);

impl Chunks {
    /// Adds a chunk. Colours without ranges are from 0 to 1.
    pub fn push(&mut self, ranges: [f64; RANGES.len()]) {
        self.0.push(ranges);
    }

    /// Unpacks the `index`th Gaussian.
    pub fn gaussian(&self, index: usize, words: [u32; WORDS.len()]) -> Result<Gaussian> {
        let Some(ranges) = self.0.get(index / CHUNK) else {
            return Err(corrupt(
                "mesh",
                format!("{} chunks for Gaussian {index}", self.0.len()),
                "one per 256 Gaussians",
            ));
        };
        let [position, rotation, scale, color] = words;
        let between = |first: usize, fractions: [f64; 3]| {
            core::array::from_fn::<f64, 3, _>(|axis| {
                let (low, high) = (ranges[first + axis], ranges[first + 3 + axis]);
                low + (high - low) * fractions[axis]
            })
        };
        let vector = |xyz: [f64; 3]| Vec3::from_array(xyz.map(|x| x as f32));
        let center = vector(between(0, coordinates(position)));
        let scales = vector(between(6, coordinates(scale)).map(libm::exp));
        let byte = |shift: u32| f64::from(color >> shift & 255) / 255.0;
        let rgb = between(12, [byte(24), byte(16), byte(8)]).map(|channel| (channel * 255.0).round() as u8);
        Gaussian::new(index, center, scales, quaternion(rotation), byte(0) as f32, rgb)
    }
}

/// Fractions of 11, 10 and 11 bits, the first one highest.
fn coordinates(word: u32) -> [f64; 3] {
    [(21, 11), (11, 10), (0, 11)].map(|(shift, bits)| {
        let most = (1_u32 << bits) - 1;
        f64::from(word >> shift & most) / f64::from(most)
    })
}

/// w, x, y, z: two bits have the place of the largest, which follows from the length; the others have ten bits each.
fn quaternion(word: u32) -> [f32; 4] {
    let others = [20, 10, 0].map(|shift| (f64::from(word >> shift & 1023) / 1023.0 - 0.5) * core::f64::consts::SQRT_2);
    let square: f64 = others.iter().map(|x| x * x).sum();
    let largest = (1.0 - square).max(0.0).sqrt();
    let mut others = others.into_iter();
    let place = (word >> 30) as usize;
    core::array::from_fn(|i| if i == place { largest } else { others.next().unwrap_or_default() } as f32)
}
