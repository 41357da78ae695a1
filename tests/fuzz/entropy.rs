//! Choices from the bytes of an input; without bytes, every choice is the plainest.

use arbitrary::Unstructured;
use sim3align::geometry::random::Random;

pub struct Entropy<'a>(Unstructured<'a>);

/// Numbers that may replace any number.
const NUMBERS: [f64; 14] =
    [1.0, 0.0, -1.0, 0.5, 1e-3, 1e3, 1e-9, 1e9, 1e-30, 1e30, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

impl<'a> Entropy<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(Unstructured::new(bytes))
    }

    /// A number below `bound`, or 0.
    pub fn below(&mut self, bound: usize) -> usize {
        self.0.int_in_range(0..=bound.max(1) - 1).unwrap_or(0)
    }

    /// One of several values; the first is the plainest.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// An integer from `low` to `high`, about evenly distributed in its logarithm.
    pub fn size(&mut self, low: usize, high: usize) -> usize {
        let base = low << self.below((high / low).max(1).ilog2() as usize + 1);
        (base + self.below(base)).clamp(low, high)
    }

    /// A power of ten from 10^-`decades` to 10^`decades`; mostly 1.
    pub fn power(&mut self, decades: i32) -> f64 {
        let exponent = if self.once_in(8) { self.below(2 * decades as usize + 1) as i32 - decades } else { 0 };
        10f64.powi(exponent)
    }

    /// Any number, mostly an ordinary one.
    pub fn number(&mut self) -> f64 {
        if self.once_in(4) { self.pick(&NUMBERS) } else { 0.01 * self.size(1, 1000) as f64 }
    }

    /// Random numbers from a drawn seed.
    pub fn noise(&mut self) -> Random {
        Random::new(self.below(1 << 16) as u64, 0)
    }
}
