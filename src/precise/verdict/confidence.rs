//! Confidence: the probability that a pose is correct, from its fit, its conditioning and its alternatives.
//!
//! A logistic regression on generated cases, some of them with the mesh of another object. Its intercept is fitted to real cases
//! as well, each sensor weighing the same (`npm run fit`, which prints the calibration on other cases). The score alone is not
//! informative: correct poses of half-hidden objects have low scores. Informative are the margin to the next best placement, the
//! agreement of independent terms, and how sharply the score falls around the pose.

use super::choice::CORRELATION_PER_SCORE;
use crate::precise::scoring::conditioning::{Conditioning, DROP};
use crate::precise::scoring::score::NOISE;
use crate::precise::search::ranking::Candidate;
use crate::report::Alternative;

/// Intercept and coefficients of the regression: overlap, depth, outline, the margin relative to [`NOISE`], and the
/// logarithms of the standard deviations of scale (relative) and rotation (degrees).
const INTERCEPT: f64 = -23.583;
const SLOPES: [f64; 6] = [4.971, 5.276, 3.319, 2.546, -3.013, -1.763];

/// The range of standard deviations in these cases. Values outside are clamped, because the fit has no data there.
const SCALE: [f64; 2] = [1e-3, 1.0];
const ROTATION_DEG: [f64; 2] = [0.03, 90.0];

/// Relative error of the relief that turns a pose by about 10°: as much as it turns a surface that is slanted by 45°.
const WRONG_RELIEF: f64 = 0.43;

/// The confidence in a pose: the probabilities of its independent parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// The probability that the pose is right, by the shape of the object.
    pub shape: f64,
    /// The probability that it is the right one of the poses that shape leaves, by colour; 1 without colours.
    pub color: f64,
    /// The relative standard deviation of the relief of the depth; 0 for metric depth.
    pub relief_deviation: f64,
    /// The probability that it is the right one of the poses that a symmetry of the shape makes equal, by colour; `None` where no
    /// other turn is possible.
    pub turn: Option<f64>,
}

impl Confidence {
    /// The probability that the pose is right.
    pub fn overall(&self) -> f64 {
        with_turn(self.up_to_symmetry(), self.turn)
    }

    /// The probability that the pose is right up to the symmetry of the shape.
    pub fn up_to_symmetry(&self) -> f64 {
        self.shape * self.color * depth_calibration_reliability(self.relief_deviation)
    }
}

/// The probability that a pose is right, given that up to the symmetry of the shape and that of its turn, if others are possible.
pub fn with_turn(up_to_symmetry: f64, turn: Option<f64>) -> f64 {
    up_to_symmetry * turn.unwrap_or(1.0)
}

/// The probability that the relief of an observation is not so wrong that the pose is, given the standard deviation of its
/// estimate: at least this, by Chebyshev's inequality. The errors of such estimates have long tails.
fn depth_calibration_reliability(deviation: f64) -> f64 {
    let share = deviation / WRONG_RELIEF;
    (1.0 - share * share).max(0.0)
}

/// The probability that a pose is right by the shape of the object, given its alternatives.
pub(crate) fn shape_confidence(
    best: &Candidate,
    alternatives: &[Alternative],
    conditioning: Option<&Conditioning>,
) -> f64 {
    let score = f64::from(best.score.total);
    // Colour has lowered the odds of poses that shape alone cannot exclude.
    let lead =
        |other: &Alternative| score - other.score + other.color_margin.unwrap_or(0.0).max(0.0) / CORRELATION_PER_SCORE;
    let margin = alternatives.iter().fold(f64::from(NOISE), |margin, other| margin.min(lead(other)));
    pose_probability(best, margin, conditioning)
}

/// The same, given the lead over the next best placement, of which no more than [`NOISE`] counts. Of two placements that score
/// the same, either may be right: the odds between them grow with the lead in units of [`DROP`], the score of one deviation.
pub(crate) fn pose_probability(best: &Candidate, lead: f64, conditioning: Option<&Conditioning>) -> f64 {
    let Some(conditioning) = conditioning else { return 0.0 };
    let margin = lead.clamp(0.0, f64::from(NOISE));
    let log = |x: f64, [low, high]: [f64; 2]| libm::log(x.max(low).min(high));
    let features = [
        f64::from(best.score.overlap),
        f64::from(best.score.depth),
        f64::from(best.score.outline),
        margin / f64::from(NOISE),
        log(conditioning.scale, SCALE),
        log(conditioning.rotation.0.to_degrees(), ROTATION_DEG),
    ];
    let logit = features.iter().zip(SLOPES).map(|(x, slope)| x * slope).sum::<f64>() + INTERCEPT;
    logistic(logit) * logistic(margin / DROP)
}

fn logistic(log_odds: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-log_odds))
}
