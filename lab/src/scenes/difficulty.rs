//! Difficulty of a pair as one number.

use crate::cases::tier::Tier;

/// Visibility of the object of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Visible share of its silhouette.
    pub visible: f64,
    /// Pixels in its mask.
    pub mask_px: usize,
    /// By how many pixels the mask is too wide (positive) or too narrow.
    pub mask_offset_px: f64,
    /// How far away it is, metres.
    pub distance_m: f64,
}

/// Shares of the difficulty: hidden, small, masked wrongly, far.
const WEIGHTS: [f64; 4] = [0.4, 0.3, 0.15, 0.15];
/// The visible share, the pixels, the mask's offset in pixels and the distance in metres that count as 0 and as 1.
const VISIBLE: [f64; 2] = [1.0, 0.35];
const MASK_PX: [f64; 2] = [20_000.0, 350.0];
const OFFSET_PX: [f64; 2] = [0.0, 2.5];
const DISTANCE_M: [f64; 2] = [0.5, 1.6];
/// Difficulties below the first are easy, below the second medium; about a third of the pairs each.
const TIERS: [f64; 2] = [0.175, 0.305];

/// How hard a pair is, from 0 to 1: 0.4 · hidden + 0.3 · small + 0.15 · wrongly masked + 0.15 · far, each from 0 to 1.
///
/// Hidden is linear from all visible to 35 % visible, small is logarithmic from 20 000 pixels to 350, wrongly masked is
/// linear from no offset to 2.5 pixels, far is linear from 0.5 m to 1.6 m. It rises with each and knows nothing of the
/// object's shape, its mesh, or any method.
pub fn difficulty(sight: &Sight) -> f64 {
    let share = |value: f64, [none, all]: [f64; 2]| ((value - none) / (all - none)).clamp(0.0, 1.0);
    let parts = [
        share(sight.visible, VISIBLE),
        share(libm::log(sight.mask_px.max(1) as f64), MASK_PX.map(libm::log)),
        share(sight.mask_offset_px.abs(), OFFSET_PX),
        share(sight.distance_m, DISTANCE_M),
    ];
    WEIGHTS.iter().zip(parts).map(|(weight, part)| weight * part).sum()
}

/// The tier of a difficulty.
pub fn tier(difficulty: f64) -> Tier {
    let [easy, medium] = TIERS;
    match difficulty {
        d if d < easy => Tier::Easy,
        d if d < medium => Tier::Medium,
        _ => Tier::Hard,
    }
}
