//! The long parts of registration as functions without pauses.

use glam::Vec3;

use super::fpfh::Descriptor;
use super::matching::{Match, Nearest};
use super::ransac::{Consensus, RansacSettings};
use crate::error::Result;
use crate::pauses::{Pauses, finished};

/// See [`super::matching::Nearest`].
pub fn nearest(source: &[Descriptor], target: &[Descriptor]) -> Nearest {
    finished(Nearest::of(source, target, &Pauses::none()))
}

/// See [`super::ransac::ransac`].
///
/// # Errors
/// As there.
pub fn ransac(source: &[Vec3], target: &[Vec3], matches: &[Match], settings: &RansacSettings) -> Result<Consensus> {
    finished(super::ransac::ransac(source, target, matches, settings, &Pauses::none()))
}
