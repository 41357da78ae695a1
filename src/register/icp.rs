//! Scale-locked ICP (paper §3.3): refines R and t, and s only if it is unlocked.
//!
//! Each iteration pairs every supported source point with its nearest target point and takes one weighted
//! Gauss-Newton step (point-to-plane) or one closed form (point-to-point). Tukey's biweight, with a width from the
//! median of the residuals, excludes outliers. The support distance decreases as the pose improves, and the
//! hallucination filter is evaluated in every iteration.

use nalgebra::Vector3;

use super::support::{Support, SupportSettings, supported};
use super::tukey::biweights;
use super::umeyama::{Pair, ScaleMode, umeyama};
use crate::geometry::angle;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::normal_equations::{NormalEquations, PARAMETERS};
use crate::geometry::similarity::{Similarity, nearest_rotation, vector3};
use crate::scheduler::Scheduler;

/// The distance that an iteration minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IcpMetric {
    /// Distance to the target's tangent plane (Chen & Medioni). Needs target normals.
    PointToPlane,
    /// Distance to the target point (Besl & McKay).
    PointToPoint,
}

/// Settings of [`refine`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IcpSettings {
    /// The distance to minimise.
    pub metric: IcpMetric,
    /// Whether ŝ is kept (the scale lock of the paper).
    pub lock_scale: bool,
    /// Bounds of the scale if it is not locked.
    pub scale_bounds: Option<[f64; 2]>,
    /// Maximum number of iterations.
    pub max_iterations: usize,
    /// Support in the first iteration.
    pub support: SupportSettings,
    /// Final support distance; it decreases by a quarter per iteration.
    pub final_distance: f32,
    /// ICP has converged if no corner of the unit box moves further than this in an iteration.
    pub tolerance: f64,
}

/// Result of [`refine`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refined {
    /// The transform.
    pub target_from_source: Similarity,
    /// Iterations taken.
    pub iterations: usize,
    /// Whether the last iteration moved the pose by less than the tolerance.
    pub converged: bool,
    /// Number of supported source points in the last iteration.
    pub supported: usize,
    /// Weighted root mean square residual of the last iteration, in the unit of the target.
    pub rms: f64,
}

/// Rounding error of f32 coordinates in a unit box.
const ROUNDING: f64 = 1e-6;

/// Factor of the support distance per iteration.
const SHRINK: f32 = 0.75;

/// Units of work of a source point in an iteration.
const LANDED: f64 = 1e-3;

/// Refines a pose of `source` relative to `target`; `target_tree` is the search tree over the target. With too little
/// support for a step (fewer than six points), iteration stops and `converged` is false.
pub async fn refine(
    source: &Cloud,
    target: &Cloud,
    target_tree: &KdTree,
    initial: &Similarity,
    settings: &IcpSettings,
    scheduler: &Scheduler,
) -> Refined {
    let mut refined = Refined { target_from_source: *initial, iterations: 0, converged: false, supported: 0, rms: 0.0 };
    let mut support_settings = settings.support;
    while refined.iterations < settings.max_iterations && scheduler.may_continue(refined.iterations > 0) {
        scheduler.yield_after(LANDED * source.len() as f64).await;
        let support = supported(source, target, target_tree, &refined.target_from_source, &support_settings);
        refined.supported = support.len();
        let residuals = Residuals::of(&support, target, settings);
        let Some(next) = step(source, &residuals, &refined.target_from_source, settings) else { break };
        refined.rms = residuals.rms();
        refined.iterations += 1;
        let moved = movement(&refined.target_from_source, &next);
        refined.target_from_source = next;
        let tight =
            support_settings.max_distance <= settings.final_distance || !support_settings.max_distance.is_finite();
        if moved < settings.tolerance && tight {
            refined.converged = true;
            break;
        }
        if !tight {
            support_settings.max_distance = (support_settings.max_distance * SHRINK).max(settings.final_distance);
        }
    }
    refined
}

/// A residual of an iteration.
struct Residual {
    source: usize,
    landed: Vector3<f64>,
    target: Vector3<f64>,
    /// The target's normal; zero for point-to-point.
    normal: Vector3<f64>,
    /// Signed distance to the plane, or distance to the point.
    value: f64,
    weight: f64,
}

struct Residuals(Vec<Residual>);

impl Residuals {
    fn of(support: &[Support], target: &Cloud, settings: &IcpSettings) -> Self {
        let metric = settings.metric;
        let residual = |s: &Support| {
            let index = s.target as usize;
            let (landed, point) = (vector3(s.landed), vector3(*target.points.get(index)?));
            let normal = match metric {
                IcpMetric::PointToPoint => Vector3::zeros(),
                IcpMetric::PointToPlane => vector3(*target.normals.get(index).filter(|n| **n != glam::Vec3::ZERO)?),
            };
            let value = match metric {
                IcpMetric::PointToPoint => (landed - point).norm(),
                IcpMetric::PointToPlane => normal.dot(&(landed - point)),
            };
            Some(Residual { source: s.source as usize, landed, target: point, normal, value, weight: 1.0 })
        };
        let mut residuals: Vec<Residual> = support.iter().filter_map(residual).collect();
        // Tukey's biweights, where classical ICP weights all pairs equally.
        let values: Vec<f64> = residuals.iter().map(|r| r.value).collect();
        for (residual, weight) in residuals.iter_mut().zip(biweights(&values, ROUNDING)) {
            residual.weight = weight;
        }
        Self(residuals)
    }

    fn rms(&self) -> f64 {
        let weight: f64 = self.0.iter().map(|r| r.weight).sum();
        let squares: f64 = self.0.iter().map(|r| r.weight * r.value * r.value).sum();
        if weight > 0.0 { (squares / weight).sqrt() } else { 0.0 }
    }
}

fn step(source: &Cloud, residuals: &Residuals, pose: &Similarity, settings: &IcpSettings) -> Option<Similarity> {
    if residuals.0.iter().filter(|r| r.weight > 0.0).count() < 6 {
        return None;
    }
    let next = match settings.metric {
        IcpMetric::PointToPoint => closed_form(source, residuals, pose, settings.lock_scale)?,
        IcpMetric::PointToPlane => gauss_newton(residuals, pose, settings.lock_scale)?,
    };
    match settings.scale_bounds {
        Some([min, max]) if !settings.lock_scale && !(min..=max).contains(&next.scale) => {
            // The clamped scale is applied about the centre of the weighted points, not about the origin.
            let scale = next.scale.min(max).max(min);
            let center = weighted_center(residuals);
            let local = next.inverse().apply(center);
            Some(Similarity { scale, translation: center - next.rotation * local * scale, ..next })
        }
        _ => Some(next),
    }
}

fn closed_form(source: &Cloud, residuals: &Residuals, pose: &Similarity, lock_scale: bool) -> Option<Similarity> {
    let pairs = residuals.0.iter().filter_map(|r| {
        let point = vector3(*source.points.get(r.source)?);
        Some(Pair { source: point, target: r.target, weight: r.weight })
    });
    let scale_mode = if lock_scale { ScaleMode::Fixed(pose.scale) } else { ScaleMode::Free };
    umeyama(pairs, scale_mode).ok()
}

fn weighted_center(residuals: &Residuals) -> Vector3<f64> {
    let weight: f64 = residuals.0.iter().map(|r| r.weight).sum();
    residuals.0.iter().map(|r| r.landed * r.weight).sum::<Vector3<f64>>() / weight
}

/// One point-to-plane step in (ω, τ, σ): x ↦ c + e^σ exp(ω)(x − c) + τ about the centre c of the weighted points, which
/// decouples rotation and translation. With a locked scale, the derivatives by σ are 0, so that σ stays 0.
fn gauss_newton(residuals: &Residuals, pose: &Similarity, lock_scale: bool) -> Option<Similarity> {
    let center = weighted_center(residuals);
    let mut equations = NormalEquations::new();
    for r in residuals.0.iter().filter(|r| r.weight > 0.0) {
        let arm = r.landed - center;
        let mut jacobian = rigid_jacobian(arm, r.normal);
        jacobian[6] = if lock_scale { 0.0 } else { arm.dot(&r.normal) };
        equations.add(&jacobian, r.value, r.weight);
    }
    // The damping keeps the pose along unconstrained directions, such as sliding along a plane.
    let delta = equations.solve(1e-9)?;
    moved(pose, center, &delta)
}

/// The derivatives by (ω, τ, σ) of the motion along `direction` of a point at `arm` from the centre; that by σ is 0.
pub fn rigid_jacobian(arm: Vector3<f64>, direction: Vector3<f64>) -> [f64; PARAMETERS] {
    let moment = arm.cross(&direction);
    [moment.x, moment.y, moment.z, direction.x, direction.y, direction.z, 0.0]
}

/// The pose after the step (ω, τ, σ) about `center`; `None` if it is not finite.
pub fn moved(pose: &Similarity, center: Vector3<f64>, delta: &[f64; PARAMETERS]) -> Option<Similarity> {
    let rotation_step = angle::exp_so3(Vector3::new(delta[0], delta[1], delta[2]));
    let shift = Vector3::new(delta[3], delta[4], delta[5]);
    let growth = libm::exp(delta[6].clamp(-0.5, 0.5));
    let rotation_step = rotation_step.to_rotation_matrix();
    // Rounding in products of many small rotations accumulates; the projection keeps R in SO(3).
    let rotation = nearest_rotation((rotation_step * pose.rotation).into_inner());
    let translation = center + rotation_step * (pose.translation - center) * growth + shift;
    let finite = translation.iter().chain(rotation.matrix().iter()).all(|x| x.is_finite());
    finite.then_some(Similarity { scale: pose.scale * growth, rotation, translation })
}

/// The maximum distance between corresponding corners of the unit box under two poses.
pub fn movement(from: &Similarity, to: &Similarity) -> f64 {
    let corner = |i: usize| Vector3::new(0.5 - (i & 1) as f64, 0.5 - (i >> 1 & 1) as f64, 0.5 - (i >> 2 & 1) as f64);
    (0..8).map(|i| (from.apply(corner(i)) - to.apply(corner(i))).norm()).fold(0.0, f64::max)
}
