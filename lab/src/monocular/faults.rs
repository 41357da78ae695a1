//! The errors of one map.

use crate::prelude::*;

/// The errors of a map; distances are shares, so that they fit any image.
#[derive(Debug, Clone)]
pub struct Faults {
    /// The map is so many times too far.
    pub factor: f64,
    /// Added to depth before the factor, as a share of the distance of the objects.
    pub shift: f64,
    /// Smooth errors.
    pub bend: Option<Bend>,
    /// Standard deviation of a Gaussian blur, as a share of the width of the objects.
    pub blur: f64,
    /// Width of the ramps at edges, in pixels of the network; only where the edges are not a sensor's.
    pub ramp: f64,
    /// Whether a model whose own output is inverse depth made it, which is what is blurred.
    pub is_inverse: bool,
    /// What is written.
    pub output: Output,
    /// What is wrong with the focal length.
    pub focal: FocalFault,
}

/// What a model writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Depth.
    Depth,
    /// Inverse depth, from 0 to 1 over the image.
    Disparity {
        /// Bits of an integer.
        bits: u32,
    },
    /// Depth from such a map and a guess of near and far.
    GuessedDepth {
        /// Bits of the integer.
        bits: u32,
    },
}

/// What is wrong with the focal length that is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FocalFault {
    /// Nothing.
    None,
    /// It is so many times the true one.
    Wrong(f64),
    /// There is none.
    Unknown,
}

/// Lengths of the waves of a bend, in widths of the objects. Their amplitudes are as their lengths, so that all are as
/// steep: errors of networks are smooth.
const WAVES: [f64; 2] = [4.0, 1.0];

/// Waves across the image: factors on depth.
#[derive(Debug, Clone)]
pub struct Bend {
    /// For each, its direction and its phase, radians.
    waves: [[f64; 2]; WAVES.len()],
    /// The largest factor of all together, less 1.
    amplitude: f64,
}

impl Faults {
    /// A perfect model.
    pub fn none() -> Self {
        Self {
            factor: 1.0,
            shift: 0.0,
            bend: None,
            blur: 0.0,
            ramp: 0.0,
            is_inverse: false,
            output: Output::Depth,
            focal: FocalFault::None,
        }
    }
}

impl Bend {
    /// Waves whose amplitudes sum to this.
    pub fn draw(amplitude: f64, random: &mut Random) -> Self {
        Self { waves: WAVES.map(|_| [TAU * random.uniform(), TAU * random.uniform()]), amplitude }
    }

    /// Bends depth, in an image whose objects are so many pixels wide.
    pub fn apply(&self, depth: &mut [f64], width: usize, object_width_px: f64) {
        let all: f64 = WAVES.iter().sum();
        let waves: Vec<[f64; 4]> = core::iter::zip(WAVES, self.waves)
            .map(|(length, [direction, phase])| {
                let frequency = TAU / (length * object_width_px);
                let (sine, cosine) = libm::sincos(direction);
                [frequency * cosine, frequency * sine, phase, self.amplitude * length / all]
            })
            .collect();
        for (i, z) in depth.iter_mut().enumerate() {
            let (u, v) = ((i % width) as f64, (i / width) as f64);
            let sum: f64 = waves.iter().map(|[du, dv, phase, most]| most * libm::cos(du * u + dv * v + phase)).sum();
            *z *= 1.0 + sum;
        }
    }
}
