//! The least-squares similarity between corresponding points, in closed form (paper §3.2; Umeyama 1991).
//!
//! With centroids p̄, q̄ and Σ = Σ w (q − q̄)(p − p̄)ᵀ = U D Vᵀ:
//! R* = U S Vᵀ, s* = tr(D S) / Σ w ‖p − p̄‖² (= tr(RᵀΣ) / …), t* = q̄ − s* R* p̄,
//! where S = diag(1, 1, det(U) det(V)) makes R* a rotation if a reflection would fit better.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::error::{Error, ErrorCode, Result};
use crate::geometry::similarity::Similarity;
use crate::geometry::singular_values::SingularValues;

/// Ratio of the second to the first singular value below which points are collinear up to rounding, so that the
/// rotation about their line is undetermined.
const COLLINEAR: f64 = 1e-6;

/// Whether the scale is estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ScaleMode {
    /// s* from the data.
    Free,
    /// s fixed at this value; R* does not depend on it.
    Fixed(f64),
}

/// A point, its counterpart and its weight ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// p, in the source frame.
    pub source: Vector3<f64>,
    /// q, in the target frame.
    pub target: Vector3<f64>,
    /// w ≥ 0.
    pub weight: f64,
}

/// The similarity that minimises Σ w ‖q − (s R p + t)‖².
///
/// # Errors
/// [`ErrorCode::TooFewPoints`] for fewer than three pairs of positive weight;
/// [`ErrorCode::DegeneratePoints`] if either side is coincident, collinear, or not finite.
pub fn umeyama(pairs: impl Iterator<Item = Pair>, scale_mode: ScaleMode) -> Result<Similarity> {
    closed_form(&pairs.collect::<Vec<_>>(), scale_mode)
}

fn closed_form(pairs: &[Pair], scale_mode: ScaleMode) -> Result<Similarity> {
    let weighted = || pairs.iter().filter(|pair| pair.weight > 0.0);
    let count = weighted().count();
    if count < 3 {
        return Err(Error::new(
            ErrorCode::TooFewPoints,
            "correspondences",
            format!("{count} pairs"),
            "at least 3",
            "Three pairs that are not on one line determine a similarity.",
        ));
    }
    let total: f64 = weighted().map(|pair| pair.weight).sum();
    let mean =
        |side: fn(&Pair) -> Vector3<f64>| weighted().map(|pair| side(pair) * pair.weight).sum::<Vector3<f64>>() / total;
    let (p_mean, q_mean) = (mean(|pair| pair.source), mean(|pair| pair.target));

    let mut sigma = Matrix3::zeros();
    let (mut p_spread, mut q_spread) = (Matrix3::zeros(), Matrix3::zeros());
    for pair in weighted() {
        let (p, q) = (pair.source - p_mean, pair.target - q_mean);
        sigma += q * p.transpose() * pair.weight;
        p_spread += p * p.transpose() * pair.weight;
        q_spread += q * q.transpose() * pair.weight;
    }
    check_spread("source", &p_spread)?;
    check_spread("target", &q_spread)?;

    let SingularValues { u, values: d, v } = SingularValues::of(&sigma);
    if d[1].is_nan() || d[1] <= COLLINEAR * d[0] {
        return Err(degenerate("correspondences"));
    }
    // U and V are rotations: the sign of the last singular value contains S.
    let rotation = u * v.transpose();
    let scale = match scale_mode {
        ScaleMode::Free => (d[0] + d[1] + d[2]) / p_spread.trace(),
        ScaleMode::Fixed(scale) => scale,
    };
    if !(scale.is_finite() && scale > 0.0) {
        return Err(degenerate("correspondences"));
    }
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    Ok(Similarity { scale, rotation, translation: q_mean - rotation * p_mean * scale })
}

/// Rejects points that do not span a plane.
fn check_spread(argument: &str, spread: &Matrix3<f64>) -> Result<()> {
    if !spread.iter().all(|x| x.is_finite()) {
        return Err(degenerate(argument));
    }
    // Compares the middle eigenvalue with the largest by invariants, without a decomposition: the sum of the principal
    // minors, about the product of the two largest eigenvalues, relative to the squared trace.
    let trace = spread.trace();
    let minors = 0.5 * (trace * trace - (spread * spread).trace());
    if trace > 0.0 && minors > COLLINEAR * COLLINEAR * trace * trace { Ok(()) } else { Err(degenerate(argument)) }
}

fn degenerate(argument: &str) -> Error {
    Error::new(
        ErrorCode::DegeneratePoints,
        argument.to_owned(),
        "points that coincide or lie on one line",
        "points that span at least a plane",
        "The rotation about the line is undetermined. Add pairs that are not on it.",
    )
}
