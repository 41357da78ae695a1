//! Quatro (Lim et al., "A Single Correspondence Is Enough", ICRA 2022): TEASER++ for clouds with a known
//! vertical. It only estimates the rotation about the vertical, for which fewer correct matches suffice.
//!
//! Intentional difference: the vertical is any direction per frame, instead of z in both.

use super::gnc::{Turns, about};
use super::measurements::Matched;
use super::teaser::{Teaser, TeaserSettings, solve_with};
use crate::prelude::*;

/// Settings of [`solve`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuatroSettings {
    /// Settings other than the rotation.
    pub teaser: TeaserSettings,
    /// Up in the source frame, of any length above 0.
    pub source_up: Vector3<f64>,
    /// Up in the target frame, of any length above 0.
    pub target_up: Vector3<f64>,
}

/// Estimates the similarity from corresponding points that maps up to up.
///
/// # Errors
/// As [`teaser::solve`](super::teaser::solve); [`ErrorCode::InvalidOption`] for an up of length 0.
pub fn solve(source: &[Vector3<f64>], target: &[Vector3<f64>], settings: &QuatroSettings) -> Result<Teaser> {
    let (source_up, target_up) = (unit(settings.source_up)?, unit(settings.target_up)?);
    let upright = shortest_turn(source_up, target_up);
    let mut matched = Matched::from_points(source, target)?;
    matched.source.iter_mut().for_each(|p| *p = upright * *p);
    let found = solve_with(&matched, &settings.teaser, Turns::About(target_up))?;
    let turn = Similarity { scale: 1.0, rotation: upright, translation: Vector3::zeros() };
    Ok(Teaser { target_from_source: found.target_from_source.compose(&turn), ..found })
}

fn unit(up: Vector3<f64>) -> Result<Vector3<f64>> {
    let length = up.norm();
    if length.is_finite() && length > 0.0 {
        return Ok(up / length);
    }
    let remedy = "Pass the direction that is up in both frames.";
    Err(Error::new(ErrorCode::InvalidOption, "options.up", "no direction", "a vector of a length above 0", remedy))
}

/// The smallest rotation from one unit vector to another.
fn shortest_turn(from: Vector3<f64>, to: Vector3<f64>) -> Rotation3<f64> {
    let axis = from.cross(&to);
    let (sine, cosine) = (axis.norm(), from.dot(&to));
    if sine > 1e-12 {
        return about(axis / sine, sine, cosine);
    }
    if cosine > 0.0 {
        return Rotation3::identity();
    }
    // For opposite vectors: a half turn about any perpendicular axis.
    let other = if from.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    about(from.cross(&other).normalize(), 0.0, -1.0)
}
