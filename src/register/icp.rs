//! Scale-locked ICP (paper §3.3): refines R and t, and s only where the caller unlocks it.
//!
//! Each iteration pairs every supported source point with its nearest target point and takes one weighted
//! Gauss-Newton step (point-to-plane) or one closed form (point-to-point). Tukey's biweight on the residuals,
//! with its width from their median, gives the points that do not belong no say. The support distance shrinks
//! from generous to tight as the pose improves, so the hallucination filter is re-evaluated at every step.

use nalgebra::Vector3;

use super::support::{Support, SupportSettings, supported};
use super::tukey::biweights;
use super::umeyama::{Pair, ScaleMode, umeyama};
use crate::geometry::angle;
use crate::geometry::cloud::Cloud;
use crate::geometry::kd_tree::KdTree;
use crate::geometry::normal_equations::{NormalEquations, PARAMETERS};
use crate::geometry::similarity::{Similarity, nearest_rotation, vector3};

/// What an iteration minimises.
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
    /// What is minimised.
    pub metric: IcpMetric,
    /// Tukey's biweight on the residuals; `false` gives every pair the same say, as classical ICP does.
    pub robust: bool,
    /// ŝ stays as it came in (the paper's lock).
    pub lock_scale: bool,
    /// The scale never leaves this interval when it is not locked.
    pub scale_bounds: Option<[f64; 2]>,
    /// Most iterations.
    pub max_iterations: usize,
    /// Support at the first iteration.
    pub support: SupportSettings,
    /// The support distance shrinks towards this one, by a quarter an iteration.
    pub final_distance: f32,
    /// Converged when no point of a unit box moves further than this in an iteration.
    pub tolerance: f64,
}

/// The refined pose and how it came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refined {
    /// The transform.
    pub target_from_source: Similarity,
    /// Iterations taken.
    pub iterations: usize,
    /// Whether the last iteration moved less than the tolerance.
    pub converged: bool,
    /// Source points that took part in the last iteration.
    pub supported: usize,
    /// Weighted root mean square residual of the last iteration, in the target frame's unit.
    pub rms: f64,
}

/// What f32 leaves uncertain in a unit box.
const ROUNDING: f64 = 1e-6;

/// Factor of the support distance from one iteration to the next.
const SHRINK: f32 = 0.75;

/// Refines a pose. With too little support for a step (fewer than six points) the pose stays as it is and
/// `converged` is false.
pub fn refine(
    source: &Cloud,
    target: &Cloud,
    target_tree: &KdTree,
    initial: &Similarity,
    settings: &IcpSettings,
) -> Refined {
    let mut refined = Refined { target_from_source: *initial, iterations: 0, converged: false, supported: 0, rms: 0.0 };
    let mut support_settings = settings.support;
    while refined.iterations < settings.max_iterations {
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

/// One residual of an iteration.
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
        if settings.robust {
            let values: Vec<f64> = residuals.iter().map(|r| r.value).collect();
            for (residual, weight) in residuals.iter_mut().zip(biweights(&values, ROUNDING)) {
                residual.weight = weight;
            }
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
            // The turn and the scale stay about the middle of the points that matter, not about the origin.
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

/// One point-to-plane step in (ω, τ, σ): x ↦ c + e^σ exp(ω)(x − c) + τ about the centre c of the weighted
/// points, which keeps turn and shift apart. A locked scale has no say in any residual, and does not move.
fn gauss_newton(residuals: &Residuals, pose: &Similarity, lock_scale: bool) -> Option<Similarity> {
    let center = weighted_center(residuals);
    let mut equations = NormalEquations::new();
    for r in residuals.0.iter().filter(|r| r.weight > 0.0) {
        let arm = r.landed - center;
        let mut jacobian = rigid_jacobian(arm, r.normal);
        jacobian[6] = if lock_scale { 0.0 } else { arm.dot(&r.normal) };
        equations.add(&jacobian, r.value, r.weight);
    }
    // Directions that the data leave free (a plane slides on itself) stay where they are.
    let delta = equations.solve(1e-9)?;
    moved(pose, center, &delta)
}

/// The derivatives by (ω, τ, σ) of the distance along `direction` that a point at `arm` from the centre moves.
pub fn rigid_jacobian(arm: Vector3<f64>, direction: Vector3<f64>) -> [f64; PARAMETERS] {
    let turn = arm.cross(&direction);
    [turn.x, turn.y, turn.z, direction.x, direction.y, direction.z, 0.0]
}

/// The pose after the step (ω, τ, σ) about `center`; `None` where that is not finite.
pub fn moved(pose: &Similarity, center: Vector3<f64>, delta: &[f64; PARAMETERS]) -> Option<Similarity> {
    let turn = angle::turn(Vector3::new(delta[0], delta[1], delta[2]));
    let shift = Vector3::new(delta[3], delta[4], delta[5]);
    let growth = libm::exp(delta[6].clamp(-0.5, 0.5));
    let turn = turn.to_rotation_matrix();
    // Products of many small turns drift off SO(3) by rounding; the projection keeps R a rotation.
    let rotation = nearest_rotation((turn * pose.rotation).into_inner());
    let translation = center + turn * (pose.translation - center) * growth + shift;
    let finite = translation.iter().chain(rotation.matrix().iter()).all(|x| x.is_finite());
    finite.then_some(Similarity { scale: pose.scale * growth, rotation, translation })
}

/// The furthest that a corner of the unit box moves from one pose to the next.
pub fn movement(from: &Similarity, to: &Similarity) -> f64 {
    let corner = |i: usize| Vector3::new(0.5 - (i & 1) as f64, 0.5 - (i >> 1 & 1) as f64, 0.5 - (i >> 2 & 1) as f64);
    (0..8).map(|i| (from.apply(corner(i)) - to.apply(corner(i))).norm()).fold(0.0, f64::max)
}
