//! Seeded randomness: PCG-32 with one stream per stage, so that a stage that draws more numbers
//! does not change what the next one sees.

use rand_core::Rng;
use rand_pcg::Pcg32;

/// A reproducible source of random numbers: the same seed and stream give the same numbers on every platform.
#[derive(Debug, Clone)]
pub struct Random(Pcg32);

impl Random {
    /// The generator of `stream` under `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(Pcg32::new(seed, stream))
    }

    /// A whole number in 0..`bound`; 0 for a bound of 0. Lemire's multiplication, without his rejection:
    /// the bias is below bound / 2³², and the number of draws is fixed.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u64::from(self.0.next_u32()) * bound as u64) >> 32) as usize
    }

    /// One index, drawn at random, from each of `count` equal runs of 0..`n`, in ascending order;
    /// `count` is at most `n`.
    pub fn one_of_each_run(&mut self, n: usize, count: usize) -> impl Iterator<Item = usize> {
        // In u64: where usize has 32 bits, 20 000 of a VGA image's pixels are already too many to multiply.
        let start = move |k: usize| (k as u64 * n as u64 / count as u64) as usize;
        (0..count).map(move |k| start(k) + self.below(start(k + 1) - start(k)))
    }

    /// A number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }
}
