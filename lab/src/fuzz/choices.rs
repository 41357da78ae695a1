//! The list of integers from which an input is generated.

use crate::prelude::*;

/// Random stream of the choices.
const STREAM: u64 = 31;

/// A source of choices that records them.
#[derive(Debug, Clone)]
pub struct Choices {
    source: Source,
    taken: Vec<u32>,
}

#[derive(Debug, Clone)]
enum Source {
    Random(Random),
    /// Choices beyond the end of the list are 0.
    List(Vec<u32>),
}

impl Choices {
    /// Random choices.
    pub fn random(seed: u64) -> Self {
        Self { source: Source::Random(Random::new(seed, STREAM)), taken: Vec::new() }
    }

    /// The choices of a list.
    pub fn of(list: Vec<u32>) -> Self {
        Self { source: Source::List(list), taken: Vec::new() }
    }

    /// Reads a list: numbers between white space; `#` begins a comment.
    ///
    /// # Errors
    /// The word that is no number.
    pub fn read(text: &str) -> Result<Self, String> {
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
        let words = lines.flat_map(str::split_whitespace);
        words.map(|word| word.parse().map_err(|_| word.to_owned())).collect::<Result<_, _>>().map(Self::of)
    }

    /// The choices so far.
    pub fn taken(&self) -> &[u32] {
        &self.taken
    }

    /// A number below `bound`, or 0.
    pub fn below(&mut self, bound: usize) -> usize {
        let bound = bound.clamp(1, u32::MAX as usize);
        let choice = match &mut self.source {
            Source::Random(random) => random.below(bound),
            Source::List(list) => list.get(self.taken.len()).map_or(0, |&choice| choice as usize % bound),
        };
        self.taken.push(choice as u32);
        choice
    }

    /// One of several values; the first is the simplest.
    pub fn pick<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// True once in `n` times.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// An integer from `low` to `high`, about evenly distributed in its logarithm.
    pub fn size(&mut self, low: usize, high: usize) -> usize {
        let (low, high) = (low.max(1), high.max(low).max(1));
        let doublings = (high / low).max(1).ilog2() as usize + 1;
        let base = low << self.below(doublings);
        (base + self.below(base)).clamp(low, high)
    }

    /// A number from 0 to 1 in steps of a thousandth.
    pub fn share(&mut self) -> f64 {
        self.below(1001) as f64 / 1000.0
    }

    /// A power of ten from 10^-`decades` to 10^`decades`; mostly 1.
    pub fn power(&mut self, decades: u32) -> f64 {
        if !self.once_in(8) {
            return 1.0;
        }
        let exponent = self.below(2 * decades as usize + 1) as i32;
        // 0, 1, −1, 2, −2, …: the plainest first.
        let exponent = if exponent % 2 == 1 { exponent / 2 + 1 } else { -(exponent / 2) };
        libm::pow(10.0, f64::from(exponent))
    }

    /// Random numbers that one choice stands for.
    pub fn noise(&mut self) -> Random {
        Random::new(self.below(1 << 16) as u64, STREAM + 1)
    }
}
