//! Generalized ICP, plane to plane (Segal, Haehnel, Thrun, "Generalized-ICP", RSS 2009).
//!
//! Every point represents a surface patch with covariance 1 along and ε across the surface. The residual of a pair is
//! weighted by the inverse of the sum of both covariances, so that patches can slide along each other but not apart. As
//! in small_gicp and Open3D: ε = 1e-3, 20 neighbours, nearest neighbours paired anew in every iteration; steps are
//! those of Levenberg–Marquardt, as in small_gicp.
//!
//! Intentional differences: a covariance is stored as its normal; if the neighbours are collinear, it is 1 in all
//! directions, as in small_gicp for too few neighbours.

use super::icp::{TOLERANCE, no_overlap};
use crate::prelude::*;
use sim3align::evidence::normals::{Neighborhood, Orientation, estimate_normals};
use sim3align::register::icp::{Refined, moved, movement, rigid_jacobian};
use sim3align_geometry::normal_equations::NormalEquations;

/// Fewer pairs than this do not determine a pose.
const MIN_PAIRS: usize = 6;

/// Maximum number of steps per linearisation.
const TRIALS: usize = 10;

/// Initial damping, relative to the trace.
const DAMPING: f64 = 1e-6;

/// Neighbours for surface estimation, including the point itself.
const NEIGHBORS: usize = 20;

/// Variance across a surface; that along it is 1.
const EPSILON: f64 = 1e-3;

/// Factor by which the damping increases after a rejected step, and decreases after an accepted one.
const DAMPING_FACTOR: f64 = 10.0;

/// A pair of an iteration.
struct Patches {
    source: Vector3<f64>,
    target: Vector3<f64>,
    /// Rows of W, where WᵀW is the inverse of the sum of both covariances.
    whitening: [Vector3<f64>; 3],
}

impl Patches {
    fn error(&self, pose: &Similarity) -> f64 {
        let off = pose.apply(self.source) - self.target;
        self.whitening.iter().map(|row| row.dot(&off) * row.dot(&off)).sum()
    }
}

/// Rigid GICP, the scale that of `initial`. The distance is in the unit of the target; `target_tree` is the tree over the target.
///
/// # Errors
/// [`NoConsensus`](sim3align_geometry::error::ErrorCode::NoConsensus) where fewer than six source points have a target
/// point within reach.
pub fn solve(
    source: &[Vec3],
    target: &[Vec3],
    target_tree: &KdTree,
    initial: &Similarity,
    max_correspondence_distance: f32,
    max_iterations: usize,
) -> Result<Refined> {
    let normals = |points: &[Vec3], tree: &KdTree| {
        // The covariance does not depend on the sign of the normal.
        estimate_normals(points, tree, Neighborhood::nearest(NEIGHBORS), Orientation::TowardsCamera)
    };
    let (source_normals, target_normals) = (normals(source, &KdTree::new(source)), normals(target, target_tree));
    let pairs = |pose: &Similarity| -> Vec<Patches> {
        let transform = pose.to_f32();
        let pair = |(&p, &p_normal): (&Vec3, &Vec3)| {
            let nearest = target_tree.nearest_within(transform.apply(p), max_correspondence_distance)?.index as usize;
            let (q, q_normal) = (target.get(nearest)?, target_normals.get(nearest)?);
            let sum = covariance(pose.rotation * vector3(p_normal)) + covariance(vector3(*q_normal));
            Some(Patches { source: vector3(p), target: vector3(*q), whitening: whitening(&sum)? })
        };
        source.iter().zip(&source_normals).filter_map(pair).collect()
    };

    let mut refined = Refined { target_from_source: *initial, iterations: 0, converged: false, supported: 0, rms: 0.0 };
    let mut damping = DAMPING;
    while refined.iterations < max_iterations && !refined.converged {
        let pose = refined.target_from_source;
        let pairs = pairs(&pose);
        refined.supported = pairs.len();
        if pairs.len() < MIN_PAIRS {
            break;
        }
        refined.iterations += 1;
        let mut equations = NormalEquations::new();
        for pair in &pairs {
            let landed = pose.apply(pair.source);
            for row in pair.whitening {
                equations.add(&rigid_jacobian(landed, row), row.dot(&(landed - pair.target)), 1.0);
            }
        }
        let error = |pose: &Similarity| pairs.iter().map(|pair| pair.error(pose)).sum::<f64>();
        let before = error(&pose);
        // As a distance across the surfaces, of which both have a variance of ε.
        refined.rms = (2.0 * EPSILON * before / pairs.len() as f64).sqrt();
        // If no step decreases the cost, the pose has converged.
        refined.converged = true;
        for _ in 0..TRIALS {
            let next = equations.solve(damping).and_then(|delta| moved(&pose, Vector3::zeros(), &delta));
            if let Some(next) = next.filter(|next| error(next) <= before) {
                refined.target_from_source = next;
                refined.converged = movement(&pose, &next) < TOLERANCE;
                damping /= DAMPING_FACTOR;
                break;
            }
            damping *= DAMPING_FACTOR;
        }
        // With a damping of 0, unconstrained directions would be undetermined.
        damping = damping.max(1e-12);
    }
    if refined.iterations == 0 { Err(no_overlap(refined.supported)) } else { Ok(refined) }
}

/// The covariance: 1 along the surface, ε across it; the identity without a normal.
fn covariance(normal: Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() - normal * normal.transpose() * (1.0 - EPSILON)
}

/// The rows of L⁻¹ with L Lᵀ = `c`, by Cholesky decomposition; `None` if `c` is not positive definite.
fn whitening(c: &Matrix3<f64>) -> Option<[Vector3<f64>; 3]> {
    let l00 = c[(0, 0)].sqrt();
    let (l10, l20) = (c[(1, 0)] / l00, c[(2, 0)] / l00);
    let l11 = (c[(1, 1)] - l10 * l10).sqrt();
    let l21 = (c[(2, 1)] - l20 * l10) / l11;
    let l22 = (c[(2, 2)] - l20 * l20 - l21 * l21).sqrt();
    let rows = [
        Vector3::new(1.0 / l00, 0.0, 0.0),
        Vector3::new(-l10 / l00, 1.0, 0.0) / l11,
        Vector3::new((l10 * l21 / l11 - l20) / l00, -l21 / l11, 1.0) / l22,
    ];
    rows.iter().all(|row| row.iter().all(|x| x.is_finite())).then_some(rows)
}
