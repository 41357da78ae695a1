//! Adaptive voting: the value that most of many scalar measurements with known ranges agree with.
//!
//! Minimises Σ min((v − x)²/r², 1) over x exactly: the consensus set changes only at the ends of ranges, and between
//! two ends the best x is its weighted mean (Yang, Shi, Carlone, "TEASER", T-RO 2021, §V).
//!
//! Intentional difference: TEASER++ and KISS-Matcher add squares that are not divided by r² to ranges that are not
//! squared, so that their compromise between near and many depends on the unit of length.

use sim3align_geometry::order::{index_of, pack, sort};

/// Result of a vote.
#[derive(Debug, Clone, PartialEq)]
pub struct Vote {
    /// x.
    pub value: f64,
    /// Σ min((v − x)²/r², 1).
    pub cost: f64,
    /// Whether each measurement is within its range of x.
    pub agreeing: Vec<bool>,
}

/// Sums over the consensus set.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    weight: f64,
    value: f64,
    square: f64,
}

impl Sums {
    /// Adds (1.0) or removes (−1.0) a measurement.
    fn add(&mut self, sign: f64, value: f64, range: f64) {
        let weight = sign / (range * range);
        self.count += sign;
        self.weight += weight;
        self.value += weight * value;
        self.square += weight * value * value;
    }

    fn mean(&self) -> f64 {
        self.value / self.weight
    }

    /// Cost relative to an empty consensus set.
    fn gain(&self) -> f64 {
        self.count - (self.square - self.value * self.mean())
    }
}

/// Votes on `values` with ranges above 0; `None` without values, or if a number is not finite.
pub fn vote(values: &[f64], ranges: &[f64]) -> Option<Vote> {
    let n = values.len().min(ranges.len());
    let (values, ranges) = (&values[..n], &ranges[..n]);
    let sound = |(v, r): (&f64, &f64)| v.is_finite() && r.is_finite() && *r > 0.0;
    if n == 0 || !values.iter().zip(ranges).all(sound) {
        return None;
    }
    // Relative to one value: squares of large numbers would lose the precision of differences.
    let origin = values[0];
    let mut ends = Vec::with_capacity(2 * n);
    for (i, (value, range)) in (0_u32..).zip(values.iter().zip(ranges)) {
        // At equal ends, ranges that begin come first.
        ends.push(pack((value - origin - range) as f32, i));
        ends.push(pack((value - origin + range) as f32, i + n as u32));
    }
    sort(&mut ends);

    let (mut sums, mut best) = (Sums::default(), (f64::NEG_INFINITY, 0));
    for (passed, &end) in ends.iter().enumerate() {
        let index = index_of(end) as usize;
        let (i, sign) = if index < n { (index, 1.0) } else { (index - n, -1.0) };
        sums.add(sign, values[i] - origin, ranges[i]);
        if sums.count == 0.0 {
            // Additions and removals leave rounding errors.
            sums = Sums::default();
        } else if sums.gain() > best.0 {
            best = (sums.gain(), passed);
        }
    }
    // Recomputes the sums over the consensus set, without these rounding errors.
    let mut agrees = vec![false; n];
    for &end in &ends[..=best.1] {
        let index = index_of(end) as usize;
        agrees[if index < n { index } else { index - n }] = index < n;
    }
    let mut sums = Sums::default();
    for i in (0..n).filter(|&i| agrees[i]) {
        sums.add(1.0, values[i] - origin, ranges[i]);
    }
    let value = origin + sums.mean();
    let ratio = |i: usize| ((values[i] - value) / ranges[i]).abs();
    Some(Vote {
        value,
        cost: (0..n).map(|i| (ratio(i) * ratio(i)).min(1.0)).sum(),
        agreeing: (0..n).map(|i| ratio(i) <= 1.0).collect(),
    })
}
