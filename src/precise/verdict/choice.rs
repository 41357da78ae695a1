//! The choice among poses that shape leaves, by their colours.

use crate::geometry::order::largest;
use crate::report::{ColorReport, ColorVerdict};

/// Contrast between two poses, relative to the noise, from which on they look different: where a pose agrees with the photo, and
/// where none does. Prints of 45 real objects differ by 25 and more, shading and light in the colours of one-coloured ones by up
/// to 13.
const DISTINCT_MIN_CONTRAST: f64 = 2.0;
const PRINT_MIN_CONTRAST: f64 = 16.0;
/// Minimum correlation of the best pose with the photo for colour to decide.
pub const MIN_CORRELATION: f64 = 0.3;
/// Correlation that outweighs a difference of 1 between shape scores.
pub const CORRELATION_PER_SCORE: f64 = 0.5;
/// Gain for which another pose than that of shape is taken.
const MIN_GAIN: f64 = 0.02;
/// Factor of the correlation in the logarithm of the odds of two poses.
const LOG_ODDS_PER_CORRELATION: f64 = 15.0;
/// Minimum probability of the pose where none agrees with the photo.
pub const UNMATCHED_PROBABILITY: f64 = 0.5;

/// The score of a pose by colour.
#[derive(Debug, Clone, Copy)]
pub struct ColorScore {
    /// Correlation with the photo.
    pub agreement: f64,
    /// The agreement, with the difference of the shape score from that of the best pose by shape.
    pub total: f64,
}

impl ColorScore {
    /// A pose whose shape score is above that of the best pose by this much, per view.
    pub fn new(agreement: f64, shape: f32) -> Self {
        Self { agreement, total: agreement + CORRELATION_PER_SCORE * f64::from(shape) }
    }
}

/// The choice of colour among several poses. The first is the best by shape.
#[derive(Debug, Clone)]
pub struct Choice {
    scores: Vec<ColorScore>,
    /// Index of the chosen pose.
    pub chosen: usize,
    /// Indices of the poses that look different from the chosen one, best first.
    pub rivals: Vec<usize>,
    /// Whether a pose agrees with the photo, so that colour counts.
    pub is_used: bool,
}

impl Choice {
    /// The choice among poses; `contrast` is that between the poses of two indices, 0 for those that are no rivals. `None` without
    /// any.
    pub fn among(scores: Vec<ColorScore>, contrast: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let first = scores.first()?;
        let is_used = scores.iter().fold(f64::NEG_INFINITY, |most, look| most.max(look.agreement)) >= MIN_CORRELATION;
        let best = (0..scores.len()).fold(0, |best, k| if scores[k].total > scores[best].total { k } else { best });
        let chosen = if is_used && scores[best].total > first.total + MIN_GAIN { best } else { 0 };
        let min_contrast = if is_used { DISTINCT_MIN_CONTRAST } else { PRINT_MIN_CONTRAST };
        let rivals: Vec<usize> = (0..scores.len()).filter(|&other| contrast(other, chosen) > min_contrast).collect();
        let order = largest(rivals.iter().map(|&rival| scores[rival].total as f32), rivals.len());
        let rivals = order.into_iter().map(|i| rivals[i as usize]).collect();
        Some(Self { scores, chosen, rivals, is_used })
    }

    /// Probability that the chosen pose is right, given that it or one of these rivals is. `gain` is by how much its agreement
    /// has grown since.
    pub fn probability(&self, gain: f64, rivals: impl Iterator<Item = usize>) -> f64 {
        let odds: f64 = rivals.map(|rival| libm::exp(-LOG_ODDS_PER_CORRELATION * self.lead(rival, gain))).sum();
        1.0 / (1.0 + odds)
    }

    /// By how much the agreement of a rival is below that of the chosen pose.
    pub fn margin(&self, rival: usize, gain: f64) -> f64 {
        self.scores[self.chosen].agreement + gain - self.scores[rival].agreement
    }

    /// For the result.
    pub fn report(&self, gain: f64) -> ColorReport {
        let verdict = match (self.rivals.is_empty(), self.is_used, self.chosen != 0) {
            (true, ..) => ColorVerdict::Uniform,
            (_, false, _) => ColorVerdict::Unmatched,
            (_, _, false) => ColorVerdict::Agreed,
            (_, _, true) => ColorVerdict::Decided,
        };
        let agreement = self.scores[self.chosen].agreement + gain;
        ColorReport { verdict, agreement, margin: self.rivals.first().map(|&rival| self.lead(rival, gain)) }
    }

    fn lead(&self, rival: usize, gain: f64) -> f64 {
        if self.is_used { self.scores[self.chosen].total + gain - self.scores[rival].total } else { 0.0 }
    }
}

/// The contribution of colour where nothing can be compared.
pub const HIDDEN: ColorReport = ColorReport { verdict: ColorVerdict::Hidden, agreement: 0.0, margin: None };

/// Angles of the steps of a roll, radians.
const ROLL_STEPS: [f64; 4] = [0.12, 0.06, 0.03, 0.015];

/// The roll about an open axis at which `total`, a function of the angle in radians, is largest, and its gain; `None` if
/// no roll is better.
pub fn best_roll(mut total: impl FnMut(f64) -> f64) -> Option<(f64, f64)> {
    let start = total(0.0);
    let mut best = (start, 0.0);
    for step in ROLL_STEPS {
        let middle = best.1;
        for angle in [middle - step, middle + step] {
            let there = total(angle);
            if there > best.0 {
                best = (there, angle);
            }
        }
    }
    (best.1 != 0.0).then_some((best.1, best.0 - start))
}
