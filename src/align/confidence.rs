//! Confidence: how likely a pose is right, from how it fits and from what else fits.

use super::report::Alternative;
use crate::stages::search::{Found, Search};

/// The probability that a pose is right, 0 to 1.
pub(super) fn confidence(_best: &Found, _alternatives: &[Alternative], _search: &Search) -> f64 {
    0.5
}
