//! Random draws of the generators, means, medians, and cells of tables.

use sim3align_geometry::random::{self, Random};

/// A number in [`low`, `high`).
pub(crate) fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.uniform()
}

/// A standard normal number (Box–Muller transform).
pub(crate) fn normal(random: &mut Random) -> f64 {
    let (u, v) = (1.0 - random.uniform(), random.uniform());
    (-2.0 * libm::log(u)).sqrt() * libm::cos(core::f64::consts::TAU * v)
}

/// `true` with the given probability.
pub(crate) fn chance(random: &mut Random, probability: f64) -> bool {
    random.uniform() < probability
}

/// −1 or 1 with equal probability.
pub(crate) fn sign(random: &mut Random) -> f64 {
    if chance(random, 0.5) { -1.0 } else { 1.0 }
}

/// A seed derived from several numbers: SplitMix64 over each in turn.
pub(crate) fn mixed<const N: usize>(numbers: [u64; N]) -> u64 {
    numbers.into_iter().fold(0, |state, x| random::mixed(state ^ x))
}

/// The arithmetic mean; `None` without values.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// The median; for an even number of values, the mean of the two middle ones. `None` without values.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let at = |i: usize| values.get(i).copied();
    if n % 2 == 1 { at(n / 2) } else { Some(0.5 * (at((n / 2).checked_sub(1)?)? + at(n / 2)?)) }
}

/// A number with `digits` decimals, or a dash.
pub fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or("–".into(), |value| format!("{value:.digits$}"))
}
