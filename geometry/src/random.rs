//! Seeded random numbers: PCG-32 with a separate stream per stage, so that the number of draws of a stage does not
//! affect the next one.

use rand_core::Rng;
use rand_pcg::Pcg32;

/// A reproducible random number generator: the same seed and stream give the same numbers on every platform.
#[derive(Debug, Clone)]
pub struct Random(Pcg32);

impl Random {
    /// The generator of `stream` under `seed`.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(Pcg32::new(seed, stream))
    }

    /// An integer in 0..`bound`; 0 for a bound of 0. Lemire's multiplication without rejection: the bias is below
    /// bound / 2³², and the number of draws is fixed.
    pub fn below(&mut self, bound: usize) -> usize {
        ((u64::from(self.0.next_u32()) * bound as u64) >> 32) as usize
    }

    /// Stratified sampling: one random index from each of `count` equal intervals of 0..`n`, in ascending order;
    /// `count` ≤ `n`.
    pub fn one_of_each_run(&mut self, n: usize, count: usize) -> impl Iterator<Item = usize> {
        // In u64: with a 32-bit usize, 20 000 of the pixels of a VGA image overflow the product.
        let start = move |k: usize| (k as u64 * n as u64 / count as u64) as usize;
        (0..count).map(move |k| start(k) + self.below(start(k + 1) - start(k)))
    }

    /// A number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }
}

/// A hash of 64 bits: one step of SplitMix64 (Steele et al., "Fast splittable pseudorandom number generators", OOPSLA 2014).
pub fn mixed(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
