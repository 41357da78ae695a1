//! Graduated non-convexity with truncated least squares (Yang, Antonante, Tzoumas, Carlone, RA-L 2020)
//! for rotations, from vector pairs with many outliers.
//!
//! The schedule is TEASER++'s: μ begins where the worst residual is just convex and grows by 1.4 an iteration; weights
//! follow in closed form. It has converged when the cost no longer changes.

use crate::prelude::*;
use sim3align_geometry::singular_values::SingularValues;

/// Factor of μ from one iteration to the next.
const GROWTH: f64 = 1.4;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 100;

/// Converged if the cost changes by less than this, in squared noise bounds.
const REST: f64 = 1e-9;

/// Ratio of the second to the first singular value below which vectors are collinear, so that the rotation about their
/// line is undetermined.
const COLLINEAR: f64 = 1e-6;

/// A vector in the source frame and its counterpart in the target frame.
pub type VectorPair = [Vector3<f64>; 2];

/// A rotation and the weights of the pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Gnc {
    /// R.
    pub rotation: Rotation3<f64>,
    /// Weights, 0 to 1.
    pub weights: Vec<f64>,
    /// Iterations taken.
    pub iterations: usize,
}

/// The set of permitted rotations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turns {
    /// All rotations: the residual of a pair is ‖b − R a‖.
    All,
    /// Rotations about a unit vector: the residual is the component perpendicular to it, as in Quatro.
    About(Vector3<f64>),
}

/// The rotation that minimises Σ min(r², `noise_bound`²), as far as graduated non-convexity finds it; `None` where
/// fewer than two pairs of vectors off one line are left.
pub fn gnc_tls(pairs: &[VectorPair], noise_bound: f64, turns: Turns) -> Option<Gnc> {
    let bound = noise_bound * noise_bound;
    let mut weights = vec![1.0; pairs.len()];
    let mut rotation = turns.fit(pairs, &weights)?;
    let (mut mu, mut previous) = (0.0, f64::INFINITY);
    for iterations in 1..=MAX_ITERATIONS {
        let residuals: Vec<f64> = pairs.iter().map(|pair| turns.residual_squared(&rotation, pair)).collect();
        if iterations == 1 {
            let worst = residuals.iter().copied().fold(0.0, f64::max);
            mu = 1.0 / (2.0 * worst / bound - 1.0);
            // All pairs are within the bound: no outliers.
            if mu.is_nan() || mu <= 0.0 {
                return Some(Gnc { rotation, weights, iterations });
            }
        }
        let cost: f64 = weights.iter().zip(&residuals).map(|(w, r)| w * r).sum();
        let (out, inside) = ((mu + 1.0) / mu * bound, mu / (mu + 1.0) * bound);
        for (weight, &residual) in weights.iter_mut().zip(&residuals) {
            *weight = if residual >= out {
                0.0
            } else if residual <= inside {
                1.0
            } else {
                (bound * mu * (mu + 1.0) / residual).sqrt() - mu
            };
        }
        if (cost - previous).abs() < REST * bound {
            return Some(Gnc { rotation, weights, iterations });
        }
        (mu, previous) = (mu * GROWTH, cost);
        rotation = turns.fit(pairs, &weights)?;
    }
    Some(Gnc { rotation, weights, iterations: MAX_ITERATIONS })
}

impl Turns {
    /// The rotation that minimises Σ w r².
    fn fit(self, pairs: &[VectorPair], weights: &[f64]) -> Option<Rotation3<f64>> {
        let weighted = pairs.iter().zip(weights);
        match self {
            Self::All => {
                let sigma = weighted.map(|([a, b], w)| b * a.transpose() * *w).sum::<Matrix3<f64>>();
                let SingularValues { u, values, v } = SingularValues::of(&sigma);
                let spans = values[0].is_finite() && values[1] > COLLINEAR * values[0];
                spans.then(|| Rotation3::from_matrix_unchecked(u * v.transpose()))
            }
            Self::About(up) => {
                let (mut sine, mut cosine) = (0.0, 0.0);
                for ([a, b], w) in weighted {
                    sine += w * up.dot(&a.cross(b));
                    cosine += w * across(up, a).dot(b);
                }
                let length = (sine * sine + cosine * cosine).sqrt();
                (length.is_finite() && length > 0.0).then(|| about(up, sine / length, cosine / length))
            }
        }
    }

    fn residual_squared(self, rotation: &Rotation3<f64>, [a, b]: &VectorPair) -> f64 {
        let off = b - rotation * a;
        match self {
            Self::All => off.norm_squared(),
            Self::About(up) => across(up, &off).norm_squared(),
        }
    }
}

fn across(up: Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    v - up * up.dot(v)
}

/// Rodrigues' rotation about a unit vector.
fn about(axis: Vector3<f64>, sine: f64, cosine: f64) -> Rotation3<f64> {
    let turn = Matrix3::identity() * cosine + axis.cross_matrix() * sine + axis * axis.transpose() * (1.0 - cosine);
    Rotation3::from_matrix_unchecked(turn)
}
